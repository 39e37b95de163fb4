"""Columns of numbers from text files, spreadsheets and tables in memory, with numbers of lines."""

from __future__ import annotations

import csv
import math
import os
import re
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from functools import cache, partial
from pathlib import Path
from typing import TYPE_CHECKING, Any, TextIO, TypeAlias

import numpy as np
from numpy.typing import NDArray

from asperity._base import arrays
from asperity._base.arrays import Array
from asperity._base.storage.files import unreadable
from asperity.errors import ParameterError, RecordError
from asperity.identify.records.tables import clock, labview
from asperity.identify.records.tables.headings import (
    CLOCK,
    COEFFICIENT,
    WITHOUT,
    Headings,
    headings,
    is_coefficient,
    known_units,
    place_of,
    refuse_twice,
    settled,
)

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
_NO_NUMBER = "?"  # in place of a point that is no decimal mark
_BRACKETED = re.compile(r"[\[(<][^\[\]()<>]*[\])>]$")
_GROUPED = re.compile(r"[-+]?\d{1,3}([,. '\u2019\u00a0\u202f_])\d{3}(\1\d{3})*([.,]\d*)?")


@dataclass(frozen=True)
class Format:
    """How a file holds numbers.

    Attributes:
        delimiter: between columns; None or a blank for any white space.
        decimal: "." or ","; the other one is not part of a number then, but for `thousands`.
        header: lines before the numbers.
        encoding: of the text.
        names: the line of the header that names the columns, from 1; None for the last.
        thousands: between groups of three digits, nowhere else; None if nothing is.
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

    Attributes:
        source: where it comes from.
        format: of the numbers.
        values: the columns.
        units: of the columns, where configuration or heading say them.
        rows: the numbers of its lines if it was no text.
        parts: where parts of a file of LabVIEW begin.
    """

    source: str
    format: Format
    values: Array
    units: Mapping[str, str]
    rows: NDArray[np.intp] | None = None
    parts: Sequence[labview.Part] = ()

    def lines(self, rows: NDArray[np.intp]) -> NDArray[np.intp]:
        """Return the line numbers, from 1, of rows of the table."""
        if self.rows is not None:
            return self.rows[rows]
        with _text(Path(self.source), self.format) as file:
            # Blank lines of the header count as header.
            lines = enumerate(_all_lines(file, self.format), self.format.header + 1)
            used = [number for number, line in lines if line.strip()]
        return np.asarray(used, dtype=np.intp)[rows]


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
    units: Mapping[str, str] | None = None,
    check: bool = True,
    texts: bool = True,
) -> Table:
    """Read columns of a table, given by name or by number from 0, in the order of `columns`.

    Args:
        path: a text file, a spreadsheet or a table in memory.
        columns: where they are.
        form: how the file holds numbers.
        units: of columns, as far as the configuration says them; the headings say the others.
        check: whether headings that contradict them are refused.
        texts: whether cells may hold what is no number; else only gaps.

    Raises:
        RecordError: if the file is missing, empty, of another encoding, not a table of numbers, or
            without one of the columns, if it has two of one name, or a heading has another unit.
    """
    wanted = _Wanted(columns, form, name_of(path), dict(units or {}), check, texts)
    if is_frame(path):
        return _of_frame(path, wanted)
    place = Path(path)
    if place.suffix.lower() in SPREADSHEETS:
        return _of_spreadsheet(place, wanted)
    # Cells of spreadsheets and of tables in memory are parted already.
    if form.delimiter == form.decimal:
        raise ParameterError("delimiter", "must differ from the decimal mark")
    try:
        return _of_text(place, wanted)
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


@dataclass(frozen=True)
class _Wanted:
    """Columns that are looked for, and what is said of them."""

    columns: Mapping[str, str | int]
    form: Format
    source: str
    units: Mapping[str, str]
    check: bool
    texts: bool

    def places(self, head: Headings, *, also: str = "") -> tuple[list[int], dict[str, str]]:
        """Return where the columns are, and their units."""
        places = [_position(one, head, self.source, self.form, also, role) for role, one in
                  self.columns.items()]  # fmt: skip
        refuse_twice(self.columns, places)
        found = dict(self.units)
        for (role, named), at in zip(self.columns.items(), places, strict=True):
            if not known_units(role):
                continue
            text = head.units[at] if at < len(head.units) else ""
            if role == "tangential" and role not in self.units and not text:
                named_so = at < len(head.names) and is_coefficient(head.names[at], text)
                text = COEFFICIENT if named_so else text
            one = settled(role, self.units.get(role), text, called=repr(named), source=self.source,
                          check=self.check)  # fmt: skip
            found |= {} if one is None else {role: one}
        return places, found

    def refuse_beyond(self, places: Sequence[int], width: int) -> None:
        """Refuse columns beyond the last one."""
        for name, at in zip(self.columns, places, strict=True):
            if at >= width:
                raise RecordError(
                    self.source, f"has no column {at} ({name}), {width} columns", ("columns",)
                )

    def numbers(
        self, rows: Sequence[Sequence[Any]], lines: Sequence[int], head: Headings, also: str = ""
    ) -> tuple[Array, dict[str, str]]:
        """Return the columns of a table cell by cell, NaN for what is no number, and their units.

        Args:
            rows: cells of its lines.
            lines: their numbers.
            head: what heads the columns.
            also: what may be wrong beside the columns.
        """
        places, units = self.places(head, also=also)
        columns = [[row[at] if at < len(row) else None for row in rows] for at in places]
        series = [
            self.column(repr(name), cells, lines, is_clock=_is_clocked(name, units))
            for name, cells in zip(self.columns, columns, strict=True)
        ]
        values = np.stack(series, axis=-1)
        broken = np.isnan(values).any(axis=1)
        if not len(values):
            raise RecordError(
                self.source, f"holds no numbers after {self.form.header} header lines"
            )
        if broken.mean() > _MOSTLY:
            first = int(broken.argmax())
            shown = ", ".join(_short("" if one is None else str(one)) for one in rows[first][:4])
            raise RecordError(
                self.source,
                f"is not a table of numbers: line {lines[first]} reads {shown}",
                ("sheet" if also else "delimiter", "decimal", "header"),
            )
        return values, units

    def column(
        self, called: str, cells: Sequence[Any], lines: Sequence[int], *, is_clock: bool
    ) -> Array:
        """Return the numbers in cells; refuse those whose marks are not the ones of the format."""
        read = clock.of_cell if is_clock else partial(number_of, form=self.form)
        values = np.array([read(one) for one in cells], dtype=np.float64)
        if is_clock:
            if len(cells) and np.isnan(values).all():
                says = f"column {called}: line {lines[0]} reads {str(cells[0])!r}"
                raise RecordError(self.source, f"{says}: not a time of day", ("units",))
            return values
        other = Format(decimal="," if self.form.decimal == "." else ".")
        for row in np.flatnonzero(np.isnan(values)).tolist():
            cell = cells[row].strip('" ') if isinstance(cells[row], str) else ""
            if not cell or cell.lower() == "nan":
                continue
            marks = {}
            if not math.isnan(number_in(cell, other)) and self.form.thousands != other.decimal:
                marks["decimal"] = f"its decimal mark seems to be {other.decimal!r}"
            mark = self.form.thousands
            if mark is None and _GROUPED.fullmatch(cell):
                marks["thousands"] = "its digits stand in groups of three: say what parts them"
            elif mark and mark in cell and number_in(cell.replace(mark, ""), self.form) < math.inf:
                marks["thousands"] = f"{mark!r} parts groups of three digits, which these are not"
            if marks:
                says = f"column {called}: line {lines[row]} reads {cell!r}"
                words = f"{says}: {', or '.join(marks.values())}"
                raise RecordError(self.source, words, tuple(marks))
            if not self.texts:
                at = f"{self.source}, line {lines[row]}"
                raise RecordError(at, f"must hold numbers, holds {cell!r}")
        return values


def _is_clocked(role: str, units: Mapping[str, str]) -> bool:
    return units.get(role, "").removeprefix("-") == CLOCK


def names_in(path: Source, form: Format) -> list[str]:
    """Return the names of the columns of a table; none if it cannot be read."""
    if is_frame(path):
        return [str(name) for name in path.columns]
    place = Path(path)
    try:
        if place.suffix.lower() in SPREADSHEETS:
            return _heading_of_cells(cells_of(place, form.sheet), form).names
        return _heading(place, form)[0].names
    except (OSError, UnicodeError, csv.Error, RecordError):
        return []


def _heading(path: Path, form: Format) -> tuple[Headings, int]:
    """Return the headings of a text table, and its width."""
    if path.stat().st_size == 0:
        raise RecordError(str(path), "is empty")
    with _text(path, form) as file:
        lines = [file.readline() for _ in range(form.header)]
        body = next((line for line in file if line.strip()), "")
        width, least = _width_of(body, form)
    found = width
    if width < 2:
        # That these are no numbers is said later.
        width, least = max((len(split(line, form)) for line in lines), default=0), 0
    rows = [heading_cells(line, form, width) if line.strip() else [] for line in lines]
    return headings(rows, width, least=least, line=form.line_of_names), found


def _width_of(line: str, form: Format) -> tuple[int, int]:
    """Return the number of the cells of a line, with and without those empty at its end."""
    cells = split(line, form)
    return len(cells), max((at for at, cell in enumerate(cells, 1) if cell), default=0)


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


def _heading_of_cells(cells: list[list[Any]], form: Format) -> Headings:
    width = len(cells[0]) if cells else 0
    return headings(cells[: form.header], width, line=form.line_of_names)


def _of_spreadsheet(path: Path, wanted: _Wanted) -> Table:
    form = wanted.form
    cells = cells_of(path, form.sheet)
    head = _heading_of_cells(cells, form)
    wanted.refuse_beyond(wanted.places(head, also="sheet")[0], len(cells[0]) if cells else 0)
    lines = [
        number
        for number, row in enumerate(cells, 1)
        if number > form.header and any(cell is not None for cell in row)
    ]
    values, units = wanted.numbers([cells[n - 1] for n in lines], lines, head, also="sheet")
    return Table(str(path), form, values, units, np.array(lines, dtype=np.intp))


def _of_frame(frame: Any, wanted: _Wanted) -> Table:
    columns, source = wanted.columns, wanted.source
    # What is an index is found by its name as well.
    index = [name for name in frame.index.names if name in columns.values()]
    given = {name: frame.index.get_level_values(name) for name in index if name not in frame}
    frame = frame.assign(**given) if given else frame
    names = [str(name) for name in frame.columns]
    places, units = wanted.places(headings([names], len(names), line=1))
    wanted.refuse_beyond(places, len(names))
    lines = np.arange(1, len(frame) + 1, dtype=np.intp)
    series = []
    for name, at in zip(columns, places, strict=True):
        column, is_clock = frame.iloc[:, at].to_numpy(), _is_clocked(name, units)
        called = f"{names[at]!r} ({name})"
        if column.dtype.kind in "mM" and not is_clock:
            raise RecordError(
                source,
                f"column {called}: holds times of day or durations: its unit is 'clock'",
                ("units",),
            )
        if column.dtype.kind in "iuf" and not is_clock:
            series.append(column.astype(np.float64))
        else:
            series.append(wanted.column(called, column, lines.tolist(), is_clock=is_clock))
    if not len(frame):
        raise RecordError(source, "holds no numbers")
    return Table(source, wanted.form, np.stack(series, axis=-1), units, lines)


def number_of(cell: Any, form: Format) -> float:
    """Return the number that a cell of any table is or holds, NaN if there is none."""
    if isinstance(cell, str):
        return number_in(cell, form)
    try:
        return math.nan if cell is None else float(cell)
    except (TypeError, ValueError):
        return math.nan


def _of_text(path: Path, wanted: _Wanted) -> Table:
    """Return the columns of a text: at once if every line is in order, else cell by cell."""
    form = wanted.form
    head, width = _heading(path, form)
    places, units = wanted.places(head)
    if width > 1:
        # That a single column is no table is said later.
        wanted.refuse_beyond(places, width)
    values = None
    if not any(_is_clocked(name, units) for name in wanted.columns):
        with _text(path, form) as file:
            lines = _all_lines(file, form)
            values = _loaded(lines, form, places)
    if values is None:
        with _text(path, form) as file:
            lines = _all_lines(file, form)
            numbered = enumerate(lines, form.header + 1)
            rows = {number: split(line, form) for number, line in numbered if line.strip()}
        values, units = wanted.numbers(list(rows.values()), list(rows), head)
    return Table(str(path), form, values, units, parts=lines.starts)


def _text(path: Path, form: Format) -> TextIO:
    return path.open(encoding=form.encoding, newline=None)


def _all_lines(file: TextIO, form: Format) -> labview.Parts:
    """Return the lines of a text; headings that come again within a table are empty ones."""
    first = [file.readline() for _ in range(form.header)]
    again = bool(first) and labview.begins_one(first[0])
    return labview.Parts(file, first if again else None)


def split(line: str, form: Format) -> list[str]:
    """Return the cells of a line."""
    if form.delimiter is None:
        return line.split()
    return [cell.strip() for cell in next(csv.reader([line], delimiter=form.delimiter), [])]


def heading_cells(line: str, form: Format, width: int) -> list[str]:
    """Return the cells of a line before the numbers; a mark of comments before them is none.

    Where blanks part the numbers, headings that hold blanks are two blanks or a tab apart, and a
    unit in brackets belongs to the name before it. Nothing is returned if they are not `width`.
    """
    if form.delimiter is not None:
        return split(line, form)
    line = re.sub(r"^\s*[#%]+\s*", "", line)
    names: list[str] = []
    for cell in line.split():
        is_unit = _BRACKETED.fullmatch(cell) is not None
        if is_unit and names and not _BRACKETED.search(names[-1]):
            names[-1] += f" {cell}"
        else:
            names.append(cell)
    apart = re.split(r"\s{2,}|\t", line.strip())
    return next((one for one in (names, apart) if len(one) == width), names)


def _position(
    column: str | int, head: Headings, source: str, form: Format, also: str = "", role: str = ""
) -> int:
    if isinstance(column, bool) or not isinstance(column, str | int):
        raise ParameterError("columns", f"must hold names or numbers, got {column!r}")
    if isinstance(column, int):
        return arrays.count(column, "columns", least=0)
    names = head.names if head.line else []
    found = place_of(column, names, source)
    if found is not None:
        return found
    listed = ", ".join(_short(name) for name in names[:_SHOWN]) or "numbers: header is 0"
    if head.odd:
        listed = f"numbers, which count from 0: {head.odd}"
    message = f"has no column {_short(column)}, only {listed}"
    options: tuple[str, ...] = ("columns", also) if also else ("columns",)
    if len(names) == 1 and len(names[0].split()) > 1:
        options = (*options, "delimiter")
    misplaced = form.header > 1 and form.names is None
    if misplaced:
        # A line of units is often the last one.
        message += f", the names in line {form.header}, the last of the header: if they stand "
        message += "in another line, give its number, or the numbers of the columns, which "
        message += "count from 0"
        options = ("names", *options)
    # A name of the user's own is rather misspelt.
    if role == "radial" or (role in WITHOUT and column == role and not misplaced):
        option, advice = WITHOUT[role]
        message += f". {advice}"
        options = (*options, option)
    raise RecordError(source, message, options)


def _short(name: str) -> str:
    return repr(name if len(name) <= _LONGEST else f"{name[:_LONGEST]}…")


@cache
def _groups(mark: str, decimal: str) -> re.Pattern[str]:
    """Return the pattern of digits in groups of three, before a decimal mark."""
    mark = re.escape(mark)
    return re.compile(rf"(?<![\d{decimal}eE])[1-9]\d{{0,2}}(?:{mark}\d{{3}})+(?!\d)")


def _pointed(texts: Iterable[str], form: Format) -> Iterable[str]:
    """Yield texts whose numbers have a decimal point and no groups.

    A mark of groups counts between three digits each, and a point is no mark of a number where the
    decimal mark is a comma: what is left of either makes the text no number.
    """
    if form.thousands is not None:
        mark, groups = form.thousands, _groups(form.thousands, form.decimal)
        texts = (groups.sub(lambda one: one[0].replace(mark, ""), text) for text in texts)
    if form.decimal == ",":
        texts = (text.replace(".", _NO_NUMBER).replace(",", ".") for text in texts)
    return texts


def _loaded(lines: Iterable[str], form: Format, places: Sequence[int]) -> Array | None:
    """Return the columns if every line is in order and there are some, else None."""
    import warnings

    if form.delimiter is not None and form.delimiter in (form.thousands, form.decimal, _NO_NUMBER):
        return None
    with warnings.catch_warnings(), np.errstate(all="ignore"):
        # That there are no numbers is said in our own words.
        warnings.simplefilter("ignore", UserWarning)
        try:
            found = np.loadtxt(
                _pointed(lines, form),
                delimiter=form.delimiter,
                usecols=places,
                ndmin=2,
                comments=None,
                quotechar='"',
            )
        except UnicodeError:
            raise
        except ValueError:
            return None
    return found if len(found) else None


def number_in(cell: str, form: Format) -> float:
    """Return the number in a cell, NaN if there is none."""
    (text,) = _pointed([cell.strip('"')], form)
    try:
        # Python takes an underline within a number.
        return math.nan if "_" in text else float(text)
    except ValueError:
        return math.nan
