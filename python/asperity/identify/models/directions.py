"""Models of the direction set D: the force's angle over the sliding direction, with derivatives.

The scale of D drops out of the law: only ratios of its measures are coordinates.
"""

from __future__ import annotations

import math
from abc import ABC, abstractmethod

import numpy as np

from asperity._base import arrays
from asperity._base.arrays import Array
from asperity.errors import FitError
from asperity.identify.models.coordinates import (
    SHARPEST,
    TINY,
    Coordinate,
    CurveModel,
    Roundness,
    Scale,
    folded,
)
from asperity.identify.models.harmonics import FourierModel, least_squares, series
from asperity.identify.models.reservoirs import START_ANGLES, around, ellipse_through
from asperity.sets import Disk, Ellipse, StarSet, Superellipse, SupportCurve

_SAMPLES = 720
# dθ/dψ is infinite on the axes for s > 2: one sample there would outweigh all others.
_NEAREST_AXIS = 1e-3
_LOWEST_EXPONENT = 1.02
_LARGEST_LOG = 300.0


class DirectionModel(CurveModel, ABC):
    """A family of sets D, of any scale, with coordinates p."""

    @abstractmethod
    def force_direction(self, c: Array, s: Array, p: Array) -> tuple[Array, Array, Array]:
        """Return the direction of −λ while sliding along (c, s), and dθ/dp, ``(k, n)``."""

    def flow(self, p: Array) -> float:
        """Return the power of tan φ, from an axis, that tan θ goes with; 1 without such axes.

        Where it is less than 1, the force turns infinitely fast on the axes.
        """
        return 1.0

    @abstractmethod
    def direction(self, p: Array) -> StarSet:
        """Return D; its scale is of no meaning."""

    @abstractmethod
    def start(self, c: Array, s: Array, log_support: Array, slope: Array) -> list[Array]:
        """Return coordinates to start from, for ln h_D and its derivative at normals (c, s)."""


class CircleDirection(DirectionModel):
    """D is a disk: friction is opposite to sliding.

    >>> from asperity.identify import CircleDirection
    >>> CircleDirection().coordinates
    ()
    """

    coordinates = ()

    def __init__(self) -> None:
        self._set()

    def force_direction(self, c: Array, s: Array, p: Array) -> tuple[Array, Array, Array]:
        """Return the sliding direction itself."""
        return c, s, np.empty((0, c.size))

    def direction(self, p: Array) -> StarSet:
        """Return the unit disk."""
        return Disk(1.0)

    def start(self, c: Array, s: Array, log_support: Array, slope: Array) -> list[Array]:
        """Return no coordinates."""
        return [np.empty(0)]


class SuperellipseDirection(DirectionModel):
    """D is a superellipse with free angle, or an ellipse if the exponent is given as 2.

    Args:
        exponent: s > 1, or None if it is to be fitted.

    Reference: [WL19] (37), Table 1.

    >>> from asperity.identify import SuperellipseDirection
    >>> [name for name, *_ in SuperellipseDirection().coordinates]
    ['ratio', 'exponent', 'angle']
    """

    exponent: float | None

    def __init__(self, exponent: float | None = None) -> None:
        if exponent is not None:
            exponent = arrays.positive(exponent, "exponent")
            if exponent < _LOWEST_EXPONENT:
                raise FitError(
                    f"direction: the exponent must be at least {_LOWEST_EXPONENT}, got "
                    f"{exponent!r}: a direction set with corners and flats gives jumps that least "
                    "squares cannot follow"
                )
        self._set(exponent=exponent)
        bounds = math.log(_LOWEST_EXPONENT - 1.0), math.log(SHARPEST - 1.0)
        free = (Coordinate("exponent", Scale.LOG_EXCESS, *bounds),) if exponent is None else ()
        ratio, angle = Coordinate("ratio", Scale.LOG), Coordinate("angle", Scale.ANGLE)
        self._keep(coordinates=(ratio, *free, angle))

    def force_direction(self, c: Array, s: Array, p: Array) -> tuple[Array, Array, Array]:
        """Return the direction of the support point.

        |tan θ| = (p₂/p₁)^{s/(s−1)} |tan φ|^{1/(s−1)} from the first axis, [WL19] (84).
        """
        flow = self.flow(p)
        cos, sin = math.cos(p[-1]), math.sin(p[-1])
        x, y = c * cos + s * sin, s * cos - c * sin
        wide, high = np.maximum(np.abs(x), TINY), np.maximum(np.abs(y), TINY)
        log_tan = np.log(high / wide)
        tan = np.exp(np.clip(flow * log_tan - (1.0 + flow) * p[0], -_LARGEST_LOG, _LARGEST_LOG))
        along = 1.0 / np.sqrt(1.0 + tan * tan)
        u, v = np.copysign(along, x), np.copysign(tan * along, y)
        # dθ/d ln|tan θ|
        turn = u * v
        by = np.empty((len(self.coordinates), c.size))
        by[0] = -(1.0 + flow) * turn
        if self.exponent is None:
            by[1] = flow * (p[0] - log_tan) * turn
        floor = np.maximum(wide, _NEAREST_AXIS) * np.maximum(high, _NEAREST_AXIS)
        by[-1] = 1.0 - flow * np.abs(turn) / floor
        return u * cos - v * sin, u * sin + v * cos, by

    def flow(self, p: Array) -> float:
        """Return 1/(s − 1)."""
        return 1.0 / (self._exponent(p) - 1.0)

    def direction(self, p: Array) -> StarSet:
        """Return the ellipse or superellipse with p₁ p₂ = 1."""
        root = math.exp(0.5 * p[0])
        if self.exponent == 2.0:
            return Ellipse(root, 1.0 / root, angle=p[-1])
        return Superellipse(root, 1.0 / root, self._exponent(p), angle=p[-1])

    def start(self, c: Array, s: Array, log_support: Array, slope: Array) -> list[Array]:
        """Return the ellipse nearest in h² = nᵀPn, and superellipses of some of the values of h."""
        h = np.exp(log_support)
        # The ellipse of Q = P has the reciprocal semi-axes.
        first, second, angle = ellipse_through(c, s, h**2, h**-4)
        ratio = math.log(second / first)
        if self.exponent is not None:
            return [np.array([ratio, angle])]
        starts = [np.array([ratio, 0.0, angle])]
        for angle in START_ANGLES:
            p1, p2 = (around(c, s, h, angle + turn) for turn in (0.0, 0.5 * math.pi))
            halfway = math.atan2(p1, p2)
            between = 0.5 * sum(around(c, s, h, angle + sign * halfway) for sign in (-1, 1))
            # There p₁|n₁| = p₂|n₂|, so that h = 2^{1/q} p₁p₂/√(p₁² + p₂²) with 1/s + 1/q = 1.
            inverse = math.log(between * math.hypot(p1, p2) / (p1 * p2)) / math.log(2.0)
            inverse = min(max(inverse, 0.05), 0.95)
            starts.append(np.array([math.log(p1 / p2), math.log(inverse / (1 - inverse)), angle]))
        return starts

    def roundness(self) -> Roundness:
        """Return ln p₁/p₂, and ln(s − 1) if the exponent is free."""
        matrix = np.eye(len(self.coordinates))[:-1]
        return Roundness(matrix, np.zeros(len(matrix)))

    def folded(self, p: Array) -> Array:
        """Return coordinates with the angle within ±45°: a quarter turn swaps the axes."""
        return folded(p, 0, -p[0])

    def _exponent(self, p: Array) -> float:
        return 1.0 + math.exp(p[1]) if self.exponent is None else self.exponent


class FourierDirection(FourierModel, DirectionModel):
    """D is a curve whose ln h_D(φ) is a trigonometric polynomial: tan(θ − φ) = d ln h_D/dφ.

    Args:
        order: highest harmonic.
        odd: whether odd harmonics are there, for D that is not symmetric to the origin.

    Reference: [WL19] (125).

    >>> from asperity.identify import FourierDirection
    >>> [name for name, *_ in FourierDirection(4).coordinates]
    ['cos2', 'sin2', 'cos4', 'sin4']
    """

    def force_direction(self, c: Array, s: Array, p: Array) -> tuple[Array, Array, Array]:
        """Return the direction of the support point h e + h′ e⊥."""
        slopes = series(c, s, self._harmonics)[1]
        tan = p @ slopes
        along = 1.0 / np.sqrt(1.0 + tan * tan)
        across = tan * along
        return c * along - s * across, s * along + c * across, slopes * (along * along)

    def direction(self, p: Array) -> StarSet:
        """Return the curve through samples of the support function.

        Raises:
            FitError: if it is not convex.
        """
        phi = np.arange(_SAMPLES) * (2.0 * np.pi / _SAMPLES)
        waves, slopes = series(np.cos(phi), np.sin(phi), self._harmonics)
        squares = np.repeat(np.square(self._harmonics, dtype=np.float64), 2)
        curvature = 1.0 + (p @ slopes) ** 2 - (p * squares) @ waves
        if curvature.min() < 0.0:
            at = np.rad2deg(phi[curvature.argmin()])
            raise FitError(
                f"the fitted direction set of order {self.order} is not convex at φ = {at:.1f}°: "
                "choose a lower order or a superellipse"
            )
        return SupportCurve(phi, np.exp(p @ waves))

    def start(self, c: Array, s: Array, log_support: Array, slope: Array) -> list[Array]:
        """Return the least-squares polynomial through the derivatives of ln h_D."""
        return [least_squares(series(c, s, self._harmonics)[1].T, slope)]
