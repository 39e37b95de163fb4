"""What the site knows of the package: public names, their homes, the equations they state."""

from __future__ import annotations

import importlib
import inspect
import re
from collections import defaultdict
from collections.abc import Iterator
from dataclasses import dataclass
from functools import cached_property
from itertools import islice
from types import ModuleType
from typing import Any

import asperity

SUBPACKAGES = {
    "sets": "Sets",
    "law": "Friction laws",
    "contact": "Contact problems",
    "solvers": "Solvers",
    "system": "Systems",
    "runs": "Motions",
    "steady_sliding": "Stability of steady sliding",
    "cycles": "Limit cycles",
    "ensemble": "Many runs",
    "sweeps": "Sweeps",
    "status": "Words for states and ends",
    "errors": "Errors",
    "identify": "Identification",
    "predict": "Predictions",
    "track": "Tracking",
    "plot": "Pictures",
    "problems": "Generated contact problems",
    "mechanisms": "Mechanisms of instability",
    "mujoco": "MuJoCo models",
}
"""The subpackages in the order of the reference, with their titles."""

_HEADS = ("identify", "mechanisms", "mujoco", "plot", "predict", "problems", "track")
"""Subpackages whose names are not those of the package itself."""

_COMMON = ("Value", "Record")
"""Bases whose methods every page would repeat: the front page of the reference has them."""

_CITED = re.compile(r"\[WL19\]((?:[^.\[\]]|\.(?=\s?\d)|(?<=Fig)\.|(?<=Def)\.|(?<=Prop)\.)*)")
_NUMBERS = re.compile(r"\((\d+)(?:\)\s?[–-]\s?\((\d+))?\)")


@dataclass(frozen=True)
class Name:
    """A public name: where users import it from, and what it is."""

    path: str
    subpackage: str
    value: Any

    @property
    def is_class(self) -> bool:
        """Whether it is a class."""
        return inspect.isclass(self.value)

    @property
    def summary(self) -> str:
        """The first sentence of its docstring."""
        return (inspect.getdoc(self.value) or "").split("\n\n")[0].replace("\n", " ")


class Package:
    """All public names of the package."""

    @cached_property
    def names(self) -> list[Name]:
        """Every public name once, by subpackage."""
        found = []
        for subpackage in SUBPACKAGES:
            module = importlib.import_module(f"asperity.{subpackage}")
            prefix = f"asperity.{subpackage}" if subpackage in _HEADS else "asperity"
            for name in module.__all__:
                value = getattr(module, name)
                if not isinstance(value, ModuleType) and not isinstance(value, int):
                    found.append(Name(f"{prefix}.{name}", subpackage, value))
            # What nobody constructs is in its subpackage only.
            for name, value in vars(module).items():
                own = inspect.isclass(value) and value.__module__.startswith(module.__name__)
                if own and name not in module.__all__ and not name.startswith("_"):
                    found.append(Name(f"asperity.{subpackage}.{name}", subpackage, value))
        return found

    @cached_property
    def by_path(self) -> dict[str, Name]:
        """Names by the path that users import them from."""
        return {name.path: name for name in self.names}

    @cached_property
    def by_last(self) -> dict[str, list[str]]:
        """Paths by the last part of the name."""
        found = defaultdict(list)
        for name in self.names:
            found[name.path.rpartition(".")[2]].append(name.path)
        return found

    @cached_property
    def by_home(self) -> dict[str, str]:
        """Public paths by the module that defines the object."""
        return {
            f"{name.value.__module__}.{name.value.__qualname__}": name.path
            for name in self.names
            if hasattr(name.value, "__qualname__")
        }

    def bases(self, name: Name) -> list[type]:
        """Return the nearest public base of a class, or those from outside; none but `object`."""
        for base in name.value.__mro__[1:]:
            if f"{base.__module__}.{base.__qualname__}" in self.by_home:
                return [base]
        outside = (base for base in name.value.__mro__[1:] if base is not object)
        found = (base for base in outside if not base.__module__.startswith(("asperity", "abc")))
        return list(islice(found, 1))

    def members(self, name: Name) -> list[str]:
        """Return the members that the page of a class has: its own, and those of private bases.

        What a public base has is on the page of that base.
        """
        public = {id(one.value) for one in self.names}
        elsewhere: set[type] = set()
        for base in name.value.__mro__[1:]:
            if id(base) in public:
                elsewhere |= set(base.__mro__)
        found = {}
        for base in name.value.__mro__:
            if base in elsewhere or base.__name__ in _COMMON:
                continue
            if not base.__module__.startswith("asperity"):
                continue
            for key, value in vars(base).items():
                if not key.startswith("_") and _is_documented(value):
                    found.setdefault(key, value)
        return sorted(found)

    def resolve(self, text: str, inside: str = "") -> str | None:
        """Return the public path that words in backticks mean, or ``None``.

        Args:
            text: such as ``FrictionLaw.force``, ``identify.fit_law`` or ``force``.
            inside: the public class whose docstring it is.
        """
        words = text.removesuffix("()").removeprefix("asp.")
        words = self._public(words)
        for candidate in (words, f"asperity.{words}", f"{inside}.{words}" if inside else ""):
            if candidate in self.by_path:
                return candidate
            owner, _, member = candidate.rpartition(".")
            if owner in self.by_path and self._owner(owner, member):
                return f"{self._owner(owner, member)}.{member}"
        head, _, member = words.partition(".")
        paths = self.by_last.get(head, [])
        if len(paths) != 1:
            return None
        if not member:
            return paths[0]
        owner = self._owner(paths[0], member)
        if owner:
            return f"{owner}.{member}"
        # Fields and members of enumerations are described on the page of their class.
        value = self.by_path[paths[0]].value
        described = re.search(rf"^\s*{member}: ", inspect.getdoc(value) or "", re.MULTILINE)
        return paths[0] if described or hasattr(value, member) else None

    def dangles(self, text: str) -> bool:
        """Return whether words in backticks look like a public class and are none."""
        looks = re.fullmatch(r"(?:asp\.)?([A-Z]\w*[a-z]\w*)(?:\.\w+)?(?:\(\))?", text)
        return looks is not None and self.resolve(text) is None

    def _public(self, words: str) -> str:
        """Return the public path of what is named by the module that defines it."""
        head, _, member = words.rpartition(".")
        if words in self.by_home:
            return self.by_home[words]
        return f"{self.by_home[head]}.{member}" if head in self.by_home else words

    def _owner(self, path: str, member: str) -> str | None:
        """Return the public class on whose page a member of a class is."""
        name = self.by_path[path]
        if not name.is_class:
            return None
        for base in name.value.__mro__:
            public = self.by_home.get(f"{base.__module__}.{base.__qualname__}")
            if public and member in self._pages[public]:
                return public
        return None

    @cached_property
    def _pages(self) -> dict[str, set[str]]:
        return {name.path: set(self.members(name)) for name in self.names if name.is_class}

    def docstrings(self) -> Iterator[tuple[str, str]]:
        """Yield every public path that has a page or a place on one, with its docstring."""
        for name in self.names:
            yield name.path, inspect.getdoc(name.value) or ""
            if name.is_class:
                for member in self.members(name):
                    value = inspect.getattr_static(name.value, member)
                    text = getattr(getattr(value, "__func__", value), "__doc__", None) or ""
                    yield f"{name.path}.{member}", inspect.cleandoc(text)

    @cached_property
    def equations(self) -> dict[int, list[str]]:
        """What states or uses each equation of [WL19], as its docstring says."""
        found: dict[int, set[str]] = defaultdict(set)
        for path, text in self.docstrings():
            for number in cited(text):
                found[number].add(path)
        return {number: sorted(paths) for number, paths in sorted(found.items())}


def cited(text: str) -> set[int]:
    """Return the numbers of the equations of [WL19] that a docstring cites.

    >>> sorted(cited("Reference: [WL19] §4.1, (77), (79)–(81)."))
    [77, 79, 80, 81]
    """
    found: set[int] = set()
    for place in _CITED.finditer(" ".join(text.split())):
        for first, last in _NUMBERS.findall(place[1]):
            found |= set(range(int(first), int(last or first) + 1))
    return found


def _is_documented(value: Any) -> bool:
    inner = getattr(value, "__func__", value)
    return bool(getattr(inner, "__doc__", None)) and (
        inspect.isroutine(inner) or isinstance(value, property) or hasattr(value, "func")
    )


PACKAGE = Package()
VERSION = asperity.__version__
