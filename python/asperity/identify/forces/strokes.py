"""Which samples belong together: turns of a disk, strokes of what goes back and forth."""

from __future__ import annotations

import math
from dataclasses import dataclass
from itertools import pairwise
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from asperity._base.arrays import Array
from asperity.errors import RecordError
from asperity.identify.forces.turns import sense, turn_numbers
from asperity.identify.records.record import BACKLASH, Recording
from asperity.identify.records.sliding.slopes import WORST, slopes
from asperity.identify.records.sliding.stretches import (
    FEWEST,
    SLOW,
    rows_of,
    stretches,
    usual_speed,
)

_TURN = 2.0 * math.pi
# A stroke whose direction stays within this angle is straight: that of its fifths, in which noise
# of the motion is small.
_STRAIGHT = math.radians(2.0)
_FIFTHS = 5
# Of slow logs of a fast disk, turns are taken together for so many samples.
_SAMPLES = 4
LACKING = math.radians(5.0)
"""A turn that lacks more than this angle is no complete one."""


class Axes(NamedTuple):
    """How the axes of the sensor lie in the frame of the surface while it slides.

    Attributes:
        turns: whether they turn with the direction of sliding, as those of a pin on a disk.
        angle: from the direction of sliding to the tangential axis in rad if they do: 0, or π where
            the disk turns backwards; else from e₁.
    """

    turns: bool = True
    angle: float = 0.0

    def tangential(self, phi: Array) -> Array:
        """Return the tangential axis where the pin slides in directions φ, shape ``(n, 2)``."""
        angle = phi + self.angle if self.turns else np.full(phi.shape, self.angle)
        return np.stack([np.cos(angle), np.sin(angle)], axis=-1)


def on_axes(vectors: Array, tangential: Array) -> tuple[Array, Array]:
    """Return the components of vectors ``(..., n, 2)`` along the tangential axis and across it."""
    x, y = vectors[..., 0], vectors[..., 1]
    c, s = tangential[:, 0], tangential[:, 1]
    return c * x + s * y, c * y - s * x


@dataclass(frozen=True, eq=False)
class Strokes:
    """The turns or strokes of a recording.

    Attributes:
        number: of each sample, from 0; −1 outside of them; shape ``(n,)``.
        count: how many there are.
        turned: angle from the tangential axis to the direction of sliding, shape ``(n,)``, or one
            for all.
        rate: turns, or strokes there and back, per second.
    """

    number: NDArray[np.int32]
    count: int
    turned: Array | float
    rate: float


def strokes_of(run: Recording, *, swings: bool = False) -> Strokes:
    """Return the turns of a disk that turns one way, else the strokes.

    Args:
        run: a recording.
        swings: whether the disk turns back before or after it.
    """
    if run.velocity is not None:
        return _of_velocity(run, run.velocity)
    if swings or run.turns_back:
        return _of_oscillation(run)
    sign = sense(run)
    number = turn_numbers(run, sign)
    together = turns_together(run)
    if together > 1:
        complete = (int(number.max()) + 1) // together
        number = np.where(number < complete * together, number // together, -1).astype(np.int32)
    count = int(number.max()) + 1
    return Strokes(number, count, math.pi if sign < 0.0 else 0.0, run.turn_rate)


def turns_together(run: Recording) -> int:
    """Return how many turns of a disk count as one, so that this has a few samples."""
    return max(math.ceil(_SAMPLES * abs(run.turns) / len(run)), 1)


def _of_velocity(run: Recording, velocity: Array) -> Strokes:
    """Return the strokes of a stage, or the turns of one whose direction goes round."""
    if not velocity.any():
        raise RecordError(run.source, "the stage does not move")
    turned = np.arctan2(velocity[:, 1], velocity[:, 0])
    number = stretches(velocity)
    turned = _unwrapped(turned, number)
    going_round = _going_round(turned, number)
    if going_round is not None:
        number = going_round
    else:
        turned = _straightened(turned, number, velocity)
    return _checked(run, number, turned)


def _straightened(turned: Array, number: NDArray[np.int32], velocity: Array) -> Array:
    """Return directions that are the same all along a straight stroke.

    What the velocity does beside it there is noise of the motion. Taken for directions of sliding,
    it would seem to tell how the force changes with the direction, and bias the law.
    """
    straight = turned.copy()
    for rows in rows_of(number):
        along = velocity[rows].mean(axis=0)
        parts = np.stack([velocity[part].mean(axis=0) for part in np.array_split(rows, _FIFTHS)])
        off = np.arctan2(along[0] * parts[:, 1] - along[1] * parts[:, 0], parts @ along)
        if np.ptp(off) <= _STRAIGHT:
            way = math.atan2(along[1], along[0])
            # In the whole turn that the directions of the samples are in.
            straight[rows] = way + _TURN * np.rint((turned[rows[0]] - way) / _TURN)
    return straight


def _unwrapped(turned: Array, number: NDArray[np.int32]) -> Array:
    """Return directions that do not jump by whole turns within a stretch."""
    edges = np.flatnonzero(np.diff(number)) + 1
    return np.concatenate([np.unwrap(part) for part in np.split(turned, edges)])


def _going_round(turned: Array, number: NDArray[np.int32]) -> NDArray[np.int32] | None:
    """Return numbers of whole turns of the direction if one stretch makes most of the record."""
    if number.max() < 0:
        return None
    longest = int(np.bincount(number[number >= 0]).argmax())
    rows = np.flatnonzero(number == longest)
    if rows.size < 0.5 * number.size:
        return None
    angle = turned[rows]
    way = float(angle[-1] - angle[0])
    # Directions are known to a degree or so, and the last turn may seem to lack it.
    complete = math.floor((abs(way) * rows.size / (rows.size - 1) + LACKING) / _TURN)
    if not complete:
        return None
    ahead = np.floor((angle - angle[0]) * math.copysign(1.0, way) / _TURN + 1e-9)
    found = np.full(number.shape, -1, dtype=np.int32)
    found[rows] = np.where((ahead >= 0) & (ahead < complete), ahead, -1)
    return found


def _of_oscillation(run: Recording) -> Strokes:
    """Return the strokes of a disk that turns back and forth; whole turns of them, if any."""
    way = _from_turn_to_turn(run.angle)
    number = np.full(len(run), -1, dtype=np.int32)
    turned = np.zeros(len(run))
    found = slopes(run.angle[:, None], run.time)
    if not found.error <= WORST:
        raise RecordError(
            run.source,
            f"angle: its steps or noise of {math.degrees(max(found.step, found.noise)):.2g}° are "
            "not small beside the strokes: angles in finer steps or longer strokes are needed",
            ("columns",),
        )
    rate = found.velocity[:, 0]
    slow = SLOW * usual_speed(np.abs(rate))
    count = 0
    for start, stop in pairwise(way.tolist()):
        sign = math.copysign(1.0, run.angle[stop - 1] - run.angle[start])
        turned[start:stop] = 0.0 if sign > 0.0 else math.pi
        rows = start + np.flatnonzero(rate[start:stop] * sign > slow)
        if rows.size < FEWEST:
            continue
        ahead = np.abs(run.angle[rows] - run.angle[rows[0]]) / _TURN
        whole = math.floor(float(ahead[-1]) * rows.size / (rows.size - 1) + 1e-9)
        within = np.minimum(np.floor(ahead + 1e-9), 0 if whole == 0 else whole).astype(np.int32)
        number[rows] = np.where((within < whole) | (whole == 0), within + count, -1)
        count += max(whole, 1)
    return _checked(run, number, turned)


def _from_turn_to_turn(angle: Array) -> NDArray[np.intp]:
    """Return the rows where the disk turns back, with the first row and the number of rows."""
    edges, low, high, rising = [0], 0, 0, 0
    # Extremes count once the disk has turned back by more than it may shake.
    for row in _candidates(angle):
        if rising >= 0 and angle[row] > angle[high]:
            high = row
        if rising <= 0 and angle[row] < angle[low]:
            low = row
        if rising >= 0 and angle[high] - angle[row] > BACKLASH and high > edges[-1]:
            edges.append(high)
            rising, low = -1, row
        elif rising <= 0 and angle[row] - angle[low] > BACKLASH and low > edges[-1]:
            edges.append(low)
            rising, high = 1, row
        elif rising == 0 and abs(angle[row] - angle[0]) > BACKLASH:
            rising = 1 if angle[row] > angle[0] else -1
    return np.array([*edges, angle.size], dtype=np.intp)


def _candidates(angle: Array) -> NDArray[np.intp]:
    """Return the rows of local extremes, with the last row."""
    step = np.diff(angle)
    moving = np.flatnonzero(step)
    change = moving[1:][np.sign(step[moving[1:]]) != np.sign(step[moving[:-1]])]
    return np.append(change, angle.size - 1)


def _checked(run: Recording, number: NDArray[np.int32], turned: Array) -> Strokes:
    count = int(number.max()) + 1
    if not count:
        raise RecordError(
            run.source,
            f"has no stroke of {FEWEST} samples or more: is the motion noise, or its unit wrong?",
            ("columns", "units"),
        )
    turned.flags.writeable = number.flags.writeable = False
    return Strokes(number, count, turned, 0.5 * max(count, 1) / run.duration)
