"""Values as tables of data: the arguments of their constructors, by name.

A table holds numbers, words, lists and other tables. Nothing in it is executed: it only chooses
among constructors that are known, which check what they are given.
"""

from __future__ import annotations

import inspect
from collections.abc import Callable, Mapping
from typing import Any, NamedTuple, TypeVar

import numpy as np

from asperity._base.toml import COUNT, TEXT, Schema, advice_on
from asperity._base.value import Value
from asperity.errors import ParameterError

Kinds = Mapping[str, type[Value]]
"""Constructors by the word for them in ``type``."""
AnyValue = TypeVar("AnyValue", bound=Value)
# More than anyone nests sets, less than Python nests calls.
_DEEPEST = 50


def arguments(value: Value, key: str, table: Callable[[Value, str], Any]) -> dict[str, Any]:
    """Return the arguments of a value's constructor, defaults too but for None.

    A file then says all, and means the same if a default changes.

    Args:
        value: the value.
        key: of the value, for messages.
        table: returns what stands for a value among the arguments, given its key.
    """

    def plain(part: Any, key: str) -> Any:
        if isinstance(part, Value):
            return table(part, key)
        if isinstance(part, tuple):
            return [plain(one, f"{key}[{i}]") for i, one in enumerate(part)]
        return part.tolist() if isinstance(part, np.ndarray) else part

    given = ((name, value._parameters[name]) for name in inspect.signature(type(value)).parameters)
    return {name: plain(part, f"{key}.{name}") for name, part in given if part is not None}


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
    parameters = inspect.signature(kind).parameters
    for name in table:
        if name not in parameters:
            raise ParameterError(f"{key}.{name}", f"is not known{advice_on(name, parameters)}")
    for name, parameter in parameters.items():
        if parameter.default is inspect.Parameter.empty and name not in table:
            raise ParameterError(f"{key}.{name}", "is missing")

    def made(value: Any, key: str) -> Any:
        if isinstance(value, Mapping):
            return part(value, key)
        if isinstance(value, list) and any(isinstance(one, Mapping) for one in value):
            return [made(one, f"{key}[{i}]") for i, one in enumerate(value)]
        return value

    given = {}
    for name, value in table.items():
        if parameters[name].annotation != "bool":
            _refuse_truth(value, f"{key}.{name}")
        given[name] = made(value, f"{key}.{name}")
    try:
        return kind(**given)
    except ParameterError as error:
        if error.argument in given:
            raise type(error)(f"{key}.{error.argument}", error.message) from None
        # The core may blame what it makes of the arguments.
        raise type(error)(key, str(error)) from None


def typed(value: Value, key: str, kinds: Kinds) -> dict[str, Any]:
    """Return the table of a value of one of some classes: its ``type`` and its arguments.

    Raises:
        ParameterError: for an object of another class, such as one of a user, which is code.
    """
    name = type(value).__name__
    if kinds.get(name) is not type(value):
        raise ParameterError(
            key, f"of the class {name} is code, and a file holds data: it takes {_words(kinds)}"
        )
    return {"type": name, **arguments(value, key, lambda one, key: typed(one, key, kinds))}


def built_as_typed(table: Any, key: str, kinds: Kinds) -> Value:
    """Return the value of a table with its ``type`` and its arguments.

    Raises:
        ParameterError: whose argument is the key of what is wrong.
    """
    _check_table(table, key, "a table with its type and the arguments of that type")
    if key.count(".") > _DEEPEST:
        raise ParameterError(key, f"must not be nested in more than {_DEEPEST} tables")
    name = table.get("type")
    if name is None:
        raise ParameterError(f"{key}.type", f"is missing: it is one of {_words(kinds)}")
    if not isinstance(name, str):
        raise ParameterError(f"{key}.type", f"must be one of {_words(kinds)}, got {name!r}")
    if name not in kinds:
        raise ParameterError(f"{key}.type", f"{name!r} is not known{advice_on(name, kinds)}")
    rest = {word: value for word, value in table.items() if word != "type"}
    return built(kinds[name], rest, key, lambda one, key: built_as_typed(one, key, kinds))


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
    return ", ".join(kinds)


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
