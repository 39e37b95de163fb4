"""What makes the pin slide: a disk that turns, or a stage that moves along a line or in a plane."""

from __future__ import annotations

from collections.abc import Collection, Mapping, Sequence

import numpy as np

from asperity._base.arrays import Array
from asperity.errors import ParameterError
from asperity.identify.records.units import FORCES, MOTION, POSITIONS

# How a stage may be said to move, by columns.
_STAGES = (
    ("velocity",),
    ("position",),
    ("velocity_x", "velocity_y"),
    ("position_x", "position_y"),
)
# The speed that differences give shall be known to this part of the usual one.
_SHARE = 0.005
# Windows of differences shall be this many times shorter than what they follow.
_LONGEST = 40
# Of a normal distribution, the ratio of deviation and median distance.
_MEDIAN = 1.4826


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


def velocity_of(series: Mapping[str, Array], rows: slice, motion: Sequence[str]) -> Array:
    """Return the velocity of sliding along the channels in m/s, ``(n, 2)``."""
    parts = [series[name][rows] for name in motion]
    if motion[0] in POSITIONS:
        parts = list(_slopes(np.stack(parts, axis=-1), series["time"][rows]).T)
    if len(parts) == 1:
        parts.append(np.zeros_like(parts[0]))
    velocity = np.stack(parts, axis=-1)
    velocity.flags.writeable = False
    return velocity


def _slopes(position: Array, time: Array) -> Array:
    """Return velocities from local parabolas, as long as the noise of the positions asks for."""
    from scipy.signal import savgol_filter

    n = len(time)
    step = float(time[-1] - time[0]) / (n - 1)
    if n < 5:
        return np.gradient(position, step, axis=0)
    # Third differences of a motion are small beside those of noise, whose variance is 20 σ².
    rough = np.diff(position, 3, axis=0)
    noise = _MEDIAN * float(np.median(np.abs(rough), axis=0).max()) / np.sqrt(20.0)
    speed = float(np.median(np.hypot.reduce(np.diff(position, axis=0), axis=-1)))
    # A line through w samples has a slope with the standard error σ √(12/w³).
    wanted = (12.0 * (noise / max(_SHARE * speed, 1e-300)) ** 2) ** (1.0 / 3.0)
    width = int(min(max(wanted, 5.0), max(n // _LONGEST, 5)))
    window = min(width + 1 - width % 2, n - 1 + n % 2)
    return np.asarray(savgol_filter(position, window, 2, deriv=1, delta=step, axis=0))
