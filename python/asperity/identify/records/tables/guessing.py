"""How a text holds numbers: encoding, delimiter, decimal mark, groups of digits, header."""

from __future__ import annotations

import codecs
import csv
import io
import re
from collections import Counter
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from itertools import product, zip_longest
from pathlib import Path
from typing import Any

from asperity._base.storage.files import unreadable
from asperity.errors import RecordError
from asperity.identify.records.tables import clock, labview
from asperity.identify.records.tables.text_table import THOUSANDS, Format, heading_cells, split

# Bytes and lines that are looked at, and bytes in the middle and at the end of what is longer.
_BYTES, _LINES, _LATER = 1 << 18, 2000, 1 << 15
_MARKS = (
    (codecs.BOM_UTF8, "utf-8-sig"),
    (codecs.BOM_UTF16_LE, "utf-16"),
    (codecs.BOM_UTF16_BE, "utf-16"),
)
_DELIMITERS = (";", "\t", ",", "|", None)
_NUMBER = {
    mark: re.compile(rf"[-+]?(\d+{m}?\d*|{m}\d+)([eE][-+]?\d+)?")
    for mark, m in ((".", r"\."), (",", ","))
}
_GROUPS = {
    (mark, group): re.compile(rf"[-+]?\d{{1,3}}({re.escape(group)}\d{{3}})+({re.escape(mark)}\d*)?")
    for mark, group in product((".", ","), THOUSANDS)
}
# A number with marks in it, and one without that is no longer than a group.
_MARKED, _SHORT = re.compile(r"[-+]?[\d.,]*\d"), re.compile(r"[-+]?\d{1,3}")
# A line of numbers is one if this share of its cells are.
_MOST = 0.5
# So many lines of numbers one after the other begin the table.
_IN_A_ROW = 3


@dataclass(frozen=True)
class Guess:
    """How a table is written, and its first lines cell by cell.

    Attributes:
        form: of the numbers.
        header: cells of the lines before the numbers.
        body: cells of lines of numbers.
    """

    form: Format
    header: list[list[Any]]
    body: list[list[Any]]


def guess(path: Path) -> Guess:
    """Return how a text file holds its numbers.

    Raises:
        RecordError: if it cannot be read, or holds no table of numbers.
    """
    try:
        encoding, lines, later = _looked_at(path)
    except OSError as error:
        raise RecordError(str(path), unreadable(path, error)) from None
    if not lines:
        raise RecordError(str(path), "is empty")
    tables = {delimiter: _cells([*lines, *later], delimiter) for delimiter in _DELIMITERS}
    delimiter, decimal, group = _best(tables, str(path))
    cells = _cells(lines, delimiter)
    first = _first(cells, decimal, group)
    form = Format(delimiter, decimal, first, encoding, None, group)
    body = [row for row in cells[first:] if row]
    width = len(body[0])
    header = [heading_cells(line, form, width) if line.strip() else [] for line in lines[:first]]
    return Guess(form, header, body)


def of_cells(cells: Sequence[Sequence[Any]], source: str, sheet: str | int) -> Guess:
    """Return how the cells of a sheet hold numbers.

    Raises:
        RecordError: if they hold no table of numbers.
    """
    rows = [["" if cell is None else cell for cell in row] for row in cells]
    some = rows[:_LINES]
    # No character parts cells that are parted already.
    best = _best({"": some}, source, "sheet")[1:]
    first = _first(some, *best)
    delimiter = Format().delimiter if best[0] == "." else ";"
    form = Format(delimiter, best[0], first, "utf-8-sig", None, best[1], sheet)
    return Guess(form, rows[:first], [row for row in rows[first:] if any(c != "" for c in row)])


def _best(
    tables: Mapping[str | None, Sequence[Sequence[Any]]], source: str, *options: str
) -> tuple[str | None, str, str | None]:
    """Return the delimiter, the decimal mark and that of groups by which most cells are numbers.

    Args:
        tables: the cells of lines by what parts them.
        source: for messages.
        options: what else may be wrong where there are none.
    """
    best, score = None, 0.0
    for delimiter, cells in tables.items():
        groups = [mark for mark in (".", ",") if mark != delimiter and _parts_groups(cells, mark)]
        for decimal, group in product((".", ","), (None, *THOUSANDS)):
            if decimal in (delimiter, group, *groups) or (
                group is not None and delimiter is None and group.isspace()
            ):
                continue
            # What needs less to be said comes first.
            found = _score(cells, decimal, group) - 1e-6 * (group is not None)
            if found > score + 1e-9:
                best, score = (delimiter, decimal, group), found
    if best is None:
        raise RecordError(source, "holds no table of numbers", options)
    return best


def _looked_at(path: Path) -> tuple[str, list[str], list[str]]:
    """Return the encoding, the first lines, and some from the middle and the end of a long file."""
    with path.open("rb") as file:
        start = file.read(_BYTES)
        encoding, text = _decoded(start)
        lines = text.splitlines()
        if len(start) < _BYTES:
            return encoding, _table_lines(lines)[:_LINES], []
        size = file.seek(0, io.SEEK_END)
        later: list[str] = []
        # Only the start of a file has a mark.
        unmarked = {"utf-8-sig": "utf-8", "utf-16": "utf-16-le"}.get(encoding, encoding)
        for at in (size // 2, size - _LATER):
            # Characters of two bytes begin at even places.
            file.seek(max(at - at % 2, 0))
            part = file.read(_LATER).decode(unmarked, "ignore").splitlines()
            later += part[1:-1]
    # The last line may be cut.
    return encoding, _table_lines(lines[:-1])[:_LINES], later


def _table_lines(lines: list[str]) -> list[str]:
    """Return lines without those of headings that come again."""
    names = next((at for at, line in enumerate(lines) if line.startswith(labview.LAST)), None)
    if not lines or not labview.begins_one(lines[0]) or names is None:
        return lines
    head = names + 1
    return lines[:head] + [line.strip("\n") for line in labview.Parts(lines[head:], lines[:head])]


def _parts_groups(rows: Sequence[Sequence[Any]], mark: str) -> bool:
    """Return whether a mark must part groups of three digits: 998, 999, 1,000 in one column."""
    one = re.escape(mark)
    group, has = re.compile(rf"[-+]?[1-9]\d{{0,2}}({one}\d{{3}})+"), False
    for column in zip_longest(*rows, fillvalue=""):
        texts = [cell.strip('" ') for cell in column if isinstance(cell, str)]
        marked = [text for text in texts if mark in text and _MARKED.fullmatch(text)]
        if not all(group.fullmatch(text) for text in marked):
            return False
        has = has or (bool(marked) and any(_SHORT.fullmatch(text) for text in texts))
    return has


def _decoded(start: bytes) -> tuple[str, str]:
    """Return the encoding and the text."""
    for mark, name in _MARKS:
        if start.startswith(mark):
            return name, start.decode(name, "ignore")
    for name, odd in (("utf-16-le", start[1::2]), ("utf-16-be", start[::2])):
        if odd.count(0) > 0.4 * len(odd):
            return name, start.decode(name, "ignore")
    try:
        # A character may be cut at the end.
        return "utf-8-sig", codecs.getincrementaldecoder("utf-8")().decode(start)
    except UnicodeDecodeError:
        pass
    try:
        return "cp1252", start.decode("cp1252")
    except UnicodeDecodeError:
        return "latin-1", start.decode("latin-1")


def _cells(lines: Sequence[str], delimiter: str | None) -> list[list[Any]]:
    form = Format(delimiter, "." if delimiter == "," else ",")
    found: list[list[Any]] = []
    for line in lines:
        try:
            found.append(split(line, form) if line.strip() else [])
        except csv.Error:
            found.append([])
    return found


def is_number(cell: Any, decimal: str, group: str | None) -> bool:
    """Return whether a cell is a number or a time of day."""
    if not isinstance(cell, str):
        return not isinstance(cell, bool)
    text = cell.strip().strip('"')
    if _NUMBER[decimal].fullmatch(text) or clock.seconds(text) == clock.seconds(text):
        return True
    return group is not None and _GROUPS[decimal, group].fullmatch(text) is not None


def _score(rows: Sequence[Sequence[Any]], decimal: str, group: str | None) -> float:
    """Return how much of the lines is numbers, of lines that have as many as most of them."""
    numbers = [sum(is_number(cell, decimal, group) for cell in row if cell != "") for row in rows]
    filled = [sum(cell != "" for cell in row) for row in rows]
    counted = Counter(n for n in numbers if n > 1)
    if not counted:
        return 0.0
    usual = counted.most_common(1)[0][0]
    pairs = zip(numbers, filled, strict=True)
    whole = sum(n / cells for n, cells in pairs if n == usual and n >= _MOST * cells)
    # More columns decide between delimiters that both fit.
    return whole / sum(cells > 0 for cells in filled) * (1.0 - 0.1 / usual)


def _first(rows: Sequence[Sequence[Any]], decimal: str, group: str | None) -> int:
    """Return the number of lines before the numbers."""
    numbers = [sum(is_number(cell, decimal, group) for cell in row if cell != "") for row in rows]
    usual = Counter(n for n in numbers if n > 1).most_common(1)[0][0]
    run = 0
    for at, count in enumerate(numbers):
        run = run + 1 if count >= _MOST * usual and count > 1 else 0
        if run == min(_IN_A_ROW, len(rows)):
            return at - run + 1
    return next(at for at, count in enumerate(numbers) if count == usual)
