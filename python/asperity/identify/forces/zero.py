"""Readings without load."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import pairwise

import numpy as np

from asperity._base.arrays import Array
from asperity.errors import RecordError
from asperity.identify.records.record import RawData, Recording

# Batches a record is cut into, so that their means scatter like independent numbers.
_BATCHES = 20


@dataclass(frozen=True)
class Zero:
    """The zero of the channels as a straight line in time.

    Attributes:
        mean: zero at `middle`, shape ``(3,)``.
        slope: per s, shape ``(3,)``.
        middle: the time of `mean` in s.
        covariance: of `mean`, shape ``(3, 3)``; None without records.
    """

    mean: Array
    slope: Array
    middle: float
    covariance: Array | None


def zeros_of(raw: RawData) -> tuple[Zero, ...]:
    """Return the zero of each run, from the records without load nearest before and after it.

    Between two records it is the line through their means, and the covariance is that of its value
    in the middle of the run. A run with records on one side only keeps the mean of the nearest;
    how far it may have drifted since, by the slope in that record and between records, counts as
    uncertainty.

    Raises:
        RecordError: if records overlap in time, so that they cannot be on one clock.
    """
    if not raw.no_load:
        none = np.zeros(3)
        return tuple(Zero(none, none, _middle(run), None) for run in raw.recordings)
    _refuse_overlap((*raw.recordings, *raw.no_load))
    return tuple(_zero(run, raw.no_load) for run in raw.recordings)


def shared_covariance(zeros: Sequence[Zero], lengths: Sequence[int]) -> Array | None:
    """Return the covariance of the zeros of all runs as if their errors were the same.

    Runs that share no record have independent errors: their mean is known better than this, but
    runs in opposite senses pull apart what is the same for all.
    """
    if zeros[0].covariance is None:
        return None
    return np.asarray(np.average([z.covariance for z in zeros], axis=0, weights=lengths))


def _zero(run: Recording, records: Sequence[Recording]) -> Zero:
    before = max((r for r in records if r.time[0] < run.time[0]), key=_middle, default=None)
    after = min((r for r in records if r.time[0] > run.time[0]), key=_middle, default=None)
    middle = _middle(run)
    if before is None or after is None:
        nearest = before or after
        assert nearest is not None
        return _one_sided(nearest, records, middle)
    t0, t1 = _middle(before), _middle(after)
    m0, m1 = before.readings.mean(axis=0), after.readings.mean(axis=0)
    slope, share = (m1 - m0) / (t1 - t0), (middle - t0) / (t1 - t0)
    covariance = (1.0 - share) ** 2 * _covariance(before, slope)
    covariance += share**2 * _covariance(after, slope)
    return Zero((1.0 - share) * m0 + share * m1, slope, middle, covariance)


def _one_sided(record: Recording, records: Sequence[Recording], middle: float) -> Zero:
    """Return the mean of a record as a zero, as uncertain as the drift until `middle` makes it."""
    distance = middle - _middle(record)
    slope, spread = _slope(record)
    drifts = [np.outer(slope, slope) + spread]
    for other in records:
        if other is not record:
            rate = (other.readings.mean(axis=0) - record.readings.mean(axis=0)) / (
                _middle(other) - _middle(record)
            )
            drifts.append(np.outer(rate, rate))
    # Of several estimates none need hold for the run: the largest counts.
    drift = max(drifts, key=lambda d: float(np.trace(d)))
    covariance = _covariance(record, slope) + distance**2 * drift
    none = np.zeros(3)
    return Zero(record.readings.mean(axis=0), none, middle, covariance)


def _slope(record: Recording) -> tuple[Array, Array]:
    """Return the slope of a record per s and its covariance, from the slopes of batches."""
    time = record.time - _middle(record)
    weights = time / float(time @ time)
    slope: Array = weights @ record.readings
    rest = record.readings - record.readings.mean(axis=0) - np.outer(time, slope)
    # Sums over batches scatter like independent numbers, whatever the colour of the noise.
    pulls = weights[:, None] * rest
    edges = np.linspace(0, len(time), min(_BATCHES, len(time)) + 1).astype(int)[:-1]
    sums = np.add.reduceat(pulls, edges, axis=0)
    return slope, sums.T @ sums


def _refuse_overlap(records: Sequence[Recording]) -> None:
    ordered = sorted(records, key=lambda record: float(record.time[0]))
    for one, other in pairwise(ordered):
        if other.time[0] < one.time[-1]:
            raise RecordError(
                other.source,
                f"time: starts at {other.time[0]:.6g} s before {one.source or 'another record'} "
                f"ends at {one.time[-1]:.6g} s: drift of the zero needs runs and records without "
                "load on one clock: give a time column, or shift it",
            )


def _middle(record: Recording) -> float:
    return 0.5 * float(record.time[0] + record.time[-1])


def _covariance(record: Recording, slope: Array) -> Array:
    """Return the covariance of the mean reading; the drift along the line is no noise."""
    return batch_covariance(record.readings - np.outer(record.time, slope))


def batch_covariance(values: Array) -> Array:
    """Return the covariance of the mean of correlated samples ``(n, p)`` from means of batches.

    >>> import numpy as np
    >>> from asperity.identify.forces.zero import batch_covariance
    >>> noise = np.random.default_rng(0).normal(size=(100_000, 1))
    >>> bool(0.3 < batch_covariance(noise)[0, 0] * 100_000 < 2.0)
    True
    """
    batches = min(_BATCHES, len(values))
    length = len(values) // batches
    means = values[: batches * length].reshape(batches, length, -1).mean(axis=1)
    return np.atleast_2d(np.cov(means.T)) / batches
