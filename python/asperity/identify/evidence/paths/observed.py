"""Measured paths as they enter a fit, from objects and from text files."""

from __future__ import annotations

import os
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np

from asperity._base import arrays
from asperity._base.arrays import Array
from asperity.errors import ParameterError, RecordError
from asperity.identify.records.inspection import inspect_path
from asperity.identify.records.tables.headings import known_units
from asperity.identify.records.tables.text_table import (
    Format,
    read_table,
)
from asperity.runs.comparison import TimedPath
from asperity.runs.run import Run

COLUMNS = ("time", "x1", "x2", "x1_error", "x2_error")
"""What is read of a file."""
FEWEST = 4
"""A path of fewer points tells no more than its launch."""


@dataclass(frozen=True)
class Observed:
    """A measured path.

    Attributes:
        name: of the path, for messages.
        time: in s, ascending, ``(n,)``.
        position: in m, ``(n, 2)``.
        error: standard errors of the positions in m, ``(n, 2)``.
    """

    name: str
    time: Array
    position: Array
    error: Array


def observed(
    paths: Any,
    position_error: float | None,
    reading: Mapping[str, Mapping[str, Any]] | None = None,
) -> tuple[Observed, ...]:
    """Return the paths that are given as objects or as files, read as `read_path` does.

    Raises:
        ParameterError: naming the path and what is wrong with it.
        RecordError: if a file cannot be used.
    """
    if isinstance(paths, str | os.PathLike | TimedPath | Run):
        paths = (paths,)
    known = None if position_error is None else arrays.positive(position_error, "position_error")
    listed = arrays.several(paths, "paths")
    if not listed:
        raise ParameterError("paths", "must hold a path at least")
    found = tuple(_observed(one, k, known, reading) for k, one in enumerate(listed))
    for k, one in enumerate(found):
        for j, other in enumerate(found[:k]):
            # Noise of two films is never the same: a copy would narrow the scatter between paths.
            if np.array_equal(one.time, other.time) and np.array_equal(
                one.position, other.position
            ):
                raise ParameterError(f"paths[{k}]", f"is paths[{j}] once more: leave it out")
    return found


def _observed(
    given: Any,
    number: int,
    known: float | None,
    reading: Mapping[str, Mapping[str, Any]] | None,
) -> Observed:
    argument = f"paths[{number}]"
    if isinstance(given, Observed):
        return given
    if isinstance(given, str | os.PathLike):
        name = str(given)
        time, position, own = read_path(given, reading)
        first = _onset(time, position)
    elif isinstance(given, Run):
        name, first, own = argument, -np.inf, None
        time, position = given.t, given.q[:, :2]
    elif isinstance(given, TimedPath):
        name = argument
        time = arrays.array(given.time, f"{argument}.time", (None,))
        position = arrays.with_gaps(given.position, f"{argument}.position", (len(time), 2))
        stated = getattr(given, "position_error", None)
        own = None if stated is None else arrays.with_gaps(stated, f"{argument}.position_error")
        # Before, a body rests or is held, which no launch says.
        first = getattr(given, "section", (-np.inf,))[0]
    else:
        raise ParameterError(
            argument, f"must be a path with time and position, a run, or a file, got {given!r}"
        )
    if (np.diff(time) <= 0.0).any():
        raise ParameterError(f"{name}: time", "must ascend")
    if known is not None:
        own = np.full(position.shape, known)
    if own is None:
        raise ParameterError(
            "position_error",
            f"is needed: {name} does not say how exact its positions are; a configuration has it "
            "in [paths]",
        )
    error = np.broadcast_to(own, position.shape)
    kept = np.isfinite(position).all(axis=1) & np.isfinite(error).all(axis=1) & (time >= first)
    if kept.sum() < FEWEST:
        raise ParameterError(name, f"must hold {FEWEST} points at least, holds {kept.sum()}")
    if not (error[kept] > 0.0).all():
        raise ParameterError(
            "position_error", f"is needed: some errors of the positions of {name} are zero"
        )
    return Observed(name, *(arrays.read_only(part[kept]) for part in (time, position, error)))


def _onset(time: Array, position: Array) -> float:
    """Return the time at which a body begins to move, as that of a tracked path."""
    from asperity.track import MeasuredPath

    try:
        return MeasuredPath(time, position, np.zeros_like(position)).section[0]
    except ParameterError:
        # Too few points to tell a rest.
        return -np.inf


def read_path(
    path: str | os.PathLike[str], reading: Mapping[str, Mapping[str, Any]] | None = None
) -> tuple[Array, Array, Array | None]:
    """Read times, positions and, where there are columns for them, their standard errors.

    Args:
        path: of a table whose headings name the columns, such as ``t [s]``, ``x1 [m]``, ``x2 [m]``
            and ``x1 error [m]``, ``x2 error [m]``, as `track.MeasuredPath.to_csv` writes them, or
            ``Time (s)``, ``X (mm)``, ``Y (mm)``; other columns are not read.
        reading: sections ``file``, ``columns`` and ``units`` of a configuration, which take the
            place of what the file seems to be.

    Raises:
        RecordError: if it is no such table.
    """
    given, guessed = reading or {}, inspect_path(path)
    stated = {**guessed.sections, **given}
    columns = {name: stated.get("columns", {})[name] for name in COLUMNS
               if name in stated.get("columns", {})}  # fmt: skip
    for name in COLUMNS[:3]:
        if name not in columns:
            called = ", ".join(repr(one.name) for one in guessed.columns)
            notes = [
                note
                for note in guessed.notes
                if note.startswith((f"{name}: u", f"{name}: c", "head"))
            ]
            raise RecordError(
                str(path),
                "; ".join([f"no column seems to be {name}, of {called}", *notes]),
                ("columns",),
            )
    if not {"x1_error", "x2_error"} <= set(columns):
        columns = {name: columns[name] for name in COLUMNS[:3]}
    form = Format(**{k: v for k, v in stated["file"].items() if k in vars(Format())})
    table = read_table(path, columns, form, units=given.get("units"), texts=False)
    bare = {"x1", "x2"} - set(table.units)
    if len(bare) == 1:
        raise RecordError(
            str(path),
            f"{bare.pop()} has no unit, the other coordinate has: say both",
            ("units",),
        )
    known = [known_units(name) for name in columns]
    scale = [
        one[table.units.get(name, next(iter(one)))]
        for name, one in zip(columns, known, strict=True)
    ]
    values = table.values * scale
    if not np.isfinite(values[:, 0]).all():
        raise RecordError(str(path), "must hold a time in every line")
    return values[:, 0], values[:, 1:3], values[:, 3:5] if len(columns) == len(COLUMNS) else None
