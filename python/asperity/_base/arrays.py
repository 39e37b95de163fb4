"""Input conversion: the one place where what users pass becomes finite float64 arrays."""

from __future__ import annotations

import math
import operator
import sys
from collections.abc import Iterable, Sequence
from types import UnionType
from typing import Any, TypeVar

import numpy as np
from numpy.typing import ArrayLike, NDArray

from asperity.errors import DimensionError, ParameterError

Array = NDArray[np.float64]
Word = TypeVar("Word", bound=str)

_NUMERIC_KINDS = "iufb"
# Types without a mask, by far the most frequent ones, and those that may hold others.
_PLAIN, _NESTED = frozenset((np.ndarray, float, int)), (list, tuple)


def array(value: ArrayLike, argument: str, shape: Sequence[int | None] | None = None) -> Array:
    """Return a finite C-contiguous float64 array; ``None`` in `shape` stands for any length."""
    converted = with_gaps(value, argument, shape)
    if not np.isfinite(converted).all():
        raise ParameterError(argument, "must be finite, it holds NaN or infinity")
    return converted


def with_gaps(value: ArrayLike, argument: str, shape: Sequence[int | None] | None = None) -> Array:
    """Return a C-contiguous float64 array that may hold NaN and infinity."""
    refuse_masked(value, argument)
    try:
        raw = np.asarray(value)
    except ValueError:
        raise DimensionError(argument, "must be a rectangular array of numbers") from None
    if raw.dtype.kind not in _NUMERIC_KINDS:
        if hasattr(value, "toarray"):
            raise ParameterError(argument, "must be dense: .toarray() makes a sparse matrix so")
        raise ParameterError(argument, f"must hold real numbers, got {value!r}")
    converted = np.asarray(raw, dtype=np.float64, order="C")
    if shape is not None:
        check_shape(converted, argument, shape)
    return converted


def constant(value: ArrayLike, argument: str, shape: Sequence[int | None]) -> Array:
    """Return a finite array; functions of time are refused with a word on who takes them."""
    if callable(value):
        raise ParameterError(
            argument,
            "must be constant: functions of time are taken by the bodies and planes of "
            "RigidBodies, and by a System of one's own",
        )
    return array(value, argument, shape)


def refuse_masked(value: Any, argument: str) -> None:
    """Refuse masked entries, in whose place NumPy would take whatever lies under the mask."""
    if _is_masked(value):
        raise ParameterError(argument, "must not hold masked entries, fill or leave them out")


def _is_masked(value: Any) -> bool:
    if type(value) in _PLAIN:
        return False
    if isinstance(value, _NESTED):
        return any(type(part) not in _PLAIN and _is_masked(part) for part in value)
    return isinstance(value, np.ma.MaskedArray) and bool(np.ma.is_masked(value))


def check_shape(value: Any, argument: str, shape: Sequence[int | None]) -> None:
    """Refuse an array, dense or sparse, that does not have the shape."""
    found = value.shape
    if found != shape and (
        len(found) != len(shape)
        or any(wanted not in (None, length) for wanted, length in zip(shape, found, strict=True))
    ):
        lengths = ", ".join("n" if length is None else str(length) for length in shape)
        wanted = f"({lengths},)" if len(shape) == 1 else f"({lengths})"
        raise DimensionError(argument, f"must have shape {wanted}, got {found}")


def points(value: ArrayLike, argument: str, dimension: int) -> tuple[Array, tuple[int, ...]]:
    """Return points ``(..., p)`` as ``(n, p)`` together with the leading shape."""
    converted = array(value, argument)
    if converted.ndim == 0 or converted.shape[-1] != dimension:
        raise DimensionError(argument, f"must have shape (..., {dimension}), got {converted.shape}")
    return converted.reshape(-1, dimension), converted.shape[:-1]


def points_with_scalars(
    value: ArrayLike, argument: str, dimension: int, scalars: ArrayLike, scalar_argument: str
) -> tuple[Array, Array, tuple[int, ...]]:
    """Broadcast points ``(..., p)`` with scalars; return ``(n, p)``, ``(n,)`` and the shape."""
    flat, lead = points(value, argument, dimension)
    factors = array(scalars, scalar_argument)
    try:
        shape = np.broadcast_shapes(lead, factors.shape)
    except ValueError:
        raise DimensionError(
            scalar_argument, f"must broadcast with {argument} {lead}, got {factors.shape}"
        ) from None
    wide = np.broadcast_to(flat.reshape(*lead, dimension), (*shape, dimension))
    return (
        np.ascontiguousarray(wide).reshape(-1, dimension),
        np.ascontiguousarray(np.broadcast_to(factors, shape)).reshape(-1),
        shape,
    )


def point_pairs(
    x: ArrayLike, argument: str, y: ArrayLike, other: str, dimension: int
) -> tuple[Array, Array]:
    """Return two arrays of points ``(..., p)`` whose leading shapes broadcast."""
    flat, lead = points(x, argument, dimension)
    partner, shape = points(y, other, dimension)
    try:
        np.broadcast_shapes(lead, shape)
    except ValueError:
        raise DimensionError(other, f"must broadcast with {argument} {lead}, got {shape}") from None
    return flat.reshape(*lead, dimension), partner.reshape(*shape, dimension)


def unflatten(values: Array, lead: tuple[int, ...]) -> Array:
    """Give the results ``(n, ...)`` the leading shape back; shape ``()`` becomes a NumPy scalar."""
    return values.reshape(lead + values.shape[1:])[()]


def square(value: ArrayLike, argument: str, size: int) -> Array:
    """Return a square matrix given as a scalar, as its diagonal or in full."""
    converted = array(value, argument)
    if converted.ndim == 0:
        return np.eye(size) * converted
    if converted.ndim == 1:
        return np.diag(array(converted, argument, (size,)))
    return array(converted, argument, (size, size))


def inverse(value: ArrayLike, argument: str, size: int) -> Array:
    """Return the inverse of a regular matrix."""
    try:
        inverted = np.linalg.inv(array(value, argument, (size, size)))
    except np.linalg.LinAlgError:
        raise ParameterError(argument, "must be regular, its determinant vanishes") from None
    return np.asarray(inverted, dtype=np.float64)


def number(value: Any, argument: str) -> float:
    """Return a finite Python float."""
    converted = array(value, argument)
    if converted.ndim:
        raise DimensionError(argument, f"must be a number, got an array of shape {converted.shape}")
    return float(converted)


def several(values: Any, argument: str) -> tuple[Any, ...]:
    """Return what an iterable holds."""
    # Arrays without dimension only look as if they were iterable.
    if not isinstance(values, Iterable) or getattr(values, "ndim", 1) == 0:
        raise ParameterError(argument, f"must be a sequence, got {values!r}")
    return tuple(values)


def pair(values: Any, argument: str) -> tuple[Any, Any]:
    """Return what an iterable of two holds."""
    parts = several(values, argument)
    if len(parts) != 2:
        raise DimensionError(argument, f"must hold two numbers, got {values!r}")
    return parts[0], parts[1]


def positive(value: Any, argument: str) -> float:
    """Return a finite float above zero."""
    if type(value) is float and 0.0 < value < math.inf:
        return value
    if type(value) is int and 0 < value <= sys.float_info.max:
        return float(value)
    converted = number(value, argument)
    if converted <= 0.0:
        raise ParameterError(argument, f"must be positive, got {converted!r}")
    return converted


# The sizes that the core takes for sets, which names semi-axes where users give a and b.
_SMALLEST_SIZE, _LARGEST_SIZE = 1e-60, 1e60


def size(value: Any, argument: str) -> float:
    """Return a length that a set may have."""
    converted = positive(value, argument)
    if not _SMALLEST_SIZE <= converted <= _LARGEST_SIZE:
        raise ParameterError(argument, f"must be between 1e-60 and 1e60, got {converted!r}")
    return converted


def non_negative(value: Any, argument: str) -> float:
    """Return a finite float not below zero."""
    converted = number(value, argument)
    if converted < 0.0:
        raise ParameterError(argument, f"must not be negative, got {converted!r}")
    return converted


def extents(value: ArrayLike, argument: str) -> Array:
    """Return one, two or three positive numbers."""
    converted = array(value, argument, (None,))
    if not 1 <= converted.size <= 3:
        raise DimensionError(argument, f"must hold 1 to 3 numbers, got {converted.size}")
    if converted.min() <= 0.0:
        raise ParameterError(argument, f"must be positive, got {converted.tolist()}")
    for extent in converted:
        size(float(extent), argument)
    return converted


def fraction(value: Any, argument: str) -> float:
    """Return a float between 0 and 1."""
    converted = number(value, argument)
    if not 0.0 <= converted <= 1.0:
        raise ParameterError(argument, f"must lie between 0 and 1, got {converted!r}")
    return converted


_LARGEST_COUNT = 2**53


def count(value: Any, argument: str, least: int = 1) -> int:
    """Return an integer not below `least`."""
    refuse_masked(value, argument)
    try:
        converted = operator.index(value)
    except TypeError:
        raise ParameterError(argument, f"must be an integer, got {value!r}") from None
    if not least <= converted <= _LARGEST_COUNT:
        raise ParameterError(argument, f"must lie in {least}..2**53, got {converted}")
    return converted


def choice(value: Word, argument: str, allowed: Sequence[Word]) -> Word:
    """Return `value` if it is one of the allowed words."""
    # An array, or a masked number, would be compared entry by entry.
    if not isinstance(value, str) or value not in allowed:
        words = " or ".join(repr(word) for word in allowed)
        raise ParameterError(argument, f"must be {words}, got {value!r}")
    return value


def of_kind(value: Any, argument: str, kind: type | UnionType, words: str) -> Any:
    """Return an object of a class, for which there are words."""
    if not isinstance(value, kind):
        raise ParameterError(argument, f"must be {words}, got {value!r}")
    return value


def lengths(vectors: Array) -> Array:
    """Return the norms of vectors ``(..., p)`` whose squares may be beyond the range of numbers."""
    exponent = np.frexp(np.abs(vectors).max(axis=-1, initial=0.0))[1]
    norms: Array = np.linalg.norm(np.ldexp(vectors, -exponent[..., None]), axis=-1)
    with np.errstate(over="ignore"):
        whole: Array = np.ldexp(norms, exponent)
    return whole


def unit_vectors(angle: Array | float) -> Array:
    """Return (cos φ, sin φ) for angles of any shape."""
    return np.stack([np.cos(angle), np.sin(angle)], axis=-1)


def along_and_across(vectors: Array, phi: Array) -> tuple[Array, Array]:
    """Return the parts of plane vectors ``(..., 2)`` along e(φ) and along e⊥(φ), to its left."""
    cos, sin = np.cos(phi), np.sin(phi)
    x, y = vectors[..., 0], vectors[..., 1]
    return x * cos + y * sin, y * cos - x * sin


def read_only(values: NDArray[Any]) -> NDArray[Any]:
    """Return a C-contiguous copy that refuses writing."""
    frozen = np.array(values, order="C")
    frozen.flags.writeable = False
    return frozen


def rotation(angle: float) -> Array:
    """Return the matrix that turns the plane counter-clockwise by `angle`."""
    c, s = math.cos(angle), math.sin(angle)
    return np.array([[c, -s], [s, c]])
