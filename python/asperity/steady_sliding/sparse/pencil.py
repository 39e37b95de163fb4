"""The sparse pencil of small motions within the closed contacts."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from functools import cached_property
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from asperity._base.arrays import Array
from asperity.steady_sliding.linearised.pencil import ROUNDING, Complex
from asperity.steady_sliding.sparse.constraint import Constraint
from asperity.steady_sliding.sparse.friction import SlidingContacts
from asperity.system import SparseLinearSystem
from asperity.system.sparse.dissection import nested_dissection
from asperity.system.sparse.factorisation import Factorisation

if TYPE_CHECKING:
    from scipy.sparse import csc_array

    from asperity.system.sparse.matrices import SparseMatrix


@dataclass(frozen=True, eq=False)
class SparsePencil:
    """P(s) = s² M + s C + K, its rows those of Yᵀ and its columns those of Z."""

    mass: SparseMatrix
    damping: SparseMatrix
    stiffness: SparseMatrix

    @property
    def n(self) -> int:
        """Number of coordinates."""
        return int(self.mass.shape[0])

    @cached_property
    def most(self) -> int:
        """Largest number of finite eigenvalues, the sum of the degrees of the columns of P."""
        moves, damps = (
            np.asarray(abs(part).sum(axis=0)).ravel() > 0.0 for part in (self.mass, self.damping)
        )
        return int(moves.sum() + (moves | damps).sum())

    @property
    def transposed(self) -> SparsePencil:
        """P(s)ᵀ, whose right eigenvectors are the conjugates of the left ones of P."""
        return SparsePencil(*(part.T.tocsc() for part in (self.mass, self.damping, self.stiffness)))

    def at(self, s: complex) -> csc_array[Any]:
        """Return P(s)."""
        from scipy.sparse import csc_array

        z = s if isinstance(s, float) else np.complex128(s)
        return csc_array(self.mass * z**2 + self.damping * z + self.stiffness)

    @cached_property
    def order(self) -> NDArray[np.intp]:
        """The order of elimination, that of all P(s)."""
        return nested_dissection(self.at(1.0))

    def factorised(self, s: complex) -> Factorisation:
        """Factorise P(s).

        Raises:
            SingularMatrixError: if s is an eigenvalue to rounding.
        """
        return Factorisation(self.at(s), self.order)

    def times(self, s: Complex, x: NDArray[Any]) -> Complex:
        """Return P(sᵢ)xᵢ for columns xᵢ."""
        return (self.mass @ x) * s**2 + (self.damping @ x) * s + self.stiffness @ x

    def slopes(self, s: Complex, x: NDArray[Any]) -> Complex:
        """Return P′(sᵢ)xᵢ for columns xᵢ."""
        return 2.0 * s * (self.mass @ x) + self.damping @ x

    @cached_property
    def norms(self) -> tuple[float, float, float]:
        """‖M‖₁, ‖C‖₁, ‖K‖₁."""
        M, C, K = (
            float(np.asarray(abs(part).sum(axis=0)).max())
            for part in (self.mass, self.damping, self.stiffness)
        )
        return M, C, K

    @property
    def fastest(self) -> float:
        """Rate of the fastest motions in 1/s, √(‖K‖₁/‖M‖₁)."""
        M, _, K = self.norms
        return float(np.sqrt(K / M)) if M else 0.0

    def size(self, rate: Array) -> Array:
        """Return |s|²‖M‖₁ + |s|‖C‖₁ + ‖K‖₁, infinite if it overflows."""
        M, C, K = self.norms
        with np.errstate(over="ignore"):
            return np.asarray((rate * M + C) * rate + K)

    def backward_errors(self, s: Complex, x: Complex) -> Array:
        """Return ‖P(s)x‖₂/((|s|²‖M‖₁ + |s|‖C‖₁ + ‖K‖₁)‖x‖₂) of each pair."""
        size = self.size(np.abs(s)) * np.linalg.norm(x, axis=0)
        return np.linalg.norm(self.times(s, x), axis=0) / size

    def errors_of(self, s: Complex, x: Complex, left: Complex) -> Array:
        """Bound |δs| by the residual and the rounding of the entries, to first order.

        |δs| ≤ |y|ᵀ(|P(s)x| + (|s|²|M| + |s||C| + |K|)|x| ε)/|yᵀP′(s)x| with yᵀP(s) = 0.
        """
        size, y = np.abs(x), np.abs(left)
        entries = (abs(self.mass) @ size) * np.abs(s) ** 2
        entries += (abs(self.damping) @ size) * np.abs(s) + abs(self.stiffness) @ size
        doubt = np.abs(self.times(s, x)) + ROUNDING * entries
        slope = np.abs(np.sum(left * self.slopes(s, x), axis=0))
        # Without a slope the eigenvalue is multiple, and nothing is known of its error.
        bound = np.sum(y * doubt, axis=0) / np.where(slope > 0.0, slope, 1.0)
        return np.where(slope > 0.0, bound, np.inf)


@dataclass(frozen=True, eq=False)
class SmallMotions:
    """Small motions about steady sliding, with each effect of friction by itself."""

    system: SparseLinearSystem
    contacts: SlidingContacts
    closed: NDArray[np.intp]
    turning: SparseMatrix
    """∂λ_T/∂γ at constant speed, shape ``(t, t)``."""
    falling: SparseMatrix
    """∂λ_T/∂γ from the dependence on the speed, shape ``(t, t)``."""

    @classmethod
    def of(cls, system: SparseLinearSystem, load: Array, closed: NDArray[np.intp]) -> SmallMotions:
        """Linearise about the equilibrium with loads λ_N."""
        contacts = SlidingContacts.of(system.columns)
        return cls(system, contacts, closed, *contacts.jacobians(load))

    @cached_property
    def constraint(self) -> Constraint:
        """The motion within the closed contacts."""
        return self._constraint(coupled=True)

    @cached_property
    def pencil(self) -> SparsePencil:
        """The pencil with all effects."""
        return self._pencil(self.constraint, self.turning + self.falling)

    def without(self) -> Iterator[tuple[str, SparsePencil]]:
        """Yield the pencil without one effect of friction after the other."""
        yield DIRECTION, self._pencil(self.constraint, self.falling)
        if self.falling.nnz and np.abs(self.falling.data).max() > 0.0:
            yield SLOPE, self._pencil(self.constraint, self.turning)
        if len(self.closed):
            free = self._constraint(coupled=False)
            yield COUPLING, self._pencil(free, self.turning + self.falling)

    def _constraint(self, *, coupled: bool) -> Constraint:
        normals = self.system.columns.normals[:, self.closed]
        thrusts = self.contacts.thrusts[:, self.closed] if coupled else normals
        return Constraint.of(normals, thrusts)

    def _pencil(self, constraint: Constraint, jacobian: SparseMatrix) -> SparsePencil:
        W = self.system.columns.tangents
        damping = self.system.damping - W @ jacobian @ W.T
        left = constraint.Y.T.tocsr()
        made = (
            (left @ part @ constraint.Z).tocsc()
            for part in (self.system.mass, damping, self.system.stiffness)
        )
        return SparsePencil(*made)


DIRECTION, SLOPE, COUPLING = "direction of friction", "Stribeck slope", "mode coupling"
