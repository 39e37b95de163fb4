"""Unit vectors and quaternions (w, x, y, z)."""

from __future__ import annotations

from typing import Protocol, TypeAlias, runtime_checkable

import numpy as np
from numpy.typing import ArrayLike

from asperity._base import arrays
from asperity._base.arrays import Array
from asperity.errors import DimensionError, ParameterError

# What is a unit vector to rounding stays as it is, so that normalising twice changes no bit.
_UNIT = 1e-15

_ORDER = (
    "a quaternion is (w, x, y, z); SciPy's `Rotation` is taken as it is, and "
    "`asperity.axis_angle` turns about an axis"
)


@runtime_checkable
class Rotation(Protocol):
    """What is needed of a `scipy.spatial.transform.Rotation`, known without importing it."""

    def as_quat(self) -> Array:
        """Return the quaternion in SciPy's order (x, y, z, w)."""


Orientation: TypeAlias = ArrayLike | Rotation
"""A quaternion (w, x, y, z) of any length, or a `scipy.spatial.transform.Rotation`."""


def quaternion(value: Orientation, argument: str) -> Array:
    """Return the unit quaternion (w, x, y, z) of an orientation."""
    return normalised(written(value, argument), argument, 4)


def written(value: Orientation, argument: str) -> Array:
    """Return the quaternion (w, x, y, z) of an orientation, of the length that was given."""
    try:
        if isinstance(value, Rotation):
            value = _wxyz(value, argument)
        quaternion = arrays.array(value, argument, (4,))
        normalised(quaternion, argument, 4)
        return quaternion
    except ParameterError as error:
        raise type(error)(argument, f"{error.message}; {_ORDER}") from None


def axis_angle(axis: ArrayLike, *, angle: float) -> Array:
    """Return the orientation that a turn about an axis leads to, as a quaternion (w, x, y, z).

    Args:
        axis: of any length, shape ``(3,)``; seen against it, the turn is counter-clockwise.
        angle: in rad.

    Raises:
        DimensionError, ParameterError: naming the argument.

    >>> from math import radians
    >>> from asperity import Plane, axis_angle
    >>> slope = Plane.oriented(axis_angle((1.0, 0.0, 0.0), angle=radians(45.0)))
    >>> slope.normal.round(6).tolist()
    [0.0, -0.707107, 0.707107]
    """
    half = 0.5 * arrays.number(angle, "angle")
    turn = np.append(np.cos(half), np.sin(half) * normalised(axis, "axis", 3))
    return arrays.read_only(turn)


def _wxyz(rotation: Rotation, argument: str) -> Array:
    found = np.asarray(rotation.as_quat(), dtype=np.float64)
    if found.ndim != 1:
        raise DimensionError(
            argument, f"must be one rotation, got a list of {len(found)}: take one as rotation[0]"
        )
    return np.roll(found, 1)


def normalised(value: ArrayLike, argument: str, size: int) -> Array:
    """Return a vector of length 1."""
    vector = arrays.array(value, argument, (size,))
    length = float(np.linalg.norm(vector))
    if length == 0.0:
        raise ParameterError(argument, "must not vanish")
    return arrays.read_only(vector if abs(length - 1.0) <= _UNIT else vector / length)


def matrices(quaternions: Array) -> Array:
    """Return the rotation matrices (..., 3, 3) of unit quaternions (..., 4)."""
    w, x, y, z = np.moveaxis(quaternions, -1, 0)
    rows = [
        [1.0 - 2.0 * (y * y + z * z), 2.0 * (x * y - w * z), 2.0 * (x * z + w * y)],
        [2.0 * (x * y + w * z), 1.0 - 2.0 * (x * x + z * z), 2.0 * (y * z - w * x)],
        [2.0 * (x * z - w * y), 2.0 * (y * z + w * x), 1.0 - 2.0 * (x * x + y * y)],
    ]
    return np.stack([np.stack(row, axis=-1) for row in rows], axis=-2)


def planar_matrices(angle: Array) -> Array:
    """Return the rotation matrices (..., 2, 2) of angles (...)."""
    c, s = np.cos(angle), np.sin(angle)
    return np.stack([np.stack([c, -s], axis=-1), np.stack([s, c], axis=-1)], axis=-2)
