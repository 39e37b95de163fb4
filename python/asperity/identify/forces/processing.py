"""From raw readings to forces over the sliding direction."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from types import EllipsisType

import numpy as np
from numpy.typing import ArrayLike, NDArray

from asperity._base import arrays
from asperity._base.arrays import Array
from asperity._base.log import log
from asperity._base.value import Value
from asperity.errors import ParameterError, RecordError
from asperity.identify.forces import filters, stated_errors
from asperity.identify.forces.averaged import Averaged
from asperity.identify.forces.lifted import loaded_strokes
from asperity.identify.forces.measured_sets import MeasuredSets
from asperity.identify.forces.pieces import strokes_of_all
from asperity.identify.forces.rectified import refuse_rectified
from asperity.identify.forces.strokes import Axes, Strokes
from asperity.identify.forces.turns import (
    TurnAverage,
    average_turns,
    bin_centres,
    bin_numbers,
    cells,
    full_bins,
)
from asperity.identify.forces.zero import Zero, shared_covariance, zeros_of
from asperity.identify.records.record import Processing, RawData

# Samples that are worked on at a time.
_CHUNK = 1 << 15
# Turns of all directions have samples in all of so many bins.
_ROUND = 24


class ProcessedData(Value):
    """Friction forces over the sliding direction, in the frame of the disk; made by `process`.

    Attributes:
        phi: angle φ of the sliding direction from e₁ in rad, not wrapped; shape ``(n,)``.
        force: −λ = R(φ)(λ_t, λ_r) in N, not filtered; shape ``(n, 2)``.
        normal_force: λ_N in N after the low-pass filter, shape ``(n,)``.
        turn: number of the turn of each sample, from 0 over all runs; −1 outside complete turns.
            Where the pin goes back and forth or along lines, of the stroke; −1 between strokes.
        lifted: number of strokes that are left out, as the pin is lifted in them.
        run: first sample of each run and the number of samples, shape ``(m + 1,)``.
        matrix: T, shape ``(3, 3)``.
        zero: mean reading without load in the middle of the runs, shape ``(3,)``.
        calibration_covariance: of the entries of T row by row, shape ``(9, 9)``; None where the
            error is neither known by a calibration nor stated. A given λ_N needs no third row.
        zero_covariance: shape ``(3, 3)``, or None where there are no records and nothing is stated.
        cut_off_frequency: of the normal force's filter for each run, in Hz; None without one, and
            where there is nothing above it in the samples.

    Reference: [WL19] (119), (120).
    """

    raw: RawData
    cut_off: float | None
    order: int
    grid_angle: float
    phi: Array
    force: Array
    normal_force: Array
    turn: NDArray[np.int32]
    lifted: int
    run: tuple[int, ...]
    matrix: Array
    zero: Array
    calibration_covariance: Array | None
    zero_covariance: Array | None
    cut_off_frequency: tuple[float | None, ...]
    _zeros: tuple[Zero, ...]
    _turned: tuple[Array | float, ...]
    _pressed: tuple[tuple[slice, ...] | None, ...]

    def __init__(
        self,
        raw: RawData,
        *,
        cut_off: float | EllipsisType | None = ...,
        order: int | EllipsisType = ...,
        grid_angle: float | EllipsisType = ...,
    ) -> None:
        arrays.of_kind(raw, "raw", RawData, "RawData")
        given = {"cut_off": cut_off, "order": order, "grid_angle": grid_angle}
        changes = {name: value for name, value in given.items() if value is not ...}
        done = raw.processing.replace(**changes)
        self._set(raw=raw, cut_off=done.cut_off, order=done.order, grid_angle=done.grid_angle)
        calibration = raw.calibration
        zeros = zeros_of(raw)
        lengths = [len(r) for r in raw.recordings]
        starts = np.concatenate([[0], np.cumsum(lengths)])
        strokes = strokes_of_all(raw.recordings)
        for run, one in zip(raw.recordings, strokes, strict=True):
            if isinstance(one.turned, float) and abs(run.turns) < 1e-3:
                raise RecordError(run.source, "angle: the disk does not turn")
        matrix = np.eye(3) if calibration is None else calibration.matrix
        weighed = (
            None
            if calibration is None
            else calibration.known_covariance(is_load_given=self.is_load_given)
        )
        self._keep(
            matrix=matrix,
            zero=np.average([z.mean for z in zeros], axis=0, weights=lengths),
            calibration_covariance=stated_errors.added(
                weighed, stated_errors.of_gains(raw, matrix)
            ),
            zero_covariance=stated_errors.added(
                shared_covariance(zeros, lengths), stated_errors.of_zeros(raw, matrix)
            ),
            run=tuple(int(start) for start in starts),
            cut_off_frequency=tuple(
                _cut_off(self.cut_off, one.rate, run.sample_rate)
                for run, one in zip(raw.recordings, strokes, strict=True)
            ),
            _zeros=zeros,
            _turned=tuple(one.turned for one in strokes),
        )
        _refuse_incomplete(raw, strokes)
        loaded = loaded_strokes(raw.recordings, strokes, lambda at: self._read(at, 2))
        if loaded.lifted:
            log.warning(
                "%d of %d strokes are left out: there the pin is lifted, λ_N is near zero",
                loaded.lifted,
                1 + max(int(one.number.max()) for one in strokes),
            )
        self._keep(lifted=loaded.lifted, _pressed=loaded.pressed)
        self._fill(self._sized(), loaded.strokes)
        along = [self._read(number, 0) for number in range(len(lengths))]
        refuse_rectified(raw, along, loaded.strokes)

    def _read(self, number: int, channel: int) -> Array:
        """Return the force of a channel of a run in N, without the zero, not filtered."""
        run, zero = self.raw.recordings[number], self._zeros[number]
        later = run.time - zero.middle
        line = self.matrix[channel]
        return np.asarray(run.readings @ line - line @ zero.mean - line @ zero.slope * later)

    def _sized(self) -> _Series:
        n = self.run[-1]
        return _Series(np.empty(n), np.empty((n, 2)), np.empty(n), np.empty(n, dtype=np.int32))

    def _fill(self, out: _Series, strokes: Sequence[Strokes]) -> None:
        for number, (run, one) in enumerate(zip(self.raw.recordings, strokes, strict=True)):
            rows = slice(self.run[number], self.run[number + 1])
            out.turn[rows] = one.number
            if isinstance(one.turned, float):
                np.add(run.angle, self.grid_angle + one.turned, out=out.phi[rows])
            else:
                np.add(run.angle, self.grid_angle, out=out.phi[rows])
                out.phi[rows] += one.turned
            self._forces(
                number, self.matrix, self._zeros[number], out.force[rows], out.normal[rows]
            )
        _refuse_lost_contact(self.raw, self.run, out, self._turned)
        for series in (out.phi, out.force, out.normal, out.turn):
            series.flags.writeable = False
        self._keep(phi=out.phi, force=out.force, normal_force=out.normal, turn=out.turn)

    def _forces(self, number: int, matrix: Array, zero: Zero, force: Array, normal: Array) -> None:
        """Write −λ (119) and λ_N of a run for a matrix T and a zero."""
        run = self.raw.recordings[number]
        offset, slope = matrix @ zero.mean, matrix @ zero.slope
        for first in range(0, len(run), _CHUNK):
            rows = slice(first, min(first + _CHUNK, len(run)))
            later = run.time[rows] - zero.middle
            along, across, pressing = (
                line @ run.readings[rows].T - (start + rate * later)
                for line, start, rate in zip(matrix, offset, slope, strict=True)
            )
            angle = run.angle[rows] + self.grid_angle
            c, s = np.cos(angle), np.sin(angle)
            force[rows, 0] = c * along - s * across
            force[rows, 1] = s * along + c * across
            normal[rows] = pressing
        if self.raw.normal_load is not None:
            normal[:] = self.raw.normal_load
        else:
            normal[:] = self._smooth(normal, number)

    def _smooth(self, signal: Array, number: int) -> Array:
        run, frequency = self.raw.recordings[number], self.cut_off_frequency[number]
        if frequency is None:
            return signal
        # Through lifting and putting down, a filter would spread them over the strokes beside them.
        pressed = self._pressed[number]
        smooth = np.array(signal)
        for rows in (slice(None),) if pressed is None else pressed:
            smooth[rows] = filters.low_pass(
                signal[rows], sample_rate=run.sample_rate, cut_off=frequency, order=self.order
            )
        return smooth

    def __repr__(self) -> str:
        turns = f"{self.turns} {'turns' if self.goes_round else 'strokes'}"
        turns += f" ({self.lifted} without load left out)" * (self.lifted > 0)
        return (
            f"<ProcessedData: {len(self.phi)} samples, {turns} of "
            f"{len(self.raw.recordings)} runs, λ_N = {_listed(self.loads)} N>"
        )

    @property
    def usual_load(self) -> float:
        """Mean λ_N in N over complete turns, or strokes, of all runs; see `loads`."""
        return float(self.normal_force[self.turn >= 0].mean())

    @cached_property
    def loads(self) -> tuple[float, ...]:
        """Mean λ_N in N over complete turns, or strokes, of each run that has some."""
        parts = [slice(*ends) for ends in zip(self.run, self.run[1:], strict=False)]
        used = [self.normal_force[part][self.turn[part] >= 0] for part in parts]
        return tuple(float(load.mean()) for load in used if load.size)

    @property
    def turns(self) -> int:
        """Number of complete turns, or of strokes."""
        return int(self.turn.max()) + 1

    @cached_property
    def goes_round(self) -> bool:
        """Whether each turn has all directions; else the pin goes along strokes."""
        if all(isinstance(one, float) for one in self._turned):
            return True
        used = self.turn >= 0
        cell = self.turn[used] * _ROUND + bin_numbers(self.phi[used], _ROUND)
        return bool(np.bincount(cell, minlength=self.turns * _ROUND).all())

    def axes(self, first: int, *, past: int) -> Axes:
        """Return how the axes of the sensor lie from sample ``first`` to ``past`` of one stroke."""
        first = arrays.count(first, "first", least=0)
        past = arrays.count(past, "past")
        if not first < past <= self.run[-1]:
            raise ParameterError("past", f"must lie behind {first} and within, got {past}")
        number = int(np.searchsorted(self.run, first, side="right")) - 1
        run, turned = self.raw.recordings[number], self._turned[number]
        if run.velocity is None:
            one = turned if isinstance(turned, float) else float(turned[first - self.run[number]])
            return Axes(True, -one)
        middle = (first + min(past, self.run[number + 1])) // 2 - self.run[number]
        return Axes(False, float(run.angle[middle]) + self.grid_angle)

    @property
    def used(self) -> int:
        """Number of samples in complete turns."""
        return int(np.count_nonzero(self.turn >= 0))

    @property
    def is_load_given(self) -> bool:
        """Whether λ_N is `RawData.normal_load` and nothing of it comes from readings."""
        return self.raw.normal_load is not None

    @property
    def time(self) -> Array:
        """Time t in s of each sample on the clock of its run, shape ``(n,)``."""
        return np.concatenate([run.time for run in self.raw.recordings])

    @cached_property
    def speed(self) -> Array:
        """Sliding speed ‖γ‖ in m/s, low-passed like the normal force, shape ``(n,)``.

        Speeds that were recorded stay as they are.
        """
        return np.concatenate([self._speed(number) for number in range(len(self.raw.recordings))])

    def _speed(self, number: int) -> Array:
        run, radius = self.raw.recordings[number], self.raw.radius
        if run.velocity is not None:
            return np.hypot(run.velocity[:, 0], run.velocity[:, 1])
        if radius is None:
            raise ParameterError("radius", "must be given in RawData for the sliding speed")
        return radius * self._angular_speed(number)

    def _angular_speed(self, number: int) -> Array:
        """Return that of the disk in rad/s, low-passed like the normal force."""
        run = self.raw.recordings[number]
        return self._smooth(np.abs(np.gradient(run.angle, 1.0 / run.sample_rate)), number)

    def perturbed(
        self, *, matrix: ArrayLike | None = None, zero: ArrayLike | None = None
    ) -> tuple[Array, Array]:
        """Return −λ and λ_N in N that another calibration or zero would have given.

        Args:
            matrix: T, shape ``(3, 3)``.
            zero: mean reading without load, shape ``(3,)``; its drift stays.

        Returns:
            Forces ``(n, 2)`` and normal forces ``(n,)``.
        """
        t = self.matrix if matrix is None else arrays.array(matrix, "matrix", (3, 3))
        shift = (self.zero if zero is None else arrays.array(zero, "zero", (3,))) - self.zero
        out = self._sized()
        for number in range(len(self.raw.recordings)):
            rows = slice(self.run[number], self.run[number + 1])
            zero_of = self._zeros[number]
            other = replace(zero_of, mean=zero_of.mean + shift)
            self._forces(number, t, other, out.force[rows], out.normal[rows])
        return out.force, out.normal

    def averaged(self, bins: int | None = None) -> Averaged:
        """Return the means of all complete turns in equal bins of the sliding direction.

        By default there are 720, or as many as hold samples. Of strokes, bins without samples are
        left out.
        """
        given = 720 if bins is None else arrays.count(bins, "bins", least=8)
        k = self.full_bins(720) if bins is None and self.goes_round else given
        return self._averaged(k, self.turn >= 0)

    def _averaged(self, k: int, used: NDArray[np.bool_]) -> Averaged:
        # Of 1, φ from the centre, l_t, l_p, λ_N.
        sums = np.zeros((5, k))
        for first in range(0, len(self.phi), _CHUNK):
            rows = first + np.flatnonzero(used[first : first + _CHUNK])
            phi = self.phi[rows]
            cell, within = cells(phi, k)
            parts = arrays.along_and_across(self.force[rows], phi)
            columns = (np.ones(rows.size), within, *parts, self.normal_force[rows])
            for row, column in enumerate(columns):
                sums[row] += np.bincount(cell, column, k)
        held = sums[0] > 0.0
        if not held.all() and self.goes_round:
            raise ParameterError("bins", f"must be fewer: of {k}, some hold no sample")
        count = sums[0, held]
        within, *resistance, normal = sums[1:, held] / count
        return Averaged(bin_centres(k)[held] + within, np.stack(resistance, axis=-1), normal, count)

    @cached_property
    def sets(self) -> MeasuredSets:
        """Points of bdry C and of D from the means in default bins, with their defects."""
        if self.raw.one_channel:
            raise ParameterError("one_channel", "tells no sets: the radial channel is not there")
        means = self.averaged()
        return MeasuredSets(means.phi, means.force / means.normal_force[:, None])

    def full_bins(self, most: int, *, each_turn: bool = False) -> int:
        """Return a number of bins up to `most` that all hold samples, of every turn if wanted."""
        return full_bins(self.phi, self.turn, arrays.count(most, "most", 8), each_turn=each_turn)

    def turn_averages(self, bins: int | None = None) -> dict[str, TurnAverage]:
        """Return l_t, l_p (per unit normal force), λ_N in N over each turn with confidence bands.

        By default in 360 bins, or as many as hold samples of every turn.
        """
        if bins is None:
            bins = self.full_bins(360, each_turn=True)
        return {
            name: average_turns(self.phi, values=values, turn=self.turn, bins=bins)
            for name, values in self._channels().items()
        }

    def stroke_means(self) -> dict[str, Array]:
        """Return the mean of l_t, l_p (per unit normal force) and λ_N in N of each stroke or turn.

        Each is of shape ``(m,)``, in the order of `turn`.
        """
        return self._stroke_means(self.turn >= 0)

    def _stroke_means(self, used: NDArray[np.bool_]) -> dict[str, Array]:
        number = self.turn[used]
        # A stroke without a sample that is used has no mean.
        with np.errstate(invalid="ignore"):
            count = np.bincount(number, minlength=self.turns)
            return {
                name: np.bincount(number, values[used], self.turns) / count
                for name, values in self._channels().items()
            }

    def _channels(self) -> dict[str, Array]:
        along, across = arrays.along_and_across(self.force, self.phi)
        # Between strokes the pin may be lifted.
        with np.errstate(divide="ignore", invalid="ignore"):
            return {
                "tangential": along / self.normal_force,
                "radial": across / self.normal_force,
                "normal": self.normal_force,
            }


def process(
    raw: RawData,
    *,
    cut_off: float | EllipsisType | None = ...,
    order: int | EllipsisType = ...,
    grid_angle: float | EllipsisType = ...,
) -> ProcessedData:
    """Return forces over the sliding direction: crosstalk and zero removed, transformed by (119).

    Friction forces stay unfiltered: a filter would bias the models that are fitted to them. The
    normal force is low-passed forwards and backwards.

    Options that are not given are those of the raw data, `RawData.processing`: for files those of
    the configuration's section ``processing``, and else the defaults of `Processing`.

    Args:
        raw: runs, calibration and records without load.
        cut_off: cut-off frequency of one pass of the normal force's filter, in turn rates;
            None leaves it unfiltered.
        order: of one pass.
        grid_angle: angle of the sliding direction from e₁ in rad where the rotation reads 0.

    Raises:
        RecordError: for a file without a complete turn, or where the pin lost contact.

    Reference: [WL19] §5.2, (119), (120).

    >>> from asperity import Ellipse, FrictionLaw
    >>> from asperity.identify import VirtualTribometer, process
    >>> law = FrictionLaw.collinear(Ellipse(0.5, 0.4))
    >>> machine = VirtualTribometer(law, normal_force=10.0, turns=3, turn_rate=0.5)
    >>> data = process(machine.record())
    >>> data.turns, data.force.shape
    (3, (60000, 2))
    """
    return ProcessedData(raw, cut_off=cut_off, order=order, grid_angle=grid_angle)


@dataclass(frozen=True)
class _Series:
    """Arrays of all runs, to be filled."""

    phi: Array
    force: Array
    normal: Array
    turn: NDArray[np.int32]


def _cut_off(turns: float | None, rate: float, sample_rate: float) -> float | None:
    """Return a cut-off in Hz; None where the default has nothing above it in the samples."""
    if turns is None or turns * rate < 0.5 * sample_rate:
        return None if turns is None else turns * rate
    if turns == Processing().cut_off:
        return None
    raise ParameterError(
        "cut_off",
        f"must lie below half the samples per turn, which are {sample_rate / rate:.4g}, got "
        f"{turns:g}",
    )


def _refuse_incomplete(raw: RawData, strokes: Sequence[Strokes]) -> None:
    """Refuse files of a disk without a complete turn.

    Pieces of a file that was cut at its defects count together.
    """
    turns = {id(run): one.count for run, one in zip(raw.recordings, strokes, strict=True)}
    for run, one in zip(raw.recordings, strokes, strict=True):
        if not isinstance(one.turned, float):
            continue
        # A recording without a name is a file of its own.
        pieces = [one for one in raw.recordings if run.source and one.file == run.file] or [run]
        if not any(turns[id(piece)] for piece in pieces):
            covered = max(abs(piece.turns) for piece in pieces)
            raise RecordError(
                run.file,
                f"angle: covers {covered:.3g} turns, at least one complete turn is needed",
            )


def _refuse_lost_contact(
    raw: RawData, starts: tuple[int, ...], out: _Series, ways: Sequence[Array | float]
) -> None:
    """Refuse runs with a normal force that is not positive; between strokes the pin may lift."""
    for run, start, stop, turned in zip(raw.recordings, starts, starts[1:], ways, strict=False):
        normal = out.normal[start:stop]
        if not isinstance(turned, float):
            normal = np.where(out.turn[start:stop] >= 0, normal, np.inf)
        lowest = int(normal.argmin())
        if normal[lowest] <= 0.0:
            pulls = float(np.median(normal[np.isfinite(normal)])) < 0.0
            remedy = (
                "a minus before its unit turns the sign"
                if pulls
                else "where the file has more than the run, a window of time takes it out"
            )
            raise RecordError(
                run.source,
                f"normal channel: no pressure at row {lowest + 1} "
                f"({normal[lowest]:.4g} N); compression must be positive: {remedy}",
                ("units",) if pulls else ("run",),
            )


def _listed(loads: Sequence[float]) -> str:
    """Return each number once."""
    return ", ".join(dict.fromkeys(f"{load:.4g}" for load in loads))
