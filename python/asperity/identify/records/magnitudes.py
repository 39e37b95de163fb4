"""Magnitudes that betray a wrong unit."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence

import numpy as np

from asperity._base.arrays import Array
from asperity.errors import RecordError
from asperity.identify.records.record import CHANNELS, Recording, goes_back
from asperity.identify.records.tables.headings import COEFFICIENT, COUNTS, NEWTONS, TORQUES, UNITS

_TURN = 2.0 * math.pi
_RATES, _TURN_RATES, _PER_TURN = (0.5, 2e7), (2e-3, 60.0), 16.0
_LOADS, _COEFFICIENTS = (1e-4, 1e4), (3e-3, 50.0)
# An angle is in another unit if the turns of that one explain more than the first share of the
# friction's variance and leave less than the second of what its own turns leave. Over the third
# number of turns a drift is not periodic.
_MUCH, _LEFT, _TURNS = 0.5, 0.3, 2.5
_FOLDED, _BINS = 200_000, 36


def check_wrapping(angle: Array, unit: str, factor: float, source: str) -> None:
    """Refuse an angle that jumps back by a turn of another unit.

    Args:
        angle: as it was read.
        unit: in which it is said to be.
        factor: of that unit to rad.
        source: for messages.
    """
    jumps = np.abs(np.diff(angle))
    wraps = jumps[jumps > 0.5 * float(np.ptp(angle))]
    if not wraps.size or len(angle) < 3:
        return
    step = float(np.median(jumps))
    size = float(np.median(wraps)) + step
    own = unit.removeprefix("-")
    known = {name: one for name, one in UNITS["angle"].items() if name != COUNTS}
    for name, rate in {**known, own: abs(factor)}.items():
        turn = _TURN / rate
        if abs(size - turn) < 0.02 * turn + step:
            if name != own:
                raise RecordError(
                    source,
                    f"angle: jumps by {size:.6g} where it wraps, its unit seems to be {name!r}",
                    ("units",),
                )
            return
    counted = ("counts_per_turn",) if own == COUNTS else ("units",)
    raise RecordError(source, f"angle: jumps by {size:.6g} {unit}, which is no turn", counted)


def check_magnitudes(
    runs: Sequence[Recording], units: Mapping[str, str], *, is_sparse: bool = False
) -> None:
    """Refuse a record whose magnitudes do not fit a tribometer: a unit is wrong then.

    Args:
        runs: its pieces, which need not have the magnitudes of the whole each.
        units: of its columns.
        is_sparse: whether turns may have few samples, as where no direction is asked for.
    """
    longest = max(runs, key=len)
    # A record without defects is one piece, and named without its lines.
    source = longest.source if len(runs) == 1 else longest.file
    _inside(longest.sample_rate, _RATES, "Hz", source, "time: sample rate of")
    # What goes back and forth need not turn at all.
    if longest.velocity is None and not goes_back(runs):
        _check_folding(longest)
        turns = sum(abs(run.turns) for run in runs)
        if turns != 0.0:
            rate = turns / sum(run.duration for run in runs)
            _inside(rate, _TURN_RATES, "turns/s", source, "angle or time: turns at")
            per_turn = sum(map(len, runs)) / turns
            if turns > 1.0 and per_turn < _PER_TURN and not is_sparse:
                raise RecordError(
                    source,
                    f"angle: {per_turn:.3g} samples per turn: wrong unit?",
                    ("units", "check_units"),
                )
    forces = (*NEWTONS, *TORQUES, COEFFICIENT)
    if all(units[channel].removeprefix("-") in forces for channel in CHANNELS):
        is_torque = units["tangential"].removeprefix("-") in TORQUES
        weights = [len(run) for run in runs]
        size = np.abs(np.average([run.readings.mean(axis=0) for run in runs], 0, weights))
        parts = [float(np.hypot(*run.readings[:, :2].T).mean()) for run in runs]
        friction = float(np.average(parts, weights=weights))
        _inside(float(size[2]), _LOADS, "N", source, "normal channel: mean of")
        _inside(
            friction / float(size[2]),
            _COEFFICIENTS,
            "",
            source,
            f"{'arm in m, or ' * is_torque}force units: friction coefficient",
        )


def _inside(value: float, limits: tuple[float, float], unit: str, source: str, what: str) -> None:
    low, high = limits
    if not low <= value <= high:
        raise RecordError(
            source,
            f"{what} {value:.4g} {unit}".rstrip()
            + f", plausible are {low:g} to {high:g}: wrong unit?",
            ("units", "check_units"),
        )


def _check_folding(run: Recording) -> None:
    """Refuse an angle over which friction repeats with the turns of another unit only."""
    stride = max(1, len(run) // _FOLDED)
    angle, signal = run.angle[::stride], run.readings[::stride, 0]
    largest = float(np.abs(signal).max())
    if largest == 0.0 or np.ptp(signal / largest) == 0.0:
        return
    signal = signal / largest  # squares of readings beyond 1e154 would overflow
    left, degree = 1.0 - _explained(angle, signal), math.pi / 180.0
    for factor, told in ((degree, "degrees"), (1.0 / degree, "radians"), (_TURN, "turns")):
        if np.ptp(angle) * factor < _TURNS * _TURN:
            continue
        explained = _explained(angle * factor, signal)
        if explained > _MUCH and 1.0 - explained < _LEFT * left:
            raise RecordError(
                run.source,
                f"angle: friction repeats as if it were given in {told}: wrong unit?",
                ("units", "check_units"),
            )


def _explained(angle: Array, signal: Array) -> float:
    """Return the share of the variance that the mean over turns explains."""
    cell = np.floor(angle * (_BINS / _TURN)).astype(np.int64) % _BINS
    count = np.maximum(np.bincount(cell, minlength=_BINS), 1)
    mean = np.bincount(cell, signal, _BINS) / count
    left = signal - mean[cell]
    # Each bin takes one degree of freedom.
    share = float(left @ left) / float(((signal - signal.mean()) ** 2).sum())
    return 1.0 - share * len(signal) / max(len(signal) - _BINS, 1)
