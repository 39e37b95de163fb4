"""Least-squares circles."""

from __future__ import annotations

from dataclasses import KW_ONLY
from typing import Annotated

import numpy as np
from numpy.typing import ArrayLike

from asperity._base import arrays
from asperity._base.arrays import Array
from asperity._base.value import (
    Fraction,
    Given,
    NonNegative,
    Positive,
    Record,
    Vector2,
    shaped,
)
from asperity.errors import DimensionError, ParameterError

_ITERATIONS = 30
_CONVERGED = 1e-9
# Tukey's constant: 95 % efficiency for normal errors; and the median of |x| in units of sigma.
_TUKEY, _MEDIAN = 4.685, 0.6745
# What counts as a gap: an angle, and as many mean distances of neighbours, for small marks.
_GAP, _SPACINGS = np.deg2rad(20.0), 5.0
_HARMONICS = np.arange(2, 8)
_FEWEST = 4
_SMALLEST = 1e-9


class Circle(Record):
    """A circle fitted to points, with its uncertainty.

    Attributes:
        centre: shape ``(2,)``.
        radius: in the unit of the points.
        covariance: of centre and radius, shape ``(3, 3)``.
        rms: root mean square of the distances of the points used.
        coverage: share of the circle outside gaps between points used, of more than 20° and of
            five mean distances.
    """

    centre: Vector2
    radius: Positive
    _: KW_ONLY
    covariance: Annotated[Given[ArrayLike, Array], shaped(3, 3)]
    rms: NonNegative
    coverage: Fraction


def fit_circle(points: ArrayLike, *, robust: bool = False, resolution: float = 0.0) -> Circle:
    """Fit the circle with the least squared distances to points.

    Neighbours on the outline of a filtered image share their errors; the covariance follows from
    the power of the harmonics 2 to 7 of the distances over the angle, which contains that.

    Args:
        points: shape ``(n, 2)``, n ≥ 4.
        robust: whether points far off, in units of the others' median distance, count less and
            less (Tukey's biweight).
        resolution: standard deviation that the others' is taken for at least, in the unit of the
            points.

    Raises:
        DimensionError: if there are fewer than four points.
        ParameterError: if they lie in line.

    >>> circle = fit_circle([[3.0, 1.0], [1.0, 3.0], [-1.0, 1.0], [1.0, -1.0]])
    >>> circle.centre.round(9).tolist(), round(circle.radius, 9)
    ([1.0, 1.0], 2.0)
    """
    outline = arrays.array(points, "points", (None, 2))
    if len(outline) < _FEWEST:
        raise DimensionError("points", f"must hold at least {_FEWEST} points, got {len(outline)}")
    resolution = arrays.non_negative(resolution, "resolution")
    # In units of their own spread about their own mean, no digits are lost.
    middle = outline.mean(axis=0)
    spread = float(np.sqrt(np.mean((outline - middle) ** 2)))
    if spread == 0.0:
        raise ParameterError("points", "must not all be one point")
    unit = (outline - middle) / spread
    guess = _algebraic(unit)
    weights = stiffness = np.ones(len(unit))
    for _ in range(_ITERATIONS):
        distance, slope = _distances(unit, guess)
        if robust:
            weights, stiffness = _biweight(distance, resolution / spread)
        root = np.sqrt(weights)
        step, *_ = np.linalg.lstsq(slope * root[:, None], -distance * root, rcond=None)
        guess = guess + step
        if np.abs(step).max() < _CONVERGED:
            break
    distance, slope = _distances(unit, guess)
    used = weights > 0.0
    angles = np.arctan2(*(unit - guess[:2]).T[::-1])
    return Circle(
        middle + spread * guess[:2],
        spread * float(guess[2]),
        covariance=_covariance(angles, distance, slope, weights, stiffness) * spread**2,
        rms=spread * float(np.sqrt(np.mean(distance[used] ** 2))),
        coverage=_coverage(angles[used]),
    )


def _algebraic(points: Array) -> Array:
    """Return centre and radius from linear equations (Kåsa), good enough to start from."""
    equations = np.column_stack([2.0 * points, np.ones(len(points))])
    solution, _, rank, _ = np.linalg.lstsq(equations, np.sum(points**2, axis=1), rcond=1e-9)
    if rank < 3:
        raise ParameterError("points", "must not lie in line")
    x, y, c = solution
    return np.array([x, y, np.sqrt(c + x * x + y * y)])


def _distances(points: Array, circle: Array) -> tuple[Array, Array]:
    """Return the signed distances from a circle and their derivatives by centre and radius."""
    arms = points - circle[:2]
    length = np.maximum(np.hypot(*arms.T), 1e-12)
    return length - circle[2], np.column_stack([-arms / length[:, None], -np.ones(len(points))])


def _coverage(angles: Array) -> float:
    ordered = np.sort(angles)
    gaps = np.diff(ordered, append=ordered[0] + 2.0 * np.pi)
    limit = max(_GAP, _SPACINGS * 2.0 * np.pi / len(angles))
    return 1.0 - min(float(gaps[gaps > limit].sum()) / (2.0 * np.pi), 1.0)


def _biweight(distance: Array, resolution: float) -> tuple[Array, Array]:
    """Return Tukey's weights and the derivatives of weight times distance."""
    scale = max(float(np.median(np.abs(distance))) / _MEDIAN, resolution, _SMALLEST)
    share = np.minimum((distance / (_TUKEY * scale)) ** 2, 1.0)
    return (1.0 - share) ** 2, (1.0 - share) * (1.0 - 5.0 * share)


def _covariance(
    angles: Array, distance: Array, slope: Array, weights: Array, stiffness: Array
) -> Array:
    """Return the covariance of centre and radius.

    The centre follows the first harmonic of the distances over the angle. The fit has taken that
    out; the power of the next harmonics tells how large it was.
    """
    count = min(len(_HARMONICS), (len(angles) - 2) // 2)
    waves = np.exp(1j * np.outer(_HARMONICS[:count], angles)) @ (weights * distance)
    power = 0.5 * float(np.mean(np.abs(waves) ** 2))
    inverse = np.linalg.pinv(slope.T @ (slope * stiffness[:, None]))
    scores = 2.0 * power / weights.sum() * slope.T @ (slope * weights[:, None])
    return inverse @ scores @ inverse
