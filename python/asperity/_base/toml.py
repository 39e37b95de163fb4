"""The reader of configurations in TOML: what is not known is refused with file, line and key."""

from __future__ import annotations

import difflib
import json
import os
import re
import tomllib
from collections.abc import Callable, Iterator, Mapping
from contextlib import contextmanager
from pathlib import Path
from typing import Any, NamedTuple, TypeAlias

import numpy as np

from asperity.errors import ConfigurationError, ParameterError, RecordError


class Kind(NamedTuple):
    """What a value may be: in words, and as a test."""

    words: str
    holds: Callable[[Any], bool]

    def or_several(self) -> Kind:
        """Return the kind of one such value or a list of them."""
        return Kind(f"{self.words} or several", lambda value: all(map(self.holds, _listed(value))))


Schema: TypeAlias = Mapping[str, "Kind | Mapping[str, Kind]"]
"""Kinds by key, and sections of such."""


def _listed(value: Any) -> list[Any]:
    return list(value) if isinstance(value, list | tuple | np.ndarray) else [value]


def _is(value: Any, *kinds: type) -> bool:
    # True and False are numbers for Python, not for us.
    return isinstance(value, kinds) and (bool in kinds or not isinstance(value, bool))


def _holds_numbers(value: Any) -> bool:
    parts = _listed(value)
    return all(_is(one, int, float) if one is value else _holds_numbers(one) for one in parts)


TEXT = Kind("a text", lambda value: _is(value, str))
NUMBER = Kind("a number", lambda value: _is(value, int, float))
COUNT = Kind("a whole number", lambda value: _is(value, int))
SWITCH = Kind("true or false", lambda value: _is(value, bool))
NUMBERS = Kind("numbers", _holds_numbers)


def check(values: Mapping[str, Any], schema: Schema) -> None:
    """Refuse keys that the schema does not have, and values of another kind.

    None, which TOML cannot say, is as if it were not there.

    Raises:
        ParameterError: whose argument is the key, after the name of its section and a dot.

    >>> from asperity._base.toml import NUMBER, check
    >>> check({"mark": {"diametre": 0.01}}, {"mark": {"diameter": NUMBER}})
    Traceback (most recent call last):
    asperity.errors.ParameterError: mark.diametre: is not known, did you mean 'diameter'?
    """
    for key, value in values.items():
        kind = schema.get(key)
        if kind is None:
            _refuse(key, key, schema, schema)
        elif isinstance(kind, Kind):
            _check_kind(key, value, kind)
        elif not isinstance(value, Mapping):
            raise ParameterError(key, f"must be a section [{key}], got {value!r}")
        else:
            for inner, one in value.items():
                if inner not in kind:
                    _refuse(inner, f"{key}.{inner}", kind, schema)
                _check_kind(f"{key}.{inner}", one, kind[inner])


def _check_kind(key: str, value: Any, kind: Kind) -> None:
    if value is not None and not kind.holds(value):
        raise ParameterError(key, f"must be {kind.words}, got {value!r}")


def _refuse(name: str, key: str, known: Mapping[str, Any], schema: Schema) -> None:
    """Refuse a key, with what it was perhaps meant to be."""
    homes = _homes(name, schema)
    near = difflib.get_close_matches(name, known, 1)
    if homes or (name in schema and name != key):
        advice = f"belongs into [{homes[0]}]" if homes else "belongs above all sections"
        raise ParameterError(key, f"is not known here, it {advice}")
    if near:
        raise ParameterError(key, f"is not known, did you mean {near[0]!r}?")
    raise ParameterError(key, f"is not known; known are {', '.join(known)}")


def text(values: Mapping[str, Any]) -> str:
    """Return the text of a file with these keys and sections; None is left out.

    >>> from asperity._base.toml import text
    >>> print(text({"fps": 500.0, "mark": {"colour": "red", "diameter": None}}))
    fps = 500.0
    <BLANKLINE>
    [mark]
    colour = "red"
    <BLANKLINE>
    """
    keys = {key: value for key, value in values.items() if not isinstance(value, Mapping)}
    parts = [_keys_text(keys)] if keys else []
    for name, section in values.items():
        if isinstance(section, Mapping):
            parts.append(f"[{name}]\n{_keys_text(section)}")
    return "\n".join(parts)


def _keys_text(values: Mapping[str, Any]) -> str:
    # Texts, finite numbers, truth values and lists of these are written alike in JSON and TOML.
    return "".join(
        f"{key} = {json.dumps(value, ensure_ascii=False)}\n"
        for key, value in values.items()
        if value is not None
    )


def _homes(name: str, schema: Schema) -> list[str]:
    """Return the sections that know a key."""
    return [home for home, keys in schema.items() if not isinstance(keys, Kind) and name in keys]


class TomlFile:
    """A TOML file whose values have been checked.

    Args:
        path: of the file.
        schema: what it may hold.

    Attributes:
        path: of the file.
        values: what it holds.

    Raises:
        ConfigurationError: if it cannot be read, is no TOML, or holds what is not known.
    """

    def __init__(self, path: str | os.PathLike[str], schema: Schema) -> None:
        self.path = Path(path)
        self._schema = schema
        self._lines: list[str] = []
        self.values = self._parsed()
        try:
            check(self.values, schema)
        except ParameterError as error:
            raise self.error(error.argument, error.message) from None

    def _parsed(self) -> dict[str, Any]:
        line = None
        try:
            text = self.path.read_text(encoding="utf-8-sig")
            self._lines = text.splitlines()
            return tomllib.loads(text)
        except UnicodeDecodeError:
            problem = "is no TOML: save it as UTF-8"
        except tomllib.TOMLDecodeError as error:
            problem, _, place = f"is no TOML: {error}".partition(" (at ")
            number = re.match(r"line (\d+)", place)
            line = int(number[1]) if number else None
        except IsADirectoryError:
            problem = "is a folder: name the file in it"
        except OSError as error:
            problem = f"cannot be read: {error.strerror}"
        raise ConfigurationError(str(self.path), problem, line=line)

    def error(self, key: str, message: str) -> ConfigurationError:
        """Return what to raise for a key, such as ``"file.header"`` or ``"file"``."""
        return ConfigurationError(
            str(self.path), message, key=self._written(key), line=self._line(key)
        )

    @contextmanager
    def blamed(self) -> Iterator[None]:
        """Say of a wrong option where in the file it is, and of a remedy where to write it."""
        try:
            yield
        except RecordError as error:
            if not error.options:
                raise
            *others, last = (self._written(self._key(name)) for name in error.options)
            places = (*others, f"{last} in {self.path}")
            raise RecordError(error.source, error.message, places) from None
        except ParameterError as error:
            if error.argument not in self._schema and not _homes(error.argument, self._schema):
                raise
            raise self.error(self._key(error.argument), error.message) from None

    def _key(self, name: str) -> str:
        """Return the key of an option by its section, if only one section has it."""
        homes = [] if name in self._schema else _homes(name, self._schema)
        return f"{homes[0]}.{name}" if len(homes) == 1 else name

    def _written(self, key: str) -> str:
        section, _, name = key.rpartition(".")
        if section:
            return f"[{section}] {name}"
        return f"[{key}]" if isinstance(self._schema.get(key), Mapping) else key

    def _line(self, key: str) -> int | None:
        """Return the line in which a key stands, else that of its section, else none."""
        wanted, _, name = key.rpartition(".")
        section, found = "", None
        for number, line in enumerate(self._lines, 1):
            head = re.match(r"\s*\[\s*([^\[\]]+?)\s*\]", line)
            if head:
                section = head[1]
                found = number if section in (wanted, key) else found
            elif section == wanted and re.match(
                rf"""\s*["']?{re.escape(name)}["']?\s*[=.]""", line
            ):
                return number
        return found
