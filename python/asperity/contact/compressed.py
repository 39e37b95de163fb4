"""Sparse matrices, compressed by rows, without SciPy, whose objects are slow to make."""

from __future__ import annotations

from collections.abc import Sequence
from functools import cached_property
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from asperity._base import arrays
from asperity._base.arrays import Array
from asperity.errors import ParameterError

if TYPE_CHECKING:
    from scipy.sparse import csr_array


class CompressedRows:
    """The parts of a `csr_array`, read-only, with columns that ascend and none of them twice."""

    format = "csr"
    ndim = 2

    def __init__(
        self,
        data: Array,
        indices: NDArray[np.int64],
        indptr: NDArray[np.int64],
        shape: tuple[int, int],
    ) -> None:
        for part in (data, indices, indptr):
            part.flags.writeable = False
        self.data, self.indices, self.indptr, self.shape = data, indices, indptr, shape

    def __reduce__(self) -> tuple[Any, ...]:
        return CompressedRows, (self.data, self.indices, self.indptr, self.shape)

    @cached_property
    def rows(self) -> NDArray[np.int64]:
        """The row of each entry."""
        return np.arange(self.shape[0]).repeat(self.indptr[1:] - self.indptr[:-1])

    @property
    def ascends(self) -> bool:
        """Whether columns ascend within each row, as SciPy may claim in error."""
        place = self.rows * self.shape[1] + self.indices
        return bool((place[1:] > place[:-1]).all())

    @property
    def triple(self) -> tuple[NDArray[np.int64], NDArray[np.int64], Array]:
        """Row starts, columns and entries, as the core takes them."""
        return self.indptr, self.indices, self.data

    def transposed(self) -> CompressedRows:
        """Return the transpose."""
        order = self.indices.argsort(kind="stable")
        starts = _starts(np.bincount(self.indices, minlength=self.shape[1]))
        return CompressedRows(self.data[order], self.rows[order], starts, self.shape[::-1])

    def tocsr(self) -> csr_array:
        """Return SciPy's array of the same parts."""
        from scipy.sparse import csr_array

        matrix: Any = csr_array((self.data, self.indices, self.indptr), shape=self.shape)
        # SciPy's type of index depends on the content; one type makes equal matrices equal bytes.
        matrix.indices, matrix.indptr = self.indices, self.indptr
        return matrix


def compressed(value: Any, argument: str, shape: Sequence[int | None]) -> CompressedRows:
    """Return the rows of a matrix, dense or of SciPy, whose entries are finite."""
    if isinstance(value, CompressedRows):
        arrays.check_shape(value, argument, shape)
        return value
    if not hasattr(value, "tocsr"):
        dense = arrays.array(value, argument, (None, None))
        arrays.check_shape(dense, argument, shape)
        rows, columns = dense.nonzero()
        starts = _starts(np.bincount(rows, minlength=len(dense)))
        return CompressedRows(dense[rows, columns], columns.copy(), starts, dense.shape)
    if value.dtype.kind not in "iufb":
        raise ParameterError(argument, f"must hold real numbers, has dtype {value.dtype}")
    arrays.check_shape(value, argument, shape)
    _check_indices(value, argument)
    matrix = _listed(value) if value.format in ("csr", "csc") else None
    if matrix is None or not matrix.ascends:
        from scipy.sparse import csr_array

        value = csr_array(value, dtype=np.float64, copy=True)
        value.sum_duplicates()
        matrix = _listed(value)
    arrays.array(matrix.data, argument)
    return matrix.transposed() if value.format == "csc" else matrix


def sparse(value: Any, argument: str, shape: Sequence[int | None]) -> csr_array:
    """Return a read-only CSR array with sorted columns and none of them twice."""
    return compressed(value, argument, shape).tocsr()


def _starts(counts: NDArray[np.int64]) -> NDArray[np.int64]:
    starts = np.zeros(len(counts) + 1, dtype=np.int64)
    counts.cumsum(out=starts[1:])
    return starts


def _listed(matrix: Any) -> CompressedRows:
    """Return the parts of a CSR array, or of the transpose of a CSC array, without spare room."""
    entries = matrix.indptr[-1]
    return CompressedRows(
        matrix.data[:entries].astype(np.float64),
        matrix.indices[:entries].astype(np.int64),
        matrix.indptr.astype(np.int64),
        matrix.shape if matrix.format == "csr" else matrix.shape[::-1],
    )


def _check_indices(matrix: Any, argument: str) -> None:
    """SciPy builds matrices whose indices point outside, and crashes on them later."""
    rows, columns = matrix.shape
    if matrix.format == "coo":
        check_triplets(matrix.coords, matrix.data.size, matrix.shape, argument)
    elif matrix.format in ("csr", "csc", "bsr"):
        if matrix.format == "bsr":
            rows, columns = rows // matrix.blocksize[0], columns // matrix.blocksize[1]
        shape = (columns, rows) if matrix.format == "csc" else (rows, columns)
        check_compressed(matrix.indptr, matrix.indices, len(matrix.data), shape, argument)


def check_triplets(
    coordinates: Sequence[NDArray[Any]], entries: int, shape: Sequence[int], argument: str
) -> None:
    """Refuse rows and columns that are not those of entries of a matrix of a shape."""
    for indices, size in zip(coordinates, shape, strict=True):
        if indices.shape != (entries,):
            problem = f"there are {indices.size} indices of {entries} entries"
        elif indices.size and not 0 <= indices.min() <= indices.max() < size:
            problem = f"indices must lie in 0..{size - 1}"
        else:
            continue
        raise ParameterError(argument, f"must be a valid sparse matrix: {problem}")


def check_compressed(
    starts: NDArray[Any],
    indices: NDArray[Any],
    entries: int,
    shape: tuple[int, int],
    argument: str,
) -> None:
    """Refuse anything but a matrix of ``shape[0]`` compressed rows of ``shape[1]`` columns.

    SciPy's own check leaves out the order of the starts where the last one is zero, and its
    conversions and its sum of duplicates write where the starts and indices point.
    """
    count, width = shape
    problem = None
    if starts.ndim != 1 or indices.ndim != 1 or starts.size != count + 1:
        problem = f"there must be {count + 1} starts, are {starts.size}"
    elif indices.size != entries:
        problem = f"there are {indices.size} indices of {entries} entries"
    elif starts[0] != 0 or (starts[1:] < starts[:-1]).any() or starts[-1] > entries:
        problem = f"starts must not decrease from 0 to at most {entries}"
    else:
        # There may be room for more entries.
        used = indices[: starts[-1]]
        if used.size and not 0 <= used.min() <= used.max() < width:
            problem = f"indices must lie in 0..{width - 1}"
    if problem is not None:
        raise ParameterError(argument, f"must be a valid sparse matrix: {problem}")
