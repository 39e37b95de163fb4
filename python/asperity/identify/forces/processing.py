"""From raw readings to forces over the sliding direction."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property
from types import EllipsisType

import numpy as np
from numpy.typing import ArrayLike, NDArray

from asperity._base import arrays
from asperity._base.arrays import Array
from asperity._base.value import Value
from asperity.errors import ParameterError, RecordError
from asperity.identify.forces import filters, stated_errors
from asperity.identify.forces.averaged import Averaged
from asperity.identify.forces.measured_sets import MeasuredSets
from asperity.identify.forces.turns import (
    TurnAverage,
    average_turns,
    bin_centres,
    cells,
    full_bins,
    sense,
    turn_numbers,
)
from asperity.identify.forces.zero import Zero, shared_covariance, zeros_of
from asperity.identify.records.record import RawData, Recording

# Samples that are worked on at a time.
_CHUNK = 1 << 15


class ProcessedData(Value):
    """Friction forces over the sliding direction, in the frame of the disk; made by `process`.

    Attributes:
        phi: angle φ of the sliding direction from e₁ in rad, not wrapped; shape ``(n,)``.
        force: −λ = R(φ)(λ_t, λ_r) in N, not filtered; shape ``(n, 2)``.
        normal_force: λ_N in N after the low-pass filter, shape ``(n,)``.
        turn: number of the turn of each sample, from 0 over all runs; −1 outside complete turns.
        run: first sample of each run and the number of samples, shape ``(m + 1,)``.
        matrix: T, shape ``(3, 3)``.
        zero: mean reading without load in the middle of the runs, shape ``(3,)``.
        calibration_covariance: of the entries of T row by row, shape ``(9, 9)``; None where the
            error is neither known by a calibration nor stated. A given λ_N needs no third row.
        zero_covariance: shape ``(3, 3)``, or None where there are no records and nothing is stated.
        cut_off_frequency: of the normal force's filter for each run, in Hz; None without a filter.

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
    run: tuple[int, ...]
    matrix: Array
    zero: Array
    calibration_covariance: Array | None
    zero_covariance: Array | None
    cut_off_frequency: tuple[float | None, ...]
    _zeros: tuple[Zero, ...]

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
                None if self.cut_off is None else self.cut_off * rate
                for rate in map(_turn_rate, raw.recordings)
            ),
            _zeros=zeros,
        )
        self._fill(self._sized())

    def _sized(self) -> _Series:
        n = self.run[-1]
        return _Series(np.empty(n), np.empty((n, 2)), np.empty(n), np.empty(n, dtype=np.int32))

    def _fill(self, out: _Series) -> None:
        found: list[int] = []
        for number, run in enumerate(self.raw.recordings):
            rows = slice(self.run[number], self.run[number + 1])
            sign = sense(run)
            out.turn[rows] = turn_numbers(run, sign)
            complete = int(out.turn[rows].max()) + 1
            out.turn[rows][out.turn[rows] >= 0] += sum(found)
            found.append(complete)
            backwards = math.pi if sign < 0.0 else 0.0
            np.add(run.angle, self.grid_angle + backwards, out=out.phi[rows])
            self._forces(
                number, self.matrix, self._zeros[number], out.force[rows], out.normal[rows]
            )
        _refuse_incomplete(self.raw, found)
        _refuse_lost_contact(self.raw, self.run, out.normal)
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
        return filters.low_pass(
            signal, sample_rate=run.sample_rate, cut_off=frequency, order=self.order
        )

    def __repr__(self) -> str:
        return (
            f"<ProcessedData: {len(self.phi)} samples, {self.turns} turns of "
            f"{len(self.raw.recordings)} runs, λ_N = {self.normal_force.mean():.4g} N>"
        )

    @property
    def turns(self) -> int:
        """Number of complete turns."""
        return int(self.turn.max()) + 1

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
        """Sliding speed ‖γ‖ in m/s, low-passed like the normal force, shape ``(n,)``."""
        radius = self.raw.radius
        if radius is None:
            raise ParameterError("radius", "must be given in RawData for the sliding speed")
        runs = self.raw.recordings
        rates = [np.abs(np.gradient(run.angle, 1.0 / run.sample_rate)) for run in runs]
        return radius * np.concatenate(
            [self._smooth(rate, number) for number, rate in enumerate(rates)]
        )

    def perturbed(
        self, *, matrix: ArrayLike | None = None, zero: ArrayLike | None = None
    ) -> tuple[Array, Array]:
        """Return −λ and λ_N in N that another calibration or zero would have given.

        Args:
            matrix: T, shape ``(3, 3)``.
            zero: mean reading without load, shape ``(3,)``; its drift stays.

        Returns:
            Forces ``(n, 2)`` and normal forces ``(n,)``. `averaged` has the same method for means,
            at a thousandth of the cost.
        """
        t = self.matrix if matrix is None else arrays.array(matrix, "matrix", (3, 3))
        shift = (self.zero if zero is None else arrays.array(zero, "zero", (3,))) - self.zero
        out = self._sized()
        for number in range(len(self.raw.recordings)):
            rows = slice(self.run[number], self.run[number + 1])
            other = self._zeros[number].shifted(shift)
            self._forces(number, t, other, out.force[rows], out.normal[rows])
        return out.force, out.normal

    def averaged(self, bins: int | None = None) -> Averaged:
        """Return the means of all complete turns in equal bins of the sliding direction.

        By default there are 720, or as many as hold samples.
        """
        k = self.full_bins(720) if bins is None else arrays.count(bins, "bins", least=8)
        forwards, backwards = np.zeros((6, k)), np.zeros((6, k))
        for number, run in enumerate(self.raw.recordings):
            sums = forwards if sense(run) > 0.0 else backwards
            self._add(number, sums)
        count = forwards[0] + backwards[0]
        if not count.all():
            raise ParameterError("bins", f"must be fewer: of {k}, some hold no sample")
        total, signed = (forwards + backwards) / count, (forwards - backwards) / count
        return Averaged(
            bin_centres(k) + total[1],
            (signed[2:5] - signed[0] * self.zero[:, None]).T,
            total[5],
            count,
            unsigned_readings=(total[2:5] - self.zero[:, None]).T,
            sense=signed[0],
            matrix=self.matrix,
            zero=self.zero,
            is_load_given=self.is_load_given,
        )

    def _add(self, number: int, sums: Array) -> None:
        """Add a run to the sums of 1, φ from the centre, readings, λ_N in bins.

        Readings are as if the run had the mean zero of all.
        """
        run, k, zero = self.raw.recordings[number], sums.shape[1], self._zeros[number]
        off = (0.0, 0.0, *(zero.mean - self.zero), 0.0)
        drift = (0.0, 0.0, *zero.slope, 0.0)
        for first in range(0, len(run), _CHUNK):
            rows = slice(first, min(first + _CHUNK, len(run)))
            here = slice(self.run[number] + rows.start, self.run[number] + rows.stop)
            cell, within = cells(self.phi[here], k)
            later = run.time[rows] - zero.middle
            # Incomplete turns have no weight.
            used = (self.turn[here] >= 0).astype(np.float64)
            columns = (1.0, within, *run.readings[rows].T, self.normal_force[here])
            for row, (column, start, rate) in enumerate(zip(columns, off, drift, strict=True)):
                sums[row] += np.bincount(cell, used * (column - start - rate * later), k)

    @cached_property
    def sets(self) -> MeasuredSets:
        """Points of bdry C and of D from the means in default bins, with their defects."""
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
        along, across = arrays.along_and_across(self.force, self.phi)
        channels = {
            "tangential": along / self.normal_force,
            "radial": across / self.normal_force,
            "normal": self.normal_force,
        }
        return {
            name: average_turns(self.phi, values=values, turn=self.turn, bins=bins)
            for name, values in channels.items()
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


def _turn_rate(run: Recording) -> float:
    if abs(run.turns) < 1e-3:
        raise RecordError(run.source, "angle: the disk does not turn")
    return run.turn_rate


def _refuse_incomplete(raw: RawData, found: Sequence[int]) -> None:
    """Refuse files without a complete turn; `found` are the complete turns of each recording.

    Pieces of a file that was cut at its defects count together.
    """
    turns = dict(zip(map(id, raw.recordings), found, strict=True))
    for run in raw.recordings:
        # A recording without a name is a file of its own.
        pieces = [one for one in raw.recordings if run.source and one.file == run.file] or [run]
        if not any(turns[id(piece)] for piece in pieces):
            covered = max(abs(piece.turns) for piece in pieces)
            raise RecordError(
                run.file,
                f"angle: covers {covered:.3g} turns, at least one complete turn is needed",
            )


def _refuse_lost_contact(raw: RawData, starts: tuple[int, ...], normal: Array) -> None:
    """Refuse runs with a normal force that is not positive."""
    for run, start, stop in zip(raw.recordings, starts, starts[1:], strict=False):
        lowest = int(normal[start:stop].argmin())
        if normal[start + lowest] <= 0.0:
            raise RecordError(
                run.source,
                f"normal channel: no pressure at row {lowest + 1} "
                f"({normal[start + lowest]:.4g} N); compression must be positive",
            )
