"""What headings of tables say: names of columns and their units.

All spellings are here; `guessing` is about how numbers are written, `inspection` uses both.
"""

from __future__ import annotations

import math
import re
import unicodedata
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from asperity._base import arrays
from asperity._base.arrays import Array
from asperity.errors import ParameterError, RecordError
from asperity.identify.records.tables import clock, labview

_TURN = 2.0 * math.pi
CHANNELS = ("tangential", "radial", "normal")
READINGS = ("V", "mV", "raw")
"""Units of channels that only a calibration turns into forces."""
WITHOUT_RADIAL = (
    "The deflection of the force needs the radial channel; one_channel = true in [file] does "
    "without it, for the friction coefficient alone"
)
WITHOUT = {
    "time": ("sample_rate", "With equal time steps, sample_rate in [file] does without it"),
    "angle": ("turn_rate", "At a constant speed, turn_rate in [file] does without it"),
    "radial": ("one_channel", WITHOUT_RADIAL),
    "normal": ("normal_load", "Under a constant load, normal_load in [tribometer] does without it"),
}
"""What takes the place of a channel that was not recorded."""
_GRAVITY, _POUND, _INCH = 9.80665, 0.45359237, 0.0254
NEWTONS = {
    **{"N": 1.0, "uN": 1e-6, "mN": 1e-3, "cN": 1e-2, "daN": 10.0, "kN": 1e3},
    **{"gf": 1e-3 * _GRAVITY, "kgf": _GRAVITY, "lbf": _POUND * _GRAVITY},
    "ozf": _POUND * _GRAVITY / 16.0,
}
_READINGS = {**NEWTONS, **dict(zip(READINGS, (1.0, 1e-3, 1.0), strict=True))}
TORQUES = {
    **{"Nm": 1.0, "Ncm": 1e-2, "Nmm": 1e-3, "mNm": 1e-3, "uNm": 1e-6},
    "in lbf": _INCH * _POUND * _GRAVITY,
}
"""Units of a torque about the axis of a disk, which the arm of the friction force divides."""
COEFFICIENT = "1"
"""Unit of a tangential channel that is the coefficient of friction, a force per load."""
_LENGTHS = {"m": 1.0, "mm": 1e-3, "cm": 1e-2, "um": 1e-6, "in": _INCH}
_SPEEDS = {
    f"{name}/{per}": factor / seconds
    for name, factor in _LENGTHS.items()
    for per, seconds in (("s", 1.0), ("min", 60.0))
}
CLOCK, COUNTS = "clock", "counts"
POSITIONS = ("position", "position_x", "position_y")
VELOCITIES = ("velocity", "velocity_x", "velocity_y")
MOTION = (*VELOCITIES, *POSITIONS)
FORCES = ("force_x", "force_y")
UNITS: dict[str, dict[str, float]] = {
    # A clock time is read as seconds.
    "time": {"s": 1.0, "ms": 1e-3, "us": 1e-6, "min": 60.0, CLOCK: 1.0},
    # Counts are a turn once it is known how many a turn has.
    "angle": {"rad": 1.0, "deg": math.pi / 180.0, "turn": _TURN, COUNTS: _TURN},
    **dict.fromkeys(CHANNELS, _READINGS),
    "tangential": {**_READINGS, **TORQUES, COEFFICIENT: 1.0},
    "turn_rate": {
        "turn/s": 1.0,
        "rpm": 1.0 / 60.0,
        "deg/s": 1.0 / 360.0,
        "rad/s": 1.0 / _TURN,
    },
    **dict.fromkeys(VELOCITIES, _SPEEDS),
    **dict.fromkeys(POSITIONS, _LENGTHS),
    **dict.fromkeys(FORCES, _READINGS),
}
DEFAULTS = {
    "time": "s",
    "angle": "rad",
    **dict.fromkeys(CHANNELS, "N"),
    "turn_rate": "turn/s",
    **dict.fromkeys(VELOCITIES, "m/s"),
    **dict.fromkeys(POSITIONS, "m"),
    **dict.fromkeys(FORCES, "N"),
}

_BRACKETS = re.compile(r"\s*(?P<name>.*?)\s*[\[(<{]\s*(?P<unit>[^\])>}]*)\s*[\])>}]\s*")
# Behind a mark or a blank, a unit must be one of ours.
_MARKED = re.compile(r"\s*(?P<name>.+?)\s*(?:/|\bin\b|,)\s*(?P<unit>[^\s/]+(?:/\w+)?)\s*")
_SUFFIX = re.compile(r"\s*(?P<name>.*[^\W_])[\s_.]+(?P<unit>[^\s_./][^\s_.]*)\s*")
_UNITS = {
    "s": "s", "sek": "s", "second": "s", "seconds": "s", "sekunden": "s",
    "ms": "ms", "us": "us", "µs": "us", "min": "min",
    "hh:mm:ss": CLOCK, "h:m:s": CLOCK, "hh:mm:ss.fff": CLOCK,
    "rad": "rad", "deg": "deg", "°": "deg", "grad": "deg", "degree": "deg", "degrees": "deg",
    "turn": "turn", "turns": "turn", "rev": "turn", "u": "turn", "umdr": "turn",
    "counts": COUNTS, "count": COUNTS, "cts": COUNTS, "inc": COUNTS, "inkr": COUNTS,
    "ticks": COUNTS,
    "rpm": "rpm", "1/min": "rpm", "u/min": "rpm", "umdr/min": "rpm", "rev/min": "rpm",
    "r/min": "rpm", "tr/min": "rpm", "turn/s": "turn/s", "rev/s": "turn/s", "r/s": "turn/s",
    "1/s": "turn/s", "hz": "turn/s", "deg/s": "deg/s", "°/s": "deg/s", "rad/s": "rad/s",
    "n": "N", "newton": "N", "newtons": "N", "mn": "mN", "cn": "cN", "dan": "daN", "kn": "kN",
    "un": "uN", "µn": "uN", "g": "gf", "gf": "gf", "p": "gf", "pond": "gf", "gram": "gf",
    "kg": "kgf", "kgf": "kgf", "kp": "kgf", "lbf": "lbf", "lb": "lbf", "lbs": "lbf",
    "ozf": "ozf", "oz": "ozf", "inlbf": "in lbf", "inlb": "in lbf", "lbfin": "in lbf",
    "lbin": "in lbf", "inlbs": "in lbf",
    "nm": "Nm", "newtonmeter": "Nm", "ncm": "Ncm", "nmm": "Nmm", "mnm": "mNm", "µnm": "uNm",
    "unm": "uNm",
    "v": "V", "volt": "V", "volts": "V", "mv": "mV", "raw": "raw",
    "m": "m", "mm": "mm", "cm": "cm", "um": "um", "µm": "um", "micron": "um", "microns": "um",
    "in": "in", "inch": "in", "inches": "in", "zoll": "in", '"': "in",
    "m/s": "m/s", "mm/s": "mm/s", "cm/s": "cm/s", "um/s": "um/s", "µm/s": "um/s", "in/s": "in/s",
    "ips": "in/s", "inch/s": "in/s", "inches/s": "in/s",
    "m/min": "m/min", "mm/min": "mm/min", "cm/min": "cm/min", "um/min": "um/min",
    "µm/min": "um/min", "in/min": "in/min", "ipm": "in/min", "inch/min": "in/min",
    "mm/minute": "mm/min",
    "1": COEFFICIENT, "-": COEFFICIENT, "--": COEFFICIENT, "–": COEFFICIENT,
}  # fmt: skip
"""Spellings of units, in small letters; where these differ, kN from KN do not."""

# Mega, nanometres, and conductances.
_OTHERS = ("MN", "MV", "nm", "mS", "µS")
# Units of one letter that are small in names, such as those of weg_m and of Kraft_N.
_LETTERS = ("N", "V", "m", "s", "g")
WORDS = {
    "time": r"t|time|\w*zeit|zeit\w*|timestamp|time stamp|(elapsed|test|total|run) time|clock|"
    r"temps|tijd|tiempo|tempo|datum|date|date time|x value",
    "turn_rate": r"rpm|drehzahl|rotation(al)? speed|turn rate|omega|spindle speed|disk speed",
    "angle": r"phi|angle|\w*winkel|rotation|drehung|encoder|counts?|theta|position angle|"
    r"(angular|rotary|disk) position|(rotation|disk|rotary) angle|angle of rotation",
    "tangential": r"f ?t|f ?tan|tangential( force)?|tangentialkraft|reib(ungs)?kraft|"
    r"(friction|frictional|drag|traction) force|f ?f|f friction|"
    r"force (tangential|tangentielle|de frottement)",
    "radial": r"f ?r|f ?rad|radial( force)?|radialkraft|querkraft|(lateral|transverse)( force)?|"
    r"f ?q|side force|seitenkraft|force (radiale?|laterale?)",
    "normal": r"f ?n|f ?z|(normal|axial|vertical)( force| load)?|contact (force|load)|"
    r"(normal|axial)kraft|"
    r"anpresskraft|(applied )?load|last|kraft z|z kraft|force (z|normale?)|z force",
    **{
        f"{kind}_{axis}": rf"{short} ?{axis}|({names}) {axis}|{axis} ({names})"
        for kind, names, short in (
            ("velocity", "velocity|speed|geschwindigkeit", "v"),
            ("position", "pos|position|weg|displacement", "s?"),
            ("force", "kraft|force", "f"),
        )
        for axis in "xy"
    },
    "velocity": r"velocity|speed|geschwindigkeit|vitesse|sliding (speed|velocity)",
    "position": r"pos|position|weg|hub|stroke|displacement|weg s",
}
"""What columns of tribometers are called, in small letters without marks."""
_COEFFICIENT = (
    r"cof|mu|co?ef+(icient)? (of|de) (friction|traction|frottement)|"
    r"(friction|traction|friktions|reib|reibungs) ?(coef+|coef+icient|koeffizient)|"
    r"reibwert|reib(ungs)?(zahl|beiwert)"
)
"""What a coefficient of friction is called."""

# What may be anything else without a unit that fits: friction, for one, a coefficient.
_WITH_UNIT = {
    "turn_rate": r"n|speed|velocity",
    "angle": r"a|pos|position",
    "tangential": r"friction|reibung|traction|drag|((friction|frictional) )?torque|m ?t|"
    r"(dreh|reib)moment|moment",
    "velocity": "v",
    "position": "s",
}

PATH_WORDS = {
    "time": WORDS["time"],
    **{
        f"{name}{error}": rf"({name}|(pos|position|coordinate) {axis}|"
        rf"{axis}( pos| position| coordinate)?){mark}"
        for name, axis in (("x1", "x"), ("x2", "y"))
        for error, mark in (("", ""), ("_error", " error"))
    },
}
"""What columns of paths are called."""

# A column that holds what was asked for, or what is made of readings, is no reading.
_NOT_READ = re.compile(
    r"\b(set|setpoint|soll\w*|target|nominal|command\w*|cmd|demand|limit|max\w*|min\w*|std\w*|"
    r"offset|tolerance|dev|deviation)\b"
)
_PLACES = {"daq", "rotary", "linear", "measured", "actual", "ist", "istwert", "meas", "sensor",
           "channel", "ch", "kanal", "signal", "in", "richtung", "direction", "axis", "achse",
           "filtered", "filt", "mean", "avg", "abs", "rms"}  # fmt: skip
_SPELT = (("μ", "mu"), ("φ", "phi"), ("ϕ", "phi"), ("θ", "theta"), ("ω", "omega"), ("°", " deg"))
_LABELS = ("unit", "units", "einheit", "einheiten", "name", "names", "channel", "channel name",
           "channel names", "kanal", "kanalname")  # fmt: skip
# Longer texts are no units.
_LONGEST_UNIT = 12


def factors(
    units: Mapping[str, str] | None,
    counts_per_turn: float | None = None,
    arm: float | None = None,
) -> dict[str, float]:
    """Return the factors to SI of all columns; a leading minus turns the sign of a channel.

    Args:
        units: by column.
        counts_per_turn: of the encoder, where the unit of the angle is its counts.
        arm: of the friction force in m, where the tangential channel is a torque.

    >>> from asperity.identify.records.tables.headings import factors
    >>> factors({"time": "ms", "normal": "-N"})["normal"]
    -1.0
    """
    found = {}
    given = {**DEFAULTS, **(units or {})}
    for column, unit in given.items():
        if column not in UNITS:
            raise ParameterError("units", f"has no column {column!r}, only {', '.join(UNITS)}")
        known = UNITS[column]
        name = str(unit).removeprefix("-")
        if name not in known:
            raise ParameterError("units", f"of {column} must be {', '.join(known)}, got {unit!r}")
        found[column] = math.copysign(known[name], -1.0 if str(unit).startswith("-") else 1.0)
    if given["angle"].removeprefix("-") == COUNTS:
        if counts_per_turn is None:
            raise ParameterError(
                "counts_per_turn", "must be given where the unit of the angle is counts"
            )
        found["angle"] /= arrays.positive(counts_per_turn, "counts_per_turn")
    elif counts_per_turn is not None:
        raise ParameterError(
            "counts_per_turn", f"is for an angle in counts, its unit is {given['angle']!r}"
        )
    if given["tangential"].removeprefix("-") in TORQUES:
        if arm is None:
            raise ParameterError(
                "arm", "must be given, in m, where the tangential channel is a torque"
            )
        found["tangential"] /= arrays.positive(arm, "arm")
    elif arm is not None:
        raise ParameterError(
            "arm", f"is for a torque, the unit of the tangential channel is {given['tangential']!r}"
        )
    return found


def unit(text: str) -> str:
    """Return our name of a unit, or nothing.

    >>> from asperity.identify.records.tables.headings import unit
    >>> [unit(text) for text in ("mm/sec", "min⁻¹", "KN", "MN", "°C")]
    ['mm/s', 'rpm', 'kN', '', '']
    """
    plain = text.strip().rstrip(".").replace("μ", "µ").replace("⁻¹", "-1").replace("º", "°")
    if plain in _OTHERS:
        return ""
    plain = re.sub(r"[\s*·^]|(?<=[a-zµ])-(?=[a-z])", "", plain.lower()).replace("sec", "s")
    plain = re.sub(r"\.?(s|min)-1$", r"/\1", plain).removeprefix(".")
    return _UNITS.get(f"1{plain}" if plain.startswith("/") else plain, "")


def parted(name: str, words: Mapping[str, str] = WORDS) -> tuple[str, str]:
    """Return a name without its unit, and the unit as it is written.

    >>> from asperity.identify.records.tables.headings import parted
    >>> parted("Fx [kp]"), parted("angle_deg"), parted("Speed mm/sec"), parted("Angle/°")
    (('Fx', 'kp'), ('angle', 'deg'), ('Speed', 'mm/sec'), ('Angle', '°'))
    >>> parted("load_N"), parted("F_N"), parted("F_V"), parted("deg/s")
    (('load', 'N'), ('F_N', ''), ('F_V', ''), ('deg/s', ''))
    """
    found = _BRACKETS.fullmatch(name)
    if found is not None:
        text = found["unit"].strip()
        # Round brackets may hold anything: the symbol of a force, or the number of a channel.
        other = (
            len(text) > _LONGEST_UNIT or re.search(r"\d", text) or plain(text) in _PLACES - {"in"}
        )
        symbol = any(re.fullmatch(one, plain(text)) for one in words.values())
        is_unit = name.rstrip().endswith("]") or (unit(text) and text != "1")
        is_unit = is_unit or not (other or symbol)
        return (found["name"], text) if is_unit else parted(found["name"], words)
    known = any(re.fullmatch(one, plain(name)) for one in words.values())
    # An "in" at the end may be an inch.
    if unit(name) or (known and not re.search(r"[\s_.]in$", name)):
        return name, ""
    for form in (_SUFFIX, _MARKED):
        found = form.fullmatch(name)
        if found is not None and (own := unit(text := found["unit"])):
            rest = found["name"].removesuffix(" in")
            # A letter may be an index as well, such as that of a vertical force F_V.
            fits = text in (*_LETTERS, "in") and _roles_in(plain(rest), own, words)
            if form is _MARKED or (len(text) > 1 and text != "in") or fits:
                return rest, text
    return name, ""


def plain(name: str) -> str:
    """Return a name in small letters without accents, marks and what says where it is from."""
    apart = unicodedata.normalize("NFKD", name.lower())
    letters = "".join(one for one in apart if not unicodedata.combining(one))
    for mark, latin in _SPELT:
        letters = letters.replace(mark, latin)
    parts = re.sub(r"[^a-z0-9]+", " ", letters).split()
    return " ".join([one for one in parts if one not in _PLACES] or parts)


def roles_of(name: str, text: str, words: Mapping[str, str]) -> list[str]:
    """Return what a column may be by its name and the unit beside it, likeliest first."""
    called, own = plain(parted(name, words)[0]), unit(text)
    if _NOT_READ.search(called) or (text and not own) or own == COEFFICIENT:
        return []
    if own:
        return _roles_in(called, own, words)
    # A T is a temperature as well.
    if parted(name, words)[0].strip() == "T":
        return []
    return [role for role, spelt in words.items() if re.fullmatch(spelt, called)]


def _roles_in(called: str, own: str, words: Mapping[str, str]) -> list[str]:
    """Return what a column in a unit may be by its name without that."""
    spellings = (*words.items(), *_WITH_UNIT.items())
    return [
        role for role, one in spellings if own in known_units(role) and re.fullmatch(one, called)
    ]


def is_coefficient(name: str, text: str) -> bool:
    """Return whether a column seems to be a coefficient of friction, by its name and unit.

    >>> from asperity.identify.records.tables.headings import is_coefficient
    >>> [is_coefficient(*one) for one in (("µ", ""), ("COF [-]", "-"), ("Friction", ""))]
    [True, True, False]
    """
    called, own = plain(parted(name)[0]), unit(text)
    if not is_read(name) or (text and own != COEFFICIENT):
        return False
    also = [WORDS["tangential"], _WITH_UNIT["tangential"]] if own else []
    return any(re.fullmatch(one, called) for one in (_COEFFICIENT, *also))


def is_read(name: str) -> bool:
    """Return whether a column seems to hold readings, and not what was asked for."""
    return _NOT_READ.search(plain(parted(name)[0])) is None


def known_units(role: str) -> Mapping[str, float]:
    """Return the units of a column and their factors to SI."""
    if role.startswith(("x1", "x2")):
        return UNITS["position"]
    return UNITS.get(role.removeprefix("load_"), {})


@dataclass(frozen=True)
class Headings:
    """What the lines before the numbers say of each column.

    Attributes:
        names: of the columns.
        units: as they are written, empty where there is none.
        line: of the names, from 1; 0 if there is none.
        odd: why a line of names is not used, or empty.
    """

    names: list[str]
    units: list[str]
    line: int
    odd: str = ""


def headings(
    rows: Sequence[Sequence[Any]],
    width: int,
    *,
    least: int = 0,
    line: int | None = None,
    words: Mapping[str, str] = WORDS,
) -> Headings:
    """Return what the lines before the numbers say.

    Args:
        rows: their cells.
        width: of the table.
        least: columns without those at its end that may be empty.
        line: of the names, from 1; by default the one that holds most names of columns.
        words: what columns are called.
    """
    cells = [["" if cell is None else str(cell).strip() for cell in row] for row in rows]
    texts = [_laid(row, width) for row in cells]
    heading = labview.heading_of(cells)
    if heading is not None and line is None:
        line = max(at for at, row in enumerate(cells, 1) if row[:1] == [labview.LAST])
    if line is None:
        line = _line_of_names(texts, width, words)
    nameless = Headings([f"column {at}" for at in range(width)], [""] * width, 0)
    if not line:
        # What could be names, but for their number.
        line = max((at for at, row in enumerate(cells, 1) if len(row) > width), default=0)
    if not line or line > len(texts):
        return nameless
    names, count = texts[line - 1], len(cells[line - 1])
    if not names or count < least:
        odd = f"line {line} has {count} headings, the numbers have {least or width} columns"
        return replace(nameless, odd=odd)
    within = [parted(name, words)[1] for name in names]
    beside = [""] * width
    if heading is not None:
        beside = (heading.units + [""] * width)[:width]
    else:
        # Of lines beside the names, those below count first; numbers may be headed by units alone.
        order = [*range(line, len(texts)), *range(line - 2, -1, -1), line - 1]
        at = next((one for one in order if _holds_units(texts[one], words)), None)
        beside = beside if at is None else [_bare(cell) for cell in texts[at]]
    return Headings(names, [a or b for a, b in zip(within, beside, strict=True)], line)


def _laid(cells: list[str], width: int) -> list[str]:
    """Return the cells of a line, one for each column; none if they are not that many."""
    while cells and not cells[-1]:
        cells = cells[:-1]
    if len(cells) > width and plain(cells[0]) in _LABELS:
        cells = cells[1:]
    # LabVIEW names a column of comments that need not be there.
    if len(cells) > width and cells[0] == labview.LAST:
        cells = cells[:width]
    return [] if len(cells) > width else cells + [""] * (width - len(cells))


def _line_of_names(texts: Sequence[Sequence[str]], width: int, words: Mapping[str, str]) -> int:
    """Return the line that holds most names of columns, the last of several; 0 if none does."""
    best, line = 0, 0
    for at, row in enumerate(texts, 1):
        filled = [cell for cell in row if cell]
        values = sum(cell[:1].isdigit() or clock.seconds(cell) >= 0.0 for cell in filled)
        if len(filled) < max(2, 0.5 * width) or 2 * values >= len(filled):
            continue
        if _holds_units(row, words) and (best or any(map(any, texts[: at - 1]))):
            continue
        found = {role for cell in filled for role in roles_of(cell, parted(cell)[1], words)[:1]}
        score = 1 + len(found) + sum(bool(unit(parted(cell)[1])) for cell in filled)
        if score >= best:
            best, line = score, at
    return line


def _holds_units(row: Sequence[str], words: Mapping[str, str]) -> bool:
    """Return whether a line is one of units, some of which may be none of ours."""
    cells = [bare for cell in row if (bare := _bare(cell))]
    others = [cell for cell in cells if not unit(cell)]
    # Of settings, such as a load with its number and unit, the smaller part is units.
    if 2 * len(others) >= len(cells) or max(map(len, cells)) > _LONGEST_UNIT:
        return False
    return not any(
        roles_of(cell, "", words) or parted(cell)[1] or cell[0].isdigit() for cell in others
    )


def _bare(cell: str) -> str:
    text = re.sub(r"^(units?|einheit(en)?)\s*:", "", cell, flags=re.I).strip("[](){}<>:# ")
    return "" if text.lower() in _LABELS or text in ("-", "--", "1") else text


def place_of(column: str, names: Sequence[str], source: str) -> int | None:
    """Return where the column of a name is; None if there is none.

    Raises:
        RecordError: if several columns have that name.
    """
    places = [at for at, name in enumerate(names) if name == column]
    if len(places) > 1:
        listed = " and ".join(map(str, places))
        raise RecordError(
            source,
            f"has several columns {column!r}: give the number of the one that is meant, {listed} "
            "(numbers count from 0)",
            ("columns",),
        )
    return places[0] if places else None


def settled(
    role: str, stated: str | None, text: str, *, called: str, source: str, check: bool = True
) -> str | None:
    """Return the unit of a column: the one of the configuration, else of its heading, else none.

    Args:
        role: what the column is.
        stated: by the configuration.
        text: of the heading.
        called: the column, for messages.
        source: for messages.
        check: whether a contradiction is refused; else the configuration counts.

    Raises:
        RecordError: if heading and configuration contradict each other, or the heading has a unit
            that does not fit and the configuration none.
    """
    known, found = known_units(role), unit(text)
    if found == COEFFICIENT and found not in known:
        found = ""
    if stated is None:
        if found in known:
            return found
        if text and check:
            raise RecordError(
                source,
                f"column {called} ({role}): its heading says {text!r}, which is none of "
                f"{', '.join(known)}: say which unit it is",
                ("units", "check_units"),
            )
        return None
    own = stated.removeprefix("-")
    if check and found and found != own and own not in ("raw", CLOCK):
        raise RecordError(
            source,
            f"column {called} ({role}): its heading says {text!r}, the configuration {own!r}: "
            "correct the wrong one",
            ("units", "check_units"),
        )
    return stated


def refuse_twice(columns: Mapping[str, str | int], wanted: Sequence[int]) -> None:
    """Refuse one column for two."""
    names = list(columns)
    for at, place in enumerate(wanted):
        first = wanted.index(place)
        if first < at:
            raise ParameterError(
                "columns", f"give the same column for {names[first]} and {names[at]}"
            )


def assigned(
    head: Headings, words: Mapping[str, str], values: Array, held: Sequence[int]
) -> tuple[dict[int, str], list[str]]:
    """Return what columns are by their names and units, and what is to be said of it.

    Args:
        head: the headings.
        words: what columns are called.
        values: of all columns.
        held: numbers of those that may be meant.
    """
    candidates: dict[str, list[int]] = {}
    for at in held:
        for role in roles_of(head.names[at], head.units[at], words)[:1]:
            candidates.setdefault(role, []).append(at)
    roles: dict[int, str] = {}
    notes: list[str] = []
    for role, places in candidates.items():
        # A column with a unit is surer than one without, one in N than one in V or N m.
        first, *rest = sorted(
            places,
            key=lambda at: (not head.units[at], unit(head.units[at]) in (*READINGS, *TORQUES)),
        )
        one = values[:, first]
        others = [at for at in rest if not np.array_equal(values[:, at], one, equal_nan=True)]
        twins = [at for at in others if head.names[at] == head.names[first]]
        if twins:
            listed = ", ".join(map(str, sorted([first, *twins])))
            notes.append(
                f"{role}: columns {listed} are all called {head.names[first]!r}; give the number "
                "of the one that is meant in [columns]"
            )
            continue
        roles[first] = role
        if others:
            also = ", ".join(repr(head.names[at]) for at in others)
            notes.append(f"{role}: {head.names[first]!r} is taken, not {also}")
    for at in held:
        text = head.units[at] if unit(head.units[at]) in ("", COEFFICIENT) else ""
        for role in roles_of(head.names[at], "", words)[: bool(text)]:
            # A friction force without a unit is a coefficient, which `inspection` looks for.
            if role not in roles.values() and not is_coefficient(head.names[at], text):
                notes.append(f"{role}: unit {text!r} of {head.names[at]!r} is not known")
    return roles, notes
