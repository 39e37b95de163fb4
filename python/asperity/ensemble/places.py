"""Parts of a system by their dotted names, and systems with other parts."""

from __future__ import annotations

import difflib
import re
from collections.abc import Iterator, Mapping
from typing import Any, TypeAlias

import numpy as np

from asperity._base.value import Value
from asperity.errors import ParameterError

Key: TypeAlias = str | int | tuple[int, ...]
"""A parameter, a place in a tuple or the indices of an array's entry."""
Place: TypeAlias = tuple[Key, ...]
"""Keys one within the other."""

_NAME = re.compile(r"[A-Za-z_]\w*")
_INDEX = re.compile(r"\[\s*(\*|\d+(?:\s*,\s*\d+)*)\s*\]")
# Names that a message looks for the nearest ones among, and how many it tells.
_LISTED, _TOLD = 2000, 3


def places(system: Value, name: str) -> list[Place]:
    """Return the places that a dotted name means, several where it holds ``[*]``.

    Raises:
        ParameterError: ``replace``, with the nearest names of what there is, if one of the places
            does not exist.

    >>> from asperity import FrictionLaw, SlidingPoint
    >>> from asperity.ensemble.places import places
    >>> places(SlidingPoint(1.0, law=FrictionLaw.isotropic(0.5)), "law.reservoir.radius")
    [('law', 'reservoir', 'radius')]
    """
    found: list[Place] = [()]
    for step in _steps(name):
        keys = [_keys(part_at(system, place), step) for place in found]
        if not found or not all(keys):
            raise ParameterError("replace", f"has no part {name!r}{_nearest(system, name)}")
        found = [(*place, key) for place, own in zip(found, keys, strict=True) for key in own]
    return found


def part_at(value: Any, place: Place) -> Any:
    """Return the part of a value at a place."""
    for key in place:
        # Keys of values are words.
        value = value._parameters[str(key)] if isinstance(value, Value) else value[key]
    return value


def replaced(value: Any, parts: Mapping[Place, Any]) -> Any:
    """Return a value with other parts; every value in between is made once, with all its parts."""
    if () in parts:
        return parts[()]
    within: dict[Key, dict[Place, Any]] = {}
    for (first, *rest), part in parts.items():
        within.setdefault(first, {})[tuple(rest)] = part
    changes = {key: replaced(part_at(value, (key,)), inner) for key, inner in within.items()}
    if isinstance(value, Value):
        return value.replace(**{str(key): part for key, part in changes.items()})
    if isinstance(value, np.ndarray):
        entries = np.array(value)
        for index, entry in changes.items():
            entries[index] = entry
        return entries
    return tuple(changes.get(i, part) for i, part in enumerate(value))


def _steps(name: str) -> Iterator[str]:
    """Yield the words and the indices of a dotted name."""
    rest = name if isinstance(name, str) else ""
    while True:
        word = _NAME.match(rest)
        if word is None:
            raise ParameterError(
                "replace",
                "must have names such as 'law.reservoir.angle' or 'pairs[*].law.reservoir.a', "
                f"got {name!r}",
            )
        yield word[0]
        rest = rest[word.end() :]
        while index := _INDEX.match(rest):
            yield index[1]
            rest = rest[index.end() :]
        if not rest:
            return
        rest = rest.removeprefix(".") if rest.startswith(".") else "?"


def _keys(value: Any, step: str) -> list[Key]:
    """Return the keys that a word or an index means within a value; none if it has no such part."""
    if _NAME.fullmatch(step):
        return [step] if isinstance(value, Value) and step in value._parameters else []
    if isinstance(value, tuple):
        indices = range(len(value)) if step == "*" else [int(one) for one in step.split(",")]
        return list(indices) if step == "*" else [i for i in indices[:1] if i < len(value)]
    if isinstance(value, np.ndarray):
        if step == "*":
            return list(np.ndindex(value.shape))
        index = tuple(int(one) for one in step.split(","))
        fits = len(index) == value.ndim and all(map(int.__lt__, index, value.shape))
        return [index] if fits else []
    return []


def _nearest(system: Value, name: str) -> str:
    names = [known for known, _ in zip(_names(system, ""), range(_LISTED), strict=False)]
    near = difflib.get_close_matches(name, names, n=_TOLD, cutoff=0.4)
    return f": the nearest are {', '.join(map(repr, near))}" if near else ""


def _names(value: Any, front: str) -> Iterator[str]:
    """Yield the names of all parts of a value, but of those of its tuples' first entries only."""
    if isinstance(value, Value):
        for name, part in value._parameters.items():
            if part is not None:
                yield f"{front}{name}"
                yield from _names(part, f"{front}{name}.")
    elif isinstance(value, tuple) and value and isinstance(value[0], Value):
        yield from _names(value[0], f"{front[:-1]}[*].")
        yield from _names(value[0], f"{front[:-1]}[0].")
