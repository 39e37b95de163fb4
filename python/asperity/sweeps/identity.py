"""What a store says of the sweep that it belongs to."""

from __future__ import annotations

import ast
import dataclasses
import functools
import hashlib
import inspect
import linecache
import marshal
import pickle
import sys
import textwrap
from collections.abc import Callable, Iterator, Mapping
from contextlib import suppress
from enum import Enum
from pathlib import Path
from types import FunctionType, ModuleType
from typing import Any

import numpy as np

from asperity._base.value import Value
from asperity.errors import ParameterError

_SHORT = 16


_UNKNOWN = "unknown"


class _IndescribableError(Exception):
    """Why a value cannot be compared with others in another process."""


def identity_of(
    function: Callable[..., Any], constants: Mapping[str, Any], *, stored: bool = True
) -> dict[str, str]:
    """Return name and hash of the source of a function, and what else it is given, as text.

    The source is that of the function and of the whole file it is in (in a notebook its cell), with
    the other functions and the constants there; comments, layout and docstrings do not count.
    Default values and the variables of an enclosing function that it uses do. Other files are not
    looked into.

    Args:
        function: whatever can be called.
        constants: further arguments by name.
        stored: whether a store is to be compared with it later; otherwise what cannot be compared
            is merely called unknown.

    Raises:
        ParameterError: naming `constants` or `function`, and the value that cannot be compared.
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
        "defaults": _listed("function", "default value", _defaults(function), stored),
        "closure": _listed("function", "enclosed variable", _closure(function), stored),
        "constants": _listed("constants", "constant", fixed, stored),
    }


def _listed(argument: str, kind: str, values: Mapping[str, Any], stored: bool) -> str:
    """Return values by name as text."""
    texts = []
    for name, value in sorted(values.items()):
        try:
            text = _text(value)
        except _IndescribableError as error:
            if stored:
                raise ParameterError(
                    argument,
                    f"cannot be compared with that of a store: the {kind} {name} is {error}; make "
                    "it in the function itself, or sweep without a store",
                ) from None
            text = _UNKNOWN
        texts.append(f"{name}={text}")
    return ", ".join(texts)


def _in_python(function: Callable[..., Any]) -> FunctionType | None:
    """Return a function that is written in Python: of a method its own, or the one wrapped."""
    function = getattr(function, "__func__", function)
    if not isinstance(function, FunctionType):
        function = inspect.unwrap(function)
    return function if isinstance(function, FunctionType) else None


def _defaults(function: Callable[..., Any]) -> dict[str, Any]:
    """Return default values by the names of parameters."""
    plain = _in_python(function)
    if plain is None:
        return {}
    values = plain.__defaults__ or ()
    count = plain.__code__.co_argcount
    names = plain.__code__.co_varnames[count - len(values) : count]
    return {**dict(zip(names, values, strict=True)), **(plain.__kwdefaults__ or {})}


def _closure(function: Callable[..., Any]) -> dict[str, Any]:
    """Return the variables of enclosing functions that a function uses, those that have a value."""
    plain, found = _in_python(function), {}
    if plain is not None:
        for name, cell in zip(plain.__code__.co_freevars, plain.__closure__ or (), strict=True):
            with suppress(ValueError):
                found[name] = cell.cell_contents
    return found


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
    """Return the hash of a function and its file: functions of one file may share a name."""
    try:
        own = textwrap.dedent(inspect.getsource(function))
        file = linecache.getlines(inspect.getsourcefile(inspect.unwrap(function)) or "")
        return _digest(*map(_bare, (own, "".join(file))))
    except (OSError, TypeError, SyntaxError):
        code = getattr(function, "__code__", None)
        return _UNKNOWN if code is None else _digest(marshal.dumps(code))


@functools.lru_cache(maxsize=64)
def _bare(source: str) -> bytes:
    """Return source without comments, layout and docstrings."""
    tree = ast.parse(source)
    for node in ast.walk(tree):
        if (
            isinstance(node, ast.Module | ast.ClassDef | ast.FunctionDef | ast.AsyncFunctionDef)
            and ast.get_docstring(node) is not None
        ):
            node.body = node.body[1:] or [ast.Pass()]
    return ast.unparse(tree).encode()


def _text(value: Any) -> str:
    """Return numbers and words as they are, of all else a hash."""
    plain = value is None or isinstance(value, bool | int | float | str)
    text = repr(value) if plain else ""
    if plain and not isinstance(value, Enum) and len(text) <= _SHORT:
        return text
    try:
        return _digest(*_parts(value))
    except RecursionError:
        raise _IndescribableError("a value that holds itself") from None


def _digest(*parts: bytes) -> str:
    whole = hashlib.sha256()
    for part in parts:
        # The length keeps apart what would be alike when joined.
        whole.update(f"{len(part)}:".encode())
        whole.update(part)
    return whole.hexdigest()[:_SHORT]


def _parts(value: Any, within: tuple[int, ...] = ()) -> Iterator[bytes]:
    """Yield what is the same, in every process, for objects that are equal.

    Args:
        value: to describe.
        within: identities of the functions whose variables are being described, which may hold the
            functions themselves.
    """
    yield type(value).__qualname__.encode()
    if value is None or isinstance(value, bool | int | float | complex | str | bytes):
        yield repr(value).encode()
    elif isinstance(value, Enum):
        yield value.name.encode()
    elif isinstance(value, np.ndarray | np.generic) and not value.dtype.hasobject:
        yield f"{value.dtype.descr}{value.shape}".encode()
        yield np.ascontiguousarray(value).tobytes()
    elif isinstance(value, Value):
        yield from _parts(value._parameters, within)
    elif isinstance(value, Mapping | list | tuple | set | frozenset):
        # Without the length, nested containers would be alike that end at different places.
        yield str(len(value)).encode()
        yield from _elements(value, within)
    elif dataclasses.is_dataclass(value) and not isinstance(value, type):
        fields = {one.name: getattr(value, one.name) for one in dataclasses.fields(value)}
        yield from _parts(fields, within)
    elif isinstance(value, ModuleType):
        yield value.__name__.encode()
    elif callable(value) and hasattr(value, "__qualname__"):
        yield f"{value.__module__}.{value.__qualname__}".encode()
        yield _source(value).encode()
        if id(value) not in within:
            inner = (*within, id(value))
            yield from _parts(_defaults(value), inner)
            yield from _parts(_closure(value), inner)
            owner = getattr(value, "__self__", None)
            if not isinstance(owner, ModuleType):
                yield from _parts(owner, inner)
    else:
        yield _pickled(value)


def _elements(value: Any, within: tuple[int, ...]) -> Iterator[bytes]:
    if isinstance(value, Mapping):
        for key in sorted(value, key=repr):
            yield from _parts(key, within)
            yield from _parts(value[key], within)
    elif isinstance(value, list | tuple):
        for one in value:
            yield from _parts(one, within)
    else:
        yield from sorted(_digest(*_parts(one, within)).encode() for one in value)


def _pickled(value: Any) -> bytes:
    try:
        return pickle.dumps(value)
    except Exception as error:
        # Objects decide themselves how they are pickled, and what they raise.
        kind = type(value)
        raise _IndescribableError(
            f"of class {kind.__module__}.{kind.__qualname__} ({type(error).__name__})"
        ) from None
