"""Least-squares circles."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike

from asperity import _arrays
from asperity._arrays import Array
from asperity._value import Value
from asperity.errors import DimensionError, ParameterError

_ITERATIONS = 30
_CONVERGED = 1e-12
# Tukey's constant: 95 % efficiency for normal errors; and the median of |x| in units of sigma.
_TUKEY, _MEDIAN = 4.685, 0.6745
_SECTORS = 12


class Circle(Value):
    """A circle fitted to points, with its uncertainty.

    Attributes:
        centre: shape ``(2,)``.
        radius: in the unit of the points.
        covariance: of centre and radius, shape ``(3, 3)``.
        rms: root mean square of the distances of the points used.
        coverage: share of 12 sectors that hold points used.
    """

    centre: Array
    radius: float
    covariance: Array
    rms: float
    coverage: float

    def __init__(
        self,
        centre: ArrayLike,
        radius: float,
        *,
        covariance: ArrayLike,
        rms: float,
        coverage: float,
    ) -> None:
        self._set(
            centre=_arrays.read_only(_arrays.array(centre, "centre", (2,))),
            radius=_arrays.positive(radius, "radius"),
            covariance=_arrays.read_only(_arrays.array(covariance, "covariance", (3, 3))),
            rms=_arrays.non_negative(rms, "rms"),
            coverage=_arrays.fraction(coverage, "coverage"),
        )


def fit_circle(points: ArrayLike, *, robust: bool = False) -> Circle:
    """Fit the circle with the least squared distances to points.

    The covariance takes the errors of the points of one of 12 sectors as dependent, those of
    different ones as independent: neighbours on the outline of a filtered image share theirs.

    Args:
        points: shape ``(n, 2)``, n ≥ 3.
        robust: whether points far off, in units of the others' median distance, count less and
            less (Tukey's biweight).

    Raises:
        DimensionError: if there are fewer than three points.
        ParameterError: if they lie in line.

    >>> circle = fit_circle([[3.0, 1.0], [1.0, 3.0], [-1.0, 1.0], [1.0, -1.0]])
    >>> circle.centre.round(9).tolist(), round(circle.radius, 9)
    ([1.0, 1.0], 2.0)
    """
    outline = _arrays.array(points, "points", (None, 2))
    if len(outline) < 3:
        raise DimensionError("points", f"must hold at least 3 points, got {len(outline)}")
    # In units of their own spread about their own mean, no digits are lost.
    middle = outline.mean(axis=0)
    spread = float(np.sqrt(np.mean((outline - middle) ** 2)))
    if spread == 0.0:
        raise ParameterError("points", "must not all be one point")
    unit = (outline - middle) / spread
    guess, weights = _algebraic(unit), np.ones(len(unit))
    for _ in range(_ITERATIONS):
        distance, slope = _distances(unit, guess)
        if robust:
            weights = _biweight(distance)
        step, *_ = np.linalg.lstsq(slope * weights[:, None], -distance * weights, rcond=None)
        guess = guess + step
        if np.abs(step).max() < _CONVERGED:
            break
    distance, slope = _distances(unit, guess)
    used = weights > 0.0
    return Circle(
        middle + spread * guess[:2],
        spread * float(guess[2]),
        covariance=_clustered(unit, guess, distance * weights, slope, weights) * spread**2,
        rms=spread * float(np.sqrt(np.mean(distance[used] ** 2))),
        coverage=len(np.unique(_sectors(unit[used], guess))) / _SECTORS,
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


def _biweight(distance: Array) -> Array:
    """Return the roots of the weights."""
    scale = max(float(np.median(np.abs(distance))) / _MEDIAN, 1e-9)
    weights: Array = np.maximum(1.0 - (distance / (_TUKEY * scale)) ** 2, 0.0)
    return weights


def _sectors(points: Array, circle: Array) -> Array:
    x, y = (points - circle[:2]).T
    turn = np.arctan2(y, x) / (2.0 * np.pi) % 1.0
    sectors: Array = np.floor(turn * _SECTORS)
    return sectors


def _clustered(
    points: Array, circle: Array, distance: Array, slope: Array, weights: Array
) -> Array:
    weighted = slope * weights[:, None]
    inverse = np.linalg.pinv(weighted.T @ weighted)
    sectors = _sectors(points, circle).astype(np.int64)
    scores = np.stack(
        [np.bincount(sectors, column * distance, minlength=_SECTORS) for column in weighted.T]
    )
    count = len(np.unique(sectors))
    # Three parameters have been taken out of the scores.
    correction = count / max(count - 3, 1)
    covariance: Array = correction * inverse @ (scores @ scores.T) @ inverse
    return covariance
