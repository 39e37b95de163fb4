"""Checks of sparse matrices."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, TypeAlias

import numpy as np
from numpy.typing import NDArray

from asperity._base import arrays
from asperity._base.arrays import Array
from asperity.errors import DimensionError, ParameterError

if TYPE_CHECKING:
    from scipy.sparse import csc_array

    SparseMatrix: TypeAlias = csc_array[np.float64]

# Largest difference of M_ij and M_ji, relative to the largest entry, that is rounding of writers:
# files of finite elements hold at least ten digits.
_ROUNDING = 1e-9


def is_sparse(value: Any) -> bool:
    """Whether it is a sparse array or matrix of SciPy, without importing SciPy."""
    return hasattr(value, "tocsc")


def order(value: Any, argument: str) -> int:
    """Return the number of rows of a sparse square matrix."""
    if len(value.shape) != 2 or value.shape[0] != value.shape[1]:
        raise DimensionError(argument, f"must be square, has shape {value.shape}")
    if not value.shape[0]:
        raise DimensionError(argument, "must not be empty")
    return int(value.shape[0])


def compressed(value: Any, argument: str, n: int) -> SparseMatrix:
    """Return a square matrix in compressed columns, given as scalar, diagonal, dense or sparse."""
    from scipy.sparse import csc_array, diags_array

    if not is_sparse(value):
        given = arrays.array(0.0 if value is None else value, argument)
        if given.ndim < 2:
            diagonal = np.broadcast_to(given, (n,)) if given.ndim == 0 else given
            value = diags_array(arrays.array(diagonal, argument, (n,)))
        else:
            value = given
    if value.dtype.kind not in "iufb":
        raise ParameterError(argument, f"must hold real numbers, holds {value.dtype}")
    arrays.check_shape(value, argument, (n, n))
    # Before duplicates are added, which may exceed small integers.
    made = csc_array(value.astype(np.float64), copy=True)
    made.sum_duplicates()
    if not np.isfinite(made.data).all():
        raise ParameterError(argument, "must be finite, it holds NaN or infinity")
    for part in (made.data, made.indices, made.indptr):
        part.flags.writeable = False
    return made


def symmetric(matrix: SparseMatrix, argument: str) -> SparseMatrix:
    """Refuse a matrix that is not symmetric."""
    difference = abs(matrix - matrix.T)
    if difference.nnz and difference.max() > _ROUNDING * abs(matrix).max():
        whole = ", only one of its triangles is stored: add the other" if triangle(matrix) else ""
        raise ParameterError(argument, f"must be symmetric{whole}")
    return matrix


def semidefinite(matrix: SparseMatrix, argument: str) -> SparseMatrix:
    """Refuse a symmetric matrix with a negative minor of one or two rows."""
    places = matrix.tocoo()
    diagonal = np.asarray(matrix.diagonal())
    # As much as writers round.
    room = diagonal + _ROUNDING * np.abs(matrix.data).max(initial=0.0)
    minors = room[places.row] * room[places.col] - places.data**2
    wrong = (room < 0.0).any() or (minors[places.row != places.col] < 0.0).any()
    if wrong:
        raise ParameterError(argument, "must be positive semidefinite")
    return matrix


def of_both_triangles(matrix: SparseMatrix, argument: str) -> SparseMatrix:
    """Refuse one triangle of a matrix that was stored as a symmetric one."""
    if triangle(matrix):
        raise ParameterError(
            argument, "holds entries in one triangle only: add the other, A + A.T - diag(A)"
        )
    return matrix


def triangle(matrix: SparseMatrix) -> bool:
    """Whether all entries off the diagonal, at least one per row, are on one side of it."""
    from scipy.sparse import tril, triu

    above, below = (np.count_nonzero(f(matrix, k).data) for f, k in ((triu, 1), (tril, -1)))
    return bool(min(above, below) == 0 and max(above, below) >= matrix.shape[0])


class Entries:
    """Entries of a sparse matrix that are added one block after another."""

    def __init__(self) -> None:
        self._rows: list[NDArray[np.intp]] = [np.zeros(0, dtype=np.intp)]
        self._columns: list[NDArray[np.intp]] = [np.zeros(0, dtype=np.intp)]
        self._values: list[Array] = [np.zeros(0)]

    def add(self, rows: NDArray[np.intp], columns: NDArray[np.intp], values: Array) -> None:
        """Add entries, whose three arrays broadcast."""
        shape = np.broadcast_shapes(rows.shape, columns.shape, values.shape)
        self._rows.append(np.broadcast_to(rows, shape).ravel())
        self._columns.append(np.broadcast_to(columns, shape).ravel())
        self._values.append(np.broadcast_to(values, shape).ravel())

    def matrix(self, shape: tuple[int, int]) -> SparseMatrix:
        """Return the matrix, without entries that vanish."""
        from scipy.sparse import csc_array

        places = np.concatenate(self._rows), np.concatenate(self._columns)
        made = csc_array((np.concatenate(self._values), places), shape=shape)
        made.eliminate_zeros()
        return made
