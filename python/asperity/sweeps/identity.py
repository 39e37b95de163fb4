"""What a store says of the sweep that it belongs to."""

from __future__ import annotations

import ast
import dataclasses
import functools
import hashlib
import inspect
import marshal
import pickle
import sys
import textwrap
from collections.abc import Callable, Iterator, Mapping
from enum import Enum
from pathlib import Path
from types import ModuleType
from typing import Any

import numpy as np

from asperity._base.value import Value
from asperity.errors import ParameterError

_SHORT = 16


def identity_of(function: Callable[..., Any], constants: Mapping[str, Any]) -> dict[str, str]:
    """Return name and hash of the source of a function, and what else it is given, as text.

    Comments, layout and docstrings of the source do not count. What the function calls is not
    looked into.
    """
    fixed = dict(constants)
    while isinstance(function, functools.partial):
        fixed = {**_bound(function), **fixed}
        function = function.func
    owner = getattr(function, "__self__", None)
    if not hasattr(function, "__qualname__"):
        function, owner = type(function), function
    if owner is not None and not isinstance(owner, ModuleType):
        fixed["self"] = owner
    return {
        "function": f"{_module(function)}.{function.__qualname__}",
        "source": _source(function),
        "constants": ", ".join(f"{name}={_text(value)}" for name, value in sorted(fixed.items())),
    }


def _bound(function: functools.partial[Any]) -> dict[str, Any]:
    places = {f"argument {k}": value for k, value in enumerate(function.args)}
    return {**places, **function.keywords}


def _module(function: Callable[..., Any]) -> str:
    """Return the module, by the name of its file where it is run as a program."""
    file = getattr(sys.modules["__main__"], "__file__", None)
    if function.__module__ == "__main__" and file is not None:
        return Path(file).stem
    return function.__module__


def _source(function: Callable[..., Any]) -> str:
    try:
        tree = ast.parse(textwrap.dedent(inspect.getsource(function)))
    except (OSError, TypeError, SyntaxError):
        code = getattr(function, "__code__", None)
        return "unknown" if code is None else _digest(marshal.dumps(code))
    for node in ast.walk(tree):
        if isinstance(node, ast.FunctionDef | ast.ClassDef) and ast.get_docstring(node) is not None:
            node.body = node.body[1:] or [ast.Pass()]
    return _digest(ast.unparse(tree).encode())


def _text(value: Any) -> str:
    """Return numbers and words as they are, of all else a hash."""
    plain = value is None or isinstance(value, bool | int | float | str)
    text = repr(value)
    if plain and not isinstance(value, Enum) and len(text) <= _SHORT:
        return text
    return _digest(*_parts(value))


def _digest(*parts: bytes) -> str:
    whole = hashlib.sha256()
    for part in parts:
        # The length keeps apart what would be alike when joined.
        whole.update(f"{len(part)}:".encode())
        whole.update(part)
    return whole.hexdigest()[:_SHORT]


def _parts(value: Any) -> Iterator[bytes]:
    """Yield what is the same, in every process, for objects that are equal."""
    yield type(value).__qualname__.encode()
    if value is None or isinstance(value, bool | int | float | complex | str | bytes):
        yield repr(value).encode()
    elif isinstance(value, Enum):
        yield value.name.encode()
    elif isinstance(value, np.ndarray | np.generic) and value.dtype.kind != "O":
        yield f"{value.dtype.str}{value.shape}".encode()
        yield np.ascontiguousarray(value).tobytes()
    elif isinstance(value, Value):
        yield from _parts(value._parameters)
    elif isinstance(value, Mapping):
        for key in sorted(value, key=repr):
            yield from _parts(key)
            yield from _parts(value[key])
    elif isinstance(value, list | tuple):
        for one in value:
            yield from _parts(one)
    elif isinstance(value, set | frozenset):
        yield from sorted(_digest(*_parts(one)).encode() for one in value)
    elif dataclasses.is_dataclass(value) and not isinstance(value, type):
        yield from _parts({one.name: getattr(value, one.name) for one in dataclasses.fields(value)})
    elif callable(value) and hasattr(value, "__qualname__"):
        yield f"{value.__module__}.{value.__qualname__}".encode()
        yield _source(value).encode()
    else:
        yield _pickled(value)


def _pickled(value: Any) -> bytes:
    try:
        return pickle.dumps(value)
    except (pickle.PicklingError, AttributeError, TypeError) as error:
        raise ParameterError(
            "constants", f"cannot be compared with those of a store: {error}"
        ) from None
