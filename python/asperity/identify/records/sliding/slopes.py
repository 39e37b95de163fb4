"""Velocities from positions that are noisy, come in steps, and rest between strokes."""

from __future__ import annotations

import math
from itertools import pairwise
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from asperity._base.arrays import Array
from asperity.identify.records.sliding.stretches import rows_of, stretches, usual_speed

WORST = 0.1
"""Positions that tell the speed worse than to this part of it do not tell strokes."""

# Windows are as long as it takes to know the usual speed to this part of it.
_SHARE = 0.005
_SHORTEST, _GROWTH = 5, 1.4
# A stretch of sliding is this many windows long, and turns by no more than this angle in one, but
# for a quarter of its samples, where it may have corners.
_WINDOWS = 4
_BEND, _BENDING = 0.3, 0.75
# Samples of a window that tell how long it has to be.
_COARSE = 16
# Of a normal distribution, the ratio of deviation and median distance.
_MEDIAN = 1.4826
# A line through n steps of an encoder has a slope that is off by this part, over n².
_STAIRS = 0.5
# A corner turns by more than this angle, of which most is in one window.
_CORNER, _SHARP = math.radians(20.0), 1.5
# Of positions, what is rounding.
_ROUNDING = 1e-9
# At each end, a stretch loses no more than one of so many samples.
_ENDS = 8
# Positions on a line leave a deviation of so many times their noise.
_STRAIGHT = 1.5


class Slopes(NamedTuple):
    """Velocities, and how well positions tell them.

    Attributes:
        velocity: in m/s, shape ``(n, 2)``.
        error: of the usual speed, relative to it; infinite where positions tell no velocity.
        noise: standard deviation of the positions in m, that of steps included.
        width: of the windows, in samples.
        step: by which positions change in m; 0 where they have all values.
        stretch: length of the usual stretch of sliding in m, as far as it can be told.
    """

    velocity: Array
    error: float
    noise: float
    width: int
    step: float
    stretch: float


class _Tried(NamedTuple):
    """What windows of some length tell."""

    width: int
    error: float
    stretch: float


def slopes(position: Array, time: Array) -> Slopes:
    """Return the velocities of positions ``(n, d)`` that were read at equal intervals of time.

    They are slopes of local parabolas over windows as long as the noise and the steps of the
    positions ask for. Within half a window of a rest, a reversal or a corner they are zero.
    """
    from scipy.signal import savgol_filter

    n = len(time)
    interval = float(time[-1] - time[0]) / (n - 1)
    centred = position - position.mean(axis=0)
    step, noise = _resolution(centred)
    if n < _SHORTEST:
        velocity = np.zeros((n, 2))
        velocity[:, : centred.shape[1]] = np.gradient(centred, interval, axis=0)
        return Slopes(velocity, 0.0, noise, n, step, 0.0)
    best = _fitting(centred, noise, step)
    moved = savgol_filter(centred, best.width, 2, deriv=1, delta=interval, axis=0)
    velocity = np.zeros((n, 2))
    velocity[:, : moved.shape[1]] = moved
    # The parabola of the first window is that of its first half too, if it is one.
    half = best.width // 2
    for window, rows in (
        (slice(best.width), slice(half)),
        (slice(-best.width, None), slice(-half, None)),
    ):
        if not _is_parabola(centred[window], noise):
            velocity[rows] = 0.0
    velocity = _on_lines(centred, _without_ends(velocity, best.width), noise)
    return Slopes(velocity, best.error, noise, best.width, step, best.stretch)


def _resolution(position: Array) -> tuple[float, float]:
    """Return the step of positions, 0 if there is none, and the deviation of their noise."""
    step = max(_step(column) for column in position.T)
    # Third differences of a motion are small beside those of noise, whose variance is 20 σ².
    rough = np.abs(np.diff(position, 3, axis=0))
    if rough.size and not step:
        # At rest there may be no noise.
        rough = np.where(rough > 0.0, rough, np.nan)
    noise = 0.0
    if rough.size and np.isfinite(rough).any():
        columns = [column[np.isfinite(column)] for column in rough.T]
        noise = max(float(np.median(column)) for column in columns if column.size)
    return step, max(_MEDIAN * noise / math.sqrt(20.0), step / math.sqrt(12.0))


def _step(values: Array) -> float:
    """Return the usual distance between neighbouring levels where readings repeat themselves."""
    levels = np.unique(values)
    if not 2 <= levels.size <= values.size // 2:
        return 0.0
    return float(np.median(np.diff(levels)))


def _fitting(position: Array, noise: float, step: float) -> _Tried:
    """Return the shortest windows that tell the speed well, else those that tell it best."""
    n, width = len(position), float(_SHORTEST)
    found: list[_Tried] = []
    while True:
        one = _tried(position, _odd(width, n), noise, step)
        found.append(one)
        width *= _GROWTH
        if one.error <= _SHARE or width > n // _WINDOWS:
            break
    return min(found, key=lambda one: max(one.error, _SHARE))


def _tried(position: Array, width: int, noise: float, step: float) -> _Tried:
    """Return how well windows of some samples tell the speed."""
    from scipy.signal import savgol_filter

    # Means of blocks are enough to tell how fast and how far something moves.
    block = max(1, width // _COARSE)
    m = len(position) // block
    means = position[: m * block].reshape(m, block, -1).mean(axis=1)
    inside = _odd(width / block, m)
    moved = savgol_filter(means, inside, 2, deriv=1, axis=0) / block
    velocity = np.zeros((m, 2))
    velocity[:, : moved.shape[1]] = moved
    speed = np.hypot(velocity[:, 0], velocity[:, 1])
    usual = usual_speed(speed)
    if usual == 0.0:
        return _Tried(width, math.inf, 0.0)
    number = stretches(velocity)
    used = number >= 0
    if not used.any():
        return _Tried(width, math.inf, 0.0)
    length = np.bincount(number[used])
    # The stretch that holds the sample in the middle of all that slide.
    usual_stretch = float(np.median(length[number[used]])) * block
    # A line through w samples has a slope with the standard error σ √(12/w³).
    error = noise * math.sqrt(12.0 / width**3) / usual
    error += _STAIRS * (step / (width * usual)) ** 2
    bends = _bend(velocity, number, inside)
    if usual_stretch < _WINDOWS * width and width > _SHORTEST:
        error = math.inf
    return _Tried(
        width, math.inf if bends > _BEND else error, usual_stretch * float(speed[used].mean())
    )


def _bend(velocity: Array, number: NDArray[np.int32], window: int) -> float:
    """Return by how much the direction turns in a window, for most samples."""
    turned = np.arctan2(velocity[:, 1], velocity[:, 0])
    row = np.arange(turned.size - window)
    change = _change(turned, row, row + window)
    same = (number[window:] == number[:-window]) & (number[window:] >= 0)
    return float(np.quantile(np.abs(change[same]), _BENDING)) if same.any() else 0.0


def _odd(width: float, n: int) -> int:
    """Return an odd number of samples near `width`, and at most `n`."""
    window = max(round(width), _SHORTEST)
    return min(window + 1 - window % 2, n - 1 + n % 2)


def _is_parabola(position: Array, noise: float) -> bool:
    """Return whether a parabola leaves no more of some positions than their noise."""
    place = np.linspace(-1.0, 1.0, len(position))
    design = np.stack([np.ones_like(place), place, place**2], axis=-1)
    left = position - design @ np.linalg.lstsq(design, position, rcond=None)[0]
    free = (len(position) - 3) * position.shape[1]
    rounding = _ROUNDING * float(np.abs(position).max())
    most = free * (noise**2 + rounding**2) * (1.0 + 4.0 * math.sqrt(2.0 / free))
    return float((left**2).sum()) <= most


def _without_ends(velocity: Array, width: int) -> Array:
    """Return velocities that are zero where windows hold two motions.

    A window over the end of a stretch or over a corner tells neither what is before nor what is
    behind it.
    """
    if not velocity.any():
        return velocity
    half = width // 2
    number = stretches(velocity)
    found = velocity.copy()
    for row in _corners(velocity, number, half):
        number[row - half : row + half + 1] = -1
        found[row - half : row + half + 1] = 0.0
    edges = np.flatnonzero(np.diff(number)) + 1
    for first, past in pairwise([0, *edges.tolist(), number.size]):
        # What is shorter than a window is none of the motion's own.
        if number[first] >= 0 and past - first < width > _SHORTEST:
            found[first:past] = 0.0
        elif number[first] >= 0:
            cut = min(half, (past - first) // _ENDS)
            found[first : first + cut * (first > 0)] = 0.0
            found[past - cut * (past < number.size) : past] = 0.0
    return found


def _corners(velocity: Array, number: NDArray[np.int32], half: int) -> list[int]:
    """Return the samples about which the direction turns in one window, and not beside it."""
    n = number.size
    if n <= 4 * half:
        return []
    turned = np.arctan2(velocity[:, 1], velocity[:, 0])
    row = np.arange(2 * half, n - 2 * half)
    near = np.abs(_change(turned, row - half, row + half))
    far = np.abs(_change(turned, row - 2 * half, row + 2 * half))
    same = (number[row - 2 * half] == number[row + 2 * half]) & (number[row] >= 0)
    sharp = same & (near > _CORNER) & (far < _SHARP * near)
    edges = np.flatnonzero(np.diff(sharp.astype(np.int8)) != 0) + 1
    parts = np.split(np.arange(row.size), edges)
    return [int(row[part[near[part].argmax()]]) for part in parts if sharp[part[0]]]


def _change(turned: Array, before: NDArray[np.intp], after: NDArray[np.intp]) -> Array:
    change = turned[after] - turned[before]
    return np.asarray(change - 2.0 * math.pi * np.rint(change / (2.0 * math.pi)))


def _on_lines(position: Array, velocity: Array, noise: float) -> Array:
    """Return velocities along the line of each stretch whose positions are on one.

    What they do beside it is noise, or the steps of one axis while the other one moves.
    """
    if position.shape[1] < 2 or not velocity.any():
        return velocity
    found = velocity.copy()
    for rows in rows_of(stretches(velocity)):
        away = position[rows] - position[rows].mean(axis=0)
        _, size, axes = np.linalg.svd(away, full_matrices=False)
        if size[1] <= _STRAIGHT * noise * math.sqrt(rows.size):
            found[rows] = (velocity[rows] @ axes[0])[:, None] * axes[0]
    return found
