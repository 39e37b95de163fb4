"""What a table seems to be: its columns with ranges, and the configuration that reads it."""

from __future__ import annotations

import math
import re
from collections.abc import Mapping, Sequence
from contextlib import suppress
from dataclasses import KW_ONLY
from pathlib import Path
from typing import Annotated, Any

import numpy as np

from asperity._base.arrays import Array
from asperity._base.storage import toml
from asperity._base.storage.files import atomic
from asperity._base.tables import aligned
from asperity._base.value import Given, Number, Record, Text, a_path, a_tuple, field
from asperity.errors import ParameterError, RecordError
from asperity.identify.records.reading import PathLike
from asperity.identify.records.record import gap_rows
from asperity.identify.records.tables import clock, labview
from asperity.identify.records.tables.guessing import Guess, guess, of_cells
from asperity.identify.records.tables.headings import (
    CHANNELS,
    CLOCK,
    COEFFICIENT,
    COUNTS,
    DEFAULTS,
    FORCES,
    MOTION,
    PATH_WORDS,
    READINGS,
    TORQUES,
    UNITS,
    WORDS,
    Headings,
    assigned,
    headings,
    is_coefficient,
    is_read,
    plain,
    unit,
)
from asperity.identify.records.tables.text_table import (
    SPREADSHEETS,
    Format,
    cells_of,
    number_in,
    number_of,
    read_table,
    sheets_of,
)

_TURN = 2.0 * math.pi
# Kinds of columns that their units alone may show.
_BY_UNIT = {"time": ("s", "ms", "us", "min", CLOCK), "angle": ("rad", "deg", "turn", COUNTS),
            "turn_rate": ("rpm",)}  # fmt: skip
# Steps of a time differ from the usual one by less than this share.
_EVEN = 0.05
# A force across the sliding is smaller than this part of that along it; else both may be one force.
_ACROSS = 0.5


class Column(Record):
    """A column of a table.

    Attributes:
        name: of the column, as the file has it.
        unit: as the file has it, or empty.
        role: what it seems to be, such as ``"time"``, or empty.
        low, high: least and greatest number; None if it holds none.
    """

    name: Text
    _: KW_ONLY
    unit: Text = ""
    role: Text = ""
    low: Number | None
    high: Number | None


class Inspection(Record):
    """What a file seems to hold, made by `inspect_file`, and how a configuration says it.

    Attributes:
        path: of the file.
        columns: of the table, in their order.
        sections: of the configuration that reads it, as far as it can be guessed.
        notes: what is left to be said or checked.
    """

    path: Annotated[Given[PathLike, str], a_path]
    _: KW_ONLY
    columns: Annotated[Given[Sequence[Column], tuple[Column, ...]], a_tuple]
    sections: Mapping[str, Any]
    notes: Annotated[Given[Sequence[str], tuple[str, ...]], a_tuple] = field(default=())

    def __hash__(self) -> int:
        return hash((self.path, self.columns, repr(self.sections), self.notes))

    def summary(self) -> str:
        """Return a few lines of text: how the file is written, its columns, what is left to do."""
        form = self.sections.get("file", {})
        written = ", ".join(f"{name} {value!r}" for name, value in form.items())
        rows = [("column", "name", "unit", "from", "to", "read as")]
        for at, one in enumerate(self.columns):
            low, high = ("" if x is None else f"{x:.6g}" for x in (one.low, one.high))
            rows.append((str(at), one.name, one.unit, low, high, one.role))
        parts = [f"{self.path}: {written or 'as by default'}", aligned(rows, right=(0, 3, 4))]
        if self.notes:
            parts.append("\n".join(f"- {note}" for note in self.notes))
        return "\n\n".join(parts)

    def text(self) -> str:
        """Return the configuration as TOML, with the notes as comments."""
        head = f"How {Path(self.path).name} is read, as far as it could be guessed: look it over."
        return toml.text(self.sections, {"": "\n".join([head, *self.notes])}) + (
            _PATH_HINTS if {one.role for one in self.columns} & {"x1", "x2"} else _HINTS
        )

    def write(self, path: PathLike) -> None:
        """Write the configuration to edit; a file that is there stays as it is.

        Raises:
            ParameterError: if the file is there.
        """
        place = Path(path)
        if place.exists():
            raise ParameterError("config", f"{place} is there already: it is not overwritten")
        with atomic(place) as file:
            file.write(self.text().encode())


_HINTS = """
# What else can be said; `help(asperity.identify.Configuration)` has all of it.
#
# [run]                       # where a file has more than the run: windows of time
# from = 2.0
# to = 30.0
#
# [no_load]                   # without load, in the same files, or in others: files = ["rest.csv"]
# from = 0.0
# to = 1.5
#
# [calibration]               # weighings: columns load_tangential, load_radial, load_normal in N
# file = "calibration.csv"    # or, of a channel with 0.02 V per N and two that read N:
# loads = [[1, 0, 0], [0, 1, 0], [0, 0, 1]]         # N
# readings = [[0.02, 0, 0], [0, 1, 0], [0, 0, 1]]
# reading_error = 0.001
#
# [tribometer]
# radius = 0.05               # m
#
# [processing]
# grid_angle = 0.0            # rad, of the sliding direction from e1 where the rotation reads 0
"""


_PATH_HINTS = """
# What else is to be said, as far as it is known.
#
# [paths]
# position_error = 0.0005     # m, where the files have no columns of errors
# length_error = 0.002        # relative
"""


def inspect_file(path: PathLike, *, sheet: str | int | None = None) -> Inspection:
    r"""Guess how a file of a tribometer is written and what its columns are.

    Encoding, delimiter, decimal mark, groups of digits, header and line of names follow from the
    text, units from headings or from the numbers themselves, and what columns are from their names
    and units. All of it is a guess to look over; what is not found, or by order or unit alone, is
    said in the notes.

    Args:
        path: a text file or a spreadsheet (.xlsx).
        sheet: of a spreadsheet, by name or number from 0; by default the one that seems to hold
            the data.

    Raises:
        RecordError: if the file cannot be read, or holds no table of numbers.

    >>> import tempfile, pathlib
    >>> from asperity.identify import inspect_file
    >>> text = "t [ms];phi [deg]\n" + "\n".join(f"{k};{k},5" for k in range(9))
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     file = pathlib.Path(folder, "run.csv")
    ...     _ = file.write_text(text)
    ...     found = inspect_file(file)
    >>> found.sections["file"], found.sections["units"]
    ({'delimiter': ';', 'decimal': ',', 'header': 1}, {'time': 'ms', 'angle': 'deg'})
    """
    place = Path(path)
    named = None if sheet is None else Format(sheet=sheet).sheet
    if place.suffix.lower() not in SPREADSHEETS:
        return _inspected(place, guess(place))
    if named is not None:
        return _inspected(place, of_cells(cells_of(place, named), str(place), named))
    return _of_sheets(place)


def _of_sheets(path: Path) -> Inspection:
    """Return what the sheet seems to be that tells most columns, the first one of several."""
    found: dict[str, Inspection] = {}
    sheets = sheets_of(path)
    first = next(iter(sheets))
    for name, cells in sheets.items():
        with suppress(RecordError):
            found[name] = _inspected(path, of_cells(cells, str(path), 0 if name == first else name))
    if not found:
        raise RecordError(str(path), "holds no table of numbers", ("sheet",))
    best = max(found, key=lambda name: sum(bool(one.role) for one in found[name].columns))
    if len(found) == 1 and best == first:
        return found[best]
    others = ", ".join(repr(name) for name in sheets if name != best)
    note = f"sheet: {best!r} seems to hold the data, beside {others}"
    return found[best].replace(notes=[note, *found[best].notes])


def inspect_path(path: PathLike) -> Inspection:
    """Guess how a file of a measured path is written, as `inspect_file` does.

    Raises:
        RecordError: if the file cannot be read, or holds no table of numbers.
    """
    place = Path(path)
    is_sheet = place.suffix.lower() in SPREADSHEETS
    found = of_cells(cells_of(place, 0), str(place), 0) if is_sheet else guess(place)
    return _inspected(place, found, PATH_WORDS)


def _inspected(path: Path, found: Guess, words: Mapping[str, str] = WORDS) -> Inspection:
    form = found.form
    width = max(map(len, found.body))
    least = max((_used(row) for row in found.body), default=width)
    head = headings(found.header, width, least=least, words=words)
    if head.line and head.line != form.header:
        form = Format(**{**vars(form), "names": head.line})
    values, parts = _numbers(path, found, form)
    held = np.flatnonzero(np.isfinite(values).any(axis=0)).tolist()
    roles, notes = assigned(head, words, values, held if words is WORDS else range(width))
    if words is WORDS:
        roles, notes = _channels(head, values, held, roles, notes)
    file = _file_section(form, is_sheet=path.suffix.lower() in SPREADSHEETS)
    time = next((at for at, role in roles.items() if role == "time"), None)
    if time is not None and parts:
        values[:, time] = labview.through_parts(values[:, time], parts)
        if gap_rows(values[:, time]).size:
            file["on_defect"] = "split"
            notes.append("on_defect: between parts there are pauses, at which they are split")
    if head.line and any(row[:2] == found.header[head.line - 1][:2] for row in found.body):
        file["on_defect"] = "split"
        notes.append("on_defect: headings come again between the numbers, which are split there")
    columns = []
    for at, name in enumerate(head.names[:least]):
        column = values[:, at][np.isfinite(values[:, at])]
        low, high = (column.min(), column.max()) if column.size else (None, None)
        one = Column(name, unit=head.units[at], role=roles.get(at, ""), low=low, high=high)
        columns.append(one)
    sections, further = _sections(file, columns, values, found, named=head.line > 0)
    if words is WORDS:
        further += _missing(set(roles.values()), file)
    else:
        lacks = [role for role in ("time", "x1", "x2") if role not in roles.values()]
        further += [f"{role}: no column seems to be it; name it in [columns]" for role in lacks]
    odd = [f"headings: {head.odd}: which is which is left open"] if head.odd else []
    return Inspection(path, columns=columns, sections=sections, notes=[*odd, *notes, *further])


def _used(row: Sequence[Any]) -> int:
    """Return the number of cells of a line without those empty at its end."""
    return max((at for at, cell in enumerate(row, 1) if cell != ""), default=0)


def _numbers(path: Path, found: Guess, form: Format) -> tuple[Array, Sequence[labview.Part]]:
    """Return the numbers of all lines, NaN where there are none, clocks in s; and the parts."""
    width = max(map(len, found.body))

    def value(cell: Any) -> float:
        number = number_of(cell, found.form)
        return clock.of_cell(cell) if math.isnan(number) else number

    body = np.array(
        [[value(cell) for cell in (*row, *[""] * (width - len(row)))] for row in found.body]
    )
    held = np.flatnonzero(np.isfinite(body).mean(axis=0) > 0.5)
    clocked = [at for at in held.tolist() if _is_clock(found, at)]
    if path.suffix.lower() in SPREADSHEETS:
        return body, ()
    units = {f"column {at}": CLOCK for at in clocked}
    try:
        read = read_table(path, {f"column {at}": int(at) for at in held}, form, units=units)
    except RecordError:
        return body, ()
    whole = np.full((len(read.values), width), np.nan)
    whole[:, held] = read.values
    return whole, read.parts


def _channels(
    head: Headings, values: Array, held: Sequence[int], roles: dict[int, str], notes: list[str]
) -> tuple[dict[int, str], list[str]]:
    """Return what columns of a tribometer are by their units and numbers as well, and notes."""
    free = [at for at in held if at not in roles]
    for role, kinds in _BY_UNIT.items():
        fits = [at for at in free if unit(head.units[at]) in kinds and is_read(head.names[at])]
        fits = [at for at in fits if role != "time" or _rises(values[:, at])]
        asked = role in roles.values() or any(note.startswith(f"{role}: columns") for note in notes)
        if fits and not asked:
            roles[fits[0]] = role
            if role != "time" or len(fits) > 1:
                notes.append(f"{role}: {head.names[fits[0]]!r} is taken by its unit")
    if "time" not in roles.values() and "T" in head.names:
        # A temperature rises, but not in even steps.
        at = head.names.index("T")
        if at in held and not head.units[at] and _rises(values[:, at], even=True):
            roles[at] = "time"
            notes.append("time: 'T' is taken by its even steps")
    forces = [at for at in free if at not in roles and unit(head.units[at]) in UNITS["normal"]]
    alike = {unit(head.units[at]) for at in forces}
    called = [plain(head.names[at]) for at in forces]
    # The order says nothing where one of the names has the word for a channel in it.
    named = {*CHANNELS, *FORCES} & set(roles.values()) or any(
        sum(re.search(rf"\b({WORDS[role]})\b", name) is not None for name in called) == 1
        for role in CHANNELS
    )
    if len(forces) == len(CHANNELS) and len(alike) == 1 and not named:
        roles |= dict(zip(forces, CHANNELS, strict=True))
        notes.append(
            "tangential, radial, normal: by the order of the columns, no name says which is which"
        )
    roles = _consistent(roles, values)
    if not {"tangential", *FORCES} & set(roles.values()):
        # A force counts first.
        called_so = [at for at in held if is_coefficient(head.names[at], head.units[at])]
        roles |= dict.fromkeys(called_so[:1], "tangential")
    return roles, [
        note
        for note in notes
        if " is taken" not in note or note.partition(":")[0] in roles.values()
    ]


def _rises(column: Array, *, even: bool = False) -> bool:
    """Return whether numbers rise like a time, but for where it starts again."""
    steps = np.diff(column[np.isfinite(column)])
    if not steps.size or (steps > 0.0).mean() < 0.9:
        return False
    usual = float(np.median(steps))
    return not even or bool((np.abs(steps - usual) <= _EVEN * usual).mean() > 0.9)


def _consistent(roles: dict[int, str], values: Array) -> dict[int, str]:
    """Leave one motion: that of x and y if there is one, else the rotation, else the stroke."""
    found = {role: at for at, role in roles.items()}
    pairs = (("velocity_x", "velocity_y"), ("position_x", "position_y"))
    pair = next((one for one in pairs if set(one) <= set(found)), None)
    if pair is not None and set(FORCES) <= set(found):
        kept = {*pair, "time", "angle", "normal", *FORCES}
        return {at: role for at, role in roles.items() if role in kept}
    # Forces along x and y of a pin on a disk are those along it and across; one of them beside
    # a friction force is that across, unless it is as large.
    given = [role for role in FORCES if role in found]
    if len(given) == 2 and "radial" not in found:
        roles = {at: role for at, role in roles.items() if role != "tangential"}
    missing = [role for role in CHANNELS[:2] if role not in roles.values()]
    names: dict[str, str] = {}
    if len(missing) == 2 and len(given) == 2:
        names = dict(zip(FORCES, missing, strict=True))
    elif len(given) == len(missing) == 1 and "tangential" in found:
        one, other = (np.abs(values[:, found[role]]) for role in (given[0], "tangential"))
        if np.nanmedian(one) < _ACROSS * np.nanmedian(other):
            names = {given[0]: missing[0]}
    elif given == ["force_x"] and "tangential" in missing:
        names = {"force_x": "tangential"}
    # One axis that moves is the line along which the stage goes. Beside forces along x and y,
    # one along y would need a force across of another sign.
    for kind in ("velocity", "position"):
        alone = [role for role in (f"{kind}_x", f"{kind}_y") if role in found]
        along = not alone or alone[0].endswith("x") or len(missing) < 2
        if len(alone) == 1 and kind not in found and along:
            names[alone[0]] = kind
    roles = {at: names.get(role, role) for at, role in roles.items()}
    motion = next(
        (one for one in ("angle", "turn_rate", "velocity", "position") if one in roles.values()), ""
    )
    return {at: role for at, role in roles.items() if role in {"time", motion, *CHANNELS}}


def _file_section(form: Format, *, is_sheet: bool) -> dict[str, Any]:
    standard, file = Format(), dict[str, Any]()
    for name, value in vars(form).items():
        # Cells of a spreadsheet are parted already.
        if value != getattr(standard, name) and not (name == "delimiter" and is_sheet):
            file[name] = " " if name == "delimiter" and value is None else value
    return {**file, "header": form.header}


def _sections(
    file: dict[str, Any],
    columns: Sequence[Column],
    values: Array,
    found: Guess,
    *,
    named: bool,
) -> tuple[dict[str, Any], list[str]]:
    """Return the sections of the configuration, and what is to be said of the columns."""
    notes: list[str] = []
    by_role = {one.role: at for at, one in enumerate(columns) if one.role}
    names = [one.name for one in columns]
    wanted: dict[str, Any] = {}
    units: dict[str, str] = {}
    known = ("time", "angle", "turn_rate", *MOTION, *CHANNELS, *FORCES, *PATH_WORDS)
    for role in (one for one in dict.fromkeys(known) if one in by_role):
        at = by_role[role]
        name = columns[at].name
        wanted[role] = name if named and name and names.count(name) == 1 else at
        column, own = values[:, at], unit(columns[at].unit)
        if role == "tangential" and is_coefficient(columns[at].name, columns[at].unit):
            own = COEFFICIENT
            notes.append("tangential: a coefficient of friction, which is multiplied by the load")
        if role == "time" and _is_clock(found, at):
            own = CLOCK
        if not own:
            own = _by_numbers(role, column)
            if own and own != DEFAULTS.get(role, "m"):
                notes.append(f"{role}: by its numbers in {own}")
        if not own:
            notes.append(f"{role}: no unit is given; {DEFAULTS.get(role, 'm')} is taken")
        if own in READINGS:
            notes.append(f"{role}: in {own}, which only a [calibration] turns into N")
        if own in TORQUES:
            notes.append(f"{role}: a torque, in {own}; give the arm of the force in m in [file]")
        if own == COUNTS:
            turn = _counts(column)
            if turn:
                file["counts_per_turn"] = turn
                notes.append(f"counts_per_turn: {turn} by where it starts again; see the encoder")
            else:
                notes.append(
                    "counts_per_turn: the counts do not start again; see the encoder, and give it "
                    "in [file]"
                )
        if own and own != DEFAULTS.get(role, "m"):
            units[role] = own
        if role == "normal" and np.nanmean(column) < 0.0:
            units[role] = f"-{own or DEFAULTS[role]}"
            notes.append("normal: negative, the sensor seems to count tension as positive")
    if "time" not in by_role and (rate := _rate(found)):
        file["sample_rate"] = rate
    found_sections = {"file": file, "columns": wanted, "units": units}
    return {name: part for name, part in found_sections.items() if part}, notes


def _missing(roles: set[str], file: Mapping[str, Any]) -> list[str]:
    """Return what is to be said of the columns of a tribometer that are not there."""
    needed = {
        "time": "sample_rate in [file]",
        "radial": "one_channel = true in [file], for the friction coefficient alone",
        "normal": "normal_load in [tribometer]",
    }
    wanted = ("time", *(() if "force_x" in roles else CHANNELS))
    notes = [
        f"{role}: no column seems to be it; name it in [columns]"
        + (f", or {needed[role]}" if role in needed else "")
        for role in wanted
        if role not in roles and not (role == "time" and "sample_rate" in file)
    ]
    if not {"angle", "turn_rate", *MOTION} & roles:
        notes.append(
            "angle: no column seems to be it; name it in [columns], or turn_rate in [file], or a "
            "motion along lines"
        )
    return notes


def _rate(found: Guess) -> float:
    """Return the sample rate that the header says, 0 if it says none."""
    heading = labview.heading_of([[str(cell).strip() for cell in row] for row in found.header])
    step = number_in(heading.step, found.form) if heading is not None else math.nan
    # Steps of so many µs are whole numbers of Hz, up to rounding.
    return float(f"{1.0 / step:.7g}") if step > 0.0 else 0.0


def _is_clock(found: Guess, at: int) -> bool:
    """Return whether the cells of a column are times of day, or durations, in words."""
    cell = next((row[at] for row in found.body if at < len(row) and row[at] != ""), "")
    return math.isnan(number_of(cell, found.form)) and not math.isnan(clock.of_cell(cell))


def _by_numbers(role: str, column: Array) -> str:
    """Return the unit of an angle that wraps, as far as its jumps say it."""
    column = column[np.isfinite(column)]
    if role != "angle" or column.size < 3:
        return ""
    jumps = np.abs(np.diff(column))
    wraps = jumps[jumps > 0.5 * np.ptp(column)]
    if not wraps.size:
        return ""
    size, step = float(np.median(wraps) + np.median(jumps)), float(np.median(jumps))
    for name, turn in (("deg", 360.0), ("rad", _TURN), ("turn", 1.0)):
        if abs(size - turn) < 0.02 * turn + step:
            return name
    is_whole = bool((column == np.rint(column)).all())
    return COUNTS if is_whole and size > 50.0 else ""


def _counts(column: Array) -> int:
    """Return the counts of a turn by the jumps where it starts again, 0 if it does not.

    It is the usual number next to them.
    """
    column = column[np.isfinite(column)]
    jumps = np.abs(np.diff(column))
    wraps = jumps[jumps > 0.5 * np.ptp(column)] if jumps.size else jumps
    if wraps.size == 0 or not (column == np.rint(column)).all():
        return 0
    step = float(np.median(jumps[jumps > 0.0]))
    size = float(np.median(wraps)) + step
    usual = {2**k for k in range(6, 25)} | {
        round(m * 10**k) for m in (1, 2, 2.5, 3.6, 5) for k in range(2, 7)
    }
    near = min(usual, key=lambda one: abs(one - size))
    if abs(near - size) <= max(step, 0.002 * near):
        return near
    return round(max(size, float(column.max()) + 1.0))
