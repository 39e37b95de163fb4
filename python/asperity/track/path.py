"""The measured path, its velocity and acceleration."""

from __future__ import annotations

import os

import numpy as np
from numpy.typing import ArrayLike, NDArray

from asperity import _arrays
from asperity._arrays import Array
from asperity._files import atomic
from asperity._value import Value
from asperity.errors import DimensionError, ParameterError

_DEGREE = 3
_FEWEST = 7
# A frame belongs to the rest when it is nearer to the last one than this many standard errors.
_AT_REST = 4.0


class MeasuredPath(Value):
    """Positions over time with velocity, acceleration and their standard errors.

    Velocity and acceleration at a frame are those of the cubic that fits the frames within
    ± `bandwidth` with the least squares, weighted by (1 − (Δt/bandwidth)²)². Their standard errors
    follow from the scatter of the frames about these cubics, taken as independent and equal along
    the path. Where the acceleration jumps, as at rest, they are smoothed over the bandwidth, which
    the standard errors do not contain.

    Args:
        time: ascending, in s, shape ``(n,)``.
        position: in m, shape ``(n, 2)``; NaN where the mark was not seen.
        position_error: standard errors of the positions in m, shape ``(n, 2)``.
        bandwidth: half width of the window in s; default a tenth of the time in which the mark
            was seen, and at least 7 frames.

    Attributes:
        seen: frames in which the mark was seen, shape ``(n,)``.
        velocity: in m/s, shape ``(n, 2)``; NaN where too few frames are near.
        velocity_error: its standard errors, shape ``(n, 2)``.
        acceleration: in m/s², shape ``(n, 2)``.
        acceleration_error: its standard errors, shape ``(n, 2)``.
        scatter: standard deviation of the positions about the cubics in m, shape ``(2,)``: the
            median over the frames.

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

    def __init__(
        self,
        time: ArrayLike,
        position: ArrayLike,
        position_error: ArrayLike,
        *,
        bandwidth: float | None = None,
    ) -> None:
        t = _arrays.array(time, "time", (None,))
        x = _with_gaps(position, "position", len(t))
        error = _with_gaps(position_error, "position_error", len(t))
        if (np.diff(t) <= 0.0).any():
            raise ParameterError("time", "must ascend")
        seen = np.asarray(~np.isnan(x).any(axis=1))
        if seen.sum() < _FEWEST:
            raise ParameterError(
                "position", f"must hold at least {_FEWEST} frames, {seen.sum()} are no NaN"
            )
        if bandwidth is None:
            bandwidth = _usual(t[seen])
        self._set(
            time=_arrays.read_only(t),
            position=_arrays.read_only(x),
            position_error=_arrays.read_only(error),
            bandwidth=_arrays.positive(bandwidth, "bandwidth"),
        )
        derived = _derivatives(t, x, seen, bandwidth)
        self._keep(
            seen=_arrays.read_only(seen),
            **{name: _arrays.read_only(values) for name, values in derived.items()},
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
        """Last position (x₁, x₂) in m: the mean of the last frames that cannot be told apart."""
        x = self.position[self.seen]
        limit = _AT_REST * max(float(np.hypot(*self.scatter)), float(np.finfo(float).tiny))
        away = np.flatnonzero(np.hypot(*(x - x[-1]).T) > limit)
        end: Array = x[away[-1] + 1 if len(away) else 0 :].mean(axis=0)
        return end

    @property
    def start(self) -> tuple[Array, Array]:
        """First position in m and the velocity there in m/s, as a simulation may start from."""
        first = int(np.flatnonzero(self.seen)[0])
        return self.position[first], self.velocity[first]

    def to_csv(self, path: str | os.PathLike[str]) -> None:
        """Write a table with one row per frame; the header holds names and units."""
        names = {
            "position": "x{} [m]",
            "position_error": "x{}_error [m]",
            "velocity": "v{} [m/s]",
            "velocity_error": "v{}_error [m/s]",
            "acceleration": "a{} [m/s2]",
            "acceleration_error": "a{}_error [m/s2]",
        }
        header = ["t [s]", *(title.format(i) for title in names.values() for i in (1, 2))]
        table = np.column_stack([self.time, *(getattr(self, name) for name in names)])
        with atomic(path) as file:
            np.savetxt(
                file, table, fmt="%.10g", delimiter=",", header=",".join(header), comments=""
            )


def _with_gaps(value: ArrayLike, argument: str, length: int) -> Array:
    """Return an array (n, 2) that may hold NaN, in whole rows."""
    converted = np.array(value, dtype=np.float64)
    if converted.shape != (length, 2):
        raise DimensionError(argument, f"must have shape ({length}, 2), got {converted.shape}")
    missing = np.isnan(converted).any(axis=1)
    _arrays.array(converted[~missing], argument)
    converted[missing] = np.nan
    return converted


def _usual(seen: Array) -> float:
    interval = float(np.median(np.diff(seen)))
    return max(0.1 * float(seen[-1] - seen[0]), _FEWEST * interval)


def _derivatives(t: Array, x: Array, seen: NDArray[np.bool_], bandwidth: float) -> dict[str, Array]:
    """Fit a cubic around every frame, with the part of its window that has been seen."""
    count = len(t)
    slopes, gains = np.full((count, 2, 2), np.nan), np.full((count, 2), np.nan)
    variances = []
    times, places = t[seen], x[seen]
    low = np.searchsorted(times, t - bandwidth, side="right")
    high = np.searchsorted(times, t + bandwidth, side="left")
    for i in np.flatnonzero(seen & (high - low > _DEGREE + 1)):
        near = slice(low[i], high[i])
        offset = (times[near] - t[i]) / bandwidth
        weight = 1.0 - offset**2
        powers = offset[:, None] ** np.arange(_DEGREE + 1)
        # Coefficients = smoother @ positions.
        smoother = np.linalg.pinv(powers * weight[:, None]) * weight
        coefficients = smoother @ places[near]
        slopes[i] = coefficients[1] / bandwidth, 2.0 * coefficients[2] / bandwidth**2
        gains[i] = np.sqrt((smoother[1:3] ** 2).sum(axis=1)) * [1.0 / bandwidth, 2.0 / bandwidth**2]
        residual = places[near] - powers @ coefficients
        # E Σ w² r² / σ² is the trace of W² (I − P S)(I − P S)ᵀ.
        left = np.eye(len(offset)) - powers @ smoother
        variances.append(weight**2 @ residual**2 / (weight**2 @ (left**2).sum(axis=1)))
    # Not the mean: cubics do not fit where the body comes to rest.
    scatter = np.sqrt(np.median(variances, axis=0)) if variances else np.full(2, np.nan)
    errors = gains[:, :, None] * scatter
    return {
        "velocity": slopes[:, 0],
        "velocity_error": errors[:, 0],
        "acceleration": slopes[:, 1],
        "acceleration_error": errors[:, 1],
        "scatter": scatter,
    }
