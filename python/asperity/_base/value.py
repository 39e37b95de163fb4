"""Frozen value objects: the constructor's signature is the only list of their parameters."""

from __future__ import annotations

import inspect
from collections.abc import Callable, Iterator
from inspect import Parameter
from typing import TYPE_CHECKING, Any, ClassVar, NoReturn, Self, dataclass_transform

import numpy as np

from asperity._base.arrays import read_only


class Value:
    """Base of immutable objects that are equal when their parameters are.

    A subclass hands each parameter of its ``__init__`` to `_set`, and what it derives to `_keep`.
    """

    _descriptive: ClassVar[frozenset[str]] = frozenset()
    """Parameters that say where a value is from or what its parts are called: not compared."""

    if TYPE_CHECKING:

        @property
        def _parameters(self) -> dict[str, Any]: ...

    def _set(self, **parameters: Any) -> None:
        self._keep(_parameters=parameters)
        # A class attribute wins: the radius of a disk must not hide the method `radius`.
        self._keep(**{n: value for n, value in parameters.items() if not hasattr(type(self), n)})

    def _keep(self, **attributes: Any) -> None:
        for name, attribute in attributes.items():
            object.__setattr__(self, name, attribute)

    def __setattr__(self, name: str, value: object) -> NoReturn:
        raise AttributeError(
            f"{type(self).__name__} is immutable: make a variant with .replace({name}=...)"
        )

    def __delattr__(self, name: str) -> NoReturn:
        raise AttributeError(f"{type(self).__name__} is immutable")

    def _stored(self) -> Self:
        """Return what files hold of it."""
        return self

    def replace(self, **changes: Any) -> Self:
        """Return a copy with some parameters changed."""
        return type(self)(**{**self._parameters, **changes})

    def __reduce__(self) -> tuple[Any, ...]:
        return _build, (type(self), self._parameters)

    def __copy__(self) -> Self:
        return self

    def __deepcopy__(self, memo: dict[int, Any]) -> Self:
        return self

    def __eq__(self, other: object) -> bool:
        if not isinstance(other, Value) or type(self) is not type(other):
            return NotImplemented
        return all(_same(mine, other._parameters[name]) for name, mine in self._compared())

    def __hash__(self) -> int:
        return hash((type(self), *(_hashable(value) for _, value in self._compared())))

    def _compared(self) -> Iterator[tuple[str, Any]]:
        return (pair for pair in self._parameters.items() if pair[0] not in self._descriptive)

    def __repr__(self) -> str:
        parts = []
        for name, parameter in inspect.signature(type(self)).parameters.items():
            value = self._parameters[name]
            if _is_default(value, parameter):
                continue
            positional = parameter.kind is Parameter.POSITIONAL_OR_KEYWORD
            if positional and parameter.default is Parameter.empty:
                parts.append(_text(value))
            else:
                parts.append(f"{name}={_text(value)}")
        return f"{type(self).__name__}({', '.join(parts)})"


@dataclass_transform(frozen_default=True)
class Record(Value):
    """Base of values that hold what they are given: annotations are the only list of parameters.

    Integers and floats become Python's, arrays refuse writing.
    """

    def __init_subclass__(cls, *, kw_only: bool = False) -> None:
        place = Parameter.KEYWORD_ONLY if kw_only else Parameter.POSITIONAL_OR_KEYWORD
        parameters = []
        for name, kind in inspect.get_annotations(cls).items():
            default = cls.__dict__.get(name, Parameter.empty)
            if name in cls.__dict__:
                delattr(cls, name)
            parameters.append(Parameter(name, place, default=default, annotation=kind))
        cls.__signature__ = inspect.Signature(parameters)

    __signature__: ClassVar[inspect.Signature]

    def __init__(self, *args: Any, **kwargs: Any) -> None:
        signature = type(self).__signature__
        given = signature.bind(*args, **kwargs)
        given.apply_defaults()
        self._set(
            **{
                name: _CONVERTERS.get(signature.parameters[name].annotation, _unchanged)(value)
                for name, value in given.arguments.items()
            }
        )


def _unchanged(value: Any) -> Any:
    return value


# By the annotation, which is a text.
_CONVERTERS: dict[str, Callable[[Any], Any]] = {
    "int": int,
    "float": float,
    "bool": bool,
    "Array": read_only,
}


def _build(cls: type[Value], parameters: dict[str, Any]) -> Value:
    return cls(**parameters)


def _is_default(value: Any, parameter: Parameter) -> bool:
    default = parameter.default
    if isinstance(value, np.ndarray) and isinstance(default, tuple):
        return np.array_equal(value, default)
    return (
        default is not Parameter.empty
        and type(value) is type(default)
        and (value is default or _same(value, default))
    )


def _same(a: Any, b: Any) -> bool:
    if a is b:
        return True
    if isinstance(a, tuple) and isinstance(b, tuple):
        return len(a) == len(b) and all(map(_same, a, b))
    if _is_sparse(a) and _is_sparse(b):
        return bool(a.shape == b.shape) and all(map(_same, _parts(a), _parts(b)))
    if isinstance(a, np.ndarray) and isinstance(b, np.ndarray):
        return np.array_equal(a, b, equal_nan=a.dtype.kind == b.dtype.kind == "f")
    # NaN, "not known", equals itself, as within arrays: copies of an object equal it.
    return type(a) is type(b) and (bool(a == b) or (_is_nan(a) and _is_nan(b)))


def _hashable(value: Any) -> Any:
    if isinstance(value, np.ndarray):
        return value.shape, _bits(value)
    if _is_sparse(value):
        return value.shape, *map(_hashable, _parts(value))
    if isinstance(value, tuple):
        return tuple(map(_hashable, value))
    # Python hashes every NaN differently.
    return "nan" if _is_nan(value) else value


def _bits(values: np.ndarray[Any, Any]) -> bytes:
    """Return what equal arrays share, whatever the bits of their NaNs."""
    # Adding zero turns -0.0, which equals 0.0, into it.
    if values.dtype.kind == "f":
        return np.where(np.isnan(values), np.nan, values + 0.0).tobytes()
    return values.tobytes()


def _text(value: Any) -> str:
    if isinstance(value, tuple):
        return f"({', '.join(map(_text, value))}{',' * (len(value) == 1)})"
    if _is_sparse(value):
        parts = ", ".join(repr(part.tolist()) for part in _parts(value))
        return f"csr_array(({parts}), shape={value.shape})"
    return repr(value.tolist()) if isinstance(value, np.ndarray) else repr(value)


def _is_nan(value: Any) -> bool:
    """Whether it is the number NaN: what is not known equals what is not known."""
    return isinstance(value, float) and value != value


def _is_sparse(value: Any) -> bool:
    """Whether it is a CSR array, told without importing SciPy; values keep canonical ones."""
    return hasattr(value, "indptr")


def _parts(matrix: Any) -> tuple[Any, Any, Any]:
    return matrix.data, matrix.indices, matrix.indptr
