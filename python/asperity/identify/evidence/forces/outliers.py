"""Outliers: samples without the gross ones, and whether there are some that a fit follows."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from asperity._base import arrays
from asperity._base.arrays import Array
from asperity.errors import FitError
from asperity.identify.estimator.loss import MEDIAN_LENGTH
from asperity.identify.evidence.forces.bins import Bins, along_sliding, grouped
from asperity.identify.evidence.forces.samples import Samples, bin_of, chosen, inside

_MOST_SAMPLES = 100_000
_FEWEST_PER_BIN, _MOST_BINS = 25, 360
# Farther from the medians than this many deviations, and than this part of the forces.
_DEVIATIONS, _PART = 6.0, 0.5
# Farther than this from the model, an outlier: of Gaussian samples 4 in a million are so.
_FAR = 5.0
_FEWEST, _LEAST_SHARE = 3, 5e-4
_ROUNDING = 1e-6
# Arcs of directions of which outliers must be in so many of those they would fall into by chance.
_ARCS, _SPREAD = 36, 0.6
# Both sides are equally likely with outliers that a symmetric loss does not follow.
_LEVEL = 1e-3


def without_outliers(samples: Samples) -> Samples:
    """Return the samples near the medians over the sliding directions.

    Only what would spoil a mean is left out: the loss judges the rest.
    """
    some = inside(samples, _MOST_SAMPLES)
    bins = int(np.clip(some.size // _FEWEST_PER_BIN, 1, _MOST_BINS))
    levels = _medians(_parts(samples, some), bin_of(samples.phi[some], bins), bins)
    all_of = inside(samples)
    apart = np.empty(all_of.size)
    for start in range(0, all_of.size, 2**16):
        rows = slice(start, start + 2**16)
        at = bin_of(samples.phi[all_of[rows]], bins)
        apart[rows] = np.hypot(*(_parts(samples, all_of[rows]) - levels[:, at]))
    scale = float(np.median(apart)) / MEDIAN_LENGTH
    size = float(np.median(np.hypot(*levels)))
    kept = apart <= max(_DEVIATIONS * scale, _PART * size)
    return samples if kept.all() else chosen(samples, all_of, kept)


class Outliers(NamedTuple):
    """Samples farther from a model than noise explains.

    Attributes:
        share: of all samples.
        matters: whether there are more than Gaussian noise has.
        one_sided: whether more forces are too large than too small, or the other way round.
    """

    share: float
    matters: bool
    one_sided: bool


def outliers(samples: Samples, left: Array) -> Outliers:
    """Return the outliers among what a model leaves of the forces.

    Distances are from the medians over directions, so that a model that misses the forces does not
    count.

    Args:
        samples: all of them.
        left: measured minus model forces of these, ``(n, 2)``.
    """
    from scipy.special import bdtr

    some = inside(samples, _MOST_SAMPLES)
    bins = int(np.clip(some.size // _FEWEST_PER_BIN, 1, _MOST_BINS))
    at = bin_of(samples.phi[some], bins)
    parts = _parts(replace(samples, force=left), some)
    parts -= _medians(parts, at, bins)[:, at]
    distance = np.hypot(*parts)
    size = float(np.hypot(*_parts(samples, some)).mean())
    # Where a model misses forces that turn fast, they vary within a bin by more than noise.
    usual = np.maximum(_medians(distance[None], at, bins)[0][at], np.median(distance))
    far = distance > np.maximum(_FAR / MEDIAN_LENGTH * usual, _ROUNDING * size)
    count = int(np.count_nonzero(far))
    share = count / some.size
    matters = count >= _FEWEST and share >= _LEAST_SHARE and _are_everywhere(at[far] / bins)
    larger = int(np.count_nonzero(parts[0][far] > 0.0))
    # The sign test, two-sided.
    one_sided = matters and 2.0 * bdtr(min(larger, count - larger), count, 0.5) < _LEVEL
    return Outliers(share, matters, bool(one_sided))


def _are_everywhere(place: Array) -> bool:
    """Return whether outliers are spread over the directions, and not what a model misses."""
    arcs = np.unique((place * _ARCS).astype(np.intp)).size
    # So many arcs are not empty on the average if outliers fall anywhere.
    expected = _ARCS * -np.expm1(-place.size / _ARCS)
    return bool(arcs >= _SPREAD * expected)


# What φ may be given in, and how it becomes rad.
_OTHER_UNITS = (
    (np.pi / 180.0, "degrees", "np.deg2rad(phi)"),
    (2.0 * np.pi, "turns", "2 * np.pi * phi"),
)
# A wrong sign turns forces round in more than these directions.
_FEW_DIRECTIONS = 0.1


def check_sense(
    bins: Bins, samples: Samples, width: int, explanation: Callable[[], str | None]
) -> None:
    """Refuse forces that do not oppose sliding, and say whether a few of them are why.

    Args:
        bins: means over directions.
        samples: from which they are.
        width: of the bins, in fine ones.
        explanation: returns with which wrong sign turned, or which channels swapped, they would.
    """
    found = along_sliding(bins)
    if found is None:
        return
    place, share = found
    for factor, unit, cure in _OTHER_UNITS:
        turned = replace(samples, phi=samples.phi * factor)
        if along_sliding(grouped(turned, 1).bins(width=width)) is None:
            raise FitError(
                f"data: the force does not oppose sliding at φ = {place:.1f}°, but would if φ were "
                f"in {unit}: give it in rad, {cure}"
            )
    rest = without_outliers(samples)
    if rest is not samples and along_sliding(grouped(rest, 1).bins(width=width)) is None:
        raise FitError(
            f"data: the mean force does not oppose sliding at φ = {place:.1f}°, but would without "
            "outliers: leave them out, or choose the loss 'cauchy' or 'huber'"
        )
    if share < _FEW_DIRECTIONS:
        raise FitError(
            f"data: the mean force does not oppose sliding at φ = {place:.1f}°, but does in all "
            f"but {share:.1%} of the directions: the noise is as large as the force there: record "
            "more turns"
        )
    would = explanation()
    known = "" if would is None else f"; with {would} it would"
    raise FitError(
        f"data: the force does not oppose sliding at φ = {place:.1f}°{known}: check the signs of "
        "the channels and of the rotation"
    )


def _parts(samples: Samples, rows: NDArray[np.intp]) -> Array:
    """Return l_t and l_p, which vary less over the directions than the components of the force."""
    parts = arrays.along_and_across(samples.force[rows], samples.phi[rows])
    return np.stack(parts) / samples.normal[rows]


def _medians(parts: Array, at: NDArray[np.intp], bins: int) -> Array:
    """Return the median of each row in each bin; the overall one where a bin is empty."""
    count = np.bincount(at, minlength=bins)
    middle = np.minimum(np.cumsum(count) - count + count // 2, at.size - 1)
    levels = []
    for values in parts:
        ordered = values[np.lexsort((values, at))]
        levels.append(np.where(count > 0, ordered[middle], np.median(values)))
    return np.stack(levels)
