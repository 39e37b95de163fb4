"""What makes the pin slide: a disk that turns, or a stage that moves along a line or in a plane."""

from __future__ import annotations

import math
from collections.abc import Collection, Mapping, Sequence

import numpy as np

from asperity._base.arrays import Array
from asperity.errors import ParameterError, RecordError
from asperity.identify.records.sliding.slopes import WORST, Slopes, slopes
from asperity.identify.records.tables.headings import FORCES, MOTION, POSITIONS

# Positions go on after no more than so many missing samples.
_LONGEST = 100
# How a stage may be said to move, by columns.
_STAGES = (
    ("velocity",),
    ("position",),
    ("velocity_x", "velocity_y"),
    ("position_x", "position_y"),
)


def motion_columns(given: Collection[str]) -> tuple[str, ...]:
    """Return the columns from which the sliding follows, of those that are named.

    Raises:
        ParameterError: if they are those of two kinds of motion, or one of a pair is missing.
    """
    named = tuple(name for name in MOTION if name in given)
    if not named:
        rotation = "turn_rate" if "turn_rate" in given else "angle"
        if rotation == "turn_rate" and "angle" in given:
            raise ParameterError("columns", "must name angle or turn_rate, not both")
        if any(name in given for name in FORCES):
            raise ParameterError(
                "columns",
                "must name velocity_x and velocity_y, or position_x and position_y, for forces "
                "along x and y",
            )
        return (rotation,)
    if named not in _STAGES:
        pairs = "; ".join(" and ".join(stage) for stage in _STAGES)
        raise ParameterError("columns", f"must name one motion ({pairs}), got {', '.join(named)}")
    if "turn_rate" in given:
        raise ParameterError("columns", "must name a motion of the stage or turn_rate, not both")
    return named


def force_columns(given: Collection[str], motion: Sequence[str]) -> tuple[str, str]:
    """Return what the columns of the two horizontal channels are called."""
    if not any(name in given for name in FORCES):
        return "tangential", "radial"
    if any(name in given for name in ("tangential", "radial")):
        raise ParameterError("columns", "must name tangential and radial, or force_x and force_y")
    if len(motion) != 2:
        raise ParameterError("columns", "must name motions along x and y beside force_x, force_y")
    return FORCES


def velocity_of(
    series: Mapping[str, Array],
    motion: Sequence[str],
    *,
    where: Mapping[str, str | int],
    source: str,
) -> Array:
    """Return the velocity of sliding along the channels in m/s, ``(n, 2)``.

    What is missing in positions is filled by straight lines: rows without a number are to be left
    out.

    Raises:
        RecordError: if positions are too coarse to tell it.
    """
    parts = [series[name] for name in motion]
    if motion[0] not in POSITIONS:
        return np.stack([*parts, np.zeros_like(parts[0])][:2], axis=-1)
    known = np.isfinite(series["time"]) & np.isfinite(parts).all(axis=0)
    velocity = np.zeros((known.size, 2))
    rows = np.flatnonzero(known)
    if rows.size < 2:
        return velocity
    time, position = series["time"][rows], np.stack(parts, axis=-1)[rows]
    step = float(np.median(np.diff(time)))
    if not step > 0.0:
        return velocity
    cuts = np.flatnonzero(np.diff(time) > _LONGEST * step) + 1
    tried = [
        (one, _filled_slopes(position[one], time[one], step))
        for one in np.split(np.arange(rows.size), cuts)
        if one.size > 1
    ]
    longest = max((one.size for one, _ in tried), default=0)
    for one, found in tried:
        if found.error <= WORST:
            velocity[rows[one]] = found.velocity
        elif one.size == longest and np.ptp(position[one], axis=0).any():
            raise RecordError(source, _too_coarse(found, motion, where), ("columns",))
    return velocity


def _filled_slopes(position: Array, time: Array, step: float) -> Slopes:
    """Return the velocities of positions of which some samples may be missing."""
    # Times that are rounded do not rise by whole steps.
    at = np.cumsum(np.concatenate([[0], np.maximum(np.rint(np.diff(time) / step), 1.0)]))
    at = at.astype(np.intp)
    if at[-1] == at.size - 1:
        return slopes(position, time)
    grid = np.arange(at[-1] + 1)
    whole = np.stack([np.interp(grid, at, column) for column in position.T], axis=-1)
    found = slopes(whole, time[0] + step * grid)
    return found._replace(velocity=found.velocity[at])


def _too_coarse(found: Slopes, motion: Sequence[str], where: Mapping[str, str | int]) -> str:
    """Return what positions do not tell, and what would."""
    names = " and ".join(f"{where[name]!r} ({name})" for name in motion)
    # Steps alone make noise of their size over √12.
    own = found.noise > 0.5 * found.step
    steps = f"steps of {_length(found.step)}" if found.step else ""
    noise = f"noise of {_length(found.noise)}" if own else ""
    given = " and ".join(filter(None, (steps, noise)))
    told = (
        f"tell the velocity of strokes of {_length(found.stretch)} to {found.error:.0%} only"
        if math.isfinite(found.error)
        else "are not small beside its strokes and tell no velocity"
    )
    return (
        f"column {names}: {given} {told}: positions in finer steps, "
        "longer strokes or columns of velocities are needed"
    )


def _length(value: float) -> str:
    return f"{1e6 * value:.3g} µm" if value < 1e-3 else f"{1e3 * value:.3g} mm"
