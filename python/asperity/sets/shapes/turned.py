"""Planar sets that carry their own angle."""

from __future__ import annotations

from typing import Any, Self

from asperity._base import arrays
from asperity._core import Set as CoreSet
from asperity.sets.star import StarSet


class AngledSet(StarSet):
    """A planar set whose first axis is turned by an angle from e₁."""

    angle: float

    def _set_angled(self, upright: CoreSet, angle: float, **parameters: Any) -> None:
        angle = arrays.number(angle, "angle")
        core = upright.rotated(angle) if angle else upright
        self._set_core(core, angle=angle, **parameters)

    def rotated(self, angle: float) -> Self:
        """Return the set turned counter-clockwise by `angle` in rad."""
        return self.replace(angle=self.angle + arrays.number(angle, "angle"))


class TurnedSet(AngledSet):
    """A planar set with semi-axes a, b, turned by an angle."""

    a: float
    b: float

    def scaled(self, factor: float) -> Self:
        """Return the set {s x : x ∈ C}."""
        factor = arrays.positive(factor, "factor")
        return self.replace(a=factor * self.a, b=factor * self.b)
