"""Frozen value objects: the constructor's signature is the only list of their parameters."""

from __future__ import annotations

import dataclasses
import inspect
import os
from collections.abc import Callable, Iterator, Mapping
from enum import Enum
from functools import cache
from inspect import Parameter
from types import NoneType, UnionType
from typing import (
    TYPE_CHECKING,
    Annotated,
    Any,
    ClassVar,
    Generic,
    Literal,
    NoReturn,
    Self,
    TypeAlias,
    TypeVar,
    Union,
    dataclass_transform,
    get_args,
    get_origin,
    get_type_hints,
    overload,
)

import numpy as np
from numpy.typing import ArrayLike

from asperity._base import arrays
from asperity.errors import ParameterError

# Longer arrays are not printed.
_LONGEST = 24

Key = TypeVar("Key")
Part = TypeVar("Part")


class View(Mapping[Key, Part]):
    """A mapping that reads like a dictionary and that nobody can change, with tuples for lists."""

    __slots__ = ("_parts",)

    def __init__(self, parts: Mapping[Key, Part]) -> None:
        self._parts = dict(parts)

    def __getitem__(self, key: Key) -> Part:
        return self._parts[key]

    def __iter__(self) -> Iterator[Key]:
        return iter(self._parts)

    def __len__(self) -> int:
        return len(self._parts)

    def __eq__(self, other: object) -> bool:
        return isinstance(other, Mapping) and _thawed(self) == _thawed(other)

    def __or__(self, other: Mapping[Any, Any]) -> dict[Any, Any]:
        return {**self._parts, **other}

    def __ror__(self, other: Mapping[Any, Any]) -> dict[Any, Any]:
        return {**other, **self._parts}

    def __repr__(self) -> str:
        return repr(self._parts)

    def __reduce__(self) -> tuple[Any, ...]:
        return View, (self._parts,)


class ResultArray(np.ndarray):
    """A read-only array whose parts are copies that may be written into.

    Compiled functions may refuse read-only buffers, as the rotations of SciPy 1.17 do with the
    position of a body.
    """

    def __getitem__(self, key: Any) -> Any:
        part = self.view(np.ndarray)[key]
        return part.copy() if isinstance(part, np.ndarray) and not self.flags.writeable else part

    def __array_ufunc__(
        self, ufunc: Any, method: str, *inputs: Any, out: tuple[Any, ...] = (), **options: Any
    ) -> Any:
        if out:
            options["out"] = tuple(map(_plain, out))
        return getattr(ufunc, method)(*map(_plain, inputs), **options)

    def __repr__(self) -> str:
        return repr(self.view(np.ndarray))

    def __reduce__(self) -> Any:
        return self.view(np.ndarray).__reduce__()


class Value:
    """Base of immutable objects that are equal when their parameters are.

    A subclass hands each parameter of its ``__init__`` to `_set` as it was written, for `replace`,
    files and text, and what it derives to `_keep`. Arrays and mappings among them are kept as
    copies that refuse writing.
    """

    _is_result: ClassVar[bool] = False
    """Whether its arrays are those of a result, whose parts are copies: see `ResultArray`."""
    _descriptive: ClassVar[frozenset[str]] = frozenset()
    """Parameters that say where a value is from or what its parts are called: not compared."""
    _scaled: ClassVar[frozenset[str]] = frozenset()
    """Parameters whose scale has no effect: kept and compared as attributes of one scale."""

    if TYPE_CHECKING:

        @property
        def _parameters(self) -> Mapping[str, Any]: ...

    def _set(self, **parameters: Any) -> None:
        frozen = {name: _frozen(value) for name, value in parameters.items()}
        # A class attribute wins: the radius of a disk must not hide the method `radius`.
        shown = {name: value for name, value in frozen.items() if not hasattr(type(self), name)}
        object.__setattr__(self, "_parameters", frozen)
        self._keep(**shown)

    def _keep(self, **attributes: Any) -> None:
        is_result = self._is_result
        for name, attribute in attributes.items():
            kept = _frozen(attribute)
            if is_result and isinstance(kept, np.ndarray):
                kept = kept.view(ResultArray)
            object.__setattr__(self, name, kept)

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
        return _build, (type(self), dict(self._parameters))

    def __copy__(self) -> Self:
        return self

    def __deepcopy__(self, memo: dict[int, Any]) -> Self:
        return self

    def __eq__(self, other: object) -> bool:
        if not isinstance(other, Value) or type(self) is not type(other):
            return NotImplemented
        pairs = zip(self._compared(), other._compared(), strict=True)
        return all(_same(mine, its) for (_, mine), (_, its) in pairs)

    def __hash__(self) -> int:
        return hash((type(self), *(_hashable(value) for _, value in self._compared())))

    def _compared(self) -> Iterator[tuple[str, Any]]:
        for name, given in self._parameters.items():
            if name not in self._descriptive:
                yield name, getattr(self, name) if name in self._scaled else given

    def __repr__(self) -> str:
        return self._call(_text)

    def __str__(self) -> str:
        """Return its `repr`, with the shape in place of long arrays."""
        return self._call(_short) if type(self).__repr__ is Value.__repr__ else repr(self)

    def _call(self, text: Callable[[Any], str]) -> str:
        parts = []
        for name, parameter in inspect.signature(type(self)).parameters.items():
            value = self._parameters[name]
            if _is_default(value, parameter):
                continue
            positional = parameter.kind is Parameter.POSITIONAL_OR_KEYWORD
            if positional and parameter.default is Parameter.empty:
                parts.append(text(value))
            else:
                parts.append(f"{name}={text(value)}")
        return f"{type(self).__name__}({', '.join(parts)})"


Check: TypeAlias = Callable[[Any, str], Any]
Taken = TypeVar("Taken", contravariant=True)
Held = TypeVar("Held", covariant=True)


class Given(Generic[Taken, Held]):
    """For checkers of types: a field that takes one type and holds another, as a descriptor."""

    if TYPE_CHECKING:

        @overload
        def __get__(self, record: None, kind: Any) -> Self: ...
        @overload
        def __get__(self, record: object, kind: Any) -> Held: ...
        def __get__(self, record: object, kind: Any) -> Any: ...
        def __set__(self, record: Any, value: Taken) -> None: ...


_FOLLOWS = object()


def field(*, default: Any = Parameter.empty, init: bool = True) -> Any:
    """Return the default of a field that takes another type than it holds.

    With ``init=False`` it is no field, but an attribute that `_derive` keeps.
    """
    return default if init else _FOLLOWS


def shaped(*shape: int | None) -> Check:
    """Return the check that makes arrays of a shape, in which None stands for any length."""
    return lambda value, name: arrays.array(value, name, shape)


def of_kind(kind: type | UnionType, words: str) -> Check:
    """Return the check that lets objects of a class pass, for which there are words."""
    return lambda value, name: arrays.of_kind(value, name, kind, words)


def optional(check: Check) -> Check:
    """Return a check that lets None pass."""
    return lambda value, name: None if value is None else check(value, name)


def _truth(value: Any, name: str) -> bool:
    if not isinstance(value, bool | np.bool_):
        raise ParameterError(name, f"must be True or False, got {value!r}")
    return bool(value)


# Numbers that a field of a `Record` may hold; the check says what else it refuses.
Number: TypeAlias = Annotated[float, arrays.number]
Positive: TypeAlias = Annotated[float, arrays.positive]
NonNegative: TypeAlias = Annotated[float, arrays.non_negative]
Fraction: TypeAlias = Annotated[float, arrays.fraction]
Count: TypeAlias = Annotated[int, arrays.count]
Index: TypeAlias = Annotated[int, lambda value, name: arrays.count(value, name, least=0)]
Truth: TypeAlias = Annotated[bool, _truth]


def unchecked(value: Any, _: str) -> Any:
    """Return a value as it is."""
    return value


def a_tuple(value: Any, _: str) -> Any:
    """Return the parts of a sequence as a tuple."""
    return tuple(value)


def a_path(value: Any, _: str) -> str:
    """Return a path as text."""
    return os.fspath(value)


Text: TypeAlias = Annotated[str, lambda value, _: str(value)]
AnyArray: TypeAlias = Annotated[Given[ArrayLike, arrays.Array], unchecked]
"""An array that `_complete` checks."""
AnyArrayOrNone: TypeAlias = Annotated[Given[ArrayLike | None, arrays.Array], unchecked]
"""An array that `_complete` checks, or fills in."""
OptionalArray: TypeAlias = Annotated[Given[ArrayLike | None, arrays.Array | None], unchecked]
"""An array or None that `_complete` checks."""
Vector: TypeAlias = Annotated[Given[ArrayLike, arrays.Array], shaped(None)]
Vector2: TypeAlias = Annotated[Given[ArrayLike, arrays.Array], shaped(2)]
Vector3: TypeAlias = Annotated[Given[ArrayLike, arrays.Array], shaped(3)]


@dataclass_transform(frozen_default=True, field_specifiers=(field,))
class Record(Value):
    """Base of values that hold what they are given: annotations are the only list of parameters.

    A field that is ``Annotated`` holds what the check there returns, given the value and its name;
    one that is a ``Literal`` takes these words alone, one that is a class of values its objects.
    Others become Python's numbers, arrays and enumerators where the annotation says so. Fields
    behind ``_: KW_ONLY`` are given by name; names that begin with a bar, and every `ClassVar`, are
    no fields. `_complete` may check and complete all of them together, `_derive` keep what follows.
    """

    def __init_subclass__(cls) -> None:
        super().__init_subclass__()
        parameters = list(getattr(cls, "__signature__", inspect.Signature()).parameters.values())
        place: Any = Parameter.POSITIONAL_OR_KEYWORD
        for name, kind in inspect.get_annotations(cls).items():
            if kind == "KW_ONLY":
                place = Parameter.KEYWORD_ONLY
            elif not kind.startswith("ClassVar") and name != "_":
                default = cls.__dict__.get(name, Parameter.empty)
                follows = default is _FOLLOWS
                if name.startswith("_") and not follows:
                    continue
                if name in cls.__dict__:
                    delattr(cls, name)
                if not follows:
                    parameters.append(Parameter(name, place, default=default, annotation=kind))
        cls.__signature__ = inspect.Signature(parameters)

    __signature__: ClassVar[inspect.Signature]

    def __init__(self, *args: Any, **kwargs: Any) -> None:
        kind: Any = type(self)
        positional, fields = _fields_of(kind)
        values = dict(zip(positional, args, strict=False))
        given, taken = {}, 0
        for name, check, default in fields:
            if name in kwargs:
                value = kwargs[name]
                taken += 1
            else:
                value = values.get(name, default)
            if value is not Parameter.empty:
                given[name] = check(value, name)
        wrong = taken < len(kwargs) or len(args) > len(positional) or len(given) < len(fields)
        if wrong or values.keys() & kwargs.keys():
            # Python says what is wrong with the call.
            kind.__signature__.bind(*args, **kwargs)
        self._complete(given)
        self._set(**given)
        self._derive()

    def _complete(self, given: dict[str, Any]) -> None:
        """Check the fields against each other, or fill in those that follow from others."""

    def _derive(self) -> None:
        """Keep what follows from the fields."""


@cache
def _fields_of(kind: type[Any]) -> tuple[tuple[str, ...], list[tuple[str, Check, Any]]]:
    """Return the names of fields by position, and of all fields name, check and default."""
    hints = get_type_hints(kind, include_extras=True)
    parameters = kind.__signature__.parameters
    fields = [(name, _check_of(hints[name]), one.default) for name, one in parameters.items()]
    places = [name for name, one in parameters.items() if one.kind is not Parameter.KEYWORD_ONLY]
    return tuple(places), fields


def _meaning(hint: Any) -> Any:
    """Return what an alias stands for; `numpy.typing.NDArray` is one from NumPy 2.5 on."""
    alias = get_origin(hint) or hint
    if not hasattr(alias, "__value__"):
        return hint
    parts = get_args(hint)
    return _meaning(alias.__value__[parts] if parts else alias.__value__)


def _check_of(hint: Any, ending: str = "") -> Check:
    hint = _meaning(hint)
    parts = get_args(hint)
    if isinstance(hint, UnionType) or get_origin(hint) is Union:
        (inner,) = (_check_of(part, " or None") for part in parts if part is not NoneType)
        return lambda value, name: None if value is None else inner(value, name)
    if get_origin(hint) is Literal:
        return lambda value, name: arrays.choice(value, name, parts)
    if hasattr(hint, "__metadata__"):
        return hint.__metadata__[0]
    if isinstance(hint, type) and issubclass(hint, Value):
        article = "an" if hint.__name__[0] in "AEIOU" else "a"
        words = f"{article} {hint.__name__}{ending}"
        return of_kind(hint, words)
    if get_origin(hint) is np.ndarray:
        return lambda value, _: np.asarray(value)
    if hint in (int, float, bool) or (isinstance(hint, type) and issubclass(hint, Enum)):
        return lambda value, _: hint(value)
    return lambda value, _: value


def _plain(value: Any) -> Any:
    return value.view(np.ndarray) if isinstance(value, ResultArray) else value


def _build(kind: type[Value], parameters: dict[str, Any]) -> Value:
    return kind(**parameters)


def _frozen(value: Any) -> Any:
    """Return an array or a mapping as one that nobody can write into, all else as it is."""
    # Asking for dictionaries takes a tenth of the time that asking for any mapping does.
    if isinstance(value, dict):
        return View({key: _frozen_part(part) for key, part in value.items()})
    if not isinstance(value, np.ndarray) or (value.flags.owndata and not value.flags.writeable):
        return value
    return arrays.read_only(value)


def _thawed(value: Any) -> Any:
    """Return dictionaries and lists for views and tuples."""
    if isinstance(value, Mapping):
        return {key: _thawed(part) for key, part in value.items()}
    return list(map(_thawed, value)) if isinstance(value, list | tuple) else value


def keep_views(record: Any) -> None:
    """Make views of the mappings that a frozen dataclass holds, after its ``__init__``."""
    for field in dataclasses.fields(record):
        value = getattr(record, field.name)
        if isinstance(value, Mapping):
            object.__setattr__(record, field.name, View(value))


def _frozen_part(value: Any) -> Any:
    """Return what a mapping holds, lists in it as tuples."""
    if isinstance(value, list | tuple) and not hasattr(value, "_fields"):
        return tuple(map(_frozen_part, value))
    return _frozen(value)


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
    if isinstance(a, Mapping) and isinstance(b, Mapping):
        return a.keys() == b.keys() and all(_same(a[key], b[key]) for key in a)
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
    if isinstance(value, Mapping):
        return frozenset((key, _hashable(part)) for key, part in value.items())
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
        return f"{value.format}_array(({parts}), shape={value.shape})"
    return repr(value.tolist()) if isinstance(value, np.ndarray) else repr(value)


def _short(value: Any) -> str:
    """Return the text of a value without long arrays."""
    if isinstance(value, np.ndarray) and value.size > _LONGEST:
        return f"<{' × '.join(map(str, value.shape))} numbers>"
    if isinstance(value, tuple):
        return f"({', '.join(map(_short, value))}{',' * (len(value) == 1)})"
    return str(value) if isinstance(value, Value) else _text(value)


def _is_nan(value: Any) -> bool:
    """Whether it is the number NaN: what is not known equals what is not known."""
    return isinstance(value, float) and value != value


def _is_sparse(value: Any) -> bool:
    """Whether it is a CSR or CSC array, without importing SciPy; values keep canonical ones."""
    return hasattr(value, "indptr")


def _parts(matrix: Any) -> tuple[Any, Any, Any]:
    return matrix.data, matrix.indices, matrix.indptr
