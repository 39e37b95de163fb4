"""Springs and dampers between points of bodies."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import KW_ONLY
from typing import Annotated, Any, TypeAlias

import numpy as np
from numpy.typing import ArrayLike

from asperity._base import arrays
from asperity._base.value import (
    AnyArrayOrNone,
    Given,
    Index,
    NonNegative,
    Record,
    Vector,
    field,
)
from asperity.errors import DimensionError, ParameterError
from asperity.system import time_functions
from asperity.system.time_functions import Signal, TimeFunction


def _length(given: TimeFunction, argument: str) -> Any:
    if callable(given):
        return time_functions.checked(given, argument, ())
    return arrays.non_negative(given, argument)


_Length: TypeAlias = Annotated[
    Given[TimeFunction, float | Signal | Callable[[float], ArrayLike]], _length
]


class Spring(Record):
    """A spring with a damper between two points: tension k (l − l₀) + d dl/dt.

    It acts explicitly: steps need Δt d < 2 m and Δt² k < 4 m with the effective mass m along it.

    Args:
        body: number of the body.
        point: in the body's axes from its centre of mass in m, shape ``(3,)``, planar ``(2,)``.
        other: number of the other body; ``None``: the world.
        other_point: in the axes of the other body or of the world in m. Default 0.
        stiffness: k ≥ 0 in N/m.
        damping: d ≥ 0 in N s/m.
        length: l₀ ≥ 0 in m, at which the spring is relaxed; a number, or a `Signal` or a function
            of t in s. If l₀ > 0, there is no force while the ends coincide.

    Raises:
        DimensionError, ParameterError: naming the argument.

    >>> from asperity import Body, RigidBodies, Spring
    >>> spring = Spring(0, point=(0.0, 0.0, 0.0), stiffness=100.0)
    >>> RigidBodies([Body.ball(1.0, radius=0.1)], springs=[spring]).dof
    6
    """

    body: Index
    _: KW_ONLY
    point: Vector
    other: Index | None = None
    other_point: AnyArrayOrNone = field(default=None)
    stiffness: NonNegative
    damping: NonNegative = 0.0
    length: _Length = field(default=0.0)

    def _complete(self, given: dict[str, Any]) -> None:
        if given["body"] == given["other"]:
            raise ParameterError("other", f"must be another body than {given['body']}")
        near, far = given["point"], given["other_point"]
        if len(near) not in (2, 3):
            raise DimensionError("point", f"must have 2 or 3 entries, got {len(near)}")
        far = np.zeros(len(near)) if far is None else far
        given["other_point"] = arrays.array(far, "other_point", near.shape)

    @property
    def planar(self) -> bool:
        """Whether it holds planar bodies."""
        return len(self.point) == 2

    def _core_data(self) -> dict[str, Any]:
        return {**self._parameters, "length": time_functions.core(self.length)}
