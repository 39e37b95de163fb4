"""Rigid bodies: mass, inertia, initial state and loads."""

from __future__ import annotations

from dataclasses import KW_ONLY
from typing import Annotated, Self, TypedDict, Unpack

import numpy as np
from numpy.typing import ArrayLike

from asperity._base import arrays
from asperity._base.arrays import Array
from asperity._base.value import Given, Number, Positive, Record, Vector2, Vector3, field
from asperity.errors import ParameterError
from asperity.system.contacts import Name
from asperity.system.rigid import rotation
from asperity.system.rigid.rotation import Orientation
from asperity.system.time_functions import Changing1, Changing2, Changing3, TimeFunction

# Relative tolerance within which a tensor in turned axes counts as symmetric.
_SYMMETRY = 1e-12
# Relative tolerance of the inequalities that principal moments of inertia obey.
_MOMENTS = 1e-9


class BodyState(TypedDict, total=False):
    """Initial state and loads of a `Body`."""

    position: ArrayLike
    orientation: Orientation
    velocity: ArrayLike
    angular_velocity: ArrayLike
    force: TimeFunction
    torque: TimeFunction
    name: str | None


class PlanarState(TypedDict, total=False):
    """Initial state and loads of a `PlanarBody`."""

    position: ArrayLike
    angle: float
    velocity: ArrayLike
    angular_velocity: float
    force: TimeFunction
    torque: TimeFunction
    name: str | None


class Body(Record):
    """A rigid body in space, placed by its centre of mass and its orientation.

    Args:
        mass: m > 0 in kg.
        inertia: J in kg m² about the centre of mass, in the body's axes: the principal moments
            ``(3,)`` or the matrix ``(3, 3)``, symmetric to 1e-12 of its largest entry.
        position: of the centre of mass in m, shape ``(3,)``.
        orientation: what turns the body's axes into the world's: a ``Rotation`` of SciPy, or a
            quaternion (w, x, y, z) of any length, such as of `axis_angle`; SciPy's own order is
            (x, y, z, w). The attribute is of length 1, `replace`, files and text have the given.
        velocity: of the centre of mass in m/s, shape ``(3,)``.
        angular_velocity: ω in rad/s in the world's axes, shape ``(3,)``.
        force: on the centre of mass in N besides gravity, in the world's axes: shape ``(3,)``, or a
            `Signal` or a function of t in s with such values.
        torque: in N m in the world's axes, likewise.
        name: of the body, in tables and messages; by default its number, as in ``"body 0"``.

    Raises:
        DimensionError, ParameterError: naming the argument.

    >>> from asperity import Body
    >>> Body.ball(1.0, radius=0.1, position=(0.0, 0.0, 1.0)).inertia.diagonal().round(9).tolist()
    [0.004, 0.004, 0.004]
    >>> from scipy.spatial.transform import Rotation
    >>> turn = Rotation.from_euler("z", 90.0, degrees=True)
    >>> Body.ball(1.0, radius=0.1, orientation=turn).orientation.round(6).tolist()
    [0.707107, 0.0, 0.0, 0.707107]
    """

    mass: Positive
    _: KW_ONLY
    inertia: Annotated[Given[ArrayLike, Array], _inertia]
    position: Vector3 = field(default=(0.0, 0.0, 0.0))
    orientation: Annotated[Given[Orientation, Array], rotation.written] = field(
        default=(1.0, 0.0, 0.0, 0.0)
    )
    velocity: Vector3 = field(default=(0.0, 0.0, 0.0))
    angular_velocity: Vector3 = field(default=(0.0, 0.0, 0.0))
    force: Changing3 = field(default=(0.0, 0.0, 0.0))
    torque: Changing3 = field(default=(0.0, 0.0, 0.0))
    name: Name = None

    def _derive(self) -> None:
        self._keep(orientation=rotation.quaternion(self.orientation, "orientation"))

    _scaled = frozenset({"orientation"})

    @classmethod
    def box(cls, mass: float, *, half_sizes: ArrayLike, **state: Unpack[BodyState]) -> Self:
        """Return a homogeneous box.

        Args:
            mass: m > 0 in kg.
            half_sizes: half of its edges in m, shape ``(3,)``.
            **state: as of `Body`.
        """
        squares = positive_vector(half_sizes, "half_sizes", 3) ** 2
        return cls(
            mass, inertia=arrays.positive(mass, "mass") / 3.0 * (squares.sum() - squares), **state
        )

    @classmethod
    def ball(cls, mass: float, *, radius: float, **state: Unpack[BodyState]) -> Self:
        """Return a homogeneous ball, J = ⅖ m R².

        Args:
            mass: m > 0 in kg.
            radius: R > 0 in m.
            **state: as of `Body`.
        """
        square = arrays.positive(radius, "radius") ** 2
        return cls(mass, inertia=np.full(3, 0.4 * arrays.positive(mass, "mass") * square), **state)

    @classmethod
    def cylinder(
        cls, mass: float, *, radius: float, height: float, **state: Unpack[BodyState]
    ) -> Self:
        """Return a homogeneous cylinder about the body's third axis.

        Args:
            mass: m > 0 in kg.
            radius: R > 0 in m.
            height: h > 0 in m.
            **state: as of `Body`.
        """
        mass = arrays.positive(mass, "mass")
        square = arrays.positive(radius, "radius") ** 2
        across = mass * (3.0 * square + arrays.positive(height, "height") ** 2) / 12.0
        return cls(mass, inertia=[across, across, 0.5 * mass * square], **state)

    @property
    def coordinates(self) -> Array:
        """Initial coordinates: position and orientation, shape ``(7,)``."""
        return np.concatenate([self.position, self.orientation])

    @property
    def velocities(self) -> Array:
        """Initial velocities: v in the world's axes and Ω in the body's, shape ``(6,)``."""
        turned = rotation.matrices(self.orientation).T @ self.angular_velocity
        return np.concatenate([self.velocity, turned])


class PlanarBody(Record):
    """A rigid body in a plane, placed by its centre of mass and an angle.

    Args:
        mass: m > 0 in kg.
        inertia: J > 0 in kg m² about the centre of mass.
        position: of the centre of mass in m, shape ``(2,)``.
        angle: φ in rad, counter-clockwise.
        velocity: of the centre of mass in m/s, shape ``(2,)``.
        angular_velocity: ω in rad/s.
        force: on the centre of mass in N besides gravity: shape ``(2,)``, or a `Signal` or a
            function of t in s with such values.
        torque: in N m: a number, or a `Signal` or a function of t in s.
        name: of the body, in tables and messages; by default its number, as in ``"body 0"``.

    Raises:
        DimensionError, ParameterError: naming the argument.

    >>> from asperity import PlanarBody
    >>> PlanarBody.disk(2.0, radius=1.0).inertia
    1.0
    """

    mass: Positive
    _: KW_ONLY
    inertia: Positive
    position: Vector2 = field(default=(0.0, 0.0))
    angle: Number = 0.0
    velocity: Vector2 = field(default=(0.0, 0.0))
    angular_velocity: Number = 0.0
    force: Changing2 = field(default=(0.0, 0.0))
    torque: Changing1 = field(default=0.0)
    name: Name = None

    @classmethod
    def box(cls, mass: float, *, half_sizes: ArrayLike, **state: Unpack[PlanarState]) -> Self:
        """Return a homogeneous rectangle.

        Args:
            mass: m > 0 in kg.
            half_sizes: half of its edges in m, shape ``(2,)``.
            **state: as of `PlanarBody`.
        """
        squares = positive_vector(half_sizes, "half_sizes", 2) ** 2
        return cls(mass, inertia=arrays.positive(mass, "mass") / 3.0 * squares.sum(), **state)

    @classmethod
    def disk(cls, mass: float, *, radius: float, **state: Unpack[PlanarState]) -> Self:
        """Return a homogeneous disk, J = ½ m R².

        Args:
            mass: m > 0 in kg.
            radius: R > 0 in m.
            **state: as of `PlanarBody`.
        """
        square = arrays.positive(radius, "radius") ** 2
        return cls(mass, inertia=0.5 * arrays.positive(mass, "mass") * square, **state)

    @property
    def coordinates(self) -> Array:
        """Initial coordinates: position and angle, shape ``(3,)``."""
        return np.append(self.position, self.angle)

    @property
    def velocities(self) -> Array:
        """Initial velocities, shape ``(3,)``."""
        return np.append(self.velocity, self.angular_velocity)


def positive_vector(value: ArrayLike, argument: str, size: int) -> Array:
    """Return a vector with entries above zero."""
    vector = arrays.array(value, argument, (size,))
    if vector.min() <= 0.0:
        raise ParameterError(argument, f"must be positive, got {vector.tolist()}")
    return vector


def _inertia(value: ArrayLike, argument: str) -> Array:
    """Return J; no body has a principal moment above the sum of the other two."""
    inertia = arrays.square(value, argument, 3)
    if np.abs(inertia - inertia.T).max() > _SYMMETRY * np.abs(inertia).max():
        raise ParameterError(argument, "must be symmetric")
    inertia = 0.5 * (inertia + inertia.T)
    moments = np.linalg.eigvalsh(inertia)
    if moments[0] <= 0.0:
        raise ParameterError(argument, f"must be positive definite, moments {moments.tolist()}")
    if moments[2] > (moments[0] + moments[1]) * (1.0 + _MOMENTS):
        raise ParameterError(
            argument,
            f"must have no principal moment above the sum of the others, {moments.tolist()}",
        )
    return inertia
