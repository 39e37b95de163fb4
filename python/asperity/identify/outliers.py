"""Samples without gross outliers, for the means that a robust fit starts from."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from asperity._arrays import Array
from asperity.identify.loss import MEDIAN_LENGTH
from asperity.identify.samples import Samples, bin_of, chosen, inside

_MOST_SAMPLES = 100_000
_FEWEST_PER_BIN, _MOST_BINS = 25, 360
# Farther from the medians than this many deviations, and than this part of the forces.
_DEVIATIONS, _PART = 6.0, 0.5


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


def _parts(samples: Samples, rows: NDArray[np.intp]) -> Array:
    """Return l_t and l_p, which vary less over the directions than the components of the force."""
    phi, (x, y) = samples.phi[rows], samples.force[rows].T
    cos, sin = np.cos(phi), np.sin(phi)
    return np.stack([x * cos + y * sin, y * cos - x * sin]) / samples.normal[rows]


def _medians(parts: Array, at: NDArray[np.intp], bins: int) -> Array:
    """Return the median of each row in each bin; the overall one where a bin is empty."""
    count = np.bincount(at, minlength=bins)
    middle = np.minimum(np.cumsum(count) - count + count // 2, at.size - 1)
    levels = []
    for values in parts:
        ordered = values[np.lexsort((values, at))]
        levels.append(np.where(count > 0, ordered[middle], np.median(values)))
    return np.stack(levels)
