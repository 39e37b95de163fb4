"""Pieces of one record go on with the turns and strokes in which they were cut."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import replace
from itertools import pairwise

import numpy as np

from asperity._base.arrays import Array
from asperity.errors import RecordError
from asperity.identify.forces.strokes import LACKING, Strokes, strokes_of
from asperity.identify.records.record import Recording, goes_back
from asperity.identify.records.sliding.stretches import stretches

_TURN = 2.0 * math.pi
# A motion goes on after a gap that is no longer than this part of its longest stretch, or so many
# samples, and in which it turns by no more than this angle.
_GAP, _SAMPLES = 0.2, 10
_BEND = math.radians(20.0)


def strokes_of_all(runs: Sequence[Recording]) -> list[Strokes]:
    """Return the turns or strokes of recordings, numbered over all of them.

    Pieces of one record count together. A turn that a defect interrupts is complete if it lacks no
    more than a few degrees. A stroke that goes on in the next recording, on the same clock, is one
    stroke.
    """
    swinging = _swinging(runs)
    found: list[Strokes] = []
    refused: dict[str, RecordError] = {}
    while len(found) < len(runs):
        at = len(found)
        kind = _kind(runs, at, swinging)
        goes_on = {"disk": _turns_on, "swing": _swings_on, "stage": _slides_on}[kind]
        end = at + 1
        while (
            end < len(runs)
            and _kind(runs, end, swinging) == kind
            and runs[end].time[0] > runs[end - 1].time[-1]
            and goes_on(runs[end - 1], runs[end])
        ):
            end += 1
        group = runs[at:end]
        if kind == "disk":
            alone = [strokes_of(run) for run in group]
            found += alone if len(group) == 1 else _renumbered(group, alone)
            continue
        try:
            found += _shared(group, swings=kind == "swing")
        except RecordError as error:
            # A piece may have no stroke where others have some.
            refused.setdefault(group[0].file, error)
            for run in group:
                none = np.full(len(run), -1, dtype=np.int32)
                found.append(Strokes(none, 0, np.zeros(len(run)), 0.5 / run.duration))
    _refuse_without(runs, found, refused)
    found = _paced(runs, found)
    before = np.cumsum([0, *(one.count for one in found)])
    return [
        replace(one, number=np.where(one.number >= 0, one.number + first, -1).astype(np.int32))
        for one, first in zip(found, before, strict=False)
    ]


def _refuse_without(
    runs: Sequence[Recording], found: Sequence[Strokes], refused: dict[str, RecordError]
) -> None:
    """Refuse files of which no piece has a stroke."""
    for run, one in zip(runs, found, strict=True):
        if one.number.max() >= 0:
            refused.pop(run.file, None)
    for error in refused.values():
        raise error


def _paced(runs: Sequence[Recording], strokes: Sequence[Strokes]) -> list[Strokes]:
    """Return strokes whose rate is that of all pieces of a file: a piece may be short."""
    found = list(strokes)
    for file in {run.file for run in runs if run.source != run.file}:
        at = [
            k
            for k, run in enumerate(runs)
            if run.file == file and isinstance(strokes[k].turned, np.ndarray)
        ]
        if at:
            lasts = sum(runs[k].duration for k in at)
            rate = 0.5 * max(sum(strokes[k].count for k in at), 1) / lasts
            for k in at:
                found[k] = replace(strokes[k], rate=rate)
    return found


def _swinging(runs: Sequence[Recording]) -> list[bool]:
    """Return of which recordings the disk turns back, or does so in other pieces of a record."""
    pieces: dict[str, list[Recording]] = {}
    for run in runs:
        if run.velocity is None and run.source != run.file:
            pieces.setdefault(run.file, []).append(run)
    back = {run.file for run in runs if run.velocity is None and run.turns_back}
    back |= {file for file, some in pieces.items() if goes_back(some)}
    # Less than a turn, without a turn in all of its file, is a part of a stroke.
    turning = {run.file for run in runs if run.velocity is None and abs(run.turns) >= 1.0}
    return [
        run.velocity is None
        and (run.turns_back or (run.file in back) or (bool(back) and run.file not in turning))
        for run in runs
    ]


def _kind(runs: Sequence[Recording], at: int, swinging: Sequence[bool]) -> str:
    if runs[at].velocity is not None:
        return "stage"
    return "swing" if swinging[at] else "disk"


def _turns_on(before: Recording, run: Recording) -> bool:
    """Return whether two recordings are neighbouring pieces of one file of a disk."""
    return (
        before.source != before.file == run.file != run.source
        and before.turns * run.turns > 0.0
        and (run.angle[0] - before.angle[-1]) * before.turns > 0.0
    )


def _swings_on(before: Recording, run: Recording) -> bool:
    """Return whether an oscillation of a disk goes on in the next recording."""
    most = max(float(np.ptp(one.angle)) for one in (before, run))
    near = abs(float(run.angle[0] - before.angle[-1])) < max(_GAP * most, _BEND)
    return near and _gap(before, run) <= max(_SAMPLES, _GAP * max(len(before), len(run)))


def _slides_on(before: Recording, run: Recording) -> bool:
    """Return whether the motion of a stage goes on in the next recording."""
    longest, rate = 0, 0.0
    for one in (before, run):
        assert one.velocity is not None
        if not one.velocity.any():
            continue
        number = stretches(one.velocity)
        if number.max() < 0:
            continue
        size = np.bincount(number[number >= 0])
        rows = np.flatnonzero(number == int(size.argmax()))
        longest = max(longest, rows.size)
        turned = np.unwrap(np.arctan2(one.velocity[rows, 1], one.velocity[rows, 0]))
        rate = max(rate, float(np.ptp(turned)) / rows.size)
    gap = _gap(before, run)
    return (
        before.angle[-1] == run.angle[0]
        and gap <= max(_SAMPLES, _GAP * longest)
        and gap * rate < _BEND
    )


def _gap(before: Recording, run: Recording) -> float:
    """Return how many samples are between two recordings, 1 if none is missing."""
    return float(run.time[0] - before.time[-1]) * before.sample_rate


def _shared(runs: Sequence[Recording], *, swings: bool) -> list[Strokes]:
    """Return the strokes of a record that was cut, as if its gaps were filled by straight lines."""
    if len(runs) == 1:
        return [strokes_of(runs[0], swings=swings)]
    step = 1.0 / runs[0].sample_rate
    times, rows = [runs[0].time], [np.arange(len(runs[0]))]
    past = len(runs[0])
    for before, run in pairwise(runs):
        missing = max(round(_gap(before, run)) - 1, 0)
        times += [before.time[-1] + step * np.arange(1, missing + 1), run.time]
        rows.append(past + missing + np.arange(len(run)))
        past += missing + len(run)
    time = np.concatenate(times)
    known = np.concatenate([run.time for run in runs])

    def filled(series: Callable[[Recording], Array]) -> Array:
        values = np.concatenate([series(run) for run in runs])
        columns = [np.interp(time, known, column) for column in values.reshape(len(known), -1).T]
        return np.stack(columns, axis=-1).reshape(len(time), *values.shape[1:])

    whole = Recording(
        # A gap need not be a whole number of samples.
        time[0] + step * np.arange(len(time)),
        angle=filled(lambda run: run.angle),
        readings=np.zeros((len(time), 3)),
        source=runs[0].file,
        velocity=None if swings else filled(lambda run: np.asarray(run.velocity)),
    )
    found = strokes_of(whole, swings=swings)
    assert isinstance(found.turned, np.ndarray)
    # All are counted with the last one.
    last = found.count
    return [
        replace(
            found, number=found.number[at], turned=found.turned[at], count=last * (run is runs[-1])
        )
        for run, at in zip(runs, rows, strict=True)
    ]


def _renumbered(runs: Sequence[Recording], strokes: Sequence[Strokes]) -> list[Strokes]:
    sign = math.copysign(1.0, runs[0].turns)
    start = float(runs[0].angle[0])
    last = runs[-1]
    step = abs(float(last.angle[-1] - last.angle[0])) / (len(last) - 1)
    whole = math.floor((sign * (float(last.angle[-1]) - start) + step) / _TURN + 1e-9)
    lacks = np.zeros(max(whole, 1))
    for before, after in pairwise(runs):
        # Turns share what lies between the last sample before a defect and the first after it.
        low, high = (sign * (one - start) for one in (before.angle[-1], after.angle[0]))
        for turn in range(int(low // _TURN), int(high // _TURN) + 1):
            if turn < lacks.size:
                lacks[turn] += min(high, (turn + 1) * _TURN) - max(low, turn * _TURN)
    number_of = np.full(lacks.size, -1, dtype=np.int32)
    kept = np.flatnonzero((lacks < LACKING) & (np.arange(lacks.size) < whole))
    number_of[kept] = np.arange(kept.size)
    found = []
    for run, old in zip(runs, strokes, strict=True):
        ahead = np.floor(sign * (run.angle - start) / _TURN + 1e-9).astype(np.int64)
        inside = (ahead >= 0) & (ahead < lacks.size)
        number = np.where(inside, number_of[np.clip(ahead, 0, lacks.size - 1)], -1)
        count = int(kept.size) if run is runs[-1] else 0
        found.append(Strokes(number.astype(np.int32), count, old.turned, old.rate))
    return found
