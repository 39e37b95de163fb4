"""Friction forces that were recorded without their sign, where the motion goes there and back."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from asperity._base.arrays import Array
from asperity.errors import RecordError
from asperity.identify.forces.strokes import Strokes
from asperity.identify.records.record import RawData
from asperity.identify.records.sliding.stretches import rows_of

# Mean forces there and back that differ by less than the first part of them are one force without
# its sign, if it goes below the second part at reversals; else it may be an error of the zero, and
# they are to differ by less than the third.
_SAME, _LOW, _EQUAL = 0.5, 0.5, 0.02
# It would change its sign if it went so far, relative to its mean, beyond zero.
_NOISE = 0.2
# A pin that sticks has a force that rises over the stroke, by more than six times this part.
_RISE = 0.15
# Strokes along the tangential channel, by the cosine of the angle between them.
_ALONG = 0.9


def refuse_rectified(raw: RawData, forces: list[Array], strokes: list[Strokes]) -> None:
    """Refuse runs whose force along the tangential axis is the same there and back.

    Args:
        raw: the runs.
        forces: of each of them in N along the tangential axis, without the zero.
        strokes: of each of them.

    Raises:
        RecordError: naming what makes the force change its sign.
    """
    for run, force, one in zip(raw.recordings, forces, strokes, strict=True):
        if isinstance(one.turned, float):
            continue
        way = np.cos(one.turned)
        there, back = (_mean(force, (one.number >= 0) & at) for at in (way > _ALONG, way < -_ALONG))
        if not there * back > 0.0:
            continue
        size = 0.5 * (there + back)
        relative = force / size
        # A force that does not change at all is that of a sensor that is not connected.
        if relative.min() < -_NOISE or np.ptp(relative) == 0.0:
            continue
        if abs(_rise(relative, np.where(way > _ALONG, one.number, -1))) > _RISE:
            continue
        if abs(there - back) < abs(size) * (_SAME if relative.min() < _LOW else _EQUAL):
            remedy = (
                "rectified = true in [file] gives it the sign of the motion"
                if raw.one_channel
                else "record it with its sign; rectified = true in [file], with one_channel = "
                "true, gives it that of the motion"
            )
            raise RecordError(
                run.file,
                f"tangential: is {there:.4g} N there and {back:.4g} N back: friction changes its "
                f"sign where the motion turns round. If it is the magnitude of the force, {remedy}",
                ("rectified",),
            )


def _rise(force: Array, number: NDArray[np.int32]) -> float:
    """Return the mean product of the force and of a way from −1 to 1 over each stroke."""
    parts = [
        force[rows] @ np.linspace(-1.0, 1.0, rows.size) / rows.size for rows in rows_of(number)
    ]
    return float(np.mean(parts))


def _mean(force: Array, rows: NDArray[np.bool_]) -> float:
    return float(force[rows].mean()) if rows.any() else 0.0
