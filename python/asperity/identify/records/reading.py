"""Recordings from text files: what is wrong is reported with line numbers, never patched."""

from __future__ import annotations

import math
import os
from collections.abc import Iterable, Iterator, Mapping, Sequence
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

from asperity._base import arrays
from asperity._base.arrays import Array
from asperity._base.log import log
from asperity._base.progress import Progress, each, reporter
from asperity.errors import ParameterError, RecordError
from asperity.identify.records import units as _units
from asperity.identify.records.record import (
    CHANNELS,
    PIECE,
    Recording,
    gap_rows,
    rows_text,
    standstill_rows,
)
from asperity.identify.records.text_table import Format, Table, read_table

PathLike = str | os.PathLike[str]
_TURN = 2.0 * math.pi
# A channel is clipped if its extreme value comes at least so often, and so many times more often
# than the value next to it.
_REPEATED, _CROWDED = 8, 10.0
# A quiet channel with fewer levels than this may stay at one of them.
_LEVELS = 16.0
_ROUNDED = "rounded or out of order after"
# What stands for a column that is not there.
_CONSTANTS = {"time": "sample_rate", "angle": "turn_rate", "normal": "normal_load"}


def read_csv(
    paths: PathLike | Iterable[PathLike],
    *,
    columns: Mapping[str, str | int] | None = None,
    units: Mapping[str, str] | None = None,
    delimiter: str | None = ",",
    decimal: str = ".",
    header: int = 1,
    encoding: str = "utf-8-sig",
    sample_rate: float | None = None,
    turn_rate: float | None = None,
    normal_load: float | None = None,
    loaded: bool = True,
    check_units: bool = True,
    on_defect: str = "raise",
    progress: Progress = None,
) -> tuple[Recording, ...]:
    r"""Read runs of a tribometer from text files, one or several of a campaign.

    Args:
        paths: the files.
        columns: where ``time``, ``angle``, ``tangential``, ``radial`` and ``normal`` are: names in
            the last header line, or numbers from 0; by default named like that.
        units: of these columns: time s, ms, us, min; angle rad, deg, turn; forces N, mN, cN, kN, or
            readings V, mV, raw for the calibration to turn into N. A leading minus turns the sign.
            Default: s, rad, N. The angle may be wrapped.
        delimiter: between columns; None or a blank for any white space.
        decimal: ``"."`` or ``","``.
        header: number of lines before the numbers.
        encoding: of the text.
        sample_rate: in Hz, instead of a time column.
        turn_rate: in turns/s, instead of an angle column; the angle is 0 at time 0.
        normal_load: constant λ_N in N, instead of a column of the normal force; 0 is what records
            without load get.
        loaded: False for records without load, where the disk may rest and no unit is checked.
        check_units: whether implausible magnitudes are refused.
        on_defect: ``"raise"``, or ``"split"``: the record is cut at its defects, and pieces
            without them are returned.
        progress: ``True`` for a bar of tqdm, or a function of (files read, all files).

    Returns:
        The recordings, in the order of the files.

    Raises:
        RecordError: with file, line, column and remedy: numbers missing, sampling gaps, clipped or
            constant channels, implausible magnitudes, files that are no such table.

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
    form = Format(delimiter, decimal, header, encoding)
    given = {"time": sample_rate, "angle": turn_rate, "normal": normal_load}
    constants = {
        name: arrays.number(value, _CONSTANTS[name])
        for name, value in given.items()
        if value is not None
    }
    where = _columns(columns, constants)
    if not loaded and "normal" in constants:
        constants["normal"] = 0.0
    arrays.choice(on_defect, "on_defect", ("raise", "split"))
    scale = _units.factors(units)
    named = {**_units.DEFAULTS, **(units or {})}
    files = [paths] if isinstance(paths, str | os.PathLike) else arrays.several(paths, "paths")
    if not files:
        raise ParameterError("paths", "must name at least one file")
    found: list[Recording] = []
    for path, table in _tables(files, where, form, progress):
        if len(table.values) < 2:
            raise RecordError(str(path), "holds one sample only, a run needs two or more")
        series = _series(table, where, scale, constants)
        defects = _defects(series, where)
        if defects and on_defect == "raise":
            rate = ("sample_rate",) if any(what == _ROUNDED for _, what, _ in defects) else ()
            raise RecordError(str(path), _report(defects, table, where), (*rate, "on_defect"))
        for name, what, rows_of in defects:
            log.warning("%s: cut at %d defects: column %s %s", path, len(rows_of), name, what)
        for rows in _pieces(defects, len(table.values)):
            run = _recording(
                series, rows, table, named["angle"] if loaded else None, whole=not defects
            )
            if loaded:
                _refuse_constant(run, where)
                if check_units:
                    _units.check_magnitudes(run, named)
            found.append(run)
    if not found:
        raise RecordError(str(files[0]), "nothing is left between its defects")
    return tuple(found)


def _tables(
    files: Sequence[PathLike], where: Mapping[str, str | int], form: Format, progress: Progress
) -> Iterator[tuple[PathLike, Table]]:
    with reporter(progress, "file") as report:
        for path in each(files, report):
            yield path, read_table(path, where, form)


def _columns(
    columns: Mapping[str, str | int] | None, constants: Mapping[str, float]
) -> dict[str, str | int]:
    """Return where each wanted column is; constants stand for columns."""
    given = {} if columns is None else dict(columns)
    for name in given:
        if name not in _units.UNITS:
            raise ParameterError(
                "columns", f"has no channel {name!r}, only {', '.join(_units.UNITS)}"
            )
    names = ("time", "angle", *CHANNELS)
    both = [name for name in names if name in given and name in constants]
    if both:
        raise ParameterError(_CONSTANTS[both[0]], f"excludes a column of {both[0]}")
    return {name: given.get(name, name) for name in names if name not in constants}


def _series(
    table: Table,
    where: Mapping[str, str | int],
    scale: Mapping[str, float],
    constants: Mapping[str, float],
) -> dict[str, Array]:
    series = {
        name: table.values[:, at] * scale[name] if scale[name] != 1.0 else table.values[:, at]
        for at, name in enumerate(where)
    }
    count = np.arange(len(table.values))
    if "time" in constants:
        series["time"] = count / arrays.positive(constants["time"], "sample_rate")
    if "angle" in constants:
        series["angle"] = _TURN * constants["angle"] * series["time"]
    if "normal" in constants:
        series["normal"] = np.full(len(count), constants["normal"])
    return series


def _defects(
    series: Mapping[str, Array], where: Mapping[str, str | int]
) -> list[tuple[str, str, NDArray[np.intp]]]:
    """Return column, what is wrong, and the rows, the row before a gap standing for the gap."""
    found = []
    for name in where:
        bad = np.flatnonzero(~np.isfinite(series[name]))
        if bad.size:
            found.append((name, "no number in", bad))
    if found:
        return found
    halts = standstill_rows(series["time"])
    if halts.size:
        # Time that is rounded too coarsely repeats itself everywhere.
        return [("time", _ROUNDED, halts)]
    gaps = gap_rows(series["time"])
    if gaps.size:
        found.append(("time", "sampling gap after", gaps))
    for name in CHANNELS:
        clipped = _clipped(series[name])
        if clipped.size:
            found.append((name, "clipped in", clipped))
    return found


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
) -> str:
    texts = []
    for name, what, rows in defects:
        lines = rows_text(table.lines(rows)).replace("row", "line")
        texts.append(f"column {where.get(name, name)!r} ({name}): {what} {lines}")
    return f"{'; '.join(texts)}; repair the record, or split it there"


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


def _recording(
    series: Mapping[str, Array], rows: slice, table: Table, unit: str | None, *, whole: bool
) -> Recording:
    source = str(table.path)
    if not whole:
        first, last = table.lines(np.array([rows.start, rows.stop - 1]))
        source = f"{source}{PIECE}{first}-{last}"
    angle = series["angle"][rows]
    # A disk at rest has an angle that only shakes.
    if unit is not None:
        _units.check_wrapping(angle / _units.factors({"angle": unit})["angle"], unit, source)
        angle = np.unwrap(angle)
    readings = np.stack([series[name][rows] for name in CHANNELS], axis=-1)
    time, turned = np.array(series["time"][rows]), np.array(angle)
    for values in (time, turned, readings):
        values.flags.writeable = False
    return Recording(time, angle=turned, readings=readings, source=source)


def _refuse_constant(run: Recording, where: Mapping[str, str | int]) -> None:
    for name, values in (("angle", run.angle), *zip(CHANNELS, run.readings.T, strict=True)):
        if name in where and np.ptp(values) == 0.0:
            raise RecordError(
                run.source,
                f"column {where[name]!r} ({name}): does not change: is it connected?",
            )
