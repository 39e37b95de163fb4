"""Where periodic functions are negative, in intervals that a plain grid might miss."""

from __future__ import annotations

import math
from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray

from asperity._base.arrays import Array

Interval = tuple[float, float]

TURN = 2.0 * math.pi
# What is narrower is a single point, seen because functions jump there.
NARROW = 1e-11
_FIRST, _ROUNDS, _MOST = 720, 45, 40_000
_BISECTIONS, _SECTIONS, _SAMPLES = 42, 14, 8


def refined(shape: Callable[[Array], Array], first: int = _FIRST) -> Array:
    """Return angles from 0 to 2π, so dense that the angles `shape` of them, (n, k), hardly turn.

    Around a jump they come as close as 1e-13.
    """
    step = TURN / first
    # Away from the axes, where symmetric sets have their corners and flats.
    x: Array = step * (0.3 + np.arange(first + 1, dtype=np.float64))
    y = shape(x)
    for _ in range(_ROUNDS):
        turn = np.abs(np.angle(np.exp(1j * np.diff(y, axis=0)))).max(axis=1)
        coarse = np.flatnonzero((turn > 2.0 * step) & (np.diff(x) > 1e-13))
        if not len(coarse) or len(x) > _MOST:
            break
        middle = 0.5 * (x[coarse] + x[coarse + 1])
        x, y = np.insert(x, coarse + 1, middle), np.insert(y, coarse + 1, shape(middle), axis=0)
    return x


def negative(f: Callable[[Array], Array], x: Array) -> list[Interval]:
    """Return the intervals where f < 0; f is periodic, the angles x rise over one whole period.

    Minima above zero and maxima below are looked at closely before they are believed.
    """

    def flat(places: Array) -> Array:
        return f(places.ravel()).reshape(places.shape)

    period = float(x[-1] - x[0])
    y = f(x)
    for sign in (1.0, -1.0):
        doubtful = _extrema(sign * y)
        doubtful = doubtful[sign * y[doubtful] >= 0.0]
        extended = np.concatenate([[x[-2] - period], x, [x[1] + period]])
        place = least(flat, extended[doubtful], extended[doubtful + 2], sign)[0]
        x, order = np.unique(np.append(x, place), return_index=True)
        y = np.append(y, f(place))[order]
        inside = (x >= x[0]) & (x <= x[0] + period)
        x, y = x[inside], y[inside]
    below = y < 0.0
    change = np.flatnonzero(below[1:] != below[:-1])
    if not len(change):
        return [(0.0, period)] if below.any() else []
    ends = _bisected(f, x[change], x[change + 1], below[change])
    if below[change[0]]:
        ends = np.append(ends[1:], ends[0] + period)
    found = ends.reshape(-1, 2)
    found = found[found[:, 1] - found[:, 0] > NARROW]
    turns = np.floor(found[:, 0] / period) * period
    return sorted((float(a - t), float(b - t)) for (a, b), t in zip(found, turns, strict=True))


def least(
    f: Callable[[Array], Array], low: Array, high: Array, sign: float = 1.0
) -> tuple[Array, Array]:
    """Return places and values of minima of ±f between bounds, each seen by samples ever closer.

    f takes arrays with one axis more than the bounds.
    """
    share = np.arange(1.0, _SAMPLES + 1.0) / (_SAMPLES + 1.0)
    place, value = low, np.full(low.shape, np.inf)
    for _ in range(_SECTIONS):
        x = low[..., None] + (high - low)[..., None] * share
        y = sign * f(x)
        best = y.argmin(axis=-1)[..., None]
        y_best, x_best = (np.take_along_axis(part, best, axis=-1)[..., 0] for part in (y, x))
        lower, cell = y_best < value, (high - low) / (_SAMPLES + 1.0)
        place, value = np.where(lower, x_best, place), np.where(lower, y_best, value)
        low, high = np.maximum(place - cell, low), np.minimum(place + cell, high)
    return place, value


def _extrema(y: Array) -> NDArray[np.intp]:
    """Return where the periodic samples, first and last the same, have minima, not plateaus."""
    before, after = np.append(y[-2], y[:-1]), np.append(y[1:], y[1])
    return np.flatnonzero((y <= before) & (y <= after) & (y < np.maximum(before, after) - 1e-13))


def _bisected(
    f: Callable[[Array], Array], low: Array, high: Array, below: NDArray[np.bool_]
) -> Array:
    """Return where f changes sign; `below` says whether it is negative at `low`."""
    for _ in range(_BISECTIONS):
        middle = 0.5 * (low + high)
        same = (f(middle) < 0.0) == below
        low, high = np.where(same, middle, low), np.where(same, high, middle)
    return 0.5 * (low + high)
