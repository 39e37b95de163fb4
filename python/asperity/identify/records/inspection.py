"""What a table seems to be: its columns with ranges, and the configuration that reads it."""

from __future__ import annotations

import math
import os
import re
import unicodedata
from collections.abc import Mapping, Sequence
from contextlib import suppress
from pathlib import Path
from typing import Any

import numpy as np

from asperity._base import arrays
from asperity._base.arrays import Array
from asperity._base.storage import toml
from asperity._base.storage.files import atomic
from asperity._base.tables import aligned
from asperity._base.value import Value
from asperity.errors import ParameterError, RecordError
from asperity.identify.records.reading import PathLike
from asperity.identify.records.record import CHANNELS
from asperity.identify.records.tables import clock, labview
from asperity.identify.records.tables.guessing import Guess, guess, of_cells
from asperity.identify.records.tables.text_table import (
    SPREADSHEETS,
    Format,
    cells_of,
    number_in,
    read_table,
    sheets_of,
)
from asperity.identify.records.units import CLOCK, COUNTS, DEFAULTS, FORCES, MOTION

_TURN = 2.0 * math.pi
_IN_BRACKETS = re.compile(r"\s*(?P<name>.*?)\s*[\[(<]\s*(?P<unit>[^\])>]*)\s*[\])>]\s*")
_AFTER_MARK = re.compile(r"\s*(?P<name>.+?)\s*(?:/|\bin\b)\s*(?P<unit>[^\s/]+(?:/\w+)?)\s*")
_UNITS = {
    "s": "s", "sec": "s", "sek": "s", "seconds": "s", "sekunden": "s",
    "ms": "ms", "msec": "ms", "us": "us", "µs": "us", "min": "min",
    "hh:mm:ss": CLOCK, "h:m:s": CLOCK, "hh:mm:ss.fff": CLOCK,
    "rad": "rad", "deg": "deg", "°": "deg", "grad": "deg", "degree": "deg", "degrees": "deg",
    "turn": "turn", "turns": "turn", "rev": "turn", "u": "turn", "umdr": "turn",
    "counts": COUNTS, "count": COUNTS, "cts": COUNTS, "inc": COUNTS, "inkr": COUNTS,
    "ticks": COUNTS,
    "rpm": "rpm", "1/min": "rpm", "u/min": "rpm", "min-1": "rpm", "min^-1": "rpm", "rev/min": "rpm",
    "turn/s": "turn/s", "1/s": "turn/s", "hz": "turn/s", "deg/s": "deg/s", "°/s": "deg/s",
    "rad/s": "rad/s",
    "n": "N", "newton": "N", "newtons": "N", "volt": "V", "volts": "V",
    "gf": "gf", "kgf": "kgf", "kp": "kgf", "lbf": "lbf",
    "mn": "mN", "cn": "cN", "kn": "kN", "v": "V", "mv": "mV",
    "m": "m", "mm": "mm", "cm": "cm", "um": "um", "µm": "um",
    "m/s": "m/s", "mm/s": "mm/s", "cm/s": "cm/s", "um/s": "um/s", "µm/s": "um/s",
}  # fmt: skip
"""Spellings of units, in small letters; where these differ, kN from KN do not."""

_WORDS = {
    "time": r"t|time|zeit\w*|uhrzeit|timestamp|zeitstempel|clock|temps|tijd|datum|date.*",
    "turn_rate": r"rpm|drehzahl|speed rpm|rotation speed|turn rate|omega|n",
    "angle": r"a|phi|angle|winkel|drehwinkel|rotation|drehung|encoder|counts?|theta|"
    r"position angle|angular position",
    "tangential": r"ft|f t|ftan|f tan|tangential\w*|reibkraft|reibung\w*|friction\w*|"
    r"friction force|ff|f friction|tangential force",
    "radial": r"fr|f r|frad|f rad|radial\w*|querkraft|lateral\w*|radial force|fq|f q",
    "normal": r"fn|f n|fz|f z|normal\w*|anpresskraft|load|last|axial\w*|"
    r"normal force|normal load",
    "velocity_x": r"vx|v x|velocity x|geschwindigkeit x|speed x",
    "velocity_y": r"vy|v y|velocity y|geschwindigkeit y|speed y",
    "position_x": r"x|sx|pos x|position x|weg x|x pos|x position",
    "position_y": r"y|sy|pos y|position y|weg y|y pos|y position",
    "force_x": r"fx|f x|kraft x|force x",
    "force_y": r"fy|f y|kraft y|force y",
    "velocity": r"v|velocity|speed|geschwindigkeit|sliding speed|sliding velocity",
    "position": r"s|pos|position|weg|hub|stroke|displacement|weg s",
}
_KINDS = {
    "s": "time", "ms": "time", "us": "time", "min": "time", CLOCK: "time",
    "rad": "angle", "deg": "angle", "turn": "angle", COUNTS: "angle",
    "rpm": "turn_rate", "turn/s": "turn_rate", "deg/s": "turn_rate", "rad/s": "turn_rate",
    "m": "position", "mm": "position", "cm": "position", "um": "position",
    "m/s": "velocity", "mm/s": "velocity", "cm/s": "velocity", "um/s": "velocity",
    "N": "force", "mN": "force", "cN": "force", "kN": "force", "gf": "force",
    "kgf": "force", "lbf": "force", "V": "force", "mV": "force",
}  # fmt: skip


class Column(Value):
    """A column of a table.

    Attributes:
        name: of the column, as the file has it.
        unit: as the file has it, or empty.
        role: what it seems to be, such as ``"time"``, or empty.
        low, high: least and greatest number; None if it holds none.
    """

    name: str
    unit: str
    role: str
    low: float | None
    high: float | None

    def __init__(
        self, name: str, *, unit: str = "", role: str = "", low: float | None, high: float | None
    ) -> None:
        self._set(
            name=str(name),
            unit=str(unit),
            role=str(role),
            low=None if low is None else arrays.number(low, "low"),
            high=None if high is None else arrays.number(high, "high"),
        )


class Inspection(Value):
    """What a file seems to hold, made by `inspect_file`, and how a configuration says it.

    Attributes:
        path: of the file.
        columns: of the table, in their order.
        sections: of the configuration that reads it, as far as it can be guessed.
        notes: what is left to be said or checked.
    """

    path: str
    columns: tuple[Column, ...]
    sections: Mapping[str, Any]
    notes: tuple[str, ...]

    def __init__(
        self,
        path: PathLike,
        *,
        columns: Sequence[Column],
        sections: Mapping[str, Any],
        notes: Sequence[str] = (),
    ) -> None:
        self._set(
            path=os.fspath(path),
            columns=tuple(columns),
            sections={name: dict(part) for name, part in sections.items()},
            notes=tuple(notes),
        )

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
        return "\n\n".join([*parts, *([_listed(self.notes)] if self.notes else [])])

    def text(self) -> str:
        """Return the configuration as TOML, with the notes as comments."""
        head = f"How {Path(self.path).name} is read, as far as it could be guessed: look it over."
        return toml.text(self.sections, {"": "\n".join([head, *self.notes])}) + _HINTS

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
# file = "calibration.csv"
# reading_error = 0.001
#
# [tribometer]
# radius = 0.05               # m
#
# [processing]
# grid_angle = 0.0            # rad, of the sliding direction from e1 where the rotation reads 0
"""


def inspect_file(path: PathLike, *, sheet: str | int | None = None) -> Inspection:
    r"""Guess how a file of a tribometer is written and what its columns are.

    Encoding, delimiter, decimal mark, groups of digits, header and line of names follow from the
    text, units from brackets behind names, from a line of units or from the numbers themselves, and
    what columns are from their names and units. All of it is a guess to look over.

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


def _inspected(path: Path, found: Guess) -> Inspection:
    names, units, line = _names(found)
    form = found.form
    if line is not None and line != form.header:
        form = Format(**{**vars(form), "names": line})
    values = _numbers(path, found, form)
    roles = _roles(names, units, values)
    columns = []
    for at, name in enumerate(names):
        column = values[:, at][np.isfinite(values[:, at])]
        low, high = (column.min(), column.max()) if column.size else (None, None)
        columns.append(Column(name, unit=units[at], role=roles.get(at, ""), low=low, high=high))
    is_sheet = path.suffix.lower() in SPREADSHEETS
    sections, notes = _sections(form, columns, values, found, is_sheet=is_sheet)
    return Inspection(path, columns=columns, sections=sections, notes=notes)


def _names(found: Guess) -> tuple[list[str], list[str], int | None]:
    """Return the names and units of the columns, and the line of the names, from 1."""
    line: int | None
    width = max(map(len, found.body))
    while width and all(len(row) < width or row[width - 1] == "" for row in found.body):
        width -= 1
    texts = [[str(cell).strip() for cell in row] for row in found.header]
    heading = labview.heading_of(texts)
    if heading is not None:
        line = next(at for at in range(len(texts), 0, -1) if texts[at - 1][:1] == [labview.LAST])
        row, units = ((part + [""] * width)[:width] for part in (texts[line - 1], heading.units))
        within = [_parted(cell)[1] for cell in row]
        return row, [a or b for a, b in zip(within, units, strict=True)], line
    units, line = [""] * width, None
    for number in range(len(texts), 0, -1):
        row = (texts[number - 1] + [""] * width)[:width]
        filled = [cell for cell in row if cell]
        if len(filled) < max(2, 0.5 * width):
            continue
        as_units = [_unit(cell.strip("[]()<> ")) for cell in row]
        if line is None and not any(units) and sum(map(bool, as_units)) > 0.5 * len(filled):
            # A line of names, such as t, N, may look like one of units, if it is the only one.
            above = texts[number - 2] if number > 1 else []
            if sum(map(bool, above)) >= 0.5 * width:
                units = [cell.strip("[]()<> ") for cell in row]
                continue
        line = number
        within = [_parted(cell)[1] for cell in row]
        return row, [a or b for a, b in zip(within, units, strict=True)], line
    return [f"column {at}" for at in range(width)], units, line


def _unit(text: str) -> str:
    """Return our name of a unit, or nothing."""
    plain = text.strip().replace("μ", "µ")
    # Mega is no unit here.
    return _UNITS.get(plain.lower(), "")


def _parted(name: str) -> tuple[str, str]:
    """Return a name without its unit, and the unit."""
    found = _IN_BRACKETS.fullmatch(name)
    if found is not None:
        return found["name"], found["unit"].strip()
    found = _AFTER_MARK.fullmatch(name)
    if found is not None and _unit(found["unit"]):
        return found["name"], found["unit"]
    return name, ""


def _numbers(path: Path, found: Guess, form: Format) -> Array:
    """Return the numbers of all lines, NaN where there are none; clocks in s."""
    width = max(map(len, found.body))
    form_of = found.form

    def value(cell: Any) -> float:
        if not isinstance(cell, str):
            try:
                return clock.of_cell(cell) if not isinstance(cell, int | float) else float(cell)
            except (TypeError, ValueError):
                return math.nan
        number = number_in(cell, form_of)
        return clock.seconds(cell) if math.isnan(number) else number

    body = np.array(
        [[value(cell) for cell in (*row, *[""] * (width - len(row)))] for row in found.body]
    )
    held = np.flatnonzero(np.isfinite(body).mean(axis=0) > 0.5)
    clocked = [at for at in held.tolist() if _is_clock(found, at)]
    if path.suffix.lower() in SPREADSHEETS:
        return body
    timed = [f"column {at}" for at in clocked]
    try:
        read = read_table(path, {f"column {at}": int(at) for at in held}, form, clocked=timed)
    except RecordError:
        return body
    whole = np.full((len(read.values), width), np.nan)
    whole[:, held] = read.values
    return whole


def _plain(name: str) -> str:
    """Return a name in small letters without accents and marks."""
    parted = unicodedata.normalize("NFKD", _parted(name)[0].lower())
    letters = "".join(one for one in parted if not unicodedata.combining(one))
    greek = (
        letters.replace("φ", "phi").replace("ϕ", "phi").replace("θ", "theta").replace("ω", "omega")
    )
    return " ".join(re.sub(r"[^a-z0-9]+", " ", greek).split())


def _roles(names: Sequence[str], units: Sequence[str], values: Array) -> dict[int, str]:
    """Return what the columns seem to be, by their number."""
    roles: dict[int, str] = {}
    # Units that fit say more than names. Where there is one that is none of ours, as of a
    # temperature or of a coefficient of friction, the name misleads.
    with_unit = [at for at in range(len(names)) if _unit(units[at])]
    without = [at for at in range(len(names)) if not units[at]]
    for at in (*with_unit, *without):
        name, kind = names[at], _KINDS.get(_unit(units[at]), "")
        for role, words in _WORDS.items():
            if role in roles.values() or not re.fullmatch(words, _plain(name)):
                continue
            if kind and not _kind_of(role).startswith(kind):
                continue
            if np.isfinite(values[:, at]).any():
                roles[at] = role
                break
    for at in range(len(names)):
        kind = _KINDS.get(_unit(units[at]), "")
        if (
            at not in roles
            and kind in ("time", "angle", "turn_rate")
            and kind not in roles.values()
            and np.isfinite(values[:, at]).any()
        ):
            roles[at] = kind
    free = [
        at
        for at in range(len(names))
        if at not in roles and _KINDS.get(_unit(units[at])) == "force"
    ]
    missing = [one for one in CHANNELS if one not in roles.values()]
    if len(free) == len(missing) and not set(FORCES) & set(roles.values()):
        roles |= dict(zip(free, missing, strict=True))
    return _consistent(roles)


def _kind_of(role: str) -> str:
    if role in CHANNELS or role in FORCES:
        return "force"
    return role.partition("_")[0] if role in MOTION else role


def _consistent(roles: dict[int, str]) -> dict[int, str]:
    """Leave one motion: that of x and y if there is one, else the rotation, else the stroke."""
    found = set(roles.values())
    pairs = (("velocity_x", "velocity_y"), ("position_x", "position_y"))
    pair = next((one for one in pairs if set(one) <= found), None)
    if pair is not None and set(FORCES) <= found:
        kept = {*pair, "time", "angle", "normal", *FORCES}
    else:
        # Forces along x and y of a pin on a disk are those along it and across; one of them beside
        # a friction force is that across.
        given = [role for role in FORCES if role in found]
        missing = [role for role in CHANNELS[:2] if role not in found]
        names: dict[str, str] = {}
        if len(missing) == 2 or len(given) == len(missing):
            names = dict(zip(FORCES if len(missing) == 2 else given, missing, strict=True))
        # One axis that moves is the line along which the stage goes. Beside forces along x and y,
        # one along y would need a force across of another sign.
        for kind in ("velocity", "position"):
            alone = [role for role in (f"{kind}_x", f"{kind}_y") if role in found]
            along = not alone or alone[0].endswith("x") or len(missing) < 2
            if len(alone) == 1 and kind not in found and along:
                names[alone[0]] = kind
        roles = {at: names.get(role, role) for at, role in roles.items()}
        found = set(roles.values())
        motion = next(
            (one for one in ("angle", "turn_rate", "velocity", "position") if one in found), ""
        )
        kept = {"time", motion, *CHANNELS}
    return {at: role for at, role in roles.items() if role in kept}


def _sections(
    form: Format, columns: Sequence[Column], values: Array, found: Guess, *, is_sheet: bool
) -> tuple[dict[str, Any], list[str]]:
    """Return the sections of the configuration, and what is left to be said."""
    standard = Format()
    file: dict[str, Any] = {}
    for name, value in vars(form).items():
        # Cells of a spreadsheet are parted already.
        if value != getattr(standard, name) and not (name == "delimiter" and is_sheet):
            file[name] = " " if name == "delimiter" and value is None else value
    if "header" not in file:
        file["header"] = form.header
    notes: list[str] = []
    by_role = {one.role: at for at, one in enumerate(columns) if one.role}
    names = [one.name for one in columns]
    wanted: dict[str, Any] = {}
    units: dict[str, str] = {}
    for role in _order(by_role):
        at = by_role[role]
        named = columns[at].name
        unique = form.line_of_names and names.count(named) == 1 and named
        wanted[role] = named if unique else at
        unit = _unit(columns[at].unit)
        column = values[:, at]
        if role == "time" and _is_clock(found, at):
            unit = CLOCK
        if not unit:
            unit = _by_numbers(role, column)
            if unit and unit != DEFAULTS[role]:
                notes.append(f"{role}: by its numbers in {unit}")
        if not unit and role in DEFAULTS:
            notes.append(f"{role}: no unit is given; {DEFAULTS[role]} is taken")
        if unit == COUNTS:
            turn = _counts(column)
            if turn:
                file["counts_per_turn"] = turn
                notes.append(f"counts_per_turn: {turn} by where it starts again; see the encoder")
            else:
                notes.append(
                    "counts_per_turn: the counts do not start again; see the encoder, and give it "
                    "in [file]"
                )
        if unit and unit != DEFAULTS[role]:
            units[role] = unit
        if role == "normal" and np.nanmean(column) < 0.0:
            units[role] = f"-{unit or DEFAULTS[role]}"
            notes.append("normal: negative, the sensor seems to count tension as positive")
    rotation = {"angle", "turn_rate", *MOTION} & set(by_role)
    needed = {"time": "sample_rate in [file]", "normal": "normal_load in [tribometer]"}
    for role in ("time", *(() if "force_x" in by_role else CHANNELS)):
        if role not in by_role:
            rest = f", or {needed[role]}" if role in needed else ""
            notes.append(f"{role}: no column seems to be it; name it in [columns]{rest}")
    if "time" not in by_role and (rate := _rate(found)):
        file["sample_rate"] = rate
        notes = [note for note in notes if not note.startswith("time: no column")]
    if not rotation:
        notes.append(
            "angle: no column seems to be it; name it in [columns], or turn_rate in [file], or a "
            "motion along lines"
        )
    found_sections = {"file": file, "columns": wanted, "units": units}
    return {name: part for name, part in found_sections.items() if part}, notes


def _rate(found: Guess) -> float:
    """Return the sample rate that the header says, 0 if it says none."""
    heading = labview.heading_of([[str(cell).strip() for cell in row] for row in found.header])
    step = number_in(heading.step, found.form) if heading is not None else math.nan
    # Steps of so many µs are whole numbers of Hz, up to rounding.
    return float(f"{1.0 / step:.7g}") if step > 0.0 else 0.0


def _order(by_role: Mapping[str, int]) -> list[str]:
    known = ["time", "angle", "turn_rate", *MOTION, *CHANNELS, *FORCES]
    return [role for role in known if role in by_role]


def _is_clock(found: Guess, at: int) -> bool:
    """Return whether the cells of a column are times of day, or durations, in words."""
    cell = next((row[at] for row in found.body if at < len(row) and row[at] != ""), "")
    if not isinstance(cell, str):
        return not isinstance(cell, int | float)
    return math.isnan(number_in(cell, found.form)) and not math.isnan(clock.seconds(cell))


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
    for unit, turn in (("deg", 360.0), ("rad", _TURN), ("turn", 1.0)):
        if abs(size - turn) < 0.02 * turn + step:
            return unit
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


def _listed(notes: Sequence[str]) -> str:
    return "\n".join(f"- {note}" for note in notes)
