"""Models of the force reservoir C: ln r_C over the direction of the force, with derivatives."""

from __future__ import annotations

import math
from abc import ABC, abstractmethod

import numpy as np

from asperity._base import arrays
from asperity._base.arrays import Array
from asperity.identify.models.coordinates import (
    FLATTEST,
    SHARPEST,
    TINY,
    Coordinate,
    CurveModel,
    Roundness,
    Scale,
    folded,
)
from asperity.identify.models.harmonics import FourierModel, least_squares, series
from asperity.sets import Disk, Ellipse, PolarCurve, StarSet, Superellipse

_SAMPLES = 720
_LOG_2 = math.log(2.0)
# Superellipses turned by 45° are false minima: starts are tried at all these angles.
START_ANGLES = tuple(k * math.pi / 8.0 for k in range(4))
# Means about a direction are taken within this angle of it and of the opposite one.
_NEAR = math.cos(0.07)


class ReservoirModel(CurveModel, ABC):
    """A family of sets C with coordinates p; per unit normal force."""

    @abstractmethod
    def log_radius(self, c: Array, s: Array, p: Array) -> tuple[Array, Array, Array]:
        """Return ln r_C at directions (c, s), its derivatives by the angle and by p, ``(k, n)``."""

    @abstractmethod
    def reservoir(self, p: Array) -> StarSet:
        """Return the set C."""

    def is_cusped(self, p: Array) -> bool:
        """Return whether the radius has no derivative on the axes of the set."""
        return False

    @abstractmethod
    def start(self, c: Array, s: Array, radius: Array, weight: Array) -> list[Array]:
        """Return coordinates to start from, for radii in directions (c, s)."""


class CircleReservoir(ReservoirModel):
    """C is a disk: isotropic friction, if D is one too.

    >>> from asperity.identify import CircleReservoir
    >>> [name for name, *_ in CircleReservoir().coordinates]
    ['radius']
    """

    coordinates = (Coordinate("radius", Scale.LOG),)

    def __init__(self) -> None:
        self._set()

    def log_radius(self, c: Array, s: Array, p: Array) -> tuple[Array, Array, Array]:
        """Return ln r_C and its derivatives."""
        return np.full_like(c, p[0]), np.zeros_like(c), np.ones((1, c.size))

    def reservoir(self, p: Array) -> StarSet:
        """Return the disk."""
        return Disk(math.exp(p[0]))

    def start(self, c: Array, s: Array, radius: Array, weight: Array) -> list[Array]:
        """Return the mean radius."""
        return [np.array([np.log(np.average(radius, weights=weight))])]


class SuperellipseReservoir(ReservoirModel):
    """C is a superellipse with free angle, or an ellipse if the exponent is given as 2.

    Args:
        exponent: s, or None if it is to be fitted.

    Reference: [WL19] (34), (37).

    >>> from asperity.identify import SuperellipseReservoir
    >>> [name for name, *_ in SuperellipseReservoir().coordinates]
    ['a', 'b', 'exponent', 'angle']
    """

    exponent: float | None

    def __init__(self, exponent: float | None = None) -> None:
        if exponent is not None:
            exponent = arrays.positive(exponent, "exponent")
        self._set(exponent=exponent)
        bounds = math.log(FLATTEST), math.log(SHARPEST)
        free = (Coordinate("exponent", Scale.LOG, *bounds),) if exponent is None else ()
        a, b = Coordinate("a", Scale.LOG), Coordinate("b", Scale.LOG)
        self._keep(coordinates=(a, b, *free, Coordinate("angle", Scale.ANGLE)))

    def log_radius(self, c: Array, s: Array, p: Array) -> tuple[Array, Array, Array]:
        """Return ln r_C = −ln(|x₁/a|^s + |x₂/b|^s)/s at |x| = 1 and its derivatives."""
        exponent = self._exponent(p)
        cos, sin = math.cos(p[-1]), math.sin(p[-1])
        x, y = c * cos + s * sin, s * cos - c * sin
        log_a = exponent * (np.log(np.maximum(np.abs(x), TINY)) - p[0])
        log_b = exponent * (np.log(np.maximum(np.abs(y), TINY)) - p[1])
        share_a, share_b = np.exp(log_a), np.exp(log_b)
        total = share_a + share_b
        log_total = np.log(total)
        share_a /= total
        share_b /= total
        by = np.empty((len(self.coordinates), c.size))
        by[0], by[1] = share_a, share_b
        if self.exponent is None:
            by[2] = (log_total - share_a * log_a - share_b * log_b) / exponent
        slope = share_a * _ratio(y, x) - share_b * _ratio(x, y)
        by[-1] = -slope
        return log_total / -exponent, slope, by

    def reservoir(self, p: Array) -> StarSet:
        """Return the ellipse or superellipse."""
        a, b = np.exp(p[:2])
        if self.exponent == 2.0:
            return Ellipse(a, b, angle=p[-1])
        return Superellipse(a, b, self._exponent(p), angle=p[-1])

    def start(self, c: Array, s: Array, radius: Array, weight: Array) -> list[Array]:
        """Return the ellipse nearest to the points, and superellipses through some of them."""
        a, b, angle = ellipse_through(c, s, 1.0 / radius**2, weight * radius**6)
        axes = [math.log(a), math.log(b)]
        if self.exponent is not None:
            return [np.array([*axes, angle])]
        starts = [np.array([*axes, math.log(2.0), angle])]
        for angle in START_ANGLES:
            a, b = (around(c, s, radius, angle + turn) for turn in (0.0, 0.5 * math.pi))
            halfway = math.atan2(b, a)
            between = 0.5 * sum(around(c, s, radius, angle + sign * halfway) for sign in (-1, 1))
            # There |x₁/a| = |x₂/b|, so that 2 (r/√(a² + b²))^s = 1.
            exponent = _LOG_2 / max(math.log(math.hypot(a, b) / between), 0.05)
            starts.append(np.array([math.log(a), math.log(b), math.log(exponent), angle]))
        return starts

    def is_cusped(self, p: Array) -> bool:
        """Return whether the exponent is below 1: an astroid and beyond."""
        return self._exponent(p) < 1.0

    def roundness(self) -> Roundness:
        """Return ln a/b, and ln s/2 if the exponent is free."""
        matrix = np.zeros((len(self.coordinates) - 2, len(self.coordinates)))
        matrix[0, :2] = 1.0, -1.0
        if self.exponent is None:
            matrix[1, 2] = 1.0
            return Roundness(matrix, np.array([0.0, math.log(2.0)]))
        return Roundness(matrix, np.zeros(1))

    def folded(self, p: Array) -> Array:
        """Return coordinates with the angle within ±45°: a quarter turn swaps the axes."""
        return folded(p, slice(0, 2), p[1::-1])

    def _exponent(self, p: Array) -> float:
        return math.exp(p[2]) if self.exponent is None else self.exponent


class FourierReservoir(FourierModel, ReservoirModel):
    """C is a curve whose ln r_C(θ) is a trigonometric polynomial; it may be non-convex.

    Args:
        order: highest harmonic.
        odd: whether odd harmonics are there, for C that is not symmetric to the origin.

    >>> from asperity.identify import FourierReservoir
    >>> [name for name, *_ in FourierReservoir(4).coordinates]
    ['log', 'cos2', 'sin2', 'cos4', 'sin4']
    """

    _level = (Coordinate("log", Scale.PLAIN),)

    def log_radius(self, c: Array, s: Array, p: Array) -> tuple[Array, Array, Array]:
        """Return ln r_C and its derivatives."""
        waves, slopes = series(c, s, self._harmonics)
        by = np.vstack([np.ones(c.size), waves])
        return p @ by, p[1:] @ slopes, by

    def reservoir(self, p: Array) -> StarSet:
        """Return the curve through samples of the radius."""
        theta = np.arange(_SAMPLES) * (2.0 * np.pi / _SAMPLES)
        return PolarCurve(theta, np.exp(self.log_radius(np.cos(theta), np.sin(theta), p)[0]))

    def start(self, c: Array, s: Array, radius: Array, weight: Array) -> list[Array]:
        """Return the least-squares polynomial through the logarithms of the radii."""
        by = np.vstack([np.ones(c.size), series(c, s, self._harmonics)[0]])
        root = np.sqrt(weight) * radius
        return [least_squares((by * root).T, np.log(radius) * root)]


def around(c: Array, s: Array, values: Array, angle: float) -> float:
    """Return the mean of values at the directions (c, s) about an angle and its opposite."""
    closeness = np.abs(c * math.cos(angle) + s * math.sin(angle))
    return float(values[closeness >= min(_NEAR, closeness.max())].mean())


def ellipse_through(c: Array, s: Array, values: Array, weight: Array) -> tuple[float, float, float]:
    """Return a, b and angle of the ellipse whose matrix Q fits nᵀQn = values best."""
    rows = np.stack([c * c, 2.0 * c * s, s * s], axis=-1)
    root = np.sqrt(weight)
    q11, q12, q22 = least_squares(rows * root[:, None], values * root)
    sizes, vectors = np.linalg.eigh(np.array([[q11, q12], [q12, q22]]))
    sizes = np.maximum(sizes, 1e-6 * abs(sizes[1]))
    angle = math.atan2(vectors[1, 0], vectors[0, 0])
    return float(sizes[0] ** -0.5), float(sizes[1] ** -0.5), angle


def _ratio(x: Array, y: Array) -> Array:
    return x / np.where(np.abs(y) < TINY, TINY, y)
