"""Columns of numbers from text files, spreadsheets and tables in memory, with numbers of lines."""

from __future__ import annotations

import csv
import math
import os
import re
from collections.abc import Callable, Collection, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any, TextIO, TypeAlias

import numpy as np
from numpy.typing import NDArray

from asperity._base import arrays
from asperity._base.arrays import Array
from asperity._base.storage.files import unreadable
from asperity.errors import ParameterError, RecordError
from asperity.identify.records.tables import clock, labview

if TYPE_CHECKING:
    import pandas
    from typing_extensions import TypeIs

Source: TypeAlias = "str | os.PathLike[str] | pandas.DataFrame"
"""A file with a table, or a table."""

SPREADSHEETS = (".xlsx", ".xlsm")
_SHOWN, _LONGEST = 12, 40
# With more unreadable lines than this share the file is no table.
_MOSTLY = 0.5
THOUSANDS = (",", ".", " ", "'", "\u2019", "\u00a0", "\u202f", "_")
"""What may stand between groups of three digits."""
_BRACKETED = re.compile(r"[\[(<][^\[\]()<>]*[\])>]$")
_GROUPED = re.compile(r"[-+]?\d{1,3}([,. '\u2019\u00a0\u202f_])\d{3}(\1\d{3})*([.,]\d*)?")


@dataclass(frozen=True)
class Format:
    """How a file holds numbers.

    Attributes:
        delimiter: between columns; None or a blank for any white space.
        decimal: "." or ",".
        header: lines before the numbers.
        encoding: of the text.
        names: the line of the header that names the columns, from 1; None for the last.
        thousands: between groups of three digits; None if nothing is.
        sheet: of a spreadsheet, by name or number from 0.
    """

    delimiter: str | None = ","
    decimal: str = "."
    header: int = 1
    encoding: str = "utf-8-sig"
    names: int | None = None
    thousands: str | None = None
    sheet: str | int = 0

    def __post_init__(self) -> None:
        if self.delimiter == " ":
            object.__setattr__(self, "delimiter", None)
        arrays.choice(self.decimal, "decimal", (".", ","))
        arrays.count(self.header, "header", least=0)
        if self.delimiter is not None and (
            not isinstance(self.delimiter, str) or len(self.delimiter) != 1
        ):
            raise ParameterError("delimiter", f"must be one character, got {self.delimiter!r}")
        if self.names is not None and arrays.count(self.names, "names") > self.header:
            raise ParameterError("names", f"must be one of the {self.header} header lines")
        if self.thousands is not None:
            arrays.choice(self.thousands, "thousands", THOUSANDS)
            if self.thousands == self.decimal:
                raise ParameterError("thousands", "must differ from the decimal mark")
            if self.thousands.isspace() and self.delimiter is None:
                raise ParameterError("thousands", "must not be a blank where blanks part columns")
        if isinstance(self.sheet, bool) or not isinstance(self.sheet, str | int):
            raise ParameterError("sheet", f"must be a name or a number, got {self.sheet!r}")
        try:
            "".encode(self.encoding)
        except LookupError:
            raise ParameterError("encoding", f"is not known: {self.encoding!r}") from None

    @property
    def line_of_names(self) -> int:
        """The line that names the columns, from 1; 0 where there is none."""
        return self.header if self.names is None else self.names


@dataclass(frozen=True)
class Table:
    """Columns of a table, NaN where nothing could be read.

    `rows` are the numbers of its lines if it was no text.
    """

    source: str
    format: Format
    values: Array
    rows: NDArray[np.intp] | None = None

    def lines(self, rows: NDArray[np.intp]) -> NDArray[np.intp]:
        """Return the line numbers, from 1, of rows of the table."""
        if self.rows is not None:
            return self.rows[rows]
        with _text(Path(self.source), self.format) as file:
            lines = _all_lines(file)
            used = [number for number, line in enumerate(lines, 1) if line.strip()]
        # Blank lines of the header count as header.
        kept = [number for number in used if number > self.format.header]
        return np.asarray(kept, dtype=np.intp)[rows]


def name_of(source: Source) -> str:
    """Return what messages call a source."""
    if isinstance(source, str | os.PathLike):
        return os.fspath(source)
    return str(getattr(source, "attrs", {}).get("name", "table in memory"))


def is_frame(source: object) -> TypeIs[pandas.DataFrame]:
    """Return whether a source is a table in memory."""
    return hasattr(source, "columns") and hasattr(source, "iloc")


def read_table(
    path: Source,
    columns: Mapping[str, str | int],
    form: Format,
    *,
    clocked: Collection[str] = (),
) -> Table:
    """Read columns of a table, given by name or by number from 0, in the order of `columns`.

    Args:
        path: a text file, a spreadsheet or a table in memory.
        columns: where they are.
        form: how the file holds numbers.
        clocked: the columns, of these, whose cells are times of day.

    Raises:
        RecordError: if the file is missing, empty, of another encoding, not a table of numbers, or
            without one of the columns.
    """
    if is_frame(path):
        return _of_frame(path, columns, form, clocked)
    place = Path(path)
    if place.suffix.lower() in SPREADSHEETS:
        return _of_spreadsheet(place, columns, form, clocked)
    # Cells of spreadsheets and of tables in memory are parted already.
    if form.delimiter == form.decimal:
        raise ParameterError("delimiter", "must differ from the decimal mark")
    try:
        with _text(place, form) as file:
            names = _names(file, form, place)
            wanted = [_position(column, names, str(place), form) for column in columns.values()]
            _refuse_twice(columns, wanted)
            readers = _readers(columns, form, clocked)
            values = _quickly(_further_lines(file, place, form), form, wanted, readers)
        if values is None:
            _refuse_missing(columns, wanted, place, form)
            values = _slowly(place, form, dict(zip(columns, wanted, strict=True)), readers)
    except UnicodeError:
        raise RecordError(
            str(place),
            f"is not {form.encoding} text, perhaps 'latin-1' or 'utf-16'",
            ("encoding",),
        ) from None
    except csv.Error as error:
        raise RecordError(str(place), f"is not a text table: {error}") from None
    except OSError as error:
        raise RecordError(str(place), unreadable(place, error)) from None
    if not len(values):
        raise RecordError(str(place), f"holds no numbers after {form.header} header lines")
    return Table(str(place), form, values)


def names_in(path: Source, form: Format) -> list[str]:
    """Return the names of the columns of a table; none if it cannot be read."""
    if is_frame(path):
        return [str(name) for name in path.columns]
    place = Path(path)
    try:
        if place.suffix.lower() in SPREADSHEETS:
            return _names_of_cells(cells_of(place, form.sheet), form)
        with _text(place, form) as file:
            return _names(file, form, place)
    except (OSError, UnicodeError, csv.Error, RecordError):
        return []


def sheets_of(path: Path) -> dict[str, list[list[Any]]]:
    """Return the cells of all sheets by their names, in their order: see `cells_of`."""
    return {name: _cells(frame) for name, frame in _frames(path, None).items()}


def cells_of(path: Path, sheet: str | int) -> list[list[Any]]:
    """Return the cells of a sheet line by line, None where they are empty.

    Raises:
        RecordError: if the file is missing or no spreadsheet, or has no such sheet.
    """
    return _cells(_frames(path, sheet))


def _frames(path: Path, sheet: str | int | None) -> Any:
    import zipfile

    import pandas

    try:
        return pandas.read_excel(path, sheet_name=sheet, header=None, dtype=object)
    except OSError as error:
        raise RecordError(str(path), unreadable(path, error)) from None
    except (zipfile.BadZipFile, KeyError, EOFError):
        raise RecordError(str(path), "is no spreadsheet") from None
    except (ValueError, IndexError) as error:
        if "format cannot be determined" in str(error):
            raise RecordError(str(path), "is no spreadsheet") from None
        raise RecordError(str(path), f"cannot be read: {error}", ("sheet",)) from None


def _cells(frame: pandas.DataFrame) -> list[list[Any]]:
    cells = frame.astype(object).where(frame.notna(), None)
    return [list(row) for row in cells.itertuples(index=False, name=None)]


def _names_of_cells(cells: list[list[Any]], form: Format) -> list[str]:
    line = form.line_of_names
    if not line or line > len(cells):
        return []
    return ["" if cell is None else str(cell).strip() for cell in cells[line - 1]]


def _of_spreadsheet(
    path: Path, columns: Mapping[str, str | int], form: Format, clocked: Collection[str]
) -> Table:
    cells = cells_of(path, form.sheet)
    names, source = _names_of_cells(cells, form), str(path)
    wanted = [_position(one, names, source, form, also="sheet") for one in columns.values()]
    _refuse_twice(columns, wanted)
    width = len(cells[0]) if cells else 0
    for name, at in zip(columns, wanted, strict=True):
        if at >= width:
            raise RecordError(
                str(path), f"has no column {at} ({name}), {width} columns", ("columns",)
            )
    numbers = [
        number
        for number, row in enumerate(cells, 1)
        if number > form.header and any(cell is not None for cell in row)
    ]
    if not numbers:
        raise RecordError(str(path), f"holds no numbers after {form.header} header lines")
    values = np.array(
        [
            [
                _cell(cells[number - 1][at], form, is_clock=name in clocked)
                for name, at in zip(columns, wanted, strict=True)
            ]
            for number in numbers
        ]
    )
    if np.isnan(values).any(axis=1).mean() > _MOSTLY:
        first = numbers[int(np.isnan(values).any(axis=1).argmax())]
        shown = ", ".join(_short(str(cell)) for cell in cells[first - 1][:4])
        raise RecordError(
            str(path),
            f"is not a table of numbers: line {first} reads {shown}",
            ("decimal", "header", "sheet"),
        )
    return Table(str(path), form, values, np.array(numbers, dtype=np.intp))


def _of_frame(
    frame: Any, columns: Mapping[str, str | int], form: Format, clocked: Collection[str]
) -> Table:
    # What is an index is found by its name as well.
    index = [name for name in frame.index.names if name in columns.values()]
    given = {name: frame.index.get_level_values(name) for name in index if name not in frame}
    frame = frame.assign(**given) if given else frame
    source, names = name_of(frame), [str(name) for name in frame.columns]
    wanted = [_position(column, names, source, form) for column in columns.values()]
    _refuse_twice(columns, wanted)
    series = []
    for name, at in zip(columns, wanted, strict=True):
        if at >= len(names):
            raise RecordError(
                source, f"has no column {at} ({name}), {len(names)} columns", ("columns",)
            )
        column = frame.iloc[:, at].to_numpy()
        if column.dtype.kind in "iuf" and name not in clocked:
            series.append(column.astype(np.float64))
        elif column.dtype.kind in "mM" and name not in clocked:
            raise RecordError(
                source,
                f"column {names[at]!r} ({name}): holds times of day or durations: its unit is "
                "'clock'",
                ("units",),
            )
        else:
            is_clock = name in clocked
            series.append(np.array([_cell(one, form, is_clock=is_clock) for one in column]))
            if not is_clock:
                _refuse_marks(source, f"{names[at]!r} ({name})", column, series[-1], form)
    values = np.stack(series, axis=-1).astype(np.float64)
    if not len(values):
        raise RecordError(source, "holds no numbers")
    return Table(source, form, values, np.arange(1, len(values) + 1, dtype=np.intp))


def _refuse_marks(
    source: str, name: str, cells: Sequence[Any], values: Array, form: Format
) -> None:
    """Refuse a column of numbers in words whose decimal mark or mark of groups is another one."""
    for row in np.flatnonzero(np.isnan(values)).tolist():
        cell = cells[row]
        if not isinstance(cell, str):
            continue
        says = f"column {name}: line {row + 1} reads {cell!r}: "
        other = Format(decimal="," if form.decimal == "." else ".")
        if not math.isnan(number_in(cell, other)) and form.thousands != other.decimal:
            raise RecordError(
                source, f"{says}its decimal mark seems to be {other.decimal!r}", ("decimal",)
            )
        if form.thousands is None and _GROUPED.fullmatch(cell):
            raise RecordError(
                source,
                f"{says}its digits stand in groups of three: say what parts them",
                ("thousands",),
            )


def _cell(cell: Any, form: Format, *, is_clock: bool) -> float:
    if is_clock:
        return clock.of_cell(cell)
    if isinstance(cell, str):
        return number_in(cell, form)
    try:
        return math.nan if cell is None else float(cell)
    except (TypeError, ValueError):
        return math.nan


def _text(path: Path, form: Format) -> TextIO:
    return path.open(encoding=form.encoding, newline=None)


def _all_lines(file: TextIO) -> Iterator[str]:
    """Return the lines of a text; headings that come again within a table are empty ones."""
    first = file.readline()
    if first:
        yield first
    yield from labview.without_headings(file) if labview.begins_one(first) else file


def _further_lines(file: TextIO, path: Path, form: Format) -> TextIO | Iterator[str]:
    """Return the lines after the header, likewise."""
    with _text(path, form) as other:
        again = labview.begins_one(other.readline())
    return labview.without_headings(file) if again and form.header else file


def split(line: str, form: Format) -> list[str]:
    """Return the cells of a line."""
    if form.delimiter is None:
        return line.split()
    return [cell.strip() for cell in next(csv.reader([line], delimiter=form.delimiter), [])]


def _names(file: TextIO, form: Format, path: Path) -> list[str]:
    if path.stat().st_size == 0:
        raise RecordError(str(path), "is empty")
    line = ""
    for number in range(1, form.header + 1):
        read = file.readline()
        line = read if number == form.line_of_names else line
    return names_of(line, form) if form.header else []


def names_of(line: str, form: Format) -> list[str]:
    """Return the cells of a line of names; a mark of comments before them is none.

    Where blanks part the cells, a unit in brackets belongs to the name before it.
    """
    cells = split(line, form)
    if form.delimiter is not None:
        return cells
    cells = cells[1:] if cells[:1] in (["#"], ["%"]) else cells
    names: list[str] = []
    for cell in cells:
        is_unit = _BRACKETED.fullmatch(cell) is not None
        if is_unit and names and not _BRACKETED.search(names[-1]):
            names[-1] += f" {cell}"
        else:
            names.append(cell)
    return names


def _position(
    column: str | int, names: Sequence[str], source: str, form: Format, *, also: str = ""
) -> int:
    if isinstance(column, bool) or not isinstance(column, str | int):
        raise ParameterError("columns", f"must hold names or numbers, got {column!r}")
    if isinstance(column, int):
        return arrays.count(column, "columns", least=0)
    if column not in names:
        listed = ", ".join(_short(name) for name in names[:_SHOWN]) or "numbers: header is 0"
        message = f"has no column {_short(column)}, only {listed}"
        options: tuple[str, ...] = ("columns", also) if also else ("columns",)
        if len(names) == 1 and len(names[0].split()) > 1:
            options = (*options, "delimiter")
        if form.header > 1 and form.names is None:
            # A line of units is often the last one.
            message += f", the names in line {form.header}, the last of the header: if they stand "
            message += "in another line, give its number, or the numbers of the columns, which "
            message += "count from 0"
            options = ("names", *options)
        raise RecordError(source, message, options)
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
        width = len(split(next((line for line in lines if line.strip()), ""), form))
    for name, position in zip(columns, wanted, strict=True):
        if position >= width > 1 and isinstance(columns[name], int):
            raise RecordError(
                str(path), f"has no column {position} ({name}), {width} columns", ("columns",)
            )


Reader: TypeAlias = Callable[[str], float]
"""What a cell says: a number, NaN if it says none."""


def _readers(
    columns: Mapping[str, str | int], form: Format, clocked: Collection[str]
) -> list[Reader | None]:
    """Return what reads the cells of each column where they are no plain numbers."""

    def grouped(cell: str) -> float:
        return number_in(cell, form)

    usual = None if form.thousands is None else grouped
    return [clock.seconds if name in clocked else usual for name in columns]


def _quickly(
    file: Iterable[str],
    form: Format,
    wanted: Sequence[int],
    readers: Sequence[Reader | None],
) -> Array | None:
    """Return the columns if every line is in order, else None."""
    lines = file
    # A clock may have the marks in it that numbers have.
    plain = clock.seconds not in readers
    if plain and form.thousands is not None and form.thousands != form.delimiter:
        mark = form.thousands
        lines = (line.replace(mark, "") for line in lines)
        readers = [None] * len(readers)
    if form.decimal == ",":
        if plain:
            lines = (line.replace(",", ".") for line in lines)
        else:
            readers = [one or (lambda cell: number_in(cell, form)) for one in readers]
    with np.errstate(all="ignore"):
        try:
            return np.asarray(_loaded(lines, form, wanted, readers), dtype=np.float64)
        except UnicodeError:
            raise
        except ValueError:
            return None


def _loaded(
    lines: Iterable[str],
    form: Format,
    wanted: Sequence[int],
    readers: Sequence[Reader | None],
) -> Array:
    import warnings

    special: dict[int | str, Reader] = {
        at: one for at, one in zip(wanted, readers, strict=True) if one is not None
    }
    with warnings.catch_warnings():
        # That there are no numbers is said in our own words.
        warnings.simplefilter("ignore", UserWarning)
        return np.loadtxt(
            lines,
            delimiter=form.delimiter,
            usecols=wanted,
            ndmin=2,
            comments=None,
            quotechar='"',
            converters=special or None,
        )


def _slowly(
    path: Path, form: Format, wanted: Mapping[str, int], readers: Sequence[Reader | None]
) -> Array:
    """Return the columns line by line, NaN for what is no number."""
    rows, broken, first = [], 0, ""
    read = [one or (lambda cell: number_in(cell, form)) for one in readers]
    with _text(path, form) as file:
        for number, line in enumerate(_all_lines(file), 1):
            if number <= form.header or not line.strip():
                continue
            cells = split(line, form)
            row = [
                one(cells[at]) if at < len(cells) else math.nan
                for at, one in zip(wanted.values(), read, strict=True)
            ]
            if math.isnan(sum(row)):
                broken += 1
                first = first or f"line {number} reads {line.strip()[:40]!r}"
                if form.thousands is None:
                    _refuse_groups(path, number, cells, dict(zip(wanted.items(), row, strict=True)))
            rows.append(row)
    if broken > _MOSTLY * len(rows):
        raise RecordError(
            str(path), f"is not a table of numbers: {first}", ("delimiter", "decimal", "header")
        )
    return np.array(rows, dtype=np.float64).reshape(-1, len(wanted))


def _refuse_groups(
    path: Path, line: int, cells: Sequence[str], row: Mapping[tuple[str, int], float]
) -> None:
    """Refuse a cell that is no number because its digits stand in groups of three."""
    for (name, at), value in row.items():
        if math.isnan(value) and at < len(cells) and _GROUPED.fullmatch(cells[at].strip('"')):
            raise RecordError(
                str(path),
                f"column {name}: line {line} reads {cells[at]!r}: its digits stand in groups of "
                "three: say what parts them",
                ("thousands",),
            )


def number_in(cell: str, form: Format) -> float:
    """Return the number in a cell, NaN if there is none."""
    text = cell.strip('"')
    if form.thousands is not None:
        text = text.replace(form.thousands, "")
    if form.decimal == ",":
        text = text.replace(",", ".")
    try:
        return float(text)
    except ValueError:
        return math.nan
