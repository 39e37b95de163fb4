"""Columns of numbers from text files, with line numbers for what is wrong in them."""

from __future__ import annotations

import csv
import math
import os
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TextIO

import numpy as np
from numpy.typing import NDArray

from asperity._base import arrays
from asperity._base.arrays import Array
from asperity.errors import ParameterError, RecordError

_SHOWN, _LONGEST = 12, 40
# With more unreadable lines than this share the file is no table.
_MOSTLY = 0.5


@dataclass(frozen=True)
class Format:
    """How a text file holds numbers.

    Attributes:
        delimiter: between columns; None or a blank for any white space.
        decimal: "." or ",".
        header: lines before the numbers, the last of which names the columns.
        encoding: of the text.
    """

    delimiter: str | None = ","
    decimal: str = "."
    header: int = 1
    encoding: str = "utf-8-sig"

    def __post_init__(self) -> None:
        if self.delimiter == " ":
            object.__setattr__(self, "delimiter", None)
        arrays.choice(self.decimal, "decimal", (".", ","))
        arrays.count(self.header, "header", least=0)
        if self.delimiter is not None and (
            not isinstance(self.delimiter, str) or len(self.delimiter) != 1
        ):
            raise ParameterError("delimiter", f"must be one character, got {self.delimiter!r}")
        if self.delimiter == self.decimal:
            raise ParameterError("delimiter", "must differ from the decimal mark")
        try:
            "".encode(self.encoding)
        except LookupError:
            raise ParameterError("encoding", f"is not known: {self.encoding!r}") from None


@dataclass(frozen=True)
class Table:
    """Columns of a file, NaN where nothing could be read."""

    path: Path
    format: Format
    values: Array

    def lines(self, rows: NDArray[np.intp]) -> NDArray[np.intp]:
        """Return the line numbers, from 1, of rows of the table."""
        with _text(self.path, self.format) as file:
            used = [number for number, line in enumerate(file, 1) if line.strip()]
        # Blank lines of the header count as header.
        kept = [number for number in used if number > self.format.header]
        return np.asarray(kept, dtype=np.intp)[rows]


def read_table(
    path: str | os.PathLike[str], columns: Mapping[str, str | int], form: Format
) -> Table:
    """Read columns of a text file, given by name or by number from 0, in the order of `columns`.

    Raises:
        RecordError: if the file is missing, empty, of another encoding, not a table of numbers, or
            without one of the columns.
    """
    place = Path(path)
    try:
        with _text(place, form) as file:
            names = _names(file, form, place)
            wanted = [_position(column, names, place, form.header) for column in columns.values()]
            _refuse_twice(columns, wanted)
            values = _quickly(file, form, wanted)
        if values is None:
            _refuse_missing(columns, wanted, place, form)
            values = _slowly(place, form, wanted)
    except UnicodeError:
        raise RecordError(
            str(place),
            f"is not {form.encoding} text, perhaps 'latin-1' or 'utf-16'",
            ("encoding",),
        ) from None
    except csv.Error as error:
        raise RecordError(str(place), f"is not a text table: {error}") from None
    except OSError as error:
        raise RecordError(str(place), f"cannot be read: {error.strerror}") from None
    if not len(values):
        raise RecordError(str(place), f"holds no numbers after {form.header} header lines")
    return Table(place, form, values)


def has_column(path: str | os.PathLike[str], name: str, form: Format) -> bool:
    """Return whether the last header line of a file names a column; no if it cannot be read."""
    try:
        with _text(Path(path), form) as file:
            return name in _names(file, form, Path(path))
    except (OSError, UnicodeError, csv.Error, RecordError):
        return False


def _text(path: Path, form: Format) -> TextIO:
    return path.open(encoding=form.encoding, newline=None)


def _split(line: str, form: Format) -> list[str]:
    if form.delimiter is None:
        return line.split()
    return [cell.strip() for cell in next(csv.reader([line], delimiter=form.delimiter), [])]


def _names(file: TextIO, form: Format, path: Path) -> list[str]:
    if path.stat().st_size == 0:
        raise RecordError(str(path), "is empty")
    line = ""
    for _ in range(form.header):
        line = file.readline()
    return _split(line, form) if form.header else []


def _position(column: str | int, names: Sequence[str], path: Path, header: int) -> int:
    if isinstance(column, bool) or not isinstance(column, str | int):
        raise ParameterError("columns", f"must hold names or numbers, got {column!r}")
    if isinstance(column, int):
        return arrays.count(column, "columns", least=0)
    if column not in names:
        listed = ", ".join(_short(name) for name in names[:_SHOWN]) or "numbers: header is 0"
        message, options = f"has no column {_short(column)}, only {listed}", ("columns",)
        if header > 1:
            # A line of units is often the last one.
            message += f", the names in line {header}, the last of the header: if they stand in "
            message += "another line, give the numbers of the columns, which count from 0"
        raise RecordError(str(path), message, options)
    return names.index(column)


def _short(name: str) -> str:
    return repr(name if len(name) <= _LONGEST else f"{name[:_LONGEST]}…")


def _refuse_twice(columns: Mapping[str, str | int], wanted: Sequence[int]) -> None:
    names = list(columns)
    for at, position in enumerate(wanted):
        first = wanted.index(position)
        if first < at:
            raise ParameterError(
                "columns", f"give the same column for {names[first]} and {names[at]}"
            )


def _refuse_missing(
    columns: Mapping[str, str | int], wanted: Sequence[int], path: Path, form: Format
) -> None:
    """Refuse a column beyond the last one of the first line of numbers."""
    with _text(path, form) as file:
        lines = (line for number, line in enumerate(file, 1) if number > form.header)
        width = len(_split(next((line for line in lines if line.strip()), ""), form))
    for name, position in zip(columns, wanted, strict=True):
        if position >= width > 1 and isinstance(columns[name], int):
            raise RecordError(
                str(path), f"has no column {position} ({name}), {width} columns", ("columns",)
            )


def _quickly(file: TextIO, form: Format, wanted: Sequence[int]) -> Array | None:
    """Return the columns if every line is in order, else None."""
    lines: TextIO | Iterator[str] = file
    if form.decimal == ",":
        lines = (line.replace(",", ".") for line in file)
    with np.errstate(all="ignore"):
        try:
            return np.asarray(_loaded(lines, form, wanted), dtype=np.float64)
        except UnicodeError:
            raise
        except ValueError:
            return None


def _loaded(lines: TextIO | Iterator[str], form: Format, wanted: Sequence[int]) -> Array:
    import warnings

    with warnings.catch_warnings():
        # That there are no numbers is said in our own words.
        warnings.simplefilter("ignore", UserWarning)
        return np.loadtxt(
            lines, delimiter=form.delimiter, usecols=wanted, ndmin=2, comments=None, quotechar='"'
        )


def _slowly(path: Path, form: Format, wanted: Sequence[int]) -> Array:
    """Return the columns line by line, NaN for what is no number."""
    rows, broken, first = [], 0, ""
    with _text(path, form) as file:
        for number, line in enumerate(file, 1):
            if number <= form.header or not line.strip():
                continue
            cells = _split(line, form)
            row = [_number(cells[at], form) if at < len(cells) else math.nan for at in wanted]
            if math.isnan(sum(row)):
                broken += 1
                first = first or f"line {number} reads {line.strip()[:40]!r}"
            rows.append(row)
    if broken > _MOSTLY * len(rows):
        raise RecordError(
            str(path), f"is not a table of numbers: {first}", ("delimiter", "decimal", "header")
        )
    return np.array(rows, dtype=np.float64).reshape(-1, len(wanted))


def _number(cell: str, form: Format) -> float:
    text = cell.strip('"').replace(",", ".") if form.decimal == "," else cell.strip('"')
    try:
        return float(text)
    except ValueError:
        return math.nan
