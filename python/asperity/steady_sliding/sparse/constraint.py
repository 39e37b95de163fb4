"""Coordinates of the motion within closed contacts, without the normal forces."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from asperity._base.arrays import Array
from asperity.errors import ParameterError

if TYPE_CHECKING:
    from asperity.system.sparse.matrices import SparseMatrix

# Share of the largest entry below which normals depend on each other.
_DEPENDENT = 1e-12
# Largest number of contacts whose normals may share coordinates: their matrix is made dense.
_LARGEST_DENSE = 2000


@dataclass(frozen=True, eq=False)
class Constraint:
    """q = Z y + offset·gaps with W_NᵀZ = 0, and Y with YᵀE = 0, which no normal force works on.

    Z keeps all coordinates but one per contact, the one along which its normal is largest. Y = Z −
    W_N (EᵀW_N)⁻¹ EᵀZ exists unless a contact is jammed by its own friction, and its columns couple
    the same coordinates as those of Z.
    """

    normals: SparseMatrix
    thrusts: SparseMatrix
    """E = W_N + W_T f, shape ``(n, m)``."""
    Z: SparseMatrix
    Y: SparseMatrix
    held: NDArray[np.intp]
    """The coordinate of each contact that y leaves out."""
    among: SparseMatrix
    """W_N of these coordinates, shape ``(m, m)``."""
    push: SparseMatrix
    """W_NᵀE, shape ``(m, m)``."""

    @classmethod
    def of(cls, normals: SparseMatrix, thrusts: SparseMatrix) -> Constraint:
        """Eliminate one coordinate per column of W_N."""
        from scipy.sparse import csc_array, csr_array, identity, vstack

        n, m = normals.shape
        held = _pivots(normals)
        rows = csr_array(normals)
        free = np.setdiff1d(np.arange(n), held)
        among = csc_array(rows[held])
        place = np.concatenate([free, held])
        across = -csr_array(_solved(csc_array(among.T), csc_array(rows[free].T)))
        stacked = csr_array(vstack([identity(n - m, format="csr"), across]))
        Z = csc_array(stacked[np.argsort(place)])
        push = csc_array(normals.T @ thrusts)
        Y = csc_array(Z - normals @ _solved(csc_array(push.T), csc_array(thrusts.T @ Z)))
        return cls(normals, thrusts, Z, Y, held, among, push)

    def offset(self, gaps: Array) -> Array:
        """Return displacements q with W_Nᵀq = gaps, shape ``(n,)`` or ``(n, k)``."""
        q = np.zeros((self.normals.shape[0], *gaps.shape[1:]))
        if len(self.held):
            q[self.held] = _dense_solved(self.among.T.tocsc(), gaps)
        return q

    def loads(self, resisted: Array) -> Array:
        """Return λ_N with E λ_N = resisted, a force that Y does not see."""
        if not len(self.held):
            return np.zeros((0, *resisted.shape[1:]))
        return _dense_solved(self.push, np.asarray(self.normals.T @ resisted))


def _pivots(normals: SparseMatrix) -> NDArray[np.intp]:
    """Return a different row for each column, with a large entry."""
    m = normals.shape[1]
    if not m:
        return np.zeros(0, dtype=np.intp)
    ends = normals.indptr
    if (np.diff(ends) == 0).any():
        raise ParameterError("normal", f"of contact {int(np.diff(ends).argmin())} vanishes")
    size = np.abs(normals.data)
    column = np.repeat(np.arange(m), np.diff(ends))
    order = np.lexsort((size, column))
    rows: NDArray[np.intp] = normals.indices[order[ends[1:] - 1]].astype(np.intp)
    touched = np.unique(normals.indices)
    if len(touched) == len(normals.indices) or not _shared(normals, rows):
        return rows
    return _pivots_of_shared(normals, touched)


def _shared(normals: SparseMatrix, rows: NDArray[np.intp]) -> bool:
    """Whether the normals couple the chosen rows."""
    from scipy.sparse import csr_array

    return len(np.unique(rows)) < len(rows) or bool(csr_array(normals)[rows].nnz > len(rows))


def _pivots_of_shared(normals: SparseMatrix, touched: NDArray[Any]) -> NDArray[np.intp]:
    import scipy.linalg
    from scipy.sparse import csr_array

    m = normals.shape[1]
    if m > _LARGEST_DENSE:
        raise ParameterError(
            "contacts", f"share coordinates: this is possible for at most {_LARGEST_DENSE} of them"
        )
    dense = csr_array(normals)[touched].toarray()
    R, order = scipy.linalg.qr(dense.T, mode="r", pivoting=True)
    if not np.abs(np.diag(R)[:m]).min() > _DEPENDENT * np.abs(R[0, 0]) or len(touched) < m:
        raise ParameterError(
            "closed", "must be contacts with independent normals: their forces are not unique"
        )
    return np.asarray(touched[order[:m]], dtype=np.intp)


def _solved(matrix: SparseMatrix, right: SparseMatrix) -> SparseMatrix:
    """Return A⁻¹B for a sparse B; A is diagonal unless normals share coordinates."""
    from scipy.sparse import csc_array, diags_array

    diagonal = _regular_diagonal(matrix)
    if diagonal is not None:
        return csc_array(diags_array(1.0 / diagonal) @ right)
    columns = np.flatnonzero(np.diff(right.indptr))
    part = csc_array(_dense_solved(matrix, right[:, columns].toarray()))
    spread = csc_array(
        (np.ones(len(columns)), (np.arange(len(columns)), columns)),
        shape=(len(columns), right.shape[1]),
    )
    return csc_array(part @ spread)


def _dense_solved(matrix: SparseMatrix, right: Array) -> Array:
    from scipy.sparse import csc_array
    from scipy.sparse.linalg import splu

    diagonal = _regular_diagonal(matrix)
    if diagonal is not None:
        return right / diagonal.reshape(-1, *[1] * (right.ndim - 1))
    try:
        return splu(csc_array(matrix)).solve(np.asfortranarray(right))
    except RuntimeError:
        raise _jammed() from None


def _regular_diagonal(matrix: SparseMatrix) -> Array | None:
    """Return the diagonal of a matrix that has no other entries."""
    diagonal = np.asarray(matrix.diagonal())
    if np.count_nonzero(matrix.data) > np.count_nonzero(diagonal):
        return None
    if len(diagonal) and not np.abs(diagonal).min() > _DEPENDENT * np.abs(diagonal).max():
        raise _jammed()
    return diagonal


def _jammed() -> ParameterError:
    return ParameterError(
        "contacts", "are jammed by their friction: no normal force moves them along their normals"
    )
