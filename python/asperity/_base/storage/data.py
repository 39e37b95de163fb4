"""Values as tables of data: the arguments of their constructors, by name.

A table holds numbers, words, lists and other tables. Nothing in it is executed: it only chooses
among constructors that are known, which check what they are given.
"""

from __future__ import annotations

import dataclasses
import functools
import inspect
import re
from collections.abc import Callable, Mapping
from types import ModuleType
from typing import Any, NamedTuple, TypeVar, get_args, get_type_hints

import numpy as np
from numpy.typing import NDArray

from asperity._base.storage.toml import COUNT, TEXT, Schema, advice_on
from asperity._base.value import Value, View
from asperity.errors import ParameterError

Kinds = Mapping[str, type]
"""Constructors by the word for them in ``type``."""
Arrays = dict[str, NDArray[Any]]
"""Arrays that stand beside a table, by their keys."""
AnyValue = TypeVar("AnyValue")
# More than anyone nests sets, less than Python nests calls.
_DEEPEST = 50
# Classes that a message names.
_LISTED = 30
# Arrays of more entries are put beside the table, where there is a place for them.
_INLINE = 64
# The only key of a table that stands for an array beside it, and what stands in front of the keys
# of dictionaries, so that none of them is mistaken for a type.
_ARRAY, _KEY = "array", ":"
_PLAIN = (bool, int, float, str)


def classes(*modules: ModuleType) -> dict[str, type]:
    """Return the public classes of values of some modules by their names, without mere bases."""
    return {
        name: one
        for module in modules
        for name, one in sorted(vars(module).items())
        if isinstance(one, type) and issubclass(one, Value) and not name.startswith("_")
        if (one.__module__.startswith(module.__name__) or name in module.__all__)
        and one.__init__ is not object.__init__
    }


def arguments(
    value: object,
    key: str,
    table: Callable[[Any, str], Any],
    arrays: Arrays | None = None,
) -> dict[str, Any]:
    """Return the arguments of a value's constructor, defaults too but for None.

    A file then says all, and means the same if a default changes.

    Args:
        value: the value; with `arrays` also a dataclass, a named tuple or a dictionary.
        key: of the value, for messages.
        table: returns what stands for a value among the arguments, given its key.
        arrays: where arrays are put by their keys that a list cannot hold, or that are large; by
            default all become lists.

    Raises:
        ParameterError: whose argument is the key of an object that is not data, such as a function.
    """

    def plain(part: Any, key: str) -> Any:
        if isinstance(part, Value) or (arrays is not None and _is_record(part)):
            return table(part, key)
        if isinstance(part, np.ndarray):
            return _list_or_name(part, key, arrays, small=isinstance(value, Value))
        if isinstance(part, tuple):
            return [plain(one, _joined(key, f"[{i}]")) for i, one in enumerate(part)]
        if part is None or isinstance(part, _PLAIN):
            return part
        what = "a function" if callable(part) else f"of the class {type(part).__name__}"
        raise ParameterError(key, f"is {what}, which a file cannot hold")

    given = _parts(value)
    defaults = {} if isinstance(value, Mapping) else parameters(type(value))
    return {
        name: plain(part, _joined(key, f".{name}"))
        for name, part in given.items()
        # What is left out is the default. TOML cannot say None.
        if part is not None
        or (arrays is not None and (name not in defaults or defaults[name].default is not None))
    }


def _parameters(kind: Any) -> Mapping[str, inspect.Parameter]:
    """Return the parameters of a constructor; those that it unpacks by their names."""
    found: dict[str, inspect.Parameter] = {}
    for name, one in inspect.signature(kind).parameters.items():
        if one.kind is inspect.Parameter.VAR_KEYWORD:
            (keys,) = get_args(get_type_hints(kind)[name])
            for key in get_type_hints(keys):
                found[key] = inspect.Parameter(key, inspect.Parameter.KEYWORD_ONLY, default=None)
        else:
            found[name] = one
    return found


# Systems have thousands of parts of few classes.
parameters: Callable[[Any], Mapping[str, inspect.Parameter]] = functools.cache(_parameters)


def _parts(value: Any) -> dict[str, Any]:
    if isinstance(value, Value):
        given = value._stored()._parameters
        # A constructor may also take what follows from the parameters, if it is at hand.
        return {name: given[name] for name in parameters(type(value)) if name in given}
    if dataclasses.is_dataclass(value):
        return {field.name: getattr(value, field.name) for field in dataclasses.fields(value)}
    if isinstance(value, Mapping):
        return {f"{_KEY}{name}": part for name, part in value.items()}
    return value._asdict()


def _is_record(value: object) -> bool:
    """Whether it is a dataclass, a named tuple or a dictionary."""
    named = isinstance(value, tuple) and hasattr(value, "_asdict")
    return named or isinstance(value, Mapping) or dataclasses.is_dataclass(value)


def _list_or_name(part: NDArray[Any], key: str, arrays: Arrays | None, *, small: bool) -> Any:
    # Lists have neither complex numbers nor the shape of what has no entries; and records, unlike
    # values, make no arrays of lists. Arrays of the result itself are found by their own names.
    inline = small and "." in key and 0 < part.size <= _INLINE and part.dtype.kind != "c"
    if arrays is None or inline:
        return part.tolist()
    arrays[key] = part
    return {_ARRAY: key}


def _joined(key: str, part: str) -> str:
    return f"{key}{part}" if key else part.removeprefix(".")


_OF_A_PART = re.compile(r"(\w+)\[(\d+)\]\.(.+)")
"""Argument of a part of a list, such as ``pairs[1].body``."""


def built(kind: type[AnyValue], table: Any, key: str, part: Callable[[Any, str], Any]) -> AnyValue:
    """Return the value of a table of arguments.

    Args:
        kind: its class.
        table: what `arguments` has returned, or somebody has written.
        key: of the table, for messages.
        part: returns what a table among the arguments stands for, given its key.

    Raises:
        ParameterError: whose argument is the key of what is wrong.
    """
    _check_table(table, key, "a table of keys and values")
    known = parameters(kind)
    for name in table:
        if name not in known:
            raise ParameterError(_joined(key, f".{name}"), f"is not known{advice_on(name, known)}")
    for name, parameter in known.items():
        if parameter.default is inspect.Parameter.empty and name not in table:
            raise ParameterError(_joined(key, f".{name}"), "is missing")

    # Keys of the tables that parts of a list were made of.
    origins: dict[str, list[str]] = {}

    def made(value: Any, key: str) -> Any:
        if isinstance(value, Mapping):
            return part(value, key)
        if isinstance(value, list) and any(isinstance(one, Mapping) for one in value):
            each = [made(one, f"{key}[{i}]") for i, one in enumerate(value)]
            # A constructor may make several parts, such as the points of a rim.
            parts = [one if isinstance(one, tuple) else (one,) for one in each]
            origins[key] = [f"{key}[{i}]" for i, few in enumerate(parts) for _ in few]
            return [one for few in parts for one in few]
        return value

    given = {}
    for name, value in table.items():
        if not _takes_truth(known[name]):
            _refuse_truth(value, _joined(key, f".{name}"))
        given[name] = made(value, _joined(key, f".{name}"))
    if isinstance(kind, type) and not issubclass(kind, Value):
        given = {name: tuple(one) if isinstance(one, list) else one for name, one in given.items()}
    try:
        return kind(**given)
    except ParameterError as error:
        if error.argument in given:
            raise type(error)(_joined(key, f".{error.argument}"), error.message) from None
        if found := _OF_A_PART.fullmatch(error.argument):
            origin = origins[_joined(key, f".{found[1]}")][int(found[2])]
            raise type(error)(f"{origin}.{found[3]}", error.message) from None
        # The core may blame what it makes of the arguments.
        raise type(error)(key, str(error)) from None
    except (TypeError, ValueError, AttributeError, ArithmeticError, LookupError) as error:
        # Constructors check numbers and sets; a table in the place of a word may meet no check.
        raise ParameterError(
            key or kind.__qualname__, f"cannot be made into {kind.__qualname__}: {error}"
        ) from None


def typed(value: object, key: str, kinds: Kinds, arrays: Arrays | None = None) -> dict[str, Any]:
    """Return the table of a value of one of some classes: its ``type`` and its arguments.

    Args:
        value: the value; with `arrays` also a dataclass, a named tuple or a dictionary.
        key: of the value, for messages.
        kinds: the classes.
        arrays: as for `arguments`.

    Raises:
        ParameterError: for an object of another class, such as one of a user, which is code, and
            for one that is nested too deeply to be read again.
    """
    _check_depth(key)
    kind = dict if isinstance(value, View) else type(value)
    name = kind.__name__
    if kinds.get(name) is not kind:
        raise ParameterError(
            key, f"of the class {name} is code, and a file holds data: it takes {_words(kinds)}"
        )
    return {
        "type": name,
        **arguments(value, key, lambda one, key: typed(one, key, kinds, arrays), arrays),
    }


def built_as_typed(table: Any, key: str, kinds: Kinds, arrays: Arrays | None = None) -> Any:
    """Return the value of a table with its ``type`` and its arguments.

    Args:
        table: what `typed` has returned, or somebody has written.
        key: of the table, for messages.
        kinds: classes that may be made.
        arrays: that stand beside the table, by their keys; those that are used are taken out.

    Raises:
        ParameterError: whose argument is the key of what is wrong.
    """
    _check_table(table, key, "a table with its type and the arguments of that type")
    _check_depth(key)
    if arrays is not None and table.keys() == {_ARRAY}:
        name = table[_ARRAY]
        if not isinstance(name, str) or name not in arrays:
            raise ParameterError(key, f"needs the array {name!r}, which is missing")
        return arrays.pop(name)
    name, place = table.get("type"), _joined(key, ".type")
    if name is None:
        raise ParameterError(place, f"is missing: it is one of {_words(kinds)}")
    if not isinstance(name, str):
        raise ParameterError(place, f"must be one of {_words(kinds)}, got {name!r}")
    if name not in kinds:
        raise ParameterError(place, f"{name!r} is not known{advice_on(name, kinds)}")
    rest = {word: value for word, value in table.items() if word != "type"}
    if kinds[name] is dict:
        return {
            _key_of(word): built_as_typed(one, _joined(key, f".{word}"), kinds, arrays)
            for word, one in rest.items()
        }
    return built(kinds[name], rest, key, lambda one, key: built_as_typed(one, key, kinds, arrays))


def _check_depth(key: str) -> None:
    if key.count(".") > _DEEPEST:
        raise ParameterError(key, f"must not be nested in more than {_DEEPEST} tables")


def _key_of(word: str) -> int | str:
    """Return the key of a dictionary, a number or a word."""
    name = word.removeprefix(_KEY)
    return int(name) if name.isdecimal() else name


def _takes_truth(parameter: inspect.Parameter) -> bool:
    # Annotations are texts, those of named tuples references to what a text names.
    annotation = parameter.annotation
    name = getattr(annotation, "__forward_arg__", annotation)
    return name in ("bool", "Truth")


def _check_table(table: Any, key: str, words: str) -> None:
    if not isinstance(table, Mapping):
        raise ParameterError(key, f"must be {words}, got {table!r}")


def _refuse_truth(value: Any, key: str) -> None:
    """Refuse true and false, which NumPy takes for numbers."""
    if isinstance(value, bool):
        raise ParameterError(key, f"must not be a truth value, got {value!r}")
    if isinstance(value, list):
        for i, one in enumerate(value):
            _refuse_truth(one, f"{key}[{i}]")


def _words(kinds: Kinds) -> str:
    return ", ".join(kinds) if len(kinds) <= _LISTED else "the public classes of asperity"


class FileFormat(NamedTuple):
    """What the first lines of a file of data say, and what they may say when it is read.

    Attributes:
        name: what is in the file.
        version: of its keys; readers refuse newer ones.
    """

    name: str
    version: int

    def head(self) -> dict[str, Any]:
        """Return these lines."""
        return {"format": self.name, "version": self.version}

    def check(self, values: Mapping[str, Any]) -> None:
        """Refuse what is of another format, or of a newer version.

        Raises:
            ParameterError: whose argument is the key.
        """
        for key, expected in self.head().items():
            if key not in values:
                raise ParameterError(key, f"is missing: it is {expected!r}")
        name, version = values["format"], values["version"]
        if name != self.name:
            raise ParameterError("format", f"must be {self.name!r}, got {name!r}")
        if not COUNT.holds(version) or not 1 <= version <= self.version:
            known = "1" if self.version == 1 else f"1 to {self.version}"
            raise ParameterError("version", f"must be {known} for this asperity, got {version!r}")


HEAD_SCHEMA: Schema = {"format": TEXT, "version": COUNT}
"""Of these lines."""
