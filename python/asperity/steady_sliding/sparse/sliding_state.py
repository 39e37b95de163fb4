"""Steady sliding of a reduced system over friction, direction and speed, and its small motions."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from asperity._base.arrays import Array, rotation
from asperity.errors import ConvergenceError, ParameterError
from asperity.steady_sliding.linearised.pencil import Complex
from asperity.steady_sliding.sparse.active_set import none_found
from asperity.steady_sliding.sparse.friction import SlidingContacts

if TYPE_CHECKING:
    from asperity.steady_sliding.sparse.reduced_system import ReducedSystem

# Exchanges of contacts, all wrong ones at once for as long as their number falls; rounding.
_EXCHANGES, _PATIENCE, _ROUNDING = 200, 6, 1e-11
# Relative error of 1/(s − σ) by Arnoldi's method; size up to which all eigenvalues are computed.
_CONVERGED, _FEW = 1e-8, 60


@dataclass(frozen=True, eq=False)
class SlidingState:
    """Loads of a reduced system, and P(s) = s²M + sC + K of motions within its closed contacts.

    Coordinates of the reduced system are the gaps of m unilateral contacts, then amplitudes of
    modes. Its rows are those of Yᵀ, Y = (1, −L) with YᵀE = 0 over the closed contacts.
    """

    closed: NDArray[np.bool_]
    """Which unilateral contacts are closed, shape ``(m,)``."""
    load: Array
    """λ_N of all contacts."""
    contacts: SlidingContacts
    jacobian: Any
    """∂λ_T/∂γ of all contacts, sparse."""
    left: Array
    """Yᵀ, shape ``(k, r)``."""
    moving: NDArray[np.intp]
    """The k coordinates that move."""
    mass: Array
    damping: Array
    stiffness: Array

    def spread(self, shapes: Complex) -> Complex:
        """Return displacements of all coordinates of the reduced system."""
        whole = np.zeros((self.left.shape[1], shapes.shape[1]), dtype=np.complex128)
        whole[self.moving] = shapes
        return whole

    def at(self, s: complex) -> Complex:
        """Return P(s)."""
        return np.asarray((self.mass * s + self.damping) * s + self.stiffness)


class SlidingStates:
    """States of a reduced system at factors of friction, directions and speeds."""

    def __init__(self, system: ReducedSystem) -> None:
        of, V = system.full.columns, system.basis
        self.system, self.columns = system, of
        self.unilateral = np.flatnonzero(of.unilateral)
        self.tangents = np.asarray(of.tangents.T @ V)
        self.planar = bool((np.diff(of.first) == 2).all())

    def at(
        self,
        guess: NDArray[np.bool_] | None = None,
        *,
        friction: float = 1.0,
        phi: float = 0.0,
        speed: float = 1.0,
    ) -> SlidingState:
        """Return the state, with a first guess of the closed contacts.

        Raises:
            ParameterError, ConvergenceError: if there is none, or none is found.
        """
        system, m = self.system, len(self.unilateral)
        slip = self.columns.slip
        if phi:
            if not self.planar:
                raise ParameterError("phi", "turns planar sliding, not that of other contacts")
            slip = (slip.reshape(-1, 2) @ rotation(phi).T).ravel()
        contacts = SlidingContacts.of(replace(self.columns, slip=speed * slip))
        contacts = replace(contacts, unit_force=friction * contacts.unit_force)
        thrusts = np.asarray(contacts.unit_force.T @ self.tangents).T
        thrusts[:m] += self.columns.unilateral * np.eye(len(thrusts[0]))[self.unilateral]
        prescribed = np.where(self.columns.unilateral, 0.0, self.columns.normal_force)
        force = system.force + thrusts @ prescribed
        E = thrusts[:, self.unilateral]
        gap = self.columns.gap[self.unilateral]
        closed = np.ones(m, dtype=bool) if guess is None else guess
        closed, found = complementary(system.stiffness[:m, :m], E[:m], force[:m], gap, closed)
        load = prescribed
        load[self.unilateral] = found
        turning, falling = contacts.jacobians(load)
        jacobian = friction * (turning + falling)
        moving = np.append(np.flatnonzero(~closed), np.arange(m, system.dof)).astype(np.intp)
        left = np.zeros((len(moving), system.dof))
        left[np.arange(len(moving)), moving] = 1.0
        held = np.flatnonzero(closed)
        left[:, held] = -np.linalg.solve(E[np.ix_(held, held)].T, E[np.ix_(moving, held)].T).T
        made = [
            part[np.ix_(moving, moving)] + left[:, held] @ part[np.ix_(held, moving)]
            for part in (system.mass, system.damping, system.stiffness)
        ]
        made[1] -= (left @ self.tangents.T) @ (jacobian @ self.tangents[:, moving])
        return SlidingState(closed, load, contacts, jacobian, left, moving, *made)


def complementary(
    stiffness: Array, push: Array, force: Array, gap: Array, closed: NDArray[np.bool_]
) -> tuple[NDArray[np.bool_], Array]:
    """Solve S (s − g₀) = f + A λ, s ≥ 0, λ ≥ 0, s·λ = 0 by block principal pivoting.

    Returns:
        Which contacts are closed, and λ.
    """
    right = force + stiffness @ gap
    fewest, patience = len(gap) + 1, _PATIENCE
    scale = np.abs(np.diag(stiffness))
    for _ in range(_EXCHANGES):
        matrix = np.where(closed, -push, stiffness / scale)
        try:
            x = np.linalg.solve(matrix, right)
        except np.linalg.LinAlgError:
            break
        # Gaps as the loads that would make them, to compare both.
        wrong = np.flatnonzero(x < -_ROUNDING * np.abs(x).max(initial=0.0))
        if not len(wrong):
            return closed, np.where(closed, np.maximum(x, 0.0), 0.0)
        if len(wrong) < fewest:
            fewest, patience = len(wrong), _PATIENCE
        else:
            patience -= 1
        closed = closed.copy()
        closed[wrong if patience >= 0 else wrong[-1:]] ^= True
    raise none_found()


def eigenpairs(
    state: SlidingState, shift: complex, radius: float, count: int
) -> tuple[Complex, Complex]:
    """Return the eigenvalues within a circle, and perhaps more, with modes; count is a guess.

    Raises:
        ConvergenceError: if Arnoldi's method fails.
    """
    from scipy.linalg import lu_factor, lu_solve
    from scipy.sparse.linalg import ArpackError, LinearOperator, eigs

    n, unit = len(state.mass), abs(shift)
    factors = lu_factor(state.at(shift), check_finite=False)
    M = unit * state.mass.astype(np.complex128)
    B = state.damping + shift * state.mass

    def inverted(x: NDArray[Any]) -> Complex:
        a, b = x[:n], x[n:]
        y = lu_solve(factors, -(M @ b) - B @ a, check_finite=False)
        return np.concatenate([y, (shift * y + a) / unit])

    if 2 * n <= _FEW:
        found, vectors = np.linalg.eig(inverted(np.eye(2 * n, dtype=np.complex128)))
    operator = LinearOperator((2 * n, 2 * n), matvec=lambda x: inverted(x.ravel()), dtype=complex)
    start = np.cos(np.arange(1.0, 2 * n + 1.0)).astype(np.complex128)
    while 2 * n > _FEW:
        count = min(count, 2 * n - 2)
        try:
            found, vectors = eigs(operator, k=count, which="LM", v0=start, tol=_CONVERGED)
        except ArpackError as error:
            raise ConvergenceError(str(error), residual=np.nan, advice="Narrow the band") from None
        if count == 2 * n - 2 or radius * np.abs(found).min() <= 1.0:
            break
        count += count // 2 + 1
    finite = np.abs(found) > 0.0
    values = shift + 1.0 / found[finite]
    shapes = vectors[:n, finite]
    return values, shapes / np.linalg.norm(shapes, axis=0)
