"""Recordings from text files: what is wrong is reported with line numbers, never patched."""

from __future__ import annotations

import math
import os
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property
from itertools import pairwise
from typing import TypeAlias

import numpy as np
from numpy.typing import NDArray

from asperity._base import arrays
from asperity._base.arrays import Array
from asperity._base.log import log
from asperity._base.progress import Progress, each, reporter
from asperity.errors import ParameterError, RecordError
from asperity.identify.records.magnitudes import check_magnitudes, check_wrapping
from asperity.identify.records.record import (
    CHANNELS,
    PIECE,
    Recording,
    gap_rows,
    rows_text,
    standstill_rows,
)
from asperity.identify.records.sliding.motion import force_columns, motion_columns, velocity_of
from asperity.identify.records.sliding.slopes import slopes
from asperity.identify.records.tables import clock, labview
from asperity.identify.records.tables.headings import (
    CLOCK,
    COEFFICIENT,
    DEFAULTS,
    FORCES,
    NEWTONS,
    POSITIONS,
    UNITS,
    WITHOUT_RADIAL,
    factors,
)
from asperity.identify.records.tables.text_table import (
    Format,
    Source,
    Table,
    is_frame,
    name_of,
    read_table,
)

PathLike = str | os.PathLike[str]
Window: TypeAlias = "tuple[float | str | None, float | str | None]"
"""From when to when, None for the start and the end of the file."""

_TURN = 2.0 * math.pi
# A channel is clipped if its extreme value comes at least so often, and so many times more often
# than the value next to it.
_REPEATED, _CROWDED = 8, 10.0
# A quiet channel with fewer levels than this may stay at one of them.
_LEVELS = 16.0
# So many long steps with short ones beside them, whose mean is the usual one up to this part, are
# those of a time that is rounded.
_SEVERAL, _EVEN = 3, 0.1
_ROUNDED = "rounded or out of order after"
FORM = tuple(Format.__dataclass_fields__)
# What stands for a column that is not there.
_CONSTANTS = {"time": "sample_rate", "angle": "turn_rate", "normal": "normal_load"}


def read_csv(
    paths: Source | Iterable[Source],
    *,
    columns: Mapping[str, str | int] | None = None,
    units: Mapping[str, str] | None = None,
    delimiter: str | None = ",",
    decimal: str = ".",
    header: int = 1,
    encoding: str = "utf-8-sig",
    names: int | None = None,
    thousands: str | None = None,
    sheet: str | int = 0,
    sample_rate: float | None = None,
    turn_rate: float | None = None,
    counts_per_turn: float | None = None,
    arm: float | None = None,
    normal_load: float | None = None,
    one_channel: bool = False,
    rectified: bool = False,
    run: Sequence[Window] | None = None,
    angles: float | Sequence[float] | None = None,
    loaded: bool = True,
    check_units: bool = True,
    on_defect: str = "raise",
    progress: Progress = None,
) -> tuple[Recording, ...]:
    r"""Read runs of a tribometer from tables, one or several of a campaign.

    It reads, and no more: calibration, records without load and options of the processing are
    those of `load`.

    Args:
        paths: text files, spreadsheets (.xlsx, with pandas and openpyxl), or tables in memory, each
            a ``pandas.DataFrame``.
        columns: where ``time``, ``angle``, ``tangential``, ``radial`` and ``normal`` are: names in
            the header, or numbers from 0; by default named like that. ``turn_rate`` in place of
            ``angle`` is summed up from 0 at the start of the file. Where a stage moves instead of
            a disk: ``velocity`` or ``position`` along the tangential channel, or ``velocity_x``
            and ``velocity_y`` or ``position_x`` and ``position_y``, with ``force_x`` and
            ``force_y`` for the channels; an ``angle`` then says how the surface lies.
        units: of these columns: time s, ms, us, min, clock (12:00:00.123, with or without a date);
            angle rad, deg, turn, counts; turn_rate turn/s, rpm, deg/s, rad/s; forces N, uN, mN, cN,
            daN, kN, gf, kgf, ozf, lbf, or readings V, mV, raw for the calibration to turn into N,
            of the tangential channel also torques Nm, Ncm, Nmm, mNm, uNm, in lbf, or 1 for the
            coefficient of friction, which is multiplied by the load; velocities m/s, cm/s, mm/s,
            um/s, in/s, or per min; positions m, cm, mm, um, in. A leading minus turns the sign.
            Default: the unit of the heading, else s, rad, turn/s, N, m/s, m. The angle may be
            wrapped.
        delimiter: between columns; None or a blank for any white space.
        decimal: ``"."`` or ``","``.
        header: number of lines before the numbers.
        encoding: of the text.
        names: the line of the header that names the columns, from 1; by default the last.
        thousands: what stands between groups of three digits; by default nothing does.
        sheet: of a spreadsheet, by name or number from 0.
        sample_rate: in Hz, instead of a time column.
        turn_rate: in turns/s or the unit given for it, instead of an angle column; the angle is 0
            at time 0.
        counts_per_turn: of the encoder, for an angle in counts.
        arm: of the friction force in m, for a tangential channel that is a torque.
        normal_load: constant λ_N in N, instead of a column of the normal force; 0 is what records
            without load get.
        one_channel: whether no radial channel is read: `friction_coefficient` does without.
        rectified: whether the one channel is the magnitude of the force, |F|, although the motion
            goes there and back: it gets the sign of the motion.
        run: windows of time, each a run: pairs of start and end in the unit of the time column, or
            texts for a clock; None for those of the file. By default a file is one run.
        angles: how the surface lies, one number or one for each file in the unit of the angle,
            where a stage moves: from e₁ of the surface to the axis of the stage, so that a surface
            turned counter-clockwise under the stage by α has the angle −α; by default 0.
        loaded: False for records without load, where the disk may rest and no unit is checked.
        check_units: whether implausible magnitudes, and headings with another unit, are refused.
        on_defect: ``"raise"``, or ``"split"``: the record is cut at its defects, and pieces
            without them are returned.
        progress: ``True`` for a bar of tqdm, or a function of (files read, all files).

    Returns:
        The recordings, in the order of the files.

    Raises:
        RecordError: with file, line, column and remedy: numbers missing, sampling gaps, clipped or
            constant channels, implausible magnitudes, headings with other units, two columns of one
            name, files that are no such table.

    Reference: [WL19] §5.2.

    >>> import tempfile, pathlib
    >>> from asperity.identify import read_csv
    >>> text = "t/ms;a/deg;Ft;Fr;Fn\n" + "\n".join(
    ...     f"{k};{k},5;{1 + k % 7},25;{k % 5},0;{9 + k % 3},5" for k in range(900)
    ... )
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     file = pathlib.Path(folder, "run.csv")
    ...     _ = file.write_text(text)
    ...     read_csv(
    ...         file,
    ...         columns={"time": 0, "angle": 1, "tangential": "Ft", "radial": "Fr", "normal": "Fn"},
    ...         units={"time": "ms", "angle": "deg"},
    ...         delimiter=";",
    ...         decimal=",",
    ...     )[0].readings[0].tolist()
    [1.25, 0.0, 9.5]
    """
    reader = Reader(
        Format(delimiter, decimal, header, encoding, names, thousands, sheet),
        dict(columns or {}),
        dict(units or {}),
        sample_rate=sample_rate,
        turn_rate=turn_rate,
        counts_per_turn=counts_per_turn,
        arm=arm,
        normal_load=normal_load,
        one_channel=one_channel,
        rectified=rectified,
        check_units=check_units,
        on_defect=on_defect,
    )
    windows = {bool(loaded): [(None, None)] if run is None else list(run)}
    runs, idle = read_records(paths, windows, reader, angles=angles, progress=progress)
    return runs if loaded else idle


def read_records(
    paths: Source | Iterable[Source],
    windows: Mapping[bool, Sequence[Window]],
    reader: Reader,
    *,
    angles: float | Sequence[float] | None = None,
    progress: Progress = None,
) -> tuple[tuple[Recording, ...], tuple[Recording, ...]]:
    """Return the recordings with and without load in some files, each of which is read once.

    Args:
        paths: as of `read_csv`, like the other options.
        windows: of the recordings with load, True, and of those without, False.
        reader: what reads the files.
        angles: how the surface lies.
        progress: as of `read_csv`.
    """
    files = sources(paths)
    lie = _one_for_each(angles, files, reader)
    found: dict[bool, list[Recording]] = {True: [], False: []}
    with reporter(progress, "file") as report:
        for at, path in enumerate(each(files, report)):
            read = reader.read(path, windows, angle=None if lie is None else lie[at])
            for loaded, records in read.items():
                found[loaded] += records
    for loaded in windows:
        if not found[loaded]:
            raise RecordError(name_of(files[0]), "nothing is left between its defects")
    return tuple(found[True]), tuple(found[False])


def sources(paths: Source | Iterable[Source]) -> list[Source]:
    """Return the sources of one or several runs as a list, which is not empty."""
    if isinstance(paths, str | os.PathLike) or is_frame(paths):
        return [paths]
    files = list(arrays.several(paths, "paths"))
    if not files:
        raise ParameterError("paths", "must name at least one file")
    for path in files:
        if not isinstance(path, str | os.PathLike) and not is_frame(path):
            raise ParameterError("paths", f"must be files or tables of pandas, got {path!r:.60}")
    return files


def _one_for_each(
    angles: float | Sequence[float] | None, files: Sequence[Source], reader: Reader
) -> list[float] | None:
    """Return how the surface lies for each file, in the unit of the angle."""
    if angles is None:
        return None
    if not reader.is_stage:
        raise ParameterError("angles", "are for a stage: its velocity or position is no column")
    if "angle" in reader.columns:
        raise ParameterError("angles", "excludes a column of angle")
    values = arrays.array(angles, "angles")
    if values.ndim == 0:
        values = np.full(len(files), values)
    if values.shape != (len(files),):
        raise ParameterError(
            "angles", f"must be one number, or one for each of {len(files)} files, got {angles!r}"
        )
    return values.tolist()


@dataclass(frozen=True, eq=False)
class Reader:
    """How tables of one laboratory become recordings; its arguments are those of `read_csv`."""

    form: Format
    columns: dict[str, str | int]
    units: dict[str, str]
    sample_rate: float | None = None
    turn_rate: float | None = None
    counts_per_turn: float | None = None
    arm: float | None = None
    normal_load: float | None = None
    one_channel: bool = False
    rectified: bool = False
    check_units: bool = True
    on_defect: str = "raise"

    def __post_init__(self) -> None:
        if self.one_channel and self.forces == FORCES:
            raise ParameterError("one_channel", "is for a tangential channel, not for force_x")
        if self.rectified and not self.one_channel:
            raise ParameterError("rectified", "is for one_channel = true: two channels have signs")
        arrays.choice(self.on_defect, "on_defect", ("raise", "split"))
        for name in self.columns:
            if name not in UNITS:
                raise ParameterError("columns", f"has no channel {name!r}, only {', '.join(UNITS)}")
        both = [name for name in _CONSTANTS if name in self.columns and name in self.constants]
        if both:
            raise ParameterError(_CONSTANTS[both[0]], f"excludes a column of {both[0]}")
        if "angle" in self.constants and (self.is_stage or self.motion == ("turn_rate",)):
            raise ParameterError("turn_rate", f"excludes a column of {self.motion[0]}")
        counts = self.counts_per_turn if "angle" in self.units else None
        arm = self.arm if "tangential" in self.units else None
        _ = self.forces, factors(self.units, counts, arm)

    @cached_property
    def constants(self) -> dict[str, float]:
        """What stands for columns that are not there."""
        given = {"time": self.sample_rate, "angle": self.turn_rate, "normal": self.normal_load}
        return {
            name: arrays.number(value, _CONSTANTS[name])
            for name, value in given.items()
            if value is not None
        }

    @cached_property
    def motion(self) -> tuple[str, ...]:
        """The columns from which the sliding follows."""
        return motion_columns(self.columns)

    @property
    def is_stage(self) -> bool:
        """Whether a stage moves, and no disk turns."""
        return self.motion[0] not in ("angle", "turn_rate")

    @property
    def is_rate_given(self) -> bool:
        """Whether the angle is made of the turn rate, and never jumps by a turn."""
        return "angle" in self.constants or self.motion == ("turn_rate",)

    @cached_property
    def forces(self) -> tuple[str, str]:
        """The columns of the two horizontal channels."""
        return force_columns(self.columns, self.motion)

    def where(self, *, loaded: bool) -> dict[str, str | int]:
        """Return where each wanted column is; constants stand for columns."""
        moving = [*self.motion, *(["angle"] if self.is_stage and "angle" in self.columns else [])]
        if not loaded and self.motion != ("angle",):
            # Nothing moves, or it does not matter.
            moving = []
        wanted = ("time", *moving, *self.forces[: 1 if self.one_channel else 2], "normal")
        return {name: self.columns.get(name, name) for name in wanted if name not in self.constants}

    def read(
        self,
        path: Source,
        windows: Mapping[bool, Sequence[Window]],
        *,
        angle: float | None = None,
    ) -> dict[bool, list[Recording]]:
        """Return the recordings in windows of one table, those with and those without load."""
        where = self.where(loaded=any(windows))
        table = read_table(path, where, self.form, units=self.units, check=self.check_units)
        if len(table.values) < 2:
            raise RecordError(table.source, "holds one sample only, a run needs two or more")
        named = {**DEFAULTS, **table.units}
        scale = factors(named, self.counts_per_turn, self.arm)
        series = self._series(table, where, named, scale)
        if angle is not None:
            series["angle"] = np.full(len(table.values), angle * scale["angle"])
        found: dict[bool, list[Recording]] = {}
        for loaded, given in windows.items():
            found[loaded] = []
            for window in given:
                part = _Part(self, table, where, series, loaded, named, scale)
                rows = part.rows(window)
                found[loaded] += part.recordings(rows, whole=window == (None, None))
        return found

    def _series(
        self,
        table: Table,
        where: Mapping[str, str | int],
        named: Mapping[str, str],
        scale: Mapping[str, float],
    ) -> dict[str, Array]:
        constants = self.constants
        series = {
            name: table.values[:, at] * scale[name] if scale[name] != 1.0 else table.values[:, at]
            for at, name in enumerate(where)
        }
        count = np.arange(len(table.values))
        if "time" in constants:
            rate = arrays.positive(constants["time"], "sample_rate")
            series["time"] = labview.of_parts(len(count), table.parts, rate)
        elif named["time"].removeprefix("-") == CLOCK:
            series["time"] = clock.through_midnight(series["time"])
        elif table.parts:
            series["time"] = labview.through_parts(series["time"], table.parts)
        if "angle" in constants:
            series["angle"] = _TURN * scale["turn_rate"] * constants["angle"] * series["time"]
        elif "turn_rate" in where:
            series["angle"] = _summed(series["turn_rate"], series["time"])
        elif "angle" not in where:
            series["angle"] = np.zeros(len(count))
        if "normal" in constants:
            series["normal"] = np.full(len(count), constants["normal"])
        for name, channel in zip(self.forces, CHANNELS[:2], strict=True):
            series[channel] = series[name] if name in series else np.zeros(len(count))
        if named["tangential"].removeprefix("-") == COEFFICIENT and "tangential" in where:
            if named["normal"].removeprefix("-") not in NEWTONS:
                raise RecordError(
                    table.source,
                    f"column {where['tangential']!r} (tangential): is a coefficient of friction, "
                    f"which needs the load in N, not in {named['normal']}",
                    ("units",),
                )
            series["tangential"] = series["tangential"] * series["normal"]
        return series


def _summed(rate: Array, time: Array) -> Array:
    """Return the rotation in rad since the first sample; over gaps the rate goes on straight."""
    known = np.isfinite(rate) & np.isfinite(time)
    if not known.any():
        return np.full(len(rate), np.nan)
    row = np.arange(len(rate))
    rate, time = (np.interp(row, row[known], values[known]) for values in (rate, time))
    steps = 0.5 * (rate[1:] + rate[:-1]) * np.diff(time)
    return _TURN * np.concatenate([[0.0], np.cumsum(steps)])


@dataclass(frozen=True, eq=False)
class _Part:
    """What windows of a table have in common."""

    reader: Reader
    table: Table
    where: Mapping[str, str | int]
    series: Mapping[str, Array]
    loaded: bool
    named: Mapping[str, str]
    scale: Mapping[str, float]

    def rows(self, window: Window) -> slice:
        time = self.series["time"]
        if window == (None, None):
            return slice(0, len(time))
        low = self._time(window[0], -math.inf)
        high = self._time(window[1], math.inf, after=low)
        inside = np.flatnonzero((time >= low) & (time <= high))
        if inside.size < 2:
            known = time[np.isfinite(time)]
            told = (
                f"its times go from {self._said(known.min())} to {self._said(known.max())}"
                if known.size
                else "it has no times"
            )
            raise RecordError(
                self.table.source,
                f"has no samples from {window[0]} to {window[1]}: {told}",
                ("run" if self.loaded else "no_load",),
            )
        return slice(int(inside[0]), int(inside[-1]) + 1)

    @property
    def _unit(self) -> str:
        return self.named["time"].removeprefix("-")

    @property
    def _has_clock(self) -> bool:
        return self._unit == CLOCK

    def _said(self, time: float) -> str:
        """Return a time as the file has it."""
        if self._has_clock:
            return clock.text(time)
        return f"{time / self.scale['time']:.6g}"

    def _time(
        self, value: float | str | None, missing: float, *, after: float = -math.inf
    ) -> float:
        """Return a time in s; of one without date the day is that on which the record has it."""
        argument = "run" if self.loaded else "no_load"
        if value is None:
            return missing
        if isinstance(value, str) != self._has_clock:
            words = (
                "a time of day in quotes"
                if self._has_clock
                else "a number in the unit of the times"
            )
            raise ParameterError(argument, f"must have {words} for from and to, got {value!r}")
        if not isinstance(value, str):
            return arrays.number(value, argument) * self.scale["time"]
        found = clock.seconds(value)
        if math.isnan(found):
            raise ParameterError(argument, f"must have times such as '12:00:05', got {value!r}")
        time = self.series["time"]
        known = time[np.isfinite(time)]
        if not known.size or found >= clock.DAY:
            dated = known.size and known.min() >= clock.UNDATED
            if known.size and found >= clock.UNDATED and not dated:
                raise ParameterError(
                    argument, f"must have times without a date, like those read, got {value!r}"
                )
            return found
        return clock.in_record(found, float(known.min()), float(known.max()), after=after)

    def recordings(self, rows: slice, *, whole: bool) -> list[Recording]:
        """Return the recordings between the defects of some rows."""
        table, where = self.table, self.where
        series = {name: values[rows] for name, values in self.series.items()}
        if not self.loaded and "normal" in self.reader.constants:
            series["normal"] = np.zeros(rows.stop - rows.start)
        source = table.source
        if not whole:
            first, last = (self._said(series["time"][at]) for at in (0, -1))
            source = f"{source} from {first} to {last}" + (
                "" if self._has_clock else f" {self._unit}"
            )
        defects = _defects(series, where)
        if defects and self.reader.on_defect == "raise":
            raise RecordError(
                source, _report(defects, table, where, rows.start), _remedies(defects, where)
            )
        for name, what, bad in defects:
            log.warning("%s: cut at %d defects: column %s %s", source, len(bad), name, what)
        velocity = None
        if self.loaded and self.reader.is_stage:
            # Pieces do not tell as much of the motion as the whole.
            velocity = velocity_of(series, self.reader.motion, where=where, source=source)
        found: list[Recording] = []
        for piece in _pieces(defects, rows.stop - rows.start):
            name = source
            if defects:
                ends = np.array([rows.start + piece.start, rows.start + piece.stop - 1])
                first, last = table.lines(ends)
                name = f"{source}{PIECE}{first}-{last}"
            before = found[-1] if found else None
            moved = None if velocity is None else velocity[piece]
            found.append(self._recording(series, piece, name, before, moved))
        if self.loaded and found:
            _refuse_constant(found, source, where)
            if self.reader.check_units:
                units = self._units_of_channels()
                is_sparse = self.reader.one_channel and self.reader.is_rate_given
                check_magnitudes(found, units, is_sparse=is_sparse)
        return found

    def _recording(
        self,
        series: Mapping[str, Array],
        rows: slice,
        source: str,
        before: Recording | None,
        velocity: Array | None,
    ) -> Recording:
        reader = self.reader
        angle, time = series["angle"][rows], np.array(series["time"][rows])
        # A disk at rest has an angle that only shakes.
        if self.loaded and not reader.is_stage and not reader.is_rate_given:
            factor = self.scale["angle"]
            check_wrapping(angle / factor, self.named["angle"], factor, source)
            angle = np.unwrap(angle)
            if before is not None:
                angle = angle + _turns_between(before, angle, time, series["angle"])
        readings = np.stack([series[name][rows] for name in CHANNELS], axis=-1)
        if self.loaded and reader.rectified:
            way = slopes(angle[:, None], time).velocity if velocity is None else velocity
            readings[:, 0] = np.copysign(readings[:, 0], way[:, 0])
        turned = np.array(angle)
        for values in (time, turned, readings):
            values.flags.writeable = False
        found = Recording(time, angle=turned, readings=readings, source=source, velocity=velocity)
        found._keep(_units=tuple(self._units_of_channels().values()))
        if reader.motion[0] in POSITIONS and velocity is not None:
            found._keep(_position=np.stack([series[one][rows] for one in reader.motion], axis=-1))
        return found

    def _units_of_channels(self) -> dict[str, str]:
        read = (*self.reader.forces, "normal")
        found = {channel: self.named[name] for channel, name in zip(CHANNELS, read, strict=True)}
        return found | ({"normal": "N"} if "normal" in self.reader.constants else {})


def _turns_between(before: Recording, angle: Array, time: Array, read: Array) -> float:
    """Return the whole turns that a wrapped angle has lost in a gap, in rad."""
    if np.nanmax(read) - np.nanmin(read) > 1.02 * _TURN:
        return 0.0
    rate = (before.angle[-1] - before.angle[0]) / before.duration
    expected = float(before.angle[-1] + rate * (time[0] - before.time[-1]))
    return _TURN * round((expected - float(angle[0])) / _TURN)


def _defects(
    series: Mapping[str, Array], where: Mapping[str, str | int]
) -> list[tuple[str, str, NDArray[np.intp]]]:
    """Return column, what is wrong, and the rows, the row before a gap standing for the gap."""
    found = []
    for name in where:
        bad = np.flatnonzero(~np.isfinite(series[name]))
        if bad.size:
            found.append((name, "no number in", bad))
    time, good = series["time"], np.isfinite(series["time"])
    for *_, rows in found:
        good[rows] = False
    # Of rows that are cut out, the time does not matter.
    known = np.where(good, time, np.nan)
    halts = standstill_rows(known)
    if halts.size:
        # Time that is rounded too coarsely repeats itself everywhere.
        return [*found, ("time", _ROUNDED, halts)]
    gaps = gap_rows(known)
    if gaps.size and _is_rounded(known, gaps):
        return [*found, ("time", _ROUNDED, gaps)]
    if gaps.size:
        found.append(("time", "sampling gap after", gaps))
    broken = {name for name, *_ in found}
    for name in where:
        if name not in (*CHANNELS, *FORCES) or name in broken:
            continue
        clipped = _clipped(series[name])
        if clipped.size:
            found.append((name, "clipped in", clipped))
    return found


def _is_rounded(time: Array, gaps: NDArray[np.intp]) -> bool:
    """Return whether most of the long steps have a short one beside them that makes up for them."""
    steps = np.diff(time)
    usual = float(np.nanmean(steps))
    padded = np.concatenate([[np.inf], steps, [np.inf]])
    beside = np.minimum(padded[gaps], padded[gaps + 2])
    makes_up = np.abs(0.5 * (steps[gaps] + beside) - usual) < _EVEN * usual
    return bool(gaps.size >= _SEVERAL and makes_up.mean() > 0.5)


def _clipped(values: Array) -> NDArray[np.intp]:
    """Return the rows where a channel is at the end of its range.

    A smooth signal is at its extreme value somewhat longer than at the next one, a clipped signal
    many times longer.
    """
    rows: list[NDArray[np.intp]] = []
    low, high = float(values.min()), float(values.max())
    if low == high:
        return np.array([], dtype=np.intp)
    for extreme in (low, high):
        at = np.flatnonzero(values == extreme)
        if len(at) < _REPEATED:
            continue
        rest = values[values != extreme]
        neighbour = rest.max() if extreme == high else rest.min()
        if high - low < _LEVELS * abs(extreme - neighbour):
            continue
        if len(at) > _CROWDED * np.count_nonzero(values == neighbour):
            rows.append(at)
    return np.sort(np.concatenate(rows)) if rows else np.array([], dtype=np.intp)


def _report(
    defects: list[tuple[str, str, NDArray[np.intp]]],
    table: Table,
    where: Mapping[str, str | int],
    first: int,
) -> str:
    texts = []
    for name, what, rows in defects:
        lines = rows_text(table.lines(rows + first)).replace("row", "line")
        texts.append(f"column {where.get(name, name)!r} ({name}): {what} {lines}")
    if _is_text_line(defects, where) and not first:
        lines = rows_text(table.lines(np.array([0]))).replace("row", "line")
        return f"{'; '.join(texts)}; if {lines} is one of units, it belongs to the header"
    return f"{'; '.join(texts)}; repair the record, or split it there"


def _is_text_line(
    defects: list[tuple[str, str, NDArray[np.intp]]], where: Mapping[str, str | int]
) -> bool:
    """Return whether no column has a number in the first line alone."""
    return {name for name, _, _ in defects} == set(where) and all(
        rows.tolist() == [0] for _, _, rows in defects
    )


def _remedies(
    defects: list[tuple[str, str, NDArray[np.intp]]], where: Mapping[str, str | int]
) -> tuple[str, ...]:
    if _is_text_line(defects, where):
        return "header", "names"
    rate = ("sample_rate",) if any(what == _ROUNDED for _, what, _ in defects) else ()
    return *rate, "on_defect"


def _pieces(defects: list[tuple[str, str, NDArray[np.intp]]], n: int) -> list[slice]:
    """Return the stretches between defects that hold two samples or more."""
    if not defects:
        return [slice(0, n)]
    good = np.ones(n, dtype=bool)
    cuts = set()
    for _, what, rows in defects:
        if what.endswith("after"):
            cuts |= set((rows + 1).tolist())
        else:
            good[rows] = False
    flips = np.flatnonzero(np.diff(good.astype(np.int8))) + 1
    ends = sorted({0, n, *flips.tolist(), *cuts})
    return [
        slice(start, stop) for start, stop in pairwise(ends) if stop - start > 1 and good[start]
    ]


def _refuse_constant(
    runs: Sequence[Recording], source: str, where: Mapping[str, str | int]
) -> None:
    """Refuse channels that are the same in all pieces of a record."""
    readings = np.array([[one.readings.min(axis=0), one.readings.max(axis=0)] for one in runs])
    spread = readings[:, 1].max(axis=0) - readings[:, 0].min(axis=0)
    named = dict(zip((*CHANNELS, *FORCES), (*spread, *spread[:2]), strict=True))
    moves = [one.velocity for one in runs if one.velocity is not None]
    if not moves:
        angle = max(one.angle.max() for one in runs) - min(one.angle.min() for one in runs)
        named["angle"] = named["turn_rate"] = angle
    for name, change in named.items():
        if name in where and change == 0.0:
            message = f"column {where[name]!r} ({name}): does not change: is it connected?"
            raise RecordError(source, message + f" {WITHOUT_RADIAL}" * (name == "radial"))
    if moves and not any(one.any() for one in moves):
        raise RecordError(source, "the stage does not move")
