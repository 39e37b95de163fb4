"""Sets that grow with their parameters, and planar ones that carry their own angle."""

from __future__ import annotations

from typing import Any, ClassVar, Self

from asperity._base import arrays
from asperity._core import Set as CoreSet
from asperity.sets.star import StarSet


class SizedSet(StarSet):
    """A set whose lengths are parameters."""

    _lengths: ClassVar[tuple[str, ...]]

    def scaled(self, factor: float) -> Self:
        """Return the set {s x : x ∈ C}."""
        factor = arrays.positive(factor, "factor")
        given = {name: self._parameters[name] for name in self._lengths}
        return self.replace(
            **{name: factor * length for name, length in given.items() if length is not None}
        )


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


class TurnedSet(SizedSet, AngledSet):
    """A planar set with semi-axes a, b, turned by an angle."""

    _lengths: ClassVar[tuple[str, ...]] = ("a", "b")

    a: float
    b: float
