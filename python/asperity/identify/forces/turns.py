"""Turns of the disk, and averages over them."""

from __future__ import annotations

import math
from dataclasses import KW_ONLY
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from asperity._base import arrays
from asperity._base.arrays import Array
from asperity._base.quantiles import student
from asperity._base.value import AnyArray, Fraction, Record, Vector, field
from asperity.errors import ParameterError
from asperity.identify.records.record import Recording

_TURN = 2.0 * math.pi
# Angles that miss a whole turn by this share of it complete it.
_ROUNDING = 1e-9
_FEWEST = 8


def sense(recording: Recording) -> float:
    """Return +1 or −1, the sense in which the disk turns."""
    return math.copysign(1.0, recording.angle[-1] - recording.angle[0])


def turn_numbers(recording: Recording, sign: float) -> NDArray[np.int32]:
    """Return the number of the turn of each sample, from 0; −1 in the last, incomplete turn.

    Args:
        recording: a run.
        sign: its `sense`.

    >>> import numpy as np
    >>> from asperity.identify import Recording
    >>> from asperity.identify.forces.turns import turn_numbers
    >>> t = np.arange(25) / 10.0
    >>> turn_numbers(Recording(t, angle=2.0 * np.pi * t, readings=np.zeros((25, 3))), 1.0)[
    ...     [0, 9, 10, 20]
    ... ].tolist()
    [0, 0, 1, -1]
    """
    # The last sample stands for the step that follows it.
    n = len(recording)
    complete = math.floor(abs(recording.turns) * n / (n - 1) + _ROUNDING)
    ahead = recording.angle * (sign / _TURN)
    ahead -= ahead[0] - _ROUNDING
    numbers: NDArray[np.int32] = np.floor(ahead, out=ahead).astype(np.int32)
    numbers[numbers >= complete] = -1
    return numbers


class TurnAverage(Record):
    """A signal over the angle, averaged turn by turn.

    Args:
        phi: centres of the bins in rad, shape ``(k,)``.
        turns: mean of each turn in each bin, shape ``(m, k)``.
        confidence: level of the confidence bands.

    Attributes:
        mean: over the turns, shape ``(k,)``.
        low, high: confidence band of the mean from the scatter of the turns, Student's t;
            shape ``(k,)``; infinite for a single turn.
        offset: mean of each turn minus the mean of all, shape ``(m,)``.
        drift: slope of the turns' means, per turn.
    """

    phi: Vector
    turns: AnyArray
    _: KW_ONLY
    confidence: Fraction = 0.95
    mean: Array = field(init=False)
    low: Array = field(init=False)
    high: Array = field(init=False)
    offset: Array = field(init=False)
    drift: float = field(init=False)

    def _complete(self, given: dict[str, Any]) -> None:
        given["turns"] = arrays.array(given["turns"], "turns", (None, len(given["phi"])))

    def _derive(self) -> None:
        values, level = self.turns, self.confidence
        mean: Array = values.mean(axis=0)
        half = _half_width(values, level)
        offset = values.mean(axis=1) - values.mean()
        number = np.arange(len(values)) - 0.5 * (len(values) - 1)
        self._keep(
            mean=mean,
            low=mean - half,
            high=mean + half,
            offset=offset,
            drift=float(number @ offset / max(number @ number, 1.0)),
        )

    def __repr__(self) -> str:
        return f"<TurnAverage: {len(self.turns)} turns, {len(self.phi)} bins>"


def _half_width(values: Array, confidence: float) -> Array:
    m = len(values)
    if m < 2:
        return np.full(values.shape[1], np.inf)
    quantile = student(confidence, m - 1)
    return quantile * values.std(axis=0, ddof=1) / math.sqrt(m)


def average_turns(
    phi: ArrayLike,
    *,
    values: ArrayLike,
    turn: ArrayLike,
    bins: int = 360,
    confidence: float = 0.95,
) -> TurnAverage:
    """Average a signal over each turn in equal bins of the angle.

    Args:
        phi: angle in rad, shape ``(n,)``.
        values: signal, shape ``(n,)``.
        turn: number of the turn of each sample, negative where it does not count; shape ``(n,)``.
        bins: number k of bins.
        confidence: level of the confidence bands of the mean.

    Raises:
        ParameterError: if a bin of a turn holds no sample, or there is no complete turn.

    >>> import numpy as np
    >>> from asperity.identify import average_turns
    >>> phi = 2.0 * np.pi * np.arange(2000) / 1000
    >>> average = average_turns(phi, values=3.0 + np.cos(phi), turn=phi // (2.0 * np.pi), bins=10)
    >>> len(average.turns), round(float(average.mean.mean()), 9), abs(average.drift) < 1e-12
    (2, 3.0, True)
    """
    angle = arrays.array(phi, "phi", (None,))
    signal = arrays.array(values, "values", (angle.size,))
    number = arrays.array(turn, "turn", angle.shape)
    used = number >= 0
    if not used.any():
        raise ParameterError("turn", "must number at least one complete turn")
    kept, row = np.unique(number[used].astype(np.int64), return_inverse=True)
    k = arrays.count(bins, "bins")
    cell = row * k + bin_numbers(angle[used], k)
    counts = np.bincount(cell, minlength=len(kept) * k)
    if not counts.all():
        raise ParameterError("bins", f"must be fewer: of {k}, some hold no sample in a turn")
    means = np.bincount(cell, signal[used], len(kept) * k) / counts
    return TurnAverage(bin_centres(k), means.reshape(len(kept), k), confidence=confidence)


def bin_numbers(phi: Array, bins: int) -> NDArray[np.int64]:
    """Return the number of the bin around each angle; the first is centred at half a bin."""
    return cells(phi, bins)[0]


def cells(phi: Array, bins: int) -> tuple[NDArray[np.int64], Array]:
    """Return the bins of angles, and where in them the angles lie, from the centre in rad."""
    width = _TURN / bins
    # Angles on the edge of a bin count for the upper one, whatever their rounding.
    number = np.floor(phi / width + _ROUNDING)
    return number.astype(np.int64) % bins, phi - (number + 0.5) * width


def full_bins(phi: Array, turn: NDArray[np.int32], most: int, *, each_turn: bool = False) -> int:
    """Return a number of bins, not more than `most` and not under 8, of which none is empty.

    >>> import numpy as np
    >>> from asperity.identify.forces.turns import full_bins
    >>> full_bins(np.arange(0.0, 6.28, 0.1), np.zeros(63, dtype=np.int32), 360) in range(32, 64)
    True
    """
    used = turn >= 0
    angle, number = phi[used], turn[used].astype(np.int64)
    rows = int(number.max(initial=0)) + 1 if each_turn else 1
    bins = most
    while bins > _FEWEST:
        cell = bin_numbers(angle, bins)
        if each_turn:
            cell += number * bins
        if np.bincount(cell, minlength=rows * bins).all():
            return bins
        bins = max(2 * bins // 3, _FEWEST)
    return bins


def bin_centres(bins: int) -> Array:
    """Return the centres of equal bins of a turn."""
    return (np.arange(bins, dtype=np.float64) + 0.5) * (_TURN / bins)
