"""Entries of a matrix in lines of "row column value", numbered from 1."""

from __future__ import annotations

import io
import os
from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from asperity._base.arrays import Array
from asperity.errors import ParameterError

if TYPE_CHECKING:
    from asperity.system.sparse.matrices import SparseMatrix

# Programs in Fortran write 1.0D+03.
TO_PYTHON = str.maketrans("Dd", "Ee")


def text_of(path: str | os.PathLike[str]) -> str:
    """Return the text of a file."""
    try:
        return Path(path).read_text(encoding="ascii", errors="replace")
    except OSError as error:
        raise ParameterError("path", f"cannot be read: {error}") from None


def whole_lines(path: str | os.PathLike[str]) -> str:
    """Return the text of a file that a program writes line by line, whose last number is whole."""
    text = text_of(path)
    if text and text[-1] not in "\r\n":
        name = os.path.basename(os.fspath(path))
        raise ParameterError("path", f"{name} ends within a line: it is cut off, or lacks its end")
    return text


def table(lines: Sequence[str], name: str, columns: int) -> Array:
    """Return the numbers of lines, with exponents of C or of Fortran."""
    text = "\n".join(lines).translate(TO_PYTHON)
    if not text.strip():
        return np.zeros((0, columns))
    try:
        numbers = np.loadtxt(io.StringIO(text), dtype=np.float64, ndmin=2)
    except ValueError as error:
        raise ParameterError("path", f"{name} holds no table of numbers: {error}") from None
    if numbers.shape[1] != columns:
        raise ParameterError(
            "path", f"{name} must have {columns} numbers per line, has {numbers.shape[1]}"
        )
    if not np.isfinite(numbers).all():
        raise ParameterError("path", f"{name} must be finite, it holds NaN or infinity")
    return numbers


def symmetric(entries: Array, n: int, name: str, *, sign: float = 1.0) -> SparseMatrix:
    """Return the matrix of which one triangle is stored."""
    from scipy.sparse import csc_array

    rows, columns = _places(entries, (n, n), name)
    off = rows != columns
    keys = np.minimum(rows, columns) * n + np.maximum(rows, columns)
    above = rows < columns
    both = np.intersect1d(keys[off & above], keys[off & ~above])
    if len(both):
        i, j = divmod(int(both[0]), n)
        raise ParameterError(
            "path",
            f"{name} says that one triangle is stored and holds both, such as ({i + 1}, {j + 1}) "
            f"and ({j + 1}, {i + 1}): it is not clear whether they are to be added",
        )
    values = entries[:, 2]
    stacked = np.concatenate([values, sign * values[off]])
    places = np.concatenate([rows, columns[off]]), np.concatenate([columns, rows[off]])
    return csc_array((stacked, places), shape=(n, n))


def either(entries: Array, n: int, name: str) -> SparseMatrix:
    """Return a matrix whose entries off the diagonal are all stored, or those of one side each."""
    made = general(entries, (n, n), name)
    there = made.copy()
    there.data[:] = 1.0
    both = there.multiply(there.T)
    both.setdiag(0.0)
    both.eliminate_zeros()
    if not both.nnz:
        return symmetric(entries, n, name)
    alone = (there - there.multiply(there.T)).tocoo()
    alone.eliminate_zeros()
    if alone.nnz:
        i, j = int(alone.row[0]) + 1, int(alone.col[0]) + 1
        raise ParameterError(
            "path",
            f"{name} holds both triangles of some entries and only ({i}, {j}) of others: it is not "
            "clear whether the rest is to be added",
        )
    return made


def number(word: str) -> float:
    """Return a number with an exponent of C or of Fortran."""
    return float(word.translate(TO_PYTHON))


def general(entries: Array, shape: tuple[int, int], name: str) -> SparseMatrix:
    """Return the matrix of which all entries are stored."""
    from scipy.sparse import csc_array

    rows, columns = _places(entries, shape, name)
    return csc_array((entries[:, 2], (rows, columns)), shape=shape)


def _places(
    entries: Array, shape: tuple[int, int], name: str
) -> tuple[np.ndarray[tuple[int], np.dtype[np.intp]], np.ndarray[tuple[int], np.dtype[np.intp]]]:
    numbers = entries[:, :2]
    wrong = (numbers != np.floor(numbers)) | (numbers < 1) | (numbers > shape)
    if wrong.any():
        place = numbers[wrong.any(axis=1)][0].tolist()
        raise ParameterError(
            "path", f"{name} must hold places from (1, 1) to {shape}, holds {tuple(place)}"
        )
    places = numbers.astype(np.intp) - 1
    return places[:, 0], places[:, 1]
