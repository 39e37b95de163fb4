"""Levenberg's and Marquardt's descent on normal equations."""

from __future__ import annotations

from collections.abc import Callable
from typing import NamedTuple

import numpy as np

from asperity._base.arrays import Array
from asperity._base.value import Record
from asperity.identify.estimator.loss import Loss
from asperity.identify.models.coordinates import Coordinate

_MOST = 100
_LONGEST_STEP = 0.5
_SHORTEST_STEP = 1e-13
_SETTLED = 1e-4
_MOST_REFINEMENTS = 10


class Sums(Record):
    """Cost, gradient Jᵀe and matrix JᵀJ of each cluster: turn, block or path."""

    cost: Array
    gradient: Array
    matrix: Array

    def total(self) -> tuple[float, Array, Array]:
        """Return cost, gradient and matrix of all clusters."""
        return float(self.cost.sum()), self.gradient.sum(axis=0), self.matrix.sum(axis=0)


class Descent(NamedTuple):
    """Where the descent ended: coordinates, the sums there, and whether it is a minimum."""

    p: Array
    sums: Sums
    cost: float
    converged: bool


class Found(Record):
    """Where a search ended.

    Args:
        p: the coordinates.
        cost: half the sum of the losses of the residuals.
        evaluations: how often residuals were computed.
        converged: whether the search has ended by itself.
        scale: of a robust loss that was found with them; 0 for least squares.
    """

    p: Array
    cost: float
    evaluations: int
    converged: bool
    scale: float = 0.0


def search(
    residuals: Callable[[Array], Array],
    slopes: Callable[[Array], Array],
    start: Array,
    *,
    loss: Loss,
    close: float,
    most: int,
    bounds: tuple[Array | float, Array | float] = (-np.inf, np.inf),
    shortest: float = 1e-8,
) -> Found:
    """Return what SciPy's least squares find, for residuals by which all samples can be kept.

    Args:
        residuals: of coordinates.
        slopes: their derivatives by these.
        start: coordinates to start from.
        loss: of the residuals, one by one.
        close: relative change of the cost at which the search ends.
        most: evaluations.
        bounds: of the coordinates.
        shortest: relative step at which the search ends.
    """
    from scipy.optimize import least_squares

    found = least_squares(
        residuals,
        start,
        jac=slopes,
        bounds=bounds,
        loss=loss.kind,
        f_scale=1.0 if loss.is_linear else loss.bend,
        x_scale="jac",
        ftol=close,
        xtol=shortest,
        # The size of a gradient depends on the unit of forces.
        gtol=None,
        max_nfev=most,
    )
    return Found(found.x, float(found.cost), int(found.nfev), found.status > 0)


def descend(
    sums_at: Callable[[Array], Sums],
    start: Array,
    coordinates: tuple[Coordinate, ...],
    *,
    damping: float,
    close: float,
    degrees: int,
) -> Descent:
    """Minimise the cost from a start.

    Where a full step is shorter than `close` in standard errors of uncorrelated residuals (with so
    many `degrees` of freedom), it is taken without another evaluation: the sums are continued
    linearly, with an error of second order in the step.
    """
    low = np.array([c.low for c in coordinates])
    high = np.array([c.high for c in coordinates])
    p = np.clip(start, low, high)
    step = np.zeros_like(p)
    sums = sums_at(p)
    cost, gradient, matrix = sums.total()
    for _ in range(_MOST):
        step = damped_step(matrix, gradient, damping)
        step *= min(1.0, _LONGEST_STEP / max(np.abs(step).max(initial=0.0), 1e-300))
        step = np.clip(p + step, low, high) - p
        if np.abs(step).max(initial=0.0) <= _SHORTEST_STEP:
            return Descent(p, sums, cost, True)
        if damping == 0.0 and float(step @ matrix @ step) <= close**2 * cost / degrees:
            return Descent(p + step, _continued(sums, step), cost - float(step @ gradient), True)
        trial = sums_at(p + step)
        if trial.cost.sum() < cost:
            gain = cost - trial.cost.sum()
            p, sums = p + step, trial
            cost, gradient, matrix = sums.total()
            if gain <= 1e-15 * cost:
                return Descent(p, sums, cost, True)
            # Close to the minimum the undamped step is best, and is the criterion to stop.
            damping = 0.0 if damping < 1e-6 else damping / 10.0
        elif damping > 1e6 or np.abs(step).max() < 1e-9:
            # Not even a tiny step down the gradient decreases the cost.
            return Descent(p, sums, cost, True)
        else:
            damping = max(10.0 * damping, 1e-6)
    # Convergence is only linear where samples lie on the axes of a D with flat sides.
    return Descent(p, sums, cost, bool(np.abs(step).max() < _SETTLED))


def refine(
    sums_at: Callable[[Array], Sums],
    start: Array,
    coordinates: tuple[Coordinate, ...],
    *,
    close: float,
    degrees: int,
) -> Descent:
    """Solve Jᵀe = 0 by Gauss and Newton's steps from a start that is nearly there.

    A last step shorter than `close` standard errors, or no shorter than half the one before, is
    taken linearly. The cost is no judge so close to its minimum: derivatives are bounded near the
    axes of D, where residuals are noise. A start that is not near ends in a descent.
    """
    p, before = start, np.inf
    for _ in range(_MOST_REFINEMENTS):
        sums = sums_at(p)
        cost, gradient, matrix = sums.total()
        step = damped_step(matrix, gradient)
        length = np.abs(step).max(initial=0.0)
        if length > 2.0 * before or length > _LONGEST_STEP:
            break
        near = float(step @ matrix @ step) <= close**2 * cost / degrees
        if near or length > 0.5 * before or length < _SHORTEST_STEP:
            left = cost - float(step @ gradient)
            return Descent(p + step, _continued(sums, step), left, True)
        p, before = p + step, length
    return descend(sums_at, start, coordinates, damping=1e-3, close=close, degrees=degrees)


def damped_step(matrix: Array, gradient: Array, damping: float = 0.0) -> Array:
    """Return (H + damping diag H)⁻¹ g, in the columns' own scales; 0 along what H does not see."""
    scale = np.sqrt(np.maximum(np.diag(matrix), 0.0))
    scale[scale == 0.0] = 1.0
    scaled = matrix / np.outer(scale, scale) + damping * np.eye(scale.size)
    values, vectors = np.linalg.eigh(scaled)
    kept = values > 1e-13
    inverse = np.where(kept, 1.0 / np.where(kept, values, 1.0), 0.0)
    return vectors @ (inverse * (vectors.T @ (gradient / scale))) / scale


def _continued(sums: Sums, step: Array) -> Sums:
    """Return the sums a short step on, the matrices taken as constant."""
    turning = sums.matrix @ step
    return Sums(
        sums.cost - 2.0 * sums.gradient @ step + turning @ step,
        sums.gradient - turning,
        sums.matrix,
    )
