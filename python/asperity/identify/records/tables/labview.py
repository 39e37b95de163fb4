"""Measurement files of LabVIEW (.lvm): what their headings say, and where they come again.

A heading stands before the table and, by default, before each part of it that was written at once.
Its lines begin with a tag; that of units, of the first x and of their steps have a cell for each
column of the table, whose names come last, behind ``X_Value``.
"""

from __future__ import annotations

import math
import re
from collections.abc import Iterable, Iterator, Sequence
from typing import NamedTuple

import numpy as np

from asperity._base.arrays import Array
from asperity.identify.records.tables import clock

LAST = "X_Value"
"""Begins the line of names."""

_FIRST, _PART = "LabVIEW Measurement", "Channels"
# The heading of a part may begin with notes.
_NOTES = "Notes"


class Heading(NamedTuple):
    """What the heading of a file says of its columns.

    Attributes:
        units: of the columns; that of x is the second if it is a time.
        step: of x, as text, where x has no column of its own; empty if it has one, or the channels
            differ.
    """

    units: list[str]
    step: str


def begins_one(line: str) -> bool:
    """Return whether a line is the first one of such a file."""
    return line.startswith(_FIRST)


def heading_of(header: Sequence[Sequence[str]]) -> Heading | None:
    r"""Return what the lines before the numbers say, cell by cell; None if they are no heading.

    >>> from asperity.identify.records.tables.labview import heading_of
    >>> lines = ["LabVIEW Measurement", "X_Columns\tOne", "Y_Unit_Label\tN", "X_Dimension\tTime"]
    >>> heading_of([*(line.split("\t") for line in lines), ["X_Value", "Ft"]]).units
    ['s', 'N']
    """
    if not header or not header[0] or not begins_one(header[0][0]):
        return None
    tags = {line[0]: list(line[1:]) for line in header if line and line[0]}
    names = next((line for line in reversed(header) if line and line[0] == LAST), None)
    if names is None:
        return None
    width = len(names)
    units = ["", *tags.get("Y_Unit_Label", []), *[""] * width][:width]
    # The cell behind that of an x is that of its channel.
    dimensions = [*tags.get("X_Dimension", []), *[""] * width]
    for at, name in enumerate(names):
        if name == LAST and dimensions[at] == "Time":
            units[at] = "s"
    steps = {step for step in tags.get("Delta_X", []) if step}
    alone = tags.get("X_Columns", [""])[0] == "No" and len(steps) == 1 and "Time" in dimensions
    return Heading(units, steps.pop() if alone else "")


class Part(NamedTuple):
    """Where a part begins.

    Attributes:
        row: of the numbers, from 0.
        begins: date and time of its heading in s, NaN if it says none.
        first: x at the beginning in the heading, 0 if it says none.
    """

    row: int
    begins: float
    first: float


class Parts:
    """Lines of which those of further headings are empty; `starts` grows while they are read.

    Args:
        lines: after the first heading.
        heading: the lines of that; None if LabVIEW has not written the file.
    """

    def __init__(self, lines: Iterable[str], heading: Iterable[str] | None) -> None:
        self._lines = lines
        self._again = heading is not None
        self.starts = [_part(0, heading)] if heading is not None else []

    def __iter__(self) -> Iterator[str]:
        if not self._again:
            yield from self._lines
            return
        row, heading = 0, list[str]()
        for line in self._lines:
            if not heading and not line.startswith((_PART, _NOTES)):
                row += bool(line.strip())
                yield line
                continue
            heading.append(line)
            if line.startswith(LAST):
                self.starts.append(_part(row, heading))
                heading = []
            yield "\n"


def _part(row: int, heading: Iterable[str]) -> Part:
    apart = [line.split("\t") if "\t" in line else re.split("[;,]", line) for line in heading]
    tags = {cells[0]: cells[1] for cells in apart if len(cells) > 1}
    begins = clock.seconds(f"{tags.get('Date', '')} {tags.get('Time', '')}")
    try:
        first = float(tags.get("X0", "0").replace(",", "."))
    except ValueError:
        first = 0.0
    return Part(row, begins, first)


def through_parts(x: Array, starts: Sequence[Part]) -> Array:
    """Return times that go on where x starts again in each part: those of its heading, X0 and x.

    Pauses between parts are gaps of time then. What goes on by itself stays as it is, and so does
    what headings do not put in order.

    >>> import numpy as np
    >>> from asperity.identify.records.tables.labview import Part, through_parts
    >>> through_parts(np.array([0.0, 1.0, 0.0, 1.0]), [Part(0, 60.0, 0.0), Part(2, 65.0, 0.0)])
    array([0., 1., 5., 6.])
    """
    known = [one for one in starts if one.row < len(x)]
    rows = [one.row for one in known]
    if not any(x[row] <= x[row - 1] for row in rows[1:]):
        return x
    # X0 is in x already where x begins with it.
    begins = np.array(
        [one.begins + (0.0 if math.isclose(x[one.row], one.first, rel_tol=1e-9, abs_tol=1e-12)
                       else one.first) for one in known]
    )  # fmt: skip
    lengths = np.diff([*rows, len(x)])
    found: Array = x + np.repeat(begins - known[0].begins, lengths)
    return found if all(found[row] > found[row - 1] for row in rows[1:]) else x


def of_parts(count: int, starts: Sequence[Part], rate: float) -> Array:
    """Return the times of rows that are 1/rate apart; between parts as their headings say."""
    row = np.arange(count)
    first = np.zeros(count) if not starts else np.repeat(
        [one.row for one in starts if one.row < count],
        np.diff([*(one.row for one in starts if one.row < count), count]),
    )  # fmt: skip
    time = through_parts((row - first) / rate, starts)
    return time if (np.diff(time) > 0.0).all() else row / rate
