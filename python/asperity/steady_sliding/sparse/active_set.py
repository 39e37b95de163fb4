"""Which contacts stay closed: loads and gaps of a linear system are complementary."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from asperity._base.arrays import Array
from asperity.errors import ConvergenceError, ParameterError
from asperity.steady_sliding.sparse.constraint import Constraint
from asperity.system.sparse.factorisation import Factorisation, SingularMatrixError

if TYPE_CHECKING:
    from asperity.system.sparse.matrices import SparseMatrix

# Number of contacts that change side before the matrix is factorised anew.
_CHANGES = 150
_FACTORISATIONS = 30
# Exchanges of all wrong contacts at once that may fail to make their number smaller.
_PATIENCE = 6
_EXCHANGES = 400
# Load and gap, relative to the largest, that are rounding.
_ROUNDING = 1e-11


class LinearContact:
    """K q = f + E λ with s = W_Nᵀq + g₀ ≥ 0, λ ≥ 0, s·λ = 0.

    About one set of closed contacts the loads of the closed and the gaps of the open ones, w,
    depend linearly on the gaps of the closed and the loads of the open ones: w = w₀ + H z. Columns
    of H are made when they are asked for, each by one solution with the same factors.
    """

    def __init__(
        self, stiffness: SparseMatrix, normals: SparseMatrix, thrusts: SparseMatrix
    ) -> None:
        self.stiffness, self.normals, self.thrusts = stiffness, normals, thrusts

    def solve(self, force: Array, gap: Array, closed: NDArray[np.bool_]) -> ClosedContacts:
        """Find the equilibrium, first with a guess of the closed contacts.

        Raises:
            ParameterError, ConvergenceError: if there is none, or none is found.
        """
        for _ in range(_FACTORISATIONS):
            near = ClosedContacts(self, closed, force, gap)
            swapped, done = _exchanged(near)
            if done and not swapped.any():
                return near
            closed = closed ^ swapped
        raise none_found()


class ClosedContacts:
    """The linear system about one set of closed contacts."""

    def __init__(
        self, of: LinearContact, closed: NDArray[np.bool_], force: Array, gap: Array
    ) -> None:
        self.of, self.closed, self.gap = of, closed, gap
        place = np.flatnonzero(closed)
        self.constraint = Constraint.of(of.normals[:, place], of.thrusts[:, place])
        matrix = (self.constraint.Y.T @ of.stiffness @ self.constraint.Z).tocsc()
        self.factors: Factorisation | None = None
        try:
            # Contacts may hold every coordinate.
            if matrix.shape[0]:
                self.factors = Factorisation(matrix)
        except SingularMatrixError:
            raise _loose(closed) from None
        self.q, self.load = self._solution(force, -gap[place])
        self.offset = self._complementary(self.q, self.load) + np.where(closed, 0.0, gap)

    def responses(self, numbers: NDArray[np.intp]) -> Array:
        """Return columns of H, shape ``(m, k)``."""
        of, k = self.of, len(numbers)
        opening = self.closed[numbers]
        pushed = of.thrusts[:, numbers].toarray() * ~opening
        gaps = np.zeros((len(self.closed), k))
        gaps[numbers[opening], np.flatnonzero(opening)] = 1.0
        q, load = self._solution(pushed, gaps[self.closed])
        return self._complementary(q, load)

    def _solution(self, force: Array, gaps: Array) -> tuple[Array, Array]:
        """Return q and the loads of the closed contacts, for a force and the gaps of these."""
        K, part = self.of.stiffness, self.constraint
        q = part.offset(gaps)
        if self.factors is None:
            return q, part.loads(K @ q - force)
        # Twice: the second time for what rounding has left.
        for _ in range(2):
            q = q + part.Z @ self.factors.solve(np.asarray(part.Y.T @ (force - K @ q)))
        return q, part.loads(K @ q - force)

    def _complementary(self, q: Array, load: Array) -> Array:
        """Return loads of the closed and changes of the gaps of the open contacts."""
        w: Array = np.asarray(self.of.normals.T @ q)
        w[self.closed] = load
        return w


def _exchanged(near: ClosedContacts) -> tuple[NDArray[np.bool_], bool]:
    """Return which contacts change side, and whether the equilibrium is found.

    Block principal pivoting of Júdice and Pires: all wrong contacts change side at once; if their
    number does not fall for some exchanges, only that with the highest number does, which ends for
    P-matrices.
    """
    m = len(near.closed)
    H, known = np.zeros((m, 0)), np.zeros(0, dtype=np.intp)
    swapped = np.zeros(m, dtype=bool)
    fewest, patience = m + 1, _PATIENCE
    for _ in range(_EXCHANGES):
        if swapped.sum() > _CHANGES:
            return swapped, False
        new = np.setdiff1d(np.flatnonzero(swapped), known)
        if len(new):
            H = np.concatenate([H, near.responses(new)], axis=1)
            known = np.concatenate([known, new])
        chosen = np.flatnonzero(swapped[known])
        J = known[chosen]
        w = near.offset.copy()
        if len(J):
            block = H[np.ix_(J, chosen)]
            z = _other_side(block, near.offset[J])
            w += H[:, chosen] @ z
            w[J] = z
        is_load = near.closed ^ swapped
        sizes = [np.abs(w[side]).max(initial=0.0) for side in (is_load, ~is_load)]
        wrong = np.flatnonzero(w < -_ROUNDING * np.where(is_load, *sizes))
        if not len(wrong):
            return swapped, True
        if len(wrong) < fewest:
            fewest, patience = len(wrong), _PATIENCE
        else:
            patience -= 1
        swapped[wrong if patience >= 0 else wrong[-1:]] ^= True
    raise none_found()


def _other_side(block: Array, offset: Array) -> Array:
    scale = np.sqrt(np.abs(np.diag(block)))
    scale = np.where(scale > 0.0, scale, 1.0)
    scaled = block / scale / scale[:, None]
    if not np.linalg.cond(scaled) < 1e13:
        raise ParameterError(
            "system",
            "has no isolated equilibrium: its contacts would have to pull, and without them "
            "nothing holds it",
        )
    return -np.linalg.solve(scaled, offset / scale) / scale


def _loose(closed: NDArray[np.bool_]) -> ParameterError:
    return ParameterError(
        "system",
        "has a singular stiffness about steady sliding: its equilibria are not isolated, or there "
        f"is none ({int(closed.sum())} closed contacts hold it)",
    )


def none_found() -> ConvergenceError:
    """Return the error of a search for closed contacts that failed."""
    return ConvergenceError(
        "no set of closed contacts was found with loads and gaps that are not negative",
        residual=float("nan"),
        advice="There may be no steady sliding: with strong friction contacts can jam or lift off",
    )
