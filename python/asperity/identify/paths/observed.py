"""Measured paths as they enter a fit, from objects and from text files."""

from __future__ import annotations

import csv
import os
import re
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from asperity._base import arrays
from asperity._base.arrays import Array
from asperity._base.storage.files import unreadable
from asperity.errors import ParameterError, RecordError
from asperity.runs.comparison import TimedPath
from asperity.runs.run import Run

_TITLE = re.compile(r"\s*(?P<name>[^\[\]]*?)\s*(?:\[\s*(?P<unit>[^\]]*?)\s*\])?\s*")
_UNITS = {
    "t": {"": 1.0, "s": 1.0, "ms": 1e-3, "us": 1e-6, "µs": 1e-6},
    "x": {"": 1.0, "m": 1.0, "cm": 1e-2, "mm": 1e-3, "um": 1e-6, "µm": 1e-6},
}
_NAMES = {"t": ("t", "time"), "x1": ("x1", "x"), "x2": ("x2", "y")}
_ERRORS = {"e1": ("x1 error", "x1_error"), "e2": ("x2 error", "x2_error")}
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


def observed(paths: Any, position_error: float | None) -> tuple[Observed, ...]:
    """Return the paths that are given as objects or as files.

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
    found = tuple(_observed(one, k, known) for k, one in enumerate(listed))
    for k, one in enumerate(found):
        for j, other in enumerate(found[:k]):
            # Noise of two films is never the same: a copy would narrow the scatter between paths.
            if np.array_equal(one.time, other.time) and np.array_equal(
                one.position, other.position
            ):
                raise ParameterError(f"paths[{k}]", f"is paths[{j}] once more: leave it out")
    return found


def _observed(given: Any, number: int, known: float | None) -> Observed:
    argument = f"paths[{number}]"
    if isinstance(given, Observed):
        return given
    if isinstance(given, str | os.PathLike):
        name = str(given)
        time, position, own = read_path(given)
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
            "position_error", f"is needed: {name} does not say how exact its positions are"
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


def read_path(path: str | os.PathLike[str]) -> tuple[Array, Array, Array | None]:
    """Read times, positions and, where there are columns for them, their standard errors.

    The first line names the columns: ``t [s]``, ``x1 [m]``, ``x2 [m]``, and ``x1 error [m]``,
    ``x2 error [m]``, as `track.MeasuredPath.to_csv` writes them; other columns are not read.
    """
    place = Path(path)
    try:
        lines = place.read_text(encoding="utf-8-sig").splitlines()
    except OSError as failed:
        raise RecordError(str(place), unreadable(place, failed)) from None
    except UnicodeError:
        raise RecordError(str(place), "is not utf-8 text") from None
    head = lines[0] if lines else ""
    separator = next((one for one in (";", "\t", ",") if one in head), ",")
    titles = next(csv.reader([head], delimiter=separator), [])
    found = {key: _column(titles, key, names, place) for key, names in (_NAMES | _ERRORS).items()}
    for key, names in _NAMES.items():
        if found[key] is None:
            raise RecordError(
                str(place),
                f"must name a column {names[0]!r} in its first line, with its unit in brackets, "
                f"names {', '.join(map(repr, titles)) or 'none'}",
            )
    columns = [one for one in found.values() if one is not None]
    rows = []
    for number, cells in enumerate(csv.reader(lines[1:], delimiter=separator), 2):
        if not any(cell.strip() for cell in cells):
            continue
        rows.append([_number(cells, column, number, place) for column, _ in columns])
    table = np.array(rows).reshape(-1, len(columns)) * [factor for _, factor in columns]
    if not np.isfinite(table[:, 0]).all():
        raise RecordError(str(place), "must hold a time in every line")
    error = table[:, 3:5] if len(columns) == 5 else None
    return table[:, 0], table[:, 1:3], error


def _column(
    titles: Sequence[str], key: str, names: tuple[str, ...], place: Path
) -> tuple[int, float] | None:
    for number, text in enumerate(titles):
        match = _TITLE.fullmatch(text)
        if match is None or match["name"] not in names:
            continue
        units = _UNITS["t" if key == "t" else "x"]
        unit = match["unit"] or ""
        if unit not in units:
            words = ", ".join(one for one in units if one)
            raise RecordError(
                str(place), f"has {match['name']} in {unit!r}: must be one of {words}"
            )
        return number, units[unit]
    return None


def _number(cells: Sequence[str], column: int, line: int, place: Path) -> float:
    text = cells[column].strip() if column < len(cells) else ""
    try:
        return float(text) if text else float("nan")
    except ValueError:
        raise RecordError(f"{place}, line {line}", f"must hold numbers, holds {text!r}") from None
