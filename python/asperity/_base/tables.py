"""Tables: as CSV files, and as aligned text."""

from __future__ import annotations

import csv
import io
import os
from collections.abc import Iterable, Iterator, Mapping, Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

from asperity._base.storage.files import atomic

# Rows that become Python numbers at a time.
_CHUNK = 1 << 14


def write_csv(
    path: str | os.PathLike[str],
    header: Iterable[str],
    rows: Iterable[Iterable[object]],
    *,
    digits: int | None = None,
) -> None:
    """Write a table; the file is complete or not there.

    Args:
        path: of the file.
        header: titles of the columns, with their units.
        rows: cells; None is left empty.
        digits: of numbers that are not whole; by default as many as it takes to read the same
            number again.
    """
    with atomic(path) as file:
        text = io.TextIOWrapper(file, encoding="utf-8", newline="")
        writer = csv.writer(text, lineterminator="\n")
        writer.writerow(header)
        writer.writerows(rows if digits is None else (_rounded(row, digits) for row in rows))
        text.detach()


def write_columns(
    path: str | os.PathLike[str],
    columns: Mapping[str, NDArray[Any] | Sequence[object]],
    *,
    digits: int | None = None,
) -> None:
    """Write columns of one length by their titles, as `write_csv` does."""
    write_csv(path, columns, _rows(list(columns.values())), digits=digits)


def _rows(columns: Sequence[NDArray[Any] | Sequence[object]]) -> Iterator[tuple[object, ...]]:
    for first in range(0, len(columns[0]), _CHUNK):
        parts = (column[first : first + _CHUNK] for column in columns)
        lists = [part.tolist() if isinstance(part, np.ndarray) else part for part in parts]
        yield from zip(*lists, strict=True)


def _rounded(row: Iterable[object], digits: int) -> Iterator[object]:
    return (f"{cell:.{digits}g}" if isinstance(cell, float) else cell for cell in row)


def aligned(rows: Iterable[Sequence[str]], *, right: Iterable[int] = ()) -> str:
    """Return rows of cells as text in columns that are two blanks apart.

    Args:
        rows: cells; the rows may be of different lengths.
        right: numbers of the columns that are flush right.

    >>> from asperity._base.tables import aligned
    >>> print(aligned([("name", "mass"), ("rod", "1.5")], right=[1]))
    name  mass
    rod    1.5
    """
    listed = [tuple(row) for row in rows]
    count = max(map(len, listed), default=0)
    widths = [max(len(row[k]) for row in listed if k < len(row)) for k in range(count)]
    return "\n".join(line(row, widths, right=right) for row in listed)


def line(cells: Sequence[str], widths: Sequence[int], *, right: Iterable[int] = ()) -> str:
    """Return one line of such a table, for tables that are printed while they grow."""
    flush = set(right)
    padded = (
        cell.rjust(width) if k in flush else cell.ljust(width)
        for k, (cell, width) in enumerate(zip(cells, widths, strict=False))
    )
    return "  ".join(padded).rstrip()
