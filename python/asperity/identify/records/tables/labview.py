"""Measurement files of LabVIEW (.lvm): what their headings say, and where they come again.

A heading stands before the table and, by default, before each part of it that was written at once.
Its lines begin with a tag; that of units, of the first x and of their steps have a cell for each
column of the table, whose names come last, behind ``X_Value``.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from typing import NamedTuple

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


def without_headings(lines: Iterable[str]) -> Iterator[str]:
    """Return lines of which those of further headings are empty."""
    inside = False
    for line in lines:
        inside = inside or line.startswith((_PART, _NOTES))
        yield "\n" if inside else line
        inside = inside and not line.startswith(LAST)
