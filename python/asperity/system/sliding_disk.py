"""The sliding disk of [WL19] §5.1: a rigid body in space on three pads."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING, Self

import numpy as np
from numpy.typing import ArrayLike

from asperity._base import arrays
from asperity._base.arrays import Array, unit_vectors
from asperity.errors import ParameterError
from asperity.law import FrictionLaw
from asperity.system.rigid import Body, Plane, PointPlane, RigidBodies

if TYPE_CHECKING:
    from asperity.runs.trajectory import Trajectory

PADS = 3
"""Number of pads, equally spaced on a circle; their contacts are the first."""

# Points of either edge of the disk, which touch the plane only if the disk tips.
_EDGE_POINTS = 12
# Velocities up to this share of the largest are rest.
_REST = 1e-9


class SlidingDisk(RigidBodies):
    """A rigid disk on three pads that slides on the horizontal plane z = 0 and may turn.

    The pads are points with unilateral contacts, so friction below the centre of mass loads them
    unequally. By Amontons' law the resultants of pads that slip alike still meet the vertical
    through the centre of mass: without initial spin the disk moves as a `SlidingPoint`.

    That holds while all pads stay loaded, without spin and with vertical gravity surely if the
    coefficient of friction is below `pad_circle` / (2 `height`), 0.81 for the default sizes. Above,
    a pad may lift off; the disk then tilts until its edge touches the plane, and may tip over.
    Twelve points of each edge have contacts too, after those of the pads, with the same law.

    At the default tolerance of `simulate` the loads sum up to the weight to 1e-6, at 1e-13 to
    1e-10. Before the first step a run has no loads: its `normal_force[0]` is NaN.

    Args:
        law: planar friction law per unit normal force, in the axes e₁, e₂ of the plane.
        velocity: initial velocity (v₁, v₂) of the centre of mass in m/s.
        spin: initial angular velocity about the vertical in rad/s.
        angle: of the first pad against e₁ in rad.
        position: initial position (x₁, x₂) of the centre of mass in m.
        mass: m > 0 in kg.
        diameter: of the homogeneous disk in m.
        height: of the disk in m; the centre of mass is at half of it.
        pad_circle: diameter of the circle of the pads in m, at most `diameter`.
        pad_height: by which the pads stand out of the disk in m, a part of `height`.
        gravity: in m/s², shape ``(3,)``; it presses the disk on the plane, and may be inclined.

    Raises:
        DimensionError, ParameterError: naming the argument.

    Reference: [WL19] §5.1, Figs. 18, 27.

    >>> from asperity import FrictionLaw, SlidingDisk, simulate
    >>> disk = SlidingDisk(FrictionLaw.isotropic(0.5), velocity=(1.0, 0.0))
    >>> run = simulate(disk, dt=1e-4, t_end=1.0, tolerance=1e-13)
    >>> disk.path(run)[-1].round(6).tolist()  # v²/(2 μ g)
    [0.101937, 0.0]
    >>> run.normal_force[1, :3].round(6).tolist()  # the pad in front carries most
    [0.095297, 0.040641, 0.040641]
    >>> bool(abs(run.normal_force[1:].sum(axis=1) / (0.018 * 9.81) - 1.0).max() < 1e-10)
    True
    >>> round(disk.rest_time(run), 4)  # v/(μ g) = 0.2039
    0.2039
    """

    law: FrictionLaw
    velocity: Array
    spin: float
    angle: float
    position: Array
    mass: float
    diameter: float
    height: float
    pad_circle: float
    pad_height: float

    def __init__(
        self,
        law: FrictionLaw,
        *,
        velocity: ArrayLike = (0.0, 0.0),
        spin: float = 0.0,
        angle: float = 0.0,
        position: ArrayLike = (0.0, 0.0),
        mass: float = 0.018,
        diameter: float = 0.028,
        height: float = 0.013,
        pad_circle: float = 0.021,
        pad_height: float = 0.001,
        gravity: ArrayLike = (0.0, 0.0, -9.81),
    ) -> None:
        if not isinstance(law, FrictionLaw) or law.dimension != 2:
            raise ParameterError("law", f"must be a planar FrictionLaw, got {law!r}")
        start = arrays.array(velocity, "velocity", (2,))
        place = arrays.array(position, "position", (2,))
        given = {
            "spin": arrays.number(spin, "spin"),
            "angle": arrays.number(angle, "angle"),
            "mass": arrays.positive(mass, "mass"),
            "diameter": arrays.positive(diameter, "diameter"),
            "height": arrays.positive(height, "height"),
            "pad_circle": arrays.positive(pad_circle, "pad_circle"),
            "pad_height": arrays.positive(pad_height, "pad_height"),
        }
        if pad_circle > diameter:
            raise ParameterError("pad_circle", f"must be at most {diameter!r}, got {pad_circle!r}")
        if pad_height >= height:
            raise ParameterError("pad_height", f"must be below {height!r}, got {pad_height!r}")
        down = arrays.array(gravity, "gravity", (3,))
        if down[2] >= 0.0:
            raise ParameterError("gravity", f"must press the disk on the plane, got {gravity!r}")
        body = Body.cylinder(
            mass,
            radius=0.5 * diameter,
            height=height,
            position=(*place, 0.5 * height),
            orientation=(np.cos(0.5 * angle), 0.0, 0.0, np.sin(0.5 * angle)),
            velocity=(*start, 0.0),
            angular_velocity=(0.0, 0.0, spin),
            name="disk",
        )
        points = [
            *_ring(PADS, 0.5 * pad_circle, -0.5 * height),
            *_ring(_EDGE_POINTS, 0.5 * diameter, pad_height - 0.5 * height),
            *_ring(_EDGE_POINTS, 0.5 * diameter, 0.5 * height),
        ]
        rings = (("pad", PADS), ("lower edge", _EDGE_POINTS), ("upper edge", _EDGE_POINTS))
        names = [f"{ring} {number}" for ring, count in rings for number in range(count)]
        touching = [
            PointPlane(0, point=point, plane=Plane(), law=law, name=name)
            for point, name in zip(points, names, strict=True)
        ]
        super().__init__([body], pairs=touching, gravity=down)
        self._set(law=law, velocity=start, position=place, **given, gravity=self.gravity)

    def with_law(
        self, law: FrictionLaw, *, pairs: int | str | Sequence[int | str] | None = None
    ) -> Self:
        """Return the same disk with another friction law, which all its pads share."""
        if pairs is not None:
            raise ParameterError("pairs", "must be None: all pads of the disk share one law")
        return self.replace(law=law)

    def path(self, trajectory: Trajectory) -> Array:
        """Return the positions (x₁, x₂) of the centre of mass in m, shape ``(n_t, 2)``.

        Args:
            trajectory: of this disk.
        """
        return self.positions(trajectory)[:, 0, :2]

    def turn(self, trajectory: Trajectory) -> Array:
        """Return the angle by which the disk has turned about the vertical in rad, ``(n_t,)``.

        Args:
            trajectory: of this disk.
        """
        turned = self.rotations(trajectory)[:, 0]
        angle = np.unwrap(np.arctan2(turned[:, 1, 0], turned[:, 0, 0]))
        return angle - angle[0]

    def rest_time(self, trajectory: Trajectory) -> float:
        """Return the time in s from which on the disk rests; NaN if it still moves at the end.

        Velocities up to 1e-9 of the largest, at least of 1 m/s and 1 rad/s, count as rest. At the
        default tolerance of `simulate` they keep about 1e-11, so that ``until_rest``, which asks
        for 1e-12, may stop late or not at all; at 1e-13 it stops here.

        Args:
            trajectory: of this disk.
        """
        speed = np.abs(trajectory.u).max(axis=1)
        moving = np.flatnonzero(speed > _REST * max(1.0, speed.max()))
        first = int(moving[-1]) + 1 if len(moving) else 0
        return float(trajectory.t[first]) if first < len(speed) else float("nan")


def _ring(count: int, radius: float, height: float) -> Array:
    around = radius * unit_vectors(2.0 * np.pi * np.arange(count) / count)
    return np.column_stack([around, np.full(count, height)])
