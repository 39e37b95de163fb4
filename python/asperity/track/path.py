"""The measured path, its velocity and acceleration."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike, NDArray

from asperity._base import arrays
from asperity._base.arrays import Array
from asperity._base.result import Axis, Series, Table, TableResult, counted
from asperity._base.value import Value
from asperity.errors import ParameterError
from asperity.track.cubics import local_cubics, noise, resting

_FEWEST = 7
# A frame belongs to a rest when it is nearer to its mean than this many standard errors; so many
# frames make a rest.
_AT_REST, _REST = 4.0, 3
# Of a body that a film shows until it stops, the last step is at most this share of the largest.
_LAST_STEP = 0.05


class MeasuredPath(TableResult, Value):
    """Positions over time with velocity, acceleration and their standard errors.

    Velocity and acceleration at a frame are those of the cubic that fits the frames within
    ± `bandwidth` with the least squares, weighted by (1 − (Δt/bandwidth)²)². Their standard errors
    follow from the scatter of the frames about these cubics, taken as independent and equal along
    the path. No cubic reaches over the onset of motion or of rest; where the acceleration jumps in
    between it is smoothed over the bandwidth, which `misfit` shows and the standard errors do not.

    Args:
        time: ascending, in s, shape ``(n,)``.
        position: in m, shape ``(n, 2)``; NaN where the mark was not seen.
        position_error: standard errors of the positions in m, shape ``(n, 2)``.
        bandwidth: half width of the window in s; default a tenth of the time in which the body
            moves, and at least 7 frames.
        section: time in s of the first and of the last frame in which it moves; default those that
            are further than 4 standard errors from the rest before and after.

    Attributes:
        seen: frames in which the mark was seen, shape ``(n,)``.
        velocity: in m/s, shape ``(n, 2)``; NaN where too few frames are near.
        velocity_error: its standard errors, shape ``(n, 2)``.
        acceleration: in m/s², shape ``(n, 2)``.
        acceleration_error: its standard errors, shape ``(n, 2)``.
        scatter: standard deviation of the positions about the cubics in m, shape ``(2,)``: the
            median over the frames.
        misfit: frames with a window that its cubic does not fit, shape ``(n,)``.
        comes_to_rest: whether the body is at rest in the end.

    >>> import numpy as np
    >>> t = np.linspace(0.0, 0.3, 151)
    >>> x = np.column_stack([1.5 * t - 2.5 * t**2, 0.5 * t])
    >>> path = MeasuredPath(t, x, np.full_like(x, 1e-5), bandwidth=0.02)
    >>> path.velocity[0].round(6).tolist()
    [1.5, 0.5]
    >>> bool(np.allclose(path.acceleration, [-5.0, 0.0], atol=1e-6))
    True
    """

    time: Array
    position: Array
    position_error: Array
    bandwidth: float
    seen: NDArray[np.bool_]
    velocity: Array
    velocity_error: Array
    acceleration: Array
    acceleration_error: Array
    scatter: Array
    section: tuple[float, float]
    misfit: NDArray[np.bool_]
    comes_to_rest: bool
    _end: Array

    _picture = "plot_history"
    _digits = 10

    def __init__(
        self,
        time: ArrayLike,
        position: ArrayLike,
        position_error: ArrayLike,
        *,
        bandwidth: float | None = None,
        section: tuple[float, float] | None = None,
    ) -> None:
        t = arrays.array(time, "time", (None,))
        x = _with_gaps(position, "position", len(t))
        error = _with_gaps(position_error, "position_error", len(t))
        if (np.diff(t) <= 0.0).any():
            raise ParameterError("time", "must ascend")
        seen = np.asarray(~np.isnan(x).any(axis=1))
        if seen.sum() < _FEWEST:
            raise ParameterError(
                "position",
                f"must hold at least {_FEWEST} frames with the mark, {seen.sum()} "
                f"{'has' if seen.sum() == 1 else 'have'} it",
            )
        limit = _told_apart(x[seen])
        moves = _section(section, t) if section is not None else _moving(t[seen], x[seen], limit)
        h = _usual(t[seen], moves) if bandwidth is None else _bandwidth(bandwidth, t[seen])
        self._set(
            time=t,
            position=x,
            position_error=error,
            bandwidth=h,
            section=moves,
        )
        bounds = np.array([np.searchsorted(t, moves[0]), np.searchsorted(t, moves[1], "right")])
        derived = local_cubics(t, x, h, bounds)
        first, place = resting(x[seen], limit)
        self._keep(
            seen=seen,
            comes_to_rest=_rests(t, x, seen, len(x[seen]) - first, limit),
            _end=place,
            **{name: values for name, values in derived.items()},
        )

    def __len__(self) -> int:
        return len(self.time)

    def __repr__(self) -> str:
        return (
            f"<MeasuredPath: {len(self)} frames to t = {self.time[-1]:.9g} s, "
            f"{int(self.seen.sum())} with the mark, bandwidth {self.bandwidth:.3g} s>"
        )

    @property
    def end(self) -> Array:
        """Place (x₁, x₂) of rest in m: the mean of the last frames that cannot be told apart.

        Raises:
            ParameterError: if the body does not come to rest in view.
        """
        if not self.comes_to_rest:
            raise ParameterError("position", "does not come to rest in view: there is no end point")
        return self._end

    @property
    def onset(self) -> int:
        """Number of the first frame in which the body moves and is seen."""
        return int(np.flatnonzero(self.seen & (self.time >= self.section[0]))[0])

    @property
    def start(self) -> tuple[Array, Array]:
        """Position in m and velocity in m/s at the onset of motion, to start a simulation from.

        Raises:
            ParameterError: if no velocity is known there.
        """
        first = self.onset
        if np.isnan(self.velocity[first]).any():
            raise ParameterError(
                "position",
                f"must be known in more frames after t = {self.time[first]:.6g} s, where the "
                "motion begins: no velocity is known there",
            )
        return self.position[first], self.velocity[first]

    def summary(self) -> str:
        """Return how long and how far the body moves, in sentences."""
        first, last = self.section
        speed = float(np.nanmax(np.linalg.norm(self.velocity, axis=1), initial=0.0))
        steps = np.diff(self.position[self.seen], axis=0)
        length = float(np.linalg.norm(steps, axis=1).sum())
        rest = (
            "and comes to rest in view"
            if self.comes_to_rest
            else "but does not come to rest in view"
        )
        lines = [
            f"The mark is seen in {int(self.seen.sum())} of {counted(len(self), 'frame')}.",
            f"The body moves from t = {first:.6g} s to {last:.6g} s, {1e3 * length:.6g} mm at up "
            f"to {speed:.4g} m/s, {rest}.",
            f"Positions scatter by {1e6 * self.scatter[0]:.3g} and {1e6 * self.scatter[1]:.3g} µm "
            f"about cubics over ±{1e3 * self.bandwidth:.4g} ms.",
        ]
        if self.misfit.any():
            lines.append(f"In {counted(int(self.misfit.sum()), 'frame')} the cubic does not fit.")
        return "\n".join(lines)

    def _table(self) -> Table:
        series = {}
        for name, label, unit in (
            ("position", "x{}", "m"),
            ("position_error", "x{}_error", "m"),
            ("velocity", "v{}", "m/s"),
            ("velocity_error", "v{}_error", "m/s"),
            ("acceleration", "a{}", "m/s2"),
            ("acceleration_error", "a{}_error", "m/s2"),
        ):
            for k in (0, 1):
                values = getattr(self, name)[:, k]
                words = f"component {k + 1} of the {name.replace('_', ' ')}"
                series[label.format(k + 1)] = Series(values, ("t",), unit, words)
        return Table({"t": Axis(self.time, "s", "time")}, series, {"bandwidth": self.bandwidth})


def _with_gaps(value: ArrayLike, argument: str, length: int) -> Array:
    """Return an array (n, 2) that may hold NaN, in whole rows."""
    converted = np.array(arrays.with_gaps(value, argument, (length, 2)))
    missing = np.isnan(converted).any(axis=1)
    arrays.array(converted[~missing], argument)
    converted[missing] = np.nan
    return converted


def _told_apart(x: Array) -> float:
    """Return the distance in m from which two places are not the same."""
    least = 1e-9 * float(np.max(np.ptp(x, axis=0)))
    return max(_AT_REST * float(np.hypot(*noise(x))), least, float(np.finfo(float).tiny))


def _moving(t: Array, x: Array, limit: float) -> tuple[float, float]:
    """Return the times of the first and the last frame in which a body moves."""
    before = len(x) - resting(x[::-1], limit)[0]
    after = resting(x, limit)[0]
    first = before if before >= _REST else 0
    last = after - 1 if len(x) - after >= _REST else len(x) - 1
    if last - first < _FEWEST:
        first, last = 0, len(x) - 1
    return float(t[first]), float(t[last])


def _section(section: tuple[float, float], t: Array) -> tuple[float, float]:
    start, stop = arrays.array(section, "section", (2,)).tolist()
    if not t[0] <= start < stop <= t[-1]:
        raise ParameterError(
            "section", f"must ascend within {t[0]:.6g} and {t[-1]:.6g} s, got {start:g}, {stop:g}"
        )
    return start, stop


def _usual(seen: Array, section: tuple[float, float]) -> float:
    interval = float(np.median(np.diff(seen)))
    return max(0.1 * (section[1] - section[0]), _FEWEST * interval)


def _bandwidth(value: float, seen: Array) -> float:
    bandwidth = arrays.positive(value, "bandwidth")
    duration, interval = float(seen[-1] - seen[0]), float(np.median(np.diff(seen)))
    if not interval < bandwidth <= max(duration, _FEWEST * interval):
        raise ParameterError(
            "bandwidth",
            f"must be between the {interval:.3g} s from frame to frame and the {duration:.3g} s "
            f"in which the mark is seen, got {bandwidth:.3g}",
        )
    return bandwidth


def _rests(t: Array, x: Array, seen: NDArray[np.bool_], frames: int, limit: float) -> bool:
    """Return whether a body rests in the last frames, or a film ends with its stop."""
    if frames >= _REST or not seen[-1]:
        return frames >= _REST
    speeds = np.hypot(*np.diff(x[seen], axis=0).T) / np.diff(t[seen])
    return bool(speeds[-1] <= _LAST_STEP * float(np.percentile(speeds, 90.0)))
