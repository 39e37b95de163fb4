"""The one reader and the one writer of TOML.

What is not known is refused with file, line and key; what is written is read back to the bit.
"""

from __future__ import annotations

import datetime
import difflib
import json
import math
import os
import re
import tomllib
from collections.abc import Callable, Iterable, Iterator, Mapping
from contextlib import contextmanager
from functools import cached_property
from pathlib import Path
from typing import Any, NamedTuple, NoReturn, TypeAlias

import numpy as np

from asperity._base.storage.files import atomic, unreadable
from asperity._base.storage.key_lines import KeyLines
from asperity.errors import ConfigurationError, ParameterError, RecordError


class Kind(NamedTuple):
    """What a value may be: in words, and as a test."""

    words: str
    holds: Callable[[Any], bool]

    def or_several(self) -> Kind:
        """Return the kind of one such value or a list of them."""
        return Kind(f"{self.words} or several", lambda value: all(map(self.holds, _listed(value))))


class Tables(NamedTuple):
    """A list of tables ``[[key]]``, each with these keys."""

    schema: Schema


Schema: TypeAlias = "Mapping[str, Kind | Tables | Schema]"
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
TEXTS = Kind(
    "a list of texts", lambda value: isinstance(value, list | tuple) and all(map(TEXT.holds, value))
)
NUMBER = Kind("a number", lambda value: _is(value, int, float))
COUNT = Kind("a whole number", lambda value: _is(value, int))
SWITCH = Kind("true or false", lambda value: _is(value, bool))
NUMBERS = Kind("numbers", _holds_numbers)
TABLE = Kind("a table of keys and values", lambda value: isinstance(value, Mapping))


def check(values: Mapping[str, Any], schema: Schema) -> None:
    """Refuse keys that the schema does not have, and values of another kind.

    None, which TOML cannot say, is as if it were not there.

    Raises:
        ParameterError: whose argument is the key, after the name of its section and a dot.

    >>> from asperity._base.storage.toml import NUMBER, check
    >>> check({"mark": {"diametre": 0.01}}, {"mark": {"diameter": NUMBER}})
    Traceback (most recent call last):
    asperity.errors.ParameterError: mark.diametre: is not known, did you mean 'diameter'?
    """
    _check(values, schema, "", schema)


def _check(values: Mapping[str, Any], schema: Schema, section: str, whole: Schema) -> None:
    for name, value in values.items():
        key = f"{section}.{name}" if section else name
        kind = schema.get(name)
        if kind is None:
            _refuse(name, key, schema, whole)
        elif isinstance(kind, Kind):
            if value is not None and not kind.holds(value):
                raise ParameterError(key, f"must be {kind.words}, got {value!r}")
        elif isinstance(kind, Tables):
            if not isinstance(value, list | tuple):
                raise ParameterError(key, f"must be tables [[{key}]], got {value!r}")
            for i, one in enumerate(value):
                _check_section(one, kind.schema, f"{key}[{i}]", whole)
        else:
            _check_section(value, kind, key, whole)


def _check_section(value: Any, schema: Schema, key: str, whole: Schema) -> None:
    if not isinstance(value, Mapping):
        raise ParameterError(key, f"must be a section [{key}], got {value!r}")
    _check(value, schema, key, whole)


def _refuse(name: str, key: str, known: Mapping[str, Any], schema: Schema) -> NoReturn:
    """Refuse a key, with what it was perhaps meant to be."""
    homes = _homes(name, schema)
    if homes or (name in schema and name != key):
        advice = f"belongs into [{homes[0]}]" if homes else "belongs above all sections"
        raise ParameterError(key, f"is not known here, it {advice}")
    raise ParameterError(key, f"is not known{advice_on(name, known)}")


def advice_on(name: str, known: Iterable[str]) -> str:
    """Return the end of a sentence that refuses a word: what it was perhaps meant to be.

    >>> from asperity._base.storage.toml import advice_on
    >>> advice_on("Elipse", ["Disk", "Ellipse"]), advice_on("Torus", ["Disk", "Ellipse"])
    (", did you mean 'Ellipse'?", '; known are Disk, Ellipse')
    """
    words = list(known)
    # Below this, words have some letters in common by chance, and the list says more.
    near = difflib.get_close_matches(name, words, 1, cutoff=0.65)
    return f", did you mean {near[0]!r}?" if near else f"; known are {', '.join(words)}"


def _homes(name: str, schema: Schema) -> list[str]:
    """Return the sections that have a key."""
    return [home for home, keys in schema.items() if isinstance(keys, Mapping) and name in keys]


def write(
    path: str | os.PathLike[str],
    values: Mapping[str, Any],
    comments: Mapping[str, str] | None = None,
) -> None:
    """Write a file with these keys and sections, see `text`; it is complete or not there."""
    written = text(values, comments).encode()
    with atomic(path) as file:
        file.write(written)


# Numbers of a list that does not fit on a line are broken at this column.
_COLUMNS = 100


def text(values: Mapping[str, Any], comments: Mapping[str, str] | None = None) -> str:
    """Return the text of a file with these keys and sections; None is left out.

    Args:
        values: texts, numbers, truth values, lists and arrays of these, sections.
        comments: lines above keys and sections, by the key after those of its sections and dots;
            those of the whole file by ``""``.

    Raises:
        ParameterError: as of `plain`.

    >>> from asperity._base.storage.toml import text
    >>> print(text({"fps": 500.0, "mark": {"colour": "red", "diameter": None}}, {"mark": "seen"}))
    fps = 500.0
    <BLANKLINE>
    # seen
    [mark]
    colour = "red"
    <BLANKLINE>
    """
    said = {} if comments is None else comments
    parts = [_comment(said.get("")), *_section_texts(plain(values, ""), "", "", said)]
    return "\n".join(part for part in parts if part)


def _section_texts(
    values: Mapping[str, Any], section: str, head: str, comments: Mapping[str, str]
) -> Iterator[str]:
    """Yield the text of a section and of those within it."""
    own, within = "", []
    for name, value in values.items():
        key = f"{section}.{name}" if section else name
        if isinstance(value, Mapping):
            within.append((f"[{_path(section, name)}]", _path(section, name), value))
        elif isinstance(value, list) and value and all(isinstance(one, Mapping) for one in value):
            path = _path(section, name)
            within += [(f"[[{path}]]", path, one) for one in value]
        else:
            own += f"{_comment(comments.get(key))}{_key(name)} = {_value(value, name)}\n"
    comment = _comment(comments.get(section)) if section else ""
    # A section that only holds others needs no line of its own, an entry of a list does.
    if own or (head and (not within or head.startswith("[["))):
        yield f"{comment}{head}\n{own}" if head else own
    for header, path, value in within:
        yield from _section_texts(value, path, header, comments)


def _path(section: str, name: str) -> str:
    return f"{section}.{_key(name)}" if section else _key(name)


def _key(name: str) -> str:
    return name if re.fullmatch(r"[A-Za-z0-9_-]+", name) else _quoted(name)


def _comment(lines: str | None) -> str:
    return "" if not lines else "".join(f"# {line}".rstrip() + "\n" for line in lines.split("\n"))


def _quoted(words: str) -> str:
    # JSON leaves DEL as it is, which TOML does not take; halves of pairs cannot be encoded.
    whole = words.encode("utf-8", "replace").decode()
    return json.dumps(whole, ensure_ascii=False).replace("\x7f", "\\u007F")


def _value(value: Any, name: str) -> str:
    """Return a value as TOML; lists that do not fit behind their name are broken into lines."""
    if not isinstance(value, list):
        return _scalar(value)
    line = _one_line(value)
    if len(name) + len(" = ") + len(line) <= _COLUMNS:
        return line
    if any(isinstance(one, list | Mapping) for one in value):
        rows = "".join(f"    {_one_line(one)},\n" for one in value)
        return f"[\n{rows}]"
    rows, row = "", "   "
    for one in value:
        word = f" {_scalar(one)},"
        if len(row) + len(word) > _COLUMNS:
            rows, row = f"{rows}{row}\n", "   "
        row += word
    return f"[\n{rows}{row}\n]"


def _one_line(value: Any) -> str:
    if isinstance(value, list):
        return f"[{', '.join(map(_one_line, value))}]"
    if isinstance(value, Mapping):
        pairs = (f"{_key(name)} = {_one_line(one)}" for name, one in value.items())
        return f"{{{', '.join(pairs)}}}"
    return _scalar(value)


def _scalar(value: Any) -> str:
    if isinstance(value, bool):
        return "true" if value else "false"
    if isinstance(value, str):
        return _quoted(value)
    if isinstance(value, int | float):
        # The shortest digits that are read back to the bit.
        return repr(value)
    assert isinstance(value, _DATES)
    return value.isoformat()


class TomlFile:
    """A TOML file whose values have been checked.

    Args:
        path: of the file.
        schema: what it may hold.
        head: looks at the values before the schema does, to refuse a file of another kind.
        others: whether it may hold other keys, which are not looked at.

    Attributes:
        path: of the file.
        values: what it holds.
        text: as it is written.

    Raises:
        ConfigurationError: if it cannot be read, is not TOML, or has unknown keys.
    """

    def __init__(
        self,
        path: str | os.PathLike[str],
        schema: Schema,
        head: Callable[[Mapping[str, Any]], object] = lambda _: None,
        *,
        others: bool = False,
    ) -> None:
        self.path = Path(path)
        self._schema = schema
        self.text = ""
        self.values = self._parsed()
        with self.named():
            plain(self.values, "")
            head(self.values)
            known = {key: one for key, one in self.values.items() if key in schema or not others}
            check(known, schema)

    def _parsed(self) -> dict[str, Any]:
        line, raw = None, b""
        try:
            raw = self.path.read_bytes()
            self.text = raw.decode("utf-8-sig", "replace")
            return tomllib.loads(raw.decode("utf-8-sig"))
        except UnicodeDecodeError as error:
            problem, line = "is not TOML: save it as UTF-8", raw.count(b"\n", 0, error.start) + 1
        except RecursionError:
            problem, line = "must not be nested so deeply", self._lines.count
        except tomllib.TOMLDecodeError as error:
            problem, _, place = f"is not TOML: {error}".partition(" (at ")
            number = re.match(r"line (\d+)", place)
            line = int(number[1]) if number else self._lines.count
            if re.search(r"=\s*[-+]?\d+,\d", "".join(self.text.split("\n")[line - 1 : line])):
                problem += "; decimals take a point"
        except ValueError:
            # Python reads no more digits.
            long = re.search(rb"[0-9_]{4300,}", raw)
            # Else the name of the file holds what no name can.
            problem = (
                "cannot be read: no file has this name" if long is None else "has too many digits"
            )
            line = None if long is None else raw.count(b"\n", 0, long.start()) + 1
        except OSError as error:
            problem = unreadable(self.path, error)
        key = self._written(self._lines.begun(line))
        raise ConfigurationError(str(self.path), problem, key=key, line=line)

    @cached_property
    def _lines(self) -> KeyLines:
        # Curves have thousands of numbers: their lines are sought where something is wrong.
        return KeyLines(self.text)

    def error(self, key: str, message: str) -> ConfigurationError:
        """Return what to raise for a key, such as ``"file.header"`` or ``"file"``."""
        return ConfigurationError(
            str(self.path), message, key=self._written(key), line=self._lines.of(key)
        )

    @contextmanager
    def named(self) -> Iterator[None]:
        """Say of a wrong argument, whose name is its key, in which file and line it is."""
        try:
            yield
        except ParameterError as error:
            raise self.error(error.argument, error.message) from None

    @contextmanager
    def blamed(self) -> Iterator[None]:
        """Add file, line and key to errors about options."""
        try:
            yield
        except RecordError as error:
            if not error.options:
                raise
            *others, last = (self._written(self._home(name)) for name in error.options)
            places = (*others, f"{last} in {self.path}")
            raise RecordError(error.source, error.message, places) from None
        except ParameterError as error:
            if error.argument not in self._schema and not _homes(error.argument, self._schema):
                raise
            raise self.error(self._home(error.argument), error.message) from None

    def _home(self, name: str) -> str:
        """Return the key of an option by its section, if only one section has it."""
        homes = [] if name in self._schema else _homes(name, self._schema)
        return f"{homes[0]}.{name}" if len(homes) == 1 else name

    def _written(self, key: str) -> str:
        section, _, name = key.rpartition(".")
        if section:
            return f"[{section}] {name}"
        return f"[{key}]" if isinstance(self._schema.get(key), Mapping) else key


# More than anyone nests tables, less than Python nests calls.
_DEEPEST = 100
_DATES = (datetime.date, datetime.time)


def plain(value: Any, key: str, depth: int = 0) -> Any:
    """Return a value as a file says it: tables without None, lists and Python's own numbers.

    What is written and what is read pass the same limits, so that all that is saved can be loaded.

    Args:
        value: tables, lists, tuples, arrays, texts, numbers, truth values and dates.
        key: of the value, for messages.
        depth: how many tables and lists it is in.

    Raises:
        ParameterError: whose argument is the key of a value that is not data, of infinite numbers,
            whole ones of more bits than TOML keeps, and of what is nested too deeply.

    >>> import numpy as np
    >>> from asperity._base.storage.toml import plain
    >>> plain({"rate": np.float64(0.5), "angles": (1, 2), "note": None}, "")
    {'rate': 0.5, 'angles': [1, 2]}
    """
    if depth > _DEEPEST:
        raise ParameterError(key.partition(".")[0], "must not be nested so deeply")
    if isinstance(value, np.ndarray | np.generic):
        value = value.tolist()
    if isinstance(value, Mapping):
        return {
            _checked_key(name, key): plain(one, f"{key}.{name}" if key else name, depth + 1)
            for name, one in value.items()
            if one is not None
        }
    if isinstance(value, list | tuple):
        return [plain(one, f"{key}[{i}]", depth + 1) for i, one in enumerate(value)]
    if isinstance(value, float) and not math.isfinite(value):
        raise ParameterError(key, f"must be finite, got {value!r}")
    if isinstance(value, int) and not -(2**63) <= value < 2**63:
        raise ParameterError(key, "must be a whole number of 64 bits at most, or a decimal one")
    if not isinstance(value, (str, int, float, *_DATES)):
        raise ParameterError(
            key, f"must be data, which a file can hold, is of the class {type(value).__name__}"
        )
    return value


def _checked_key(name: Any, section: str) -> str:
    if not isinstance(name, str):
        raise ParameterError(section, f"must have texts for keys, got {name!r}")
    return name
