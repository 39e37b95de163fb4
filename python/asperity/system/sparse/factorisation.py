"""Sparse LU factors of structurally symmetric matrices."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from asperity.system.sparse.dissection import nested_dissection

if TYPE_CHECKING:
    from scipy.sparse import csc_array
    from scipy.sparse.linalg import SuperLU

# Residual of a solution, relative to |A||x| + |b|, above which diagonal pivots are not trusted;
# what is left is taken away by one step of refinement.
_TRUSTED = 1e-8


class SingularMatrixError(ArithmeticError):
    """A matrix has no inverse."""


class Factorisation:
    """A = LU, eliminated by nested dissection, with pivots on the diagonal where those are exact.

    On solids this makes half the entries of SuperLU's default order, which is good for any exchange
    of rows and is taken where diagonal pivots are not exact.
    """

    def __init__(self, matrix: csc_array[Any], order: NDArray[np.intp] | None = None) -> None:
        self.order = nested_dissection(matrix) if order is None else order
        self.is_complex = bool(matrix.dtype.kind == "c")
        ordered = matrix[self.order][:, self.order].tocsc()
        found = _diagonal(ordered)
        # Of any type, as the stubs of SciPy know no solution with the transposed matrix.
        self.lu: Any = _exchanging(ordered) if found is None else found

    def solve(self, right: NDArray[Any], *, transposed: bool = False) -> NDArray[Any]:
        """Return A⁻¹b or A⁻ᵀb; b has shape ``(n,)`` or ``(n, k)``."""
        kind = np.complex128 if self.is_complex else np.float64
        ordered: NDArray[Any] = np.asfortranarray(right[self.order], dtype=kind)
        x = np.empty_like(ordered)
        x[self.order] = self.lu.solve(ordered, "T" if transposed else "N")
        return x

    def log_determinant(self) -> complex:
        """Return log det A up to a multiple of 2πi."""
        pivots = self.lu.U.diagonal().astype(np.complex128)
        odd = _parity(self.lu.perm_r) != _parity(self.lu.perm_c)
        return complex(np.log(pivots).sum() + (np.pi * 1j if odd else 0.0))


def _diagonal(matrix: csc_array[Any]) -> SuperLU | None:
    """Factorise with pivots on the diagonal; return None if that is not exact."""
    from scipy.sparse.linalg import splu

    try:
        found = splu(
            matrix,
            permc_spec="NATURAL",
            diag_pivot_thresh=0.0,
            options={"SymmetricMode": True},
        )
    except RuntimeError:
        return None
    # Entries of all signs and places, the same in every run.
    right = np.cos(np.arange(1.0, matrix.shape[0] + 1.0)).astype(matrix.dtype)
    x = found.solve(right)
    if not np.isfinite(x).all():
        return None
    size = abs(matrix) @ np.abs(x) + np.abs(right)
    return found if (np.abs(matrix @ x - right) <= _TRUSTED * size.max()).all() else None


def _exchanging(matrix: csc_array[Any]) -> SuperLU:
    from scipy.sparse.linalg import splu

    try:
        return splu(matrix)
    except RuntimeError as error:
        raise SingularMatrixError(str(error)) from None


def _parity(permutation: NDArray[Any]) -> bool:
    """Whether a permutation is odd."""
    left, odd = np.ones(len(permutation), dtype=bool), False
    order = permutation.tolist()
    for start in range(len(order)):
        if not left[start]:
            continue
        place, length = start, 0
        while left[place]:
            left[place] = False
            place, length = order[place], length + 1
        odd ^= length % 2 == 0
    return odd
