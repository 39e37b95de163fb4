"""Hinges, sliders and welds between bodies."""

from __future__ import annotations

from dataclasses import KW_ONLY
from typing import Any

import numpy as np

from asperity._base import arrays
from asperity._base.value import AnyArrayOrNone, Index, Record, Vector, field
from asperity.errors import DimensionError, ParameterError


class Joint(Record):
    """Base of what holds a body to another one, or to the world."""

    body: Index
    _: KW_ONLY
    other: Index | None = None

    def _complete(self, given: dict[str, Any]) -> None:
        if given["body"] == given["other"]:
            raise ParameterError("other", f"must be another body than {given['body']}")

    @property
    def planar(self) -> bool | None:
        """Whether it holds planar bodies; ``None`` if it may hold either."""
        return None

    def _core_data(self) -> dict[str, Any]:
        place = {"anchor": np.zeros(3), "axis": np.array([0.0, 0.0, 1.0])}
        return {**place, **self._parameters, "kind": type(self).__name__}


class _AxisJoint(Joint):
    """Base of joints with an axis."""

    _: KW_ONLY
    anchor: Vector
    axis: AnyArrayOrNone = field(default=None)

    def _complete(self, given: dict[str, Any]) -> None:
        super()._complete(given)
        size = len(given["anchor"])
        if size not in (2, 3):
            raise DimensionError("anchor", f"must have 2 or 3 entries, got {size}")
        if given["axis"] is None:
            if not self._across_planes or size == 3:
                raise ParameterError("axis", "must be given")
            given["axis"] = [0.0, 0.0, 1.0]
        sizes = 3 if self._across_planes else size
        given["axis"] = arrays.array(given["axis"], "axis", (sizes,))
        if not given["axis"].any():
            raise ParameterError("axis", "must not be zero")

    _across_planes = False

    @property
    def planar(self) -> bool:
        """Whether it holds planar bodies."""
        return len(self.anchor) == 2


class Hinge(_AxisJoint):
    """A hinge, which lets a body turn about an axis of another one, or of the world.

    Args:
        body: number of the body.
        other: number of the other body; ``None``: the world.
        anchor: a point of the axis in m, in the world's axes as the bodies of the system are
            given, shape ``(3,)``, planar ``(2,)``.
        axis: along the axis, likewise, of any length, shape ``(3,)``; in a plane it is
            across that.

    Raises:
        DimensionError, ParameterError: naming the argument.

    >>> import asperity as asp
    >>> rod = asp.Body(1.0, inertia=(0.1, 0.1, 0.01), position=(0.5, 0.0, 0.0))
    >>> pendulum = asp.RigidBodies(
    ...     [rod], joints=[asp.Hinge(0, anchor=(0.0, 0.0, 0.0), axis=(0.0, 1.0, 0.0))]
    ... )
    >>> motion = asp.simulate(pendulum, dt=1e-3, t_end=1.0)
    >>> bool(abs(pendulum.energy(motion)).max() < 1e-4)  # J
    True
    """

    _across_planes = True


class Slider(_AxisJoint):
    """A slider, which lets a body move along an axis of another one, or of the world.

    Args:
        body: number of the body.
        other: number of the other body; ``None``: the world.
        anchor: the point in m where forces across the axis act on the body, in the world's axes
            as the bodies of the system are given, shape ``(3,)``, planar ``(2,)``.
        axis: along which it moves, likewise, of any length, shape ``(3,)``, planar ``(2,)``.

    Raises:
        DimensionError, ParameterError: naming the argument.

    >>> import asperity as asp
    >>> sledge = asp.Body.box(1.0, half_sizes=(0.1, 0.1, 0.1))
    >>> rail = asp.Slider(0, anchor=(0.0, 0.0, 0.0), axis=(3.0, 0.0, -4.0))
    >>> motion = asp.simulate(asp.RigidBodies([sledge], joints=[rail]), dt=1e-3, t_end=1.0)
    >>> (motion.u[-1, [0, 2]] / 9.81).round(9).tolist()  # slope of 4 in 5
    [0.48, -0.64]
    """


class Weld(Joint):
    """A weld, which holds a body at another one, or at the world, as both are given.

    Args:
        body: number of the body.
        other: number of the other body; ``None``: the world.

    Raises:
        DimensionError, ParameterError: naming the argument.

    >>> import asperity as asp
    >>> shelf = asp.Body.box(1.0, half_sizes=(0.1, 0.1, 0.1))
    >>> motion = asp.simulate(asp.RigidBodies([shelf], joints=[asp.Weld(0)]), dt=0.01, t_end=1.0)
    >>> float(abs(motion.q[-1, :3]).max())
    0.0
    """
