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
    r"(?:(?P<date>\d{1,4}[-./]\d{1,2}[-./]\d{1,4})[T ]\s*)?"
    r"(?P<hour>\d{1,2}):(?P<minute>\d{2})(?::(?P<second>\d{2}(?:[.,:]\d+)?))?\s*(?P<half>[AaPp][Mm])?Z?"
)


def seconds(text: str) -> float:
    """Return the seconds since midnight, or since 1970 where there is a date; NaN if it is none.

    Dates are year-month-day, day.month.year or month/day/year.

    >>> from asperity.identify.records.clock import seconds
    >>> seconds("12:00:00.123"), seconds("1:30 PM")
    (43200.123, 48600.0)
    >>> seconds("2026-11-23T12:00:00") - seconds("23.11.2026 11:59:00")
    60.0
    """
    found = _CLOCK.fullmatch(text.strip().strip('"'))
    if found is None:
        return math.nan
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
    parts = [int(one) for one in re.split(r"[-./]", date)]
    if parts[0] > 31:
        year, month, day = parts
    elif mark == "/":
        month, day, year = parts
    else:
        day, month, year = parts
    try:
        return float(datetime.date(year, month, day).toordinal() - _EPOCH)
    except ValueError:
        return math.nan


_BEGIN = datetime.datetime(1970, 1, 1)
_EPOCH = _BEGIN.toordinal()


def of_cell(cell: Any) -> float:
    """Return the seconds that a cell of a spreadsheet or of a table in memory says."""
    if isinstance(cell, str):
        return seconds(cell)
    if isinstance(cell, datetime.datetime):
        return (cell.replace(tzinfo=None) - _BEGIN).total_seconds()
    if isinstance(cell, np.datetime64):
        return float((cell - np.datetime64(0, "s")) / np.timedelta64(1, "s"))
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
