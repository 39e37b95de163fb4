"""Where the pin slides along one way: stretches between rests, reversals and corners."""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from asperity._base.arrays import Array

FEWEST = 8
"""Samples that a stretch has at least."""

SLOW = 0.2
"""Slower than this part of the usual speed, the pin is about to stick or to turn back."""

# Slower than this part, it has stopped: between the two, noise is no end of a stretch.
_STILL = 0.1
# Of the speeds while it slides, the one that is usual: faster moves to a place are less than the
# rest of the time.
_USUAL = 0.75
# Speeds above this quantile are outliers; those below this part of the fastest are noise of a rest.
_CLIPPED, _RESTS = 0.999, 0.02
# Samples that tell the usual speed.
_MOST = 100_000
# A stretch that goes on while it changes its direction by more than this is another one.
_CORNER = math.radians(20.0)
_TURN = 2.0 * math.pi


def usual_speed(speed: Array) -> float:
    """Return the speed that is usual while something slides, however long it rests between.

    >>> import numpy as np
    >>> from asperity.identify.records.sliding.stretches import usual_speed
    >>> usual_speed(np.append(np.full(50, 2.0), np.zeros(5000)))
    2.0
    """
    some = np.sort(speed[:: max(1, speed.size // _MOST)])
    some = np.minimum(some, np.quantile(some, _CLIPPED, method="higher"))
    if not some[-1] > 0.0:
        return 0.0
    # Noise of a rest has many samples, but hardly any power; fast moves have much power, but
    # hardly any samples, and less of the way than the strokes.
    fastest = _middle(some, some**2)
    moving = some[some > _RESTS * fastest]
    middle = _middle(moving, moving)
    return float(np.quantile(moving[moving > SLOW * middle], _USUAL))


def _middle(rising: Array, weights: Array) -> float:
    """Return the median of rising numbers by their weights."""
    share = np.cumsum(weights)
    return float(rising[np.searchsorted(share, 0.5 * share[-1])])


def stretches(velocity: Array) -> NDArray[np.int32]:
    """Return the number of the stretch of each sample, from 0; −1 between them.

    Args:
        velocity: of sliding, shape ``(n, 2)``; not all zero.
    """
    speed = np.hypot(velocity[:, 0], velocity[:, 1])
    usual = usual_speed(speed)
    slides = _held(speed > SLOW * usual, speed > _STILL * usual)
    corner = _corners(velocity, slides)
    ends = np.flatnonzero(np.diff(slides.astype(np.int8)) != 0) + 1
    edges = np.union1d(ends, corner + 1)
    first = np.concatenate([[0], edges]).astype(np.intp)
    past = np.append(edges, slides.size).astype(np.intp)
    kept = slides[first] & (past - first >= FEWEST)
    of_part = np.where(kept, np.cumsum(kept) - 1, -1).astype(np.int32)
    return np.repeat(of_part, past - first)


def rows_of(number: NDArray[np.int32]) -> list[NDArray[np.intp]]:
    """Return the rows of each stretch or stroke, one after the other, of numbers per sample."""
    edges = np.flatnonzero(np.diff(number)) + 1
    return [part for part in np.split(np.arange(number.size), edges) if number[part[0]] >= 0]


def _held(fast: NDArray[np.bool_], moves: NDArray[np.bool_]) -> NDArray[np.bool_]:
    """Return the samples from the first to the last fast one of each stretch that moves."""
    edges = np.flatnonzero(np.diff(moves.astype(np.int8)) != 0) + 1
    part = np.zeros(moves.size, dtype=np.intp)
    part[edges] = 1
    part = np.cumsum(part)
    row = np.flatnonzero(fast)
    first = np.full(edges.size + 1, moves.size, dtype=np.intp)
    last = np.full(edges.size + 1, -1, dtype=np.intp)
    np.minimum.at(first, part[row], row)
    np.maximum.at(last, part[row], row)
    at = np.arange(moves.size)
    return np.asarray((at >= first[part]) & (at <= last[part]))


def _corners(velocity: Array, slides: NDArray[np.bool_]) -> NDArray[np.intp]:
    """Return the samples after which the direction jumps, and stays where it has jumped to."""
    turned = np.arctan2(velocity[:, 1], velocity[:, 0])
    step = np.diff(turned)
    step -= _TURN * np.rint(step / _TURN)
    at = np.flatnonzero((np.abs(step) > _CORNER) & slides[1:] & slides[:-1])
    if not at.size:
        return at
    sums = np.concatenate([np.zeros((1, 2)), np.cumsum(velocity, axis=0)])
    before = sums[at + 1] - sums[np.maximum(at + 1 - FEWEST, 0)]
    after = sums[np.minimum(at + 1 + FEWEST, len(velocity))] - sums[at + 1]
    along = (before * after).sum(axis=1)
    across = before[:, 0] * after[:, 1] - before[:, 1] * after[:, 0]
    return at[np.abs(np.arctan2(across, along)) > _CORNER]
