"""A simulated path beside a measured one."""

from __future__ import annotations

from dataclasses import KW_ONLY
from typing import Any, Protocol, runtime_checkable

import numpy as np

from asperity._base import arrays
from asperity._base.arrays import Array
from asperity._base.result import Axis, Series, Table, TableResult, counted
from asperity._base.value import (
    AnyArray,
    Index,
    OptionalArray,
    Record,
    Vector,
    field,
)
from asperity.errors import ParameterError
from asperity.runs.run import Run
from asperity.status import Outcome

# Distances to the curve are found this many points at a time, to bound the memory.
_CHUNK = 256


@runtime_checkable
class TimedPath(Protocol):
    """What `compare_path` needs of a measured path, such as `track.MeasuredPath`."""

    @property
    def time(self) -> Array:
        """Times in s, shape ``(n,)``."""

    @property
    def position(self) -> Array:
        """Positions in m, shape ``(n, 2)``; NaN where there is none."""


class PathComparison(TableResult, Record):
    """Differences of a simulated and a measured path at the measured times; arrays are read-only.

    Attributes:
        time: measured times that the simulation covers, in s, shape ``(n,)``.
        simulated: positions of the simulation at these times in m, shape ``(n, 2)``.
        measured: measured positions in m, shape ``(n, 2)``.
        position_error: standard deviations of the measured positions in m, shape ``(n, 2)``; or
            ``None``.
        deviation: distances of the measured points from the simulated curve, whenever it is there,
            in m, shape ``(n,)``.
        left_out: number of measured points without position or outside the simulated time.
    """

    time: Vector
    simulated: AnyArray
    measured: AnyArray
    _: KW_ONLY
    position_error: OptionalArray = field(default=None)
    deviation: AnyArray
    left_out: Index = 0

    def _complete(self, given: dict[str, Any]) -> None:
        count = len(given["time"])
        for name in ("simulated", "measured", "position_error"):
            if given[name] is not None:
                given[name] = arrays.array(given[name], name, (count, 2))
        given["deviation"] = arrays.array(given["deviation"], "deviation", (count,))

    def __len__(self) -> int:
        return len(self.time)

    def __repr__(self) -> str:
        return (
            f"<PathComparison: {len(self)} points, rms {1e3 * self.rms:.4g} mm, "
            f"largest {1e3 * self.largest:.4g} mm, ends {1e3 * self.end_distance:.4g} mm apart>"
        )

    @property
    def difference(self) -> Array:
        """Simulated minus measured position at equal times in m, shape ``(n, 2)``."""
        return self.simulated - self.measured

    @property
    def distance(self) -> Array:
        """Distance of the positions at equal times in m, shape ``(n,)``."""
        return np.linalg.norm(self.difference, axis=1)

    @property
    def rms(self) -> float:
        """Root mean square of the distances at equal times in m."""
        return float(np.sqrt(np.mean(self.distance**2)))

    @property
    def largest(self) -> float:
        """Largest distance at equal times in m."""
        return float(self.distance.max())

    @property
    def end_difference(self) -> Array:
        """Simulated minus measured last position in m, shape ``(2,)``."""
        return self.difference[-1]

    @property
    def end_distance(self) -> float:
        """Distance of the last positions in m."""
        return float(self.distance[-1])

    @property
    def lengths(self) -> tuple[float, float]:
        """Lengths of the simulated and the measured path through these points in m."""
        simulated, measured = (
            float(np.linalg.norm(np.diff(points, axis=0), axis=1).sum())
            for points in (self.simulated, self.measured)
        )
        return simulated, measured

    @property
    def normalised_rms(self) -> float:
        """Root mean square of the differences in units of their standard deviations.

        1 if nothing but the stated errors separates the paths; NaN if there are none.
        """
        if self.position_error is None:
            return float("nan")
        return float(np.sqrt(np.mean((self.difference / self.position_error) ** 2)))

    def summary(self) -> str:
        """Return how far the paths are from each other, in sentences."""
        simulated, measured = (1e3 * length for length in self.lengths)
        lines = [
            f"{counted(len(self), 'point')} were compared, {self.left_out} left out.",
            f"At equal times the paths are {1e3 * self.rms:.6g} mm apart (root mean square), at "
            f"most {1e3 * self.largest:.6g} mm, at the end {1e3 * self.end_distance:.6g} mm.",
            f"Measured points are at most {1e3 * self.deviation.max():.6g} mm from the simulated "
            "curve, whenever it is there.",
            f"The simulated path is {simulated:.6g} mm long, the measured one {measured:.6g} mm.",
        ]
        if self.position_error is not None:
            lines.append(
                f"The differences are {self.normalised_rms:.4g} times the standard errors of the "
                "measured positions (root mean square)."
            )
        return "\n".join(lines)

    def _table(self) -> Table:
        parts = {
            "simulated": (self.simulated, "simulated position"),
            "measured": (self.measured, "measured position"),
            "difference": (self.difference, "simulated minus measured position"),
        }
        if self.position_error is not None:
            parts["position_error"] = self.position_error, "standard error of the measured position"
        axes = {
            "t": Axis(self.time, "s", "measured time"),
            "coordinate": Axis(("x1", "x2"), "", "coordinate"),
        }
        series = {
            name: Series(values, ("t", "coordinate"), "m", words)
            for name, (values, words) in parts.items()
        }
        words = "distance of the measured point from the simulated curve"
        series["deviation"] = Series(self.deviation, ("t",), "m", words)
        return Table(axes, series, {"left_out": self.left_out, "rms": self.rms})


def compare_path(
    run: Run,
    measured: TimedPath | Run,
    *,
    time_offset: float = 0.0,
) -> PathComparison:
    """Compare a simulated path with a measured one, point by point.

    The simulation is interpolated by cubic Hermite polynomials; after a run that ended at rest it
    stays where it is. Measured points without position or outside the run are left out and counted.

    Args:
        run: of a point or disk that slides; its first two coordinates and velocities are used.
        measured: a path with `time`, `position` and, if known, `position_error`; or another run.
        time_offset: measured time at which the simulated time is zero, in s.

    Returns:
        The comparison.

    Raises:
        ParameterError: if nothing can be compared.

    Reference: [WL19] §5.3, Fig. 27.

    >>> from asperity import FrictionLaw, SlidingPoint, compare_path, simulate
    >>> options = {"dt": 1e-4, "t_end": 1.0, "u0": [1.0, 0.0], "until_rest": True}
    >>> first, second = (
    ...     simulate(SlidingPoint(1.0, law=FrictionLaw.isotropic(mu)), **options)
    ...     for mu in (0.5, 0.4)
    ... )
    >>> round(1e3 * compare_path(first, second).end_distance, 2)  # mm
    25.48
    """
    t, position, error = _samples(measured)
    if not isinstance(run, Run) or min(run.q.shape[1], run.u.shape[1]) < 2:
        raise ParameterError("run", f"must be a run with two coordinates, got {run!r}")
    if not len(run):
        raise ParameterError("run", "must hold a sample, it has none")
    local = t - arrays.number(time_offset, "time_offset")
    rounding = 1e-9 * (run.t[-1] - run.t[0])
    inside = local >= run.t[0] - rounding
    if run.status is not Outcome.AT_REST:
        inside &= local <= run.t[-1] + rounding
    known = inside & np.isfinite(position).all(axis=1)
    if error is not None:
        known &= (error > 0.0).all(axis=1)
    if not known.any():
        raise ParameterError("measured", "has no position within the time of the run")
    return PathComparison(
        t[known],
        hermite(run.t, run.q[:, :2], run.u[:, :2], local[known]),
        position[known],
        position_error=None if error is None else error[known],
        deviation=_from_curve(run.q[:, :2], position[known]),
        left_out=int((~known).sum()),
    )


def _samples(measured: TimedPath | Run) -> tuple[Array, Array, Array | None]:
    if isinstance(measured, Run):
        return measured.t, measured.q[:, :2], None
    arrays.of_kind(measured, "measured", TimedPath, "a path with time and position")
    t = arrays.array(measured.time, "measured.time", (None,))
    if (np.diff(t) <= 0.0).any():
        raise ParameterError("measured.time", "must ascend")
    position = np.asarray(measured.position, dtype=float)
    arrays.check_shape(position, "measured.position", (len(t), 2))
    error = getattr(measured, "position_error", None)
    if error is None:
        return t, position, None
    return t, position, np.broadcast_to(np.asarray(error, dtype=float), position.shape)


def hermite(t: Array, q: Array, u: Array, times: Array) -> Array:
    """Return positions between samples by cubics; before the first and after the last, those."""
    if len(t) < 2:
        return np.repeat(q, len(times), axis=0)
    clipped = np.clip(times, t[0], t[-1])
    k = np.clip(np.searchsorted(t, clipped, side="right") - 1, 0, len(t) - 2)
    step = t[k + 1] - t[k]
    # Samples at one time, before and after an event, leave a step of zero.
    s = ((clipped - t[k]) / np.where(step > 0.0, step, 1.0))[:, None]
    step = step[:, None]
    start = (1.0 + 2.0 * s) * (1.0 - s) ** 2 * q[k] + s * (1.0 - s) ** 2 * step * u[k]
    end = s**2 * (3.0 - 2.0 * s) * q[k + 1] + s**2 * (s - 1.0) * step * u[k + 1]
    return start + end


def _from_curve(curve: Array, points: Array) -> Array:
    """Return the distances of points from a polyline."""
    tails, edges = curve[:-1], np.diff(curve, axis=0)
    squares = np.maximum(np.sum(edges**2, axis=1), np.finfo(float).tiny)
    nearest = np.empty(len(points))
    for first in range(0, len(points), _CHUNK):
        offset = points[first : first + _CHUNK, None] - tails
        share = np.clip(np.sum(offset * edges, axis=2) / squares, 0.0, 1.0)
        away = np.linalg.norm(offset - share[..., None] * edges, axis=2)
        nearest[first : first + _CHUNK] = away.min(axis=1)
    return nearest
