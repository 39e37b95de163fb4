"""Static modes of contacts, by which reduced systems have the loads and gaps of the whole one."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from asperity._base.arrays import Array
from asperity.errors import ParameterError
from asperity.steady_sliding.sparse.constraint import Constraint
from asperity.steady_sliding.sparse.pencil import SparsePencil
from asperity.system import SparseLinearSystem
from asperity.system.sparse.factorisation import Factorisation, SingularMatrixError
from asperity.system.sparse.matrices import symmetric

if TYPE_CHECKING:
    from asperity.system.sparse.matrices import SparseMatrix

# Displacement by a force of 1, relative to that of the stiffest spring, of what nothing holds.
_LARGEST = 1e12


class StaticModes:
    """Displacements V_c by unit gaps of one contact after the other, the others closed.

    W_NᵀV_c = 1 and ZᵀK V_c = 0 for all motions Z within closed contacts. So K q = f + E λ becomes
    V_cᵀK V_c (W_Nᵀq) = V_cᵀf + V_cᵀE λ: loads and gaps of steady sliding depend on V_c alone, and
    a basis that holds it has those of the whole system, whichever contacts open.
    """

    def __init__(self, system: SparseLinearSystem) -> None:
        symmetric(system.stiffness, "stiffness")
        self.system, columns = system, system.columns
        self.normals: SparseMatrix = columns.normals[:, np.flatnonzero(columns.unilateral)]
        self.constraint = Constraint.of(self.normals, self.normals)
        held = (self._left @ system.stiffness @ self.constraint.Z).tocsc()
        try:
            self.factors = Factorisation(held)
        except SingularMatrixError:
            raise _loose() from None
        # A force of all signs and places moves what nothing holds beyond all measure.
        moved = self.factors.solve(np.cos(np.arange(1.0, held.shape[0] + 1.0)))
        if not np.abs(moved).max() * abs(held).max() < _LARGEST:
            raise _loose()
        shifted = self.constraint.offset(np.eye(self.normals.shape[1]))
        pushed = np.asarray(system.stiffness @ shifted)
        self.vectors: Array = shifted - self.responses(pushed)

    @property
    def _left(self) -> SparseMatrix:
        return self.constraint.Z.T.tocsc()

    @property
    def pencil(self) -> SparsePencil:
        """Small motions within all contacts without friction: the real modes."""
        of = self.system
        made = (
            (self._left @ part @ self.constraint.Z).tocsc()
            for part in (of.mass, of.damping, of.stiffness)
        )
        return SparsePencil(*made)

    def responses(self, forces: Array) -> Array:
        """Return displacements by forces, all contacts closed and without friction, real ones."""
        if not forces.shape[1]:
            return forces
        return np.asarray(self.constraint.Z @ self.factors.solve(np.asarray(self._left @ forces)))

    def without(self, displacements: Array) -> Array:
        """Take away the static modes: what is left moves within all contacts."""
        return displacements - self.vectors @ np.asarray(self.normals.T @ displacements)


def _loose() -> ParameterError:
    return ParameterError("system", "has a singular stiffness where all contacts are closed")
