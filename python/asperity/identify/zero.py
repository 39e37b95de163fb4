"""Readings without load."""

from __future__ import annotations

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
        _, mean, covariance = _mean(raw.no_load)
        return Zero(mean, np.zeros(3), middle, covariance)
    (t0, m0, c0), (t1, m1, c1) = _mean(before), _mean(after)
    share = (middle - t0) / (t1 - t0)
    return Zero(
        (1.0 - share) * m0 + share * m1,
        (m1 - m0) / (t1 - t0),
        middle,
        (1.0 - share) ** 2 * c0 + share**2 * c1,
    )


def _mean(records: list[Recording] | tuple[Recording, ...]) -> tuple[float, Array, Array]:
    """Return the middle of some records, their mean and its covariance from batch means."""
    weights = np.array([len(record) for record in records], dtype=float)
    weights /= weights.sum()
    means = np.array([record.readings.mean(axis=0) for record in records])
    times = np.array([record.time.mean() for record in records])
    covariance = sum(
        w**2 * batch_covariance(record.readings) for w, record in zip(weights, records, strict=True)
    )
    return float(weights @ times), weights @ means, np.asarray(covariance, dtype=np.float64)


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
