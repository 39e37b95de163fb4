"""Surfaces that bodies touch, and the frame in which friction is anisotropic."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import KW_ONLY
from typing import Annotated, Any, Literal, Self, TypeAlias

import numpy as np

from asperity._base.arrays import Array
from asperity._base.value import Index, Record, Vector2, Vector3, field
from asperity.errors import ParameterError
from asperity.system import time_functions
from asperity.system.rigid import friction_maps, plane_motion, rotation
from asperity.system.rigid.friction_maps import FrictionFactor
from asperity.system.rigid.plane_motion import PlaneMotion
from asperity.system.rigid.rotation import Orientation
from asperity.system.time_functions import Changing1, Changing2

# Sine of the smallest angle between an axis and the normal it is projected along.
_PARALLEL = 1e-12


class Plane(Record):
    """A plane with the axes e₁, e₂ = n × e₁ and the normal n that points to the touching bodies.

    Its surface may move in itself: a belt with `velocity`, a turntable with `spin` about the normal
    through `point`; plane and grooves then stay where they are. With `motion` the plane itself
    moves with its grooves: a shaken table. Attributes are unit vectors; `replace`, files and text
    have the vectors that were given.

    Args:
        point: a point of the plane in m, shape ``(3,)``; origin of the coordinates (x₁, x₂).
        normal: n, of any length, shape ``(3,)``.
        axis: e₁ after projection on the plane, shape ``(3,)``.
        velocity: v of the surface along e₁ and e₂ in m/s; enters γ as −v. Shape ``(2,)``, or a
            `Signal` or a function of t in s with such values.
        spin: angular velocity of the surface about n in rad/s: a number, or a `Signal` or a
            function of t in s.
        motion: how the plane moves; ``None``: it rests.
        friction_factor: `FrictionRegions`, a `FrictionRaster` or a smooth function of the position
            (x₁, x₂) in m from `point` along e₁, e₂: the factor of the friction there, for laws
            without a rate. It belongs to the plane, not to a belt on it. ``None``: 1 everywhere.
        body: number of the body that the plane is fixed to, in whose axes all the above is then
            given, from its centre of mass; ``None``: fixed to the world.

    Raises:
        DimensionError, ParameterError: naming the argument.

    >>> from asperity import Plane
    >>> Plane(normal=(0.0, -1.0, 1.0)).axes.round(6).tolist()
    [[1.0, 0.0, 0.0], [0.0, 0.707107, 0.707107], [0.0, -0.707107, 0.707107]]
    """

    _: KW_ONLY
    point: Vector3 = field(default=(0.0, 0.0, 0.0))
    normal: Vector3 = field(default=(0.0, 0.0, 1.0))
    axis: Vector3 = field(default=(1.0, 0.0, 0.0))
    velocity: Changing2 = field(default=(0.0, 0.0))
    spin: Changing1 = field(default=0.0)
    motion: Annotated[PlaneMotion | None, plane_motion.of_shapes((3,), (3,))] = None
    friction_factor: Annotated[FrictionFactor, friction_maps.checked_factor] = None
    body: Index | None = None
    axes: Array = field(init=False)

    def _derive(self) -> None:
        n, e1 = (rotation.normalised(getattr(self, name), name, 3) for name in ("normal", "axis"))
        self._keep(normal=n, axis=e1, axes=_axes(n, e1))

    _scaled = frozenset({"normal", "axis"})

    @classmethod
    def oriented(cls, orientation: Orientation, **options: Any) -> Self:
        """Return the plane whose e₁, e₂ and n are the turned x-, y- and z-axis.

        Args:
            orientation: a ``Rotation`` of SciPy, or a quaternion (w, x, y, z), which is normalised.
            **options: ``point``, ``velocity``, ``spin``, ``motion``, ``friction_factor``, ``body``,
                as of `Plane`.

        Raises:
            DimensionError, ParameterError: naming the argument.

        >>> from scipy.spatial.transform import Rotation
        >>> slope = Rotation.from_euler("x", 45.0, degrees=True)
        >>> Plane.oriented(slope).normal.round(6).tolist()
        [0.0, -0.707107, 0.707107]
        """
        axes = rotation.matrices(rotation.quaternion(orientation, "orientation"))
        return cls(normal=axes[:, 2], axis=axes[:, 0], **options)

    def _core_data(self) -> dict[str, Any]:
        return {
            **self._parameters,
            "normal": self.normal,
            "axis": self.axis,
            "velocity": time_functions.core(self.velocity),
            "spin": time_functions.core(self.spin),
            "motion": plane_motion.core_data(self.motion, (np.zeros(3), np.zeros(3))),
            "friction_factor": friction_maps.core_data(self.friction_factor),
        }


class Line(Record):
    """A straight line for planar bodies, with e₁ to the right of the normal n.

    Args:
        point: a point of the line in m, shape ``(2,)``.
        normal: n, of any length, towards the touching bodies, shape ``(2,)``.
        velocity: v of the surface along e₁ = (n₂, −n₁) in m/s; enters γ as −v. A number, or a
            `Signal` or a function of t in s.
        motion: how the line moves; ``None``: it rests.
        body: number of the body that the line is fixed to, in whose axes all the above is then
            given, from its centre of mass; ``None``: fixed to the world.

    Raises:
        DimensionError, ParameterError: naming the argument.

    >>> from asperity import Line
    >>> Line(normal=(0.0, 2.0)).axes.tolist()
    [[1.0, 0.0], [0.0, 1.0]]
    """

    _: KW_ONLY
    point: Vector2 = field(default=(0.0, 0.0))
    normal: Vector2 = field(default=(0.0, 1.0))
    velocity: Changing1 = field(default=0.0)
    motion: Annotated[PlaneMotion | None, plane_motion.of_shapes((2,), ())] = None
    body: Index | None = None
    axes: Array = field(init=False)

    def _derive(self) -> None:
        n1, n2 = normal = rotation.normalised(self.normal, "normal", 2)
        # Adding zero turns −0 into 0.
        self._keep(normal=normal, axes=np.array([[n2, -n1], [n1, n2]]) + 0.0)

    _scaled = frozenset({"normal"})

    def _core_data(self) -> dict[str, Any]:
        return {
            **self._parameters,
            "normal": self.normal,
            "velocity": time_functions.core(self.velocity),
            "motion": plane_motion.core_data(self.motion, (np.zeros(2), 0.0)),
        }


class BodyAxis(Record):
    """The frame of a law that a body carries: e₁ is an axis of the body, projected on the surface.

    Args:
        axis: in the body's axes, of any length, shape ``(3,)``. Where it is parallel to the
            normal the plane's axis takes its place, between spheres some direction across it.

    >>> from asperity import BodyAxis
    >>> BodyAxis((0.0, 2.0, 0.0))
    BodyAxis([0.0, 2.0, 0.0])
    """

    axis: Vector3

    def _derive(self) -> None:
        self._keep(axis=rotation.normalised(self.axis, "axis", 3))

    _scaled = frozenset({"axis"})


Frame: TypeAlias = Literal["plane", "polar"] | BodyAxis | Callable[[float, float], float]
"""What carries the axes e₁, e₂ of a law: the plane's axis; the direction away from the plane's
point (grooves that circle it); an axis of the touching body; or a function of the position
(x₁, x₂) in the plane that returns the angle of e₁ against the plane's axis in rad."""


def checked_frame(frame: Frame, surface: Plane | Line) -> Frame:
    """Return `frame` if a law may be given in it on this surface."""
    if isinstance(surface, Line):
        if frame != "plane":
            raise ParameterError("frame", f"must be 'plane' on a line, got {frame!r}")
        return frame
    if isinstance(frame, BodyAxis) or callable(frame):
        return frame
    if not isinstance(frame, str) or frame not in ("plane", "polar"):
        raise ParameterError(
            "frame", f"must be 'plane', 'polar', a BodyAxis or a function, got {frame!r}"
        )
    return frame


def _axes(normal: Array, axis: Array) -> Array:
    """Return the rows e₁, e₂, n."""
    projected = axis - (axis @ normal) * normal
    length = float(np.linalg.norm(projected))
    if length <= _PARALLEL:
        raise ParameterError("axis", "must not be parallel to normal")
    e1 = projected / length
    return np.stack([e1, np.cross(normal, e1), normal]) + 0.0
