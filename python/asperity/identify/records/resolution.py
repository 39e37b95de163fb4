"""Whether channels are resolved in steps that are not small beside their noise."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from asperity._base.arrays import Array
from asperity.identify.records.record import CHANNELS, RawData, Recording

# Readings of a run that are looked at, one after the other.
_MOST = 50_000
# Noise is what is left of a mean over so many parts of a turn, or of a stroke there and back.
_PARTS = 72
# Of a normal distribution, the ratio of deviation and median distance.
_MEDIAN = 1.4826
# Gaps between readings are whole numbers of steps, up to the rounding of a text file.
_ROUNDING = 0.02


class Steps(NamedTuple):
    """The resolution of a channel.

    Attributes:
        channel: its name.
        step: smallest difference of readings, in their unit.
        noise: standard deviation of the readings, in their unit.
    """

    channel: str
    step: float
    noise: float


def coarse_channels(raw: RawData) -> list[Steps]:
    """Return the channels whose steps are not below their noise.

    Noise that is larger than a step makes rounding errors independent of the force; below, they
    follow it. A normal channel that is replaced by a given load does not count.
    """
    found: dict[str, Steps] = {}
    used = CHANNELS if raw.normal_load is None else CHANNELS[:2]
    for run in raw.recordings:
        for number, channel in enumerate(used):
            steps = _steps(run, number)
            worst = found.get(channel)
            if steps is not None and (worst is None or steps.step > worst.step):
                found[channel] = steps
    return list(found.values())


def _steps(run: Recording, number: int) -> Steps | None:
    from scipy.ndimage import uniform_filter1d

    values = run.readings[:_MOST, number]
    step = _step(values)
    if step is None:
        return None
    window = max(3, round(len(run) / max(_turns(run), 1.0) / _PARTS))
    away = np.abs(values - uniform_filter1d(values, window))
    noise = _MEDIAN * float(np.median(away))
    return Steps(CHANNELS[number], step, noise) if step > noise else None


def _turns(run: Recording) -> float:
    """Return how often the sliding goes round, or there and back."""
    if run.velocity is None:
        there_and_back = float(np.abs(np.diff(run.angle)).sum()) / (2.0 * np.pi)
        return there_and_back if run.turns_back else abs(run.turns)
    steps = run.velocity[1:] * np.diff(run.time)[:, None]
    extent = float(np.ptp(np.cumsum(steps, axis=0), axis=0).max())
    return float(np.hypot(*steps.T).sum()) / (2.0 * extent) if extent > 0.0 else 0.0


def _step(values: Array) -> float | None:
    """Return the step of which all differences are whole multiples, if there is one."""
    levels = np.unique(values)
    if not 2 <= levels.size <= values.size // 2:
        return None
    gaps = np.diff(levels)
    step = float(gaps.min())
    multiples = gaps / step
    return step if (np.abs(multiples - np.rint(multiples)) < _ROUNDING * multiples).all() else None
