"""Moreau–Jean's θ scheme: time stepping with implicit stiffness and damping.

q_E = q_B + Δt (θ u_E + (1 − θ) u_B), M (u_E − u_B) = Δt (f − B u_θ − K q_θ) + W P with the means
u_θ = θ u_E + (1 − θ) u_B and q_θ. Solved for u_E with M̂ = M + Δt θ B + Δt² θ² K:

    M̂ (u_E − u_B) = Δt (f − B u_B − K (q_B + Δt θ u_B)) + W P.

In q̃ = q − Δt (θ − ½) u this is the explicit midpoint step of the core for the mass M̂, the stiffness
K and the damping B + Δt (2θ − 1) K, so that contacts, memory and failures are those of the core.
"""

from __future__ import annotations

from typing import Any

import numpy as np

import asperity._core as _core
from asperity._base.arrays import Array
from asperity.errors import ParameterError
from asperity.runs.model import Model
from asperity.runs.state import State
from asperity.system import (
    Contact,
    ContactLaw,
    LinearSystem,
    MassOnBelt,
    SlidingPoint,
    SparseLinearSystem,
)
from asperity.system.implicit import DEPENDENT, effective_mass
from asperity.system.sparse.factorisation import Factorisation, SingularMatrixError

# Directions of contacts per solution with the factors of a sparse matrix.
_BATCH = 64
# Most entries of M̂⁻¹W that are held, 200 MB: otherwise each step solves twice.
_HELD = 25_000_000


class ImplicitSteps:
    """A run of the core that makes steps with implicit forces.

    Attributes:
        core: the core's system.
        start: the state to start from, as the core's system has it.
    """

    core: _core.LinearSystem | _core.CallbackSystem
    start: State

    def __init__(self, system: LinearSystem, dt: float, theta: float, state: State) -> None:
        self._shift = dt * (theta - 0.5)
        mass = effective_mass(system.mass, system.damping, system.stiffness, dt * theta)
        try:
            np.linalg.cholesky(mass)
        except np.linalg.LinAlgError:
            raise _indefinite() from None
        self.core = _core.LinearSystem(
            mass,
            system.stiffness,
            system.damping + 2.0 * self._shift * system.stiffness,
            system.force,
            [contact._core_data() for contact in system.contacts],
            system._constraints,
        )
        self.start = state.replace(q=state.q - self._shift * state.u)

    def finished(self, run: dict[str, Any]) -> dict[str, Any]:
        """Return the run of the core in coordinates and velocities of the system."""
        for part in filter(None, (run, run["end"])):
            part["q"] = part["q"] + self._shift * part["u"]
        return run


class SparseSteps(ImplicitSteps):
    """The same of a sparse system, of which the core sees the velocities of the contacts only.

    With G = WᵀM̂⁻¹W = LLᵀ the core's velocities are y = L⁻¹Wᵀu, its mass is 1 and its directions
    are L: the same contact problem, and P = L⁻ᵀ (y_E − y_free).
    """

    def __init__(
        self, system: SparseLinearSystem, dt: float, theta: float, state: State, stride: int
    ) -> None:
        from scipy.sparse import csc_array

        of, self._dt, self._stride = system.columns, dt, stride
        self._shift = dt * (theta - 0.5)
        self._stiffness, self._force = system.stiffness, system.force
        self._damping = (system.damping + 2.0 * self._shift * system.stiffness).tocsc()
        self._factors = _factors(
            effective_mass(system.mass, system.damping, system.stiffness, dt * theta).tocsc()
        )
        self._normals, self._gap = of.normals, of.gap
        self._directions, self._rows = of.stacked()
        self._chi = [of.slip[a:b] for a, b in zip(of.first, of.first[1:], strict=False)]
        self._responses: Array | None = np.zeros((system.dof, 1))
        self._root = np.eye(1)
        if of.laws:
            self._responses, self._root = self._operator()
        else:
            # The core's systems have a velocity at least: one that nothing moves.
            self._directions = csc_array((system.dof, 1))
        self._q, self._u = state.q - self._shift * state.u, state.u
        self._gaps = of.gap + of.normals.T @ self._q
        self._samples, self._steps, self._time = [(self._q, self._u)], 0, np.nan
        self._y = self._slip(self._u)
        r = len(self._y)
        self.start = state.replace(q=np.zeros(r), u=self._y)
        restitution = [
            (one.normal_restitution, one.tangential_restitution)
            if isinstance(one, Contact)
            else (0.0, 0.0)
            for one in system._each
        ]
        laws = [
            ContactLaw(
                law,
                normal_force=None if np.isnan(load) else load,
                normal_restitution=normal,
                tangential_restitution=tangential,
            )._core_data()
            for law, load, (normal, tangential) in zip(
                of.laws, of.normal_force.tolist(), restitution, strict=True
            )
        ]
        self.core = _core.CallbackSystem(self, [r], None, [], None, 0, (True, True), laws)

    def _slip(self, u: Array) -> Array:
        """Return y = L⁻¹Wᵀu."""
        from scipy.linalg import solve_triangular

        slip = np.asarray(self._directions.T @ u)
        return np.asarray(solve_triangular(self._root, slip, lower=True, check_finite=False))

    def _operator(self) -> tuple[Array | None, Array]:
        """Return M̂⁻¹W, unless it is large, and L."""
        W = self._directions
        n, r = W.shape
        G = np.empty((r, r))
        held = np.empty((n, r)) if n * r <= _HELD else None
        for first in range(0, r, _BATCH):
            part = slice(first, first + _BATCH)
            X = self._factors.solve(W[:, part].toarray())
            G[:, part] = W.T @ X
            if held is not None:
                held[:, part] = X
        try:
            L: Array = np.linalg.cholesky(0.5 * (G + G.T)).astype(np.float64)
        except np.linalg.LinAlgError:
            L = np.zeros((r, r))
        if (np.diag(L) <= DEPENDENT * np.sqrt(np.diag(G))).any():
            raise ParameterError(
                "system",
                "has contacts with dependent directions, whose forces are not unique; "
                "system.dense() takes them",
            )
        return held, L

    def mass(self, q: Array) -> Array:
        """Return the mass of y."""
        return np.eye(len(self._y))

    def direction(self, t: float, q: Array, contact: int) -> Array:
        """Return the rows of L of a contact's friction."""
        rows = self._rows[contact]
        return self._root[rows.stop - len(self._chi[contact]) : rows.stop].T

    def normal(self, t: float, q: Array, contact: int) -> Array:
        """Return the row of L of its normal."""
        return self._root[self._rows[contact].start]

    def velocity(self, t: float, q: Array, contact: int) -> Array:
        """Return χ."""
        return self._chi[contact]

    def gap(self, t: float, q: Array, contact: int) -> float:
        """Return the gap of the whole system, for which `forces` is asked before."""
        return float(self._gaps[contact])

    def forces(self, t: float, q: Array, y: Array) -> Array:
        """Make the last step, of which y is the end, and begin the next one."""
        if t != self._time:
            if not np.isnan(self._time):
                self._finish(y)
            middle = self._q + 0.5 * self._dt * self._u
            load = self._force - self._damping @ self._u - self._stiffness @ middle
            self._free = self._u + self._dt * self._factors.solve(load)
            self._gaps = self._gap + self._normals.T @ middle
            self._time, self._rate = t, (self._slip(self._free) - y) / self._dt
            # As the core computes it: where no percussion acts their difference is zero.
            self._y = y + self._dt * self._rate
        return self._rate

    def _finish(self, y: Array) -> None:
        from scipy.linalg import solve_triangular

        P = solve_triangular(self._root.T, y - self._y, lower=False, check_finite=False)
        if self._responses is None:
            after = self._free + self._factors.solve(np.asarray(self._directions @ P))
        else:
            after = self._free + self._responses @ P
        self._q = self._q + 0.5 * self._dt * (self._u + after)
        self._u, self._steps = after, self._steps + 1
        if self._steps % self._stride == 0:
            self._samples.append((self._q, self._u))

    def finished(self, run: dict[str, Any]) -> dict[str, Any]:
        """Return the run of the whole system."""
        if self._steps < run["steps"]:
            self._finish(run["u"][-1])
        count = len(run["t"])
        if len(self._samples) < count:
            self._samples.append((self._q, self._u))
        shape = (count, len(self._force))
        for place, name in enumerate(("q", "u")):
            listed = [sample[place] for sample in self._samples[:count]]
            run[name] = np.array(listed).reshape(shape)
        if run["end"] is not None:
            run["end"].update(q=self._q, u=self._u)
        return super().finished(run)


def implicit_steps(
    system: Model, dt: float, theta: float, state: State, stride: int, *, until_rest: bool
) -> ImplicitSteps:
    """Return the run of a linear system that `simulate` makes with implicit forces.

    Raises:
        ParameterError: if it is none, or M̂ is not positive definite.
    """
    linear = system.linear if isinstance(system, MassOnBelt | SlidingPoint) else system
    if not isinstance(linear, LinearSystem):
        raise ParameterError("implicit", f"needs a system of matrices, got {type(system).__name__}")
    if not isinstance(linear, SparseLinearSystem):
        return ImplicitSteps(linear, dt, theta, state)
    if until_rest:
        raise ParameterError("until_rest", "has no effect on a system with sparse matrices")
    return SparseSteps(linear, dt, theta, state, stride)


def _factors(matrix: Any) -> Factorisation:
    """Return factors of a positive definite matrix."""
    try:
        factors = Factorisation(matrix)
    except SingularMatrixError:
        raise _indefinite() from None
    if not (factors.lu.U.diagonal() > 0.0).all():
        raise _indefinite()
    return factors


def _indefinite() -> ParameterError:
    return ParameterError(
        "dt",
        "must be such that M + dt θ B + dt² θ² K is positive definite: something has neither mass "
        "nor stiffness, or K or B is negative and dt too long for it",
    )
