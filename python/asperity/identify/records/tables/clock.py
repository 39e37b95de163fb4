"""Times of day, with or without a date, as seconds."""

from __future__ import annotations

import datetime
import math
import re
from functools import cache
from typing import Any

import numpy as np

from asperity._base.arrays import Array

DAY = 86_400.0
_CLOCK = re.compile(
    r"(?:(?P<date>\d{1,4}[-./](?:\d{1,2}|[A-Za-zÄä]{3,4}\.?)[-./]\d{1,4})[T ]\s*)?"
    r"(?P<hour>\d{1,2}):(?P<minute>\d{2})(?::(?P<second>\d{2}(?:[.,:]\d+)?))?\s*(?P<half>[AaPp][Mm])?Z?"
)
# Durations as MATLAB writes them.
_LASTING = re.compile(r"(?P<number>[-+]?\d+(?:[.,]\d*)?(?:[eE][-+]?\d+)?) (?P<unit>sec|min|hr)")
_LASTS = {"sec": 1.0, "min": 60.0, "hr": 3600.0}
_MONTHS = {
    **{"jan": 1, "feb": 2, "mar": 3, "apr": 4, "may": 5, "jun": 6},
    **{"jul": 7, "aug": 8, "sep": 9, "oct": 10, "nov": 11, "dec": 12},
    **{"mär": 3, "mrz": 3, "mai": 5, "okt": 10, "dez": 12},
}


def seconds(text: str) -> float:
    """Return the seconds since midnight, or since 1970 where there is a date; NaN if it is none.

    Dates are year-month-day, day.month.year or month/day/year; a month may have its name. What
    lasts "0.5 sec" is so long.

    >>> from asperity.identify.records.tables.clock import seconds
    >>> seconds("12:00:00.123"), seconds("1:30 PM")
    (43200.123, 48600.0)
    >>> seconds("2026-11-23T12:00:00") - seconds("23.11.2026 11:59:00")
    60.0
    """
    plain = text.strip().strip('"')
    found = _CLOCK.fullmatch(plain)
    if found is None:
        lasting = _LASTING.fullmatch(plain)
        if lasting is None:
            return math.nan
        return float(lasting["number"].replace(",", ".")) * _LASTS[lasting["unit"]]
    hour, half = int(found["hour"]), found["half"]
    if half is not None:
        hour = hour % 12 + 12 * (half.lower() == "pm")
    second = float((found["second"] or "0").replace(",", ".").replace(":", "."))
    day = 0.0 if found["date"] is None else _day(found["date"])
    return DAY * day + 3600.0 * hour + 60.0 * int(found["minute"]) + second


@cache
def _day(date: str) -> float:
    """Return the days since 1970."""
    mark = next(one for one in date if not one.isdigit())
    texts = [one for one in re.split(r"[-./]", date) if one]
    named = texts[1][0].isalpha()
    if named:
        texts[1] = str(_MONTHS.get(texts[1].lower()[:3], 0))
    parts = [int(one) for one in texts]
    if parts[0] > 31:
        year, month, day = parts
    elif mark == "/" and not named:
        month, day, year = parts
    else:
        day, month, year = parts
    try:
        return float(datetime.date(year, month, day).toordinal() - _EPOCH)
    except ValueError:
        return math.nan


_BEGIN = datetime.datetime(1970, 1, 1)
_EPOCH = _BEGIN.toordinal()
UNDATED = 1000.0 * DAY
"""Records whose times have no date end before this."""


def of_cell(cell: Any) -> float:
    """Return the seconds that a cell of a spreadsheet or of a table in memory says."""
    if isinstance(cell, str):
        return seconds(cell)
    if isinstance(cell, datetime.datetime):
        return (cell.replace(tzinfo=None) - _BEGIN).total_seconds()
    if isinstance(cell, np.datetime64):
        return float((cell - np.datetime64(0, "s")) / np.timedelta64(1, "s"))
    if isinstance(cell, np.timedelta64):
        return float(cell / np.timedelta64(1, "s"))
    if isinstance(cell, datetime.time):
        return 3600.0 * cell.hour + 60.0 * cell.minute + cell.second + 1e-6 * cell.microsecond
    if isinstance(cell, datetime.timedelta):
        return cell.total_seconds()
    return math.nan


def through_midnight(time: Array) -> Array:
    """Return times of day that go on after midnight instead of starting again."""
    back = np.diff(time) < -0.5 * DAY
    if not back.any():
        return time
    return time + DAY * np.concatenate([[0.0], np.cumsum(back)])


def text(time: float) -> str:
    """Return what a clock shows, with the date where there is one.

    >>> from asperity.identify.records.tables.clock import seconds, text
    >>> text(86_397.5), text(seconds("23.11.2026 12:00:00"))
    ('23:59:57.5', '2026-11-23 12:00:00')
    """
    if not math.isfinite(time):
        return "no time"
    day, rest = divmod(round(time, 6), DAY)
    minutes, second = divmod(rest, 60.0)
    hour, minute = divmod(int(minutes), 60)
    shown = f"{hour:02d}:{minute:02d}:{second:09.6f}".rstrip("0").rstrip(".")
    # What goes on after midnight has no date either.
    if abs(time) < UNDATED:
        return shown
    return f"{datetime.date.fromordinal(int(day) + _EPOCH)} {shown}"


def in_record(time: float, first: float, last: float, *, after: float = -math.inf) -> float:
    """Return a time of day on the day on which it is in a record, or nearest to it.

    Args:
        time: since midnight.
        first: of the record.
        last: of the record.
        after: what it is not before.
    """
    days = np.arange(first // DAY - 1.0, last // DAY + 2.0)
    found = time + DAY * days
    found = found[found >= after] if (found >= after).any() else found
    away = np.maximum(np.maximum(first - found, found - last), 0.0)
    return float(found[away.argmin()])
