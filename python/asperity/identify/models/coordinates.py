"""Coordinates in which models are fitted, and the parameters that are reported for them."""

from __future__ import annotations

import math
from collections.abc import Sequence
from enum import Enum
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from asperity._base import arrays
from asperity._base.arrays import Array
from asperity._base.value import Record, Value

# Logarithms are kept off minus infinity: samples may lie on an axis of a set.
TINY = 1e-150
# Exponents between which superellipses are looked for.
FLATTEST, SHARPEST = 0.3, 60.0
_AT_BOUND = 1e-6


class Scale(Enum):
    """How a reported parameter follows from its coordinate: monotone, so that intervals map."""

    PLAIN = "x"
    LOG = "exp x"
    LOG_EXCESS = "1 + exp x"
    ANGLE = "rad"

    def natural(self, x: Array) -> Array:
        """Return the reported parameter."""
        if self in (Scale.PLAIN, Scale.ANGLE):
            return x
        return np.exp(x) + (self is Scale.LOG_EXCESS)

    def slope(self, x: Array) -> Array:
        """Return its derivative by the coordinate."""
        return np.ones_like(x) if self in (Scale.PLAIN, Scale.ANGLE) else np.exp(x)


class Coordinate(NamedTuple):
    """Name of a reported parameter, how it follows from the coordinate, bounds of this."""

    name: str
    scale: Scale
    low: float = -np.inf
    high: float = np.inf


def at_bounds(p: Array, coordinates: Sequence[Coordinate]) -> NDArray[np.bool_]:
    """Return which coordinates ended at a bound."""
    low, high = np.array([(c.low, c.high) for c in coordinates]).reshape(-1, 2).T
    return (p <= low + _AT_BOUND) | (p >= high - _AT_BOUND)


class Roundness(NamedTuple):
    """Combinations M x − m of coordinates that vanish where the angle of a set has no meaning."""

    matrix: Array
    offset: Array


class CurveModel(Value):
    """A family of closed curves with coordinates p, the last one an angle where there is one."""

    coordinates: tuple[Coordinate, ...]

    @property
    def is_symmetric(self) -> bool:
        """Whether all curves are symmetric to the origin."""
        return True

    def roundness(self) -> Roundness | None:
        """Return what vanishes where the angle, the last coordinate, has no meaning."""
        return None

    def folded(self, p: Array) -> Array:
        """Return the coordinates of the same set with the angle within ±45°."""
        return p


def folded(p: Array, axes: int | slice, swapped: Array) -> Array:
    """Return coordinates with the last one, an angle, within ±45°.

    Every quarter turn puts others in the place of those of the axes.
    """
    quarters = round(p[-1] / (math.pi / 2.0))
    result = p.copy()
    result[-1] -= quarters * math.pi / 2.0
    if quarters % 2:
        result[axes] = swapped
    return result


class Estimate(Record):
    """A parameter with its confidence interval.

    Args:
        value: estimate, in SI units or rad.
        low: lower end of the confidence interval.
        high: upper end of the confidence interval.
        standard_error: standard deviation of the estimate.
        identifiable: False if the data do not determine this parameter; then only the interval
            has a meaning.

    >>> from asperity.identify import Estimate
    >>> Estimate(0.54, 0.53, 0.55, 0.005).covers(0.536)
    True
    """

    value: float
    low: float
    high: float
    standard_error: float
    identifiable: bool = True

    def covers(self, truth: float) -> bool:
        """Return whether the confidence interval holds a value."""
        return self.low <= arrays.number(truth, "truth") <= self.high

    def __str__(self) -> str:
        if not self.identifiable:
            return "not identifiable"
        if math.isnan(self.low):
            return f"{self.value:.6g} (no interval)"
        if self.low == self.high and self.standard_error == 0.0:
            return f"{self.value:.6g} (fixed)"
        return f"{self.value:.6g} ({self.low:.6g} … {self.high:.6g})"
