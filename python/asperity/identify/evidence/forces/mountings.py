"""Whether two runs differ by more than their turns scatter: the pin was set down anew between."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from asperity._base.arrays import Array
from asperity._base.quantiles import student
from asperity.identify.estimator.descent import Sums

# This part of the pairs of runs that do not differ is taken for pairs that do: half of it by the
# level of the forces, which mountings change most, half by any of the coordinates.
_LEVEL = 0.02


class Mountings(NamedTuple):
    """How the second of two runs differs from the first.

    Attributes:
        steps: of the coordinates, ``(k,)``.
        level: of the forces, relative to them.
        scatter: standard deviation of the level between turns of a run.
        matters: whether it is more than the turns of the runs scatter.
        covariance: what the difference adds to the covariance of the coordinates.
    """

    steps: Array
    level: float
    scatter: float
    matters: bool
    covariance: Array


def mountings_of(
    sums: Sums, run: NDArray[np.intp], *, inverse: Array, level: Array, shared: Array
) -> Mountings | None:
    """Return how two runs differ; None for one or many, and without scatter within runs.

    What a turn says of a coordinate is its step from the fit, (JᵀJ)⁻¹Jᵀe over the part that the
    turn has in JᵀJ. Means of the steps over either run are compared for all coordinates and for the
    level of the forces (t-tests after Bonferroni). What is added to the variances is the variance
    between mountings by its moments (DerSimonian & Laird 1986): all of the difference where it
    matters, else what goes beyond the scatter of turns.

    Args:
        sums: normal equations of each turn at the fit.
        run: number of the run of each turn.
        inverse: of JᵀJ of all turns, ``(k, k)``.
        level: gradient Jᵀf of the model forces, up to a factor: the coordinates' part in them.
        shared: covariance of the difference by errors of calibration and zeros, ``(k, k)``.
    """
    runs, number = np.unique(run, return_inverse=True)
    turns = number.size
    if runs.size != 2 or turns < 3:
        return None
    told = np.vstack([np.eye(level.size), level / (level @ inverse @ level)])
    values = sums.gradient @ inverse @ told.T
    counts = np.bincount(number)
    parts = np.bincount(number, np.einsum("tij,ji->t", sums.matrix, inverse))
    shares = np.asarray(parts / parts.sum())
    values *= (counts / shares)[number, None]
    means = np.stack([values[number == one].mean(axis=0) for one in range(2)])
    difference = means[1] - means[0]
    square = ((values - means[number]) ** 2).sum(axis=0) / (turns - 2)
    scatter = square * (1.0 / counts).sum()
    scatter += np.einsum("ij,jk,ik->i", told, shared, told)
    ratio = difference**2 / np.maximum(scatter, np.finfo(float).tiny)
    tails = np.full(ratio.size, 0.25 * _LEVEL / (ratio.size - 1))
    tails[-1] = 0.25 * _LEVEL
    matters = bool((ratio > student(1.0 - 2.0 * tails, turns - 2) ** 2).any())
    beyond = np.ones(level.size) if matters else 1.0 - 1.0 / np.maximum(ratio[:-1], 1.0)
    # The mean of both is weighted so, and half the square is the variance of either.
    beyond *= 0.5 * float(shares @ shares)
    steps = difference[:-1]
    root = np.sqrt(beyond) * steps
    return Mountings(
        steps, float(difference[-1]), float(np.sqrt(square[-1])), matters, np.outer(root, root)
    )
