"""Readings without load."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from asperity._arrays import Array
from asperity.identify.record import RawData, Recording

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

    def at(self, time: Array) -> Array:
        """Return the zero at times ``(n,)``, shape ``(n, 3)``."""
        if not self.slope.any():
            return self.mean[None, :]
        return self.mean + (time - self.middle)[:, None] * self.slope

    def shifted(self, shift: Array) -> Zero:
        """Return another mean with the same drift."""
        return replace(self, mean=self.mean + shift)


def zero_of(raw: RawData) -> Zero:
    """Return the zero of the runs from the records without load.

    With records before and after all runs it is the line through their means; the covariance is
    that of its value in the middle of the runs, which all turns share.
    """
    first = min(run.time[0] for run in raw.recordings)
    last = max(run.time[-1] for run in raw.recordings)
    middle = 0.5 * float(first + last)
    if not raw.no_load:
        return Zero(np.zeros(3), np.zeros(3), middle, None)
    before = [record for record in raw.no_load if record.time[-1] <= first]
    after = [record for record in raw.no_load if record.time[0] >= last]
    if not (before and after):
        none = np.zeros(3)
        return Zero(_mean(raw.no_load)[1], none, middle, _covariance(raw.no_load, none))
    (t0, m0), (t1, m1) = _mean(before), _mean(after)
    slope, share = (m1 - m0) / (t1 - t0), (middle - t0) / (t1 - t0)
    covariance = (1.0 - share) ** 2 * _covariance(before, slope)
    covariance += share**2 * _covariance(after, slope)
    return Zero((1.0 - share) * m0 + share * m1, slope, middle, covariance)


def _mean(records: Sequence[Recording]) -> tuple[float, Array]:
    """Return the mean time and reading of all samples of some records."""
    weights = [len(record) for record in records]
    times = [float(record.time.mean()) for record in records]
    means = [record.readings.mean(axis=0) for record in records]
    mean: Array = np.average(means, axis=0, weights=weights)
    return float(np.average(times, weights=weights)), mean


def _covariance(records: Sequence[Recording], slope: Array) -> Array:
    """Return the covariance of the mean reading; the drift along the line is no noise."""
    weights = np.array([len(record) for record in records], dtype=np.float64)
    total = np.zeros((3, 3))
    for share, record in zip(weights / weights.sum(), records, strict=True):
        total += share**2 * batch_covariance(record.readings - np.outer(record.time, slope))
    return total


def batch_covariance(values: Array) -> Array:
    """Return the covariance of the mean of correlated samples ``(n, p)`` from means of batches.

    >>> import numpy as np
    >>> from asperity.identify.zero import batch_covariance
    >>> noise = np.random.default_rng(0).normal(size=(100_000, 1))
    >>> bool(0.3 < batch_covariance(noise)[0, 0] * 100_000 < 2.0)
    True
    """
    batches = min(_BATCHES, len(values))
    length = len(values) // batches
    means = values[: batches * length].reshape(batches, length, -1).mean(axis=1)
    return np.atleast_2d(np.cov(means.T)) / batches
