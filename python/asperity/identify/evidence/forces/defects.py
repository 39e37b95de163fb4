"""Whether mean forces, turn by turn, belong to symmetric sets, to any D, to the model."""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from asperity._base import arrays
from asperity._base.arrays import Array
from asperity._base.quantiles import student
from asperity.identify.evidence.forces.bins import FINE, GroupedBins, grouped
from asperity.identify.evidence.forces.samples import Samples

MOST_GROUPS = 20
_LEVEL = 0.01
# Numbers of bins that are tried, the largest one that leaves none empty in any turn.
_BINS = (120, 60, 36, 24)
_HARMONICS = (0, 2, 4)
# Samples of one stroke are closer together in direction than this.
_STROKE = np.deg2rad(2.0)
# Errors of calibration and zeros explain a defect up to so many standard errors.
_ERRORS = 3.5


class Defect(NamedTuple):
    """How large a defect is, and whether that is neither noise nor too small to matter."""

    size: float
    matters: bool


def all_of(samples: Samples, left: Samples, data: Any) -> dict[str, Defect]:
    """Return asymmetry, closure and lack of fit; none if data are sparse.

    Args:
        samples: measured forces.
        left: the same with what the model leaves of them.
        data: as for `fit_law`.
    """
    groups = min(samples.turns, MOST_GROUPS)
    means, rest = means_of(grouped(samples, groups)), means_of(grouped(left, groups))
    if means is None or rest is None:
        strokes, open_ones = means_of_strokes(samples), means_of_strokes(left)
        if strokes is None or open_ones is None:
            return {}
        error = common_error(data, strokes[1])
        return {"lack of fit": lack_of_fit(open_ones[1], strokes[1], error)}
    error = common_error(data, means[1])
    return {
        "asymmetry": asymmetry(*means),
        "closure": closure(*means, error),
        "lack of fit": lack_of_fit(rest[1], means[1], error),
    }


def means_of(sums: GroupedBins) -> tuple[Array, Array] | None:
    """Return φ and mean forces of each group in equal bins, ``(g, n)`` and ``(g, n, 2)``."""
    for count in _BINS:
        groups = [sums.only(group, FINE // count) for group in range(len(sums.squares))]
        if all(bins.phi.size == count for bins in groups):
            return np.stack([b.phi for b in groups]), np.stack([b.force for b in groups])
    return None


def means_of_strokes(samples: Samples) -> tuple[Array, Array] | None:
    """Return φ and mean forces of repeated strokes, ``(g, n)`` and ``(g, n, 2)``.

    The g-th of them are those of the g-th stroke along each direction. None if some direction has
    one stroke only, or a turn covers several.
    """
    phi, force = np.empty(samples.turns), np.empty((samples.turns, 2))
    for turn in range(samples.turns):
        rows = [np.arange(a, b) for a, b, number in samples.runs if number == turn]
        at = np.concatenate(rows)
        # Angles of one direction may differ by whole turns, as they do on both sides of π.
        off = samples.phi[at] - samples.phi[at[0]]
        off -= 2.0 * np.pi * np.rint(off / (2.0 * np.pi))
        if np.ptp(off) > _STROKE:
            return None
        load = samples.normal[at]
        phi[turn] = samples.phi[at[0]] + off.mean()
        force[turn] = load @ samples.force[at] / (load @ load)
    direction = _directions(phi)
    repeats = int(np.bincount(direction).min())
    if repeats < 2:
        return None
    order = [np.flatnonzero(direction == one)[:repeats] for one in range(direction.max() + 1)]
    chosen = np.stack(order, axis=1)
    return phi[chosen], force[chosen]


def _directions(phi: Array) -> NDArray[np.intp]:
    """Return which strokes have one direction: gaps part them, wherever on the circle they are."""
    angle = phi % (2.0 * np.pi)
    order = np.argsort(angle)
    after_gap = np.diff(angle[order], prepend=angle[order[-1]] - 2.0 * np.pi) > _STROKE
    group = np.cumsum(after_gap)
    # What comes before the first gap goes on from the last group, across the end of the circle.
    group[group == 0] = group[-1]
    direction = np.empty(phi.size, dtype=np.intp)
    direction[order] = group - group.min()
    return direction


def asymmetry(phi: Array, force: Array) -> Defect:
    """Return the part of the force that sets symmetric to the origin do not have.

    For these f(φ + π) = −f(φ), and all even harmonics vanish. Errors of calibration and zeros turn
    with the disk and make odd ones only.
    """
    waves = [wave(k * phi) for k in _HARMONICS for wave in (np.cos, np.sin)[: 1 + (k > 0)]]
    parts = np.stack([(force * w[..., None]).mean(axis=1) for w in waves], axis=1)
    values = parts.reshape(len(phi), -1)
    size = float(np.linalg.norm(values.mean(axis=0)) / _mean_size(force))
    return Defect(size, _matters(values, size, 0.01, 0.05))


def common_error(data: Any, force: Array) -> float:
    """Return the standard error of λ_t or λ_r that all turns share, relative to the force."""
    calibration = getattr(data, "calibration_covariance", None)
    zero = getattr(data, "zero_covariance", None)
    if calibration is None and zero is None:
        return 0.0
    size, normal = _mean_size(force), float(np.mean(data.normal_force))
    readings = np.linalg.solve(data.matrix, normal * np.array([size, 0.0, 1.0]))
    variance = np.zeros(2)
    for row in range(2):
        part = slice(3 * row, 3 * row + 3)
        if calibration is not None:
            variance[row] += readings @ calibration[part, part] @ readings
        if zero is not None:
            variance[row] += data.matrix[row] @ zero @ data.matrix[row]
    return float(np.sqrt(variance.max()) / (size * normal))


def closure(phi: Array, force: Array, error: float = 0.0) -> Defect:
    """Return r_D(2π)/r_D(0) = exp ∮ l_p/l_t dφ, which is 1 where a direction set exists.

    Reference: [WL19] (125).
    """
    along, across = arrays.along_and_across(force, phi)
    if along.min() <= 0.0:
        along, across = along.mean(axis=0, keepdims=True), across.mean(axis=0, keepdims=True)
    logarithm = 2.0 * np.pi * (across / along).mean(axis=1)
    mean, far = float(logarithm.mean()), 2.0 * np.pi * _ERRORS * error
    return Defect(
        float(np.exp(mean)), _matters(logarithm[:, None], abs(mean), 0.03 + far, 0.2 + far)
    )


def lack_of_fit(left: Array, force: Array, error: float = 0.0) -> Defect:
    """Return the mean distance of the model from mean forces, relative to the force.

    It matters where means of all turns are farther off than the scatter of turns explains.

    Args:
        left: means of measured minus model forces, ``(g, n, 2)``. The model is that at the samples:
            where forces turn fast, its mean over a bin is not what it is in the middle.
        force: mean forces, ``(g, n, 2)``.
        error: standard error that all turns share, relative to the force.
    """
    mean = left.mean(axis=0)
    size = float(np.sqrt((mean**2).sum(axis=-1).mean()) / _mean_size(force))
    turns, far = len(left), _ERRORS * error
    if turns < 2:
        return Defect(size, size > 0.05 + far)
    within = float(((left - mean) ** 2).sum() / (turns - 1))
    # On the average 1 if the scatter of turns is all there is.
    ratio = turns * float((mean**2).sum()) / max(within, np.finfo(float).tiny)
    needed = 2.0 if size > 0.05 + far else 3.0
    return Defect(size, size > 0.005 + far and ratio > needed)


def _mean_size(force: Array) -> float:
    return float(np.sqrt((force.mean(axis=0) ** 2).sum(axis=-1).mean()))


def _matters(values: Array, size: float, small: float, large: float) -> bool:
    """Return whether means of columns differ from 0 (t-tests after Bonferroni), or are large."""
    turns, columns = values.shape
    if size < small or turns < 2:
        return size >= large
    error = values.std(axis=0, ddof=1) / np.sqrt(turns)
    bound = student(1.0 - _LEVEL / columns, turns - 1)
    return bool(size >= large or (np.abs(values.mean(axis=0)) > bound * error).any())
