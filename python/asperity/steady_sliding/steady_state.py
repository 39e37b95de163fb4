"""Steady sliding: equilibria whose contacts slide."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import KW_ONLY
from typing import Annotated

import numpy as np
from numpy.typing import ArrayLike

from asperity._base import arrays
from asperity._base.arrays import Array
from asperity._base.result import Result
from asperity._base.value import Given, Record, Vector, field
from asperity.errors import ConvergenceError, ParameterError
from asperity.runs.model import Model
from asperity.steady_sliding.linearised.field import STEP, Field, start
from asperity.steady_sliding.linearised.linearisation import Linearisation, linearisation, total
from asperity.system import SparseLinearSystem

_ITERATIONS = 50
# Numbers of coordinates and contacts that a summary lists one by one.
_LISTED = 100
# Residual that is rounding.
_EXACT = 1e-15


def _real(value: ArrayLike, _: str) -> Array:
    return np.asarray(value, dtype=np.float64)


class Equilibrium(Result, Record):
    """Steady sliding: u = 0 while the contacts slide with γ = χ, 0 = h + W_N λ_N + W λ.

    Args:
        q: coordinates, shape ``(coordinates,)``.
        force: friction forces λ in N, shape ``(n_contact, p)``; NaN where contacts have fewer
            components than others, 0 in open contacts.
        normal_force: λ_N in N, shape ``(n_contact,)``.
        slip: γ in m/s, shape ``(n_contact, p)``.
        closed: numbers of the closed unilateral contacts.
        residual: ‖h + W_N λ_N + W λ‖ over the sum of the norms of its parts and of the forces that
            a displacement by one difference step makes; of systems with sparse matrices over the
            norms of |K||q|, f and the contact forces.

    Reference: [WL19] §4.1, (77).
    """

    q: Vector
    force: Annotated[Given[ArrayLike, Array], _real]
    normal_force: Vector
    slip: Annotated[Given[ArrayLike, Array], _real]
    _: KW_ONLY
    closed: Annotated[
        Given[Sequence[int], tuple[int, ...]], lambda value, _: tuple(map(int, value))
    ] = field(default=())
    residual: float = 0.0

    def summary(self) -> str:
        """Return where the system is and how its contacts slide."""
        if max(len(self.q), len(self.normal_force)) > _LISTED:
            return self._short_summary()
        q = ", ".join(f"{value:.6g}" for value in self.q.tolist())
        lines = [
            f"The system slides steadily at q = ({q}), with a residual of {self.residual:.2g}."
        ]
        for number, force in enumerate(self.normal_force.tolist()):
            speed = float(np.sqrt(np.nansum(self.slip[number] ** 2)))
            friction = float(np.sqrt(np.nansum(self.force[number] ** 2)))
            lines.append(
                f"Contact {number} slips with {speed:.6g} m/s under a normal force of "
                f"{force:.6g} N; its friction is {friction:.6g} N."
            )
        return "\n".join(lines)

    def _short_summary(self) -> str:
        loaded = self.normal_force[self.normal_force > 0.0]
        return (
            f"The system of {len(self.q)} coordinates slides steadily, with a residual of "
            f"{self.residual:.2g}. Of {len(self.normal_force)} contacts {len(loaded)} are loaded, "
            f"with {loaded.min(initial=np.inf):.6g} N to {loaded.max(initial=0.0):.6g} N, "
            f"{loaded.sum():.6g} N together."
        )


def equilibrium(
    system: Model,
    *,
    q0: ArrayLike | None = None,
    closed: Sequence[int] | None = None,
    tolerance: float = 1e-10,
    step: float = STEP,
) -> Equilibrium:
    """Find steady sliding by Newton's method on the branch where all closed contacts slide.

    Args:
        system: `LinearSystem`, `MassOnBelt`, `RigidBodies` or a `System`, at time 0.
        q0: coordinates to start from, shape ``(coordinates,)``; default 0, of `RigidBodies` the
            state of the bodies.
        closed: numbers of the unilateral contacts that are closed. Default all. Of a system with
            sparse matrices they are a first guess: its contacts open and close.
        tolerance: of the residual, and of closed gaps in m.
        step: largest displacement for difference quotients in m or rad; linear systems need none,
            those with sparse matrices refuse it.

    Returns:
        The equilibrium.

    Raises:
        ParameterError: if a contact would stick, is not smooth along its sliding direction, would
            open, or penetrates; if the stiffness is singular.
        ConvergenceError: if Newton's method does not converge.

    Reference: [WL19] §4.1, (77).

    >>> from asperity import FrictionLaw, MassOnBelt, equilibrium
    >>> belt = MassOnBelt(
    ...     1.0,
    ...     stiffness=2.0,
    ...     law=FrictionLaw.isotropic(0.5),
    ...     normal_force=10.0,
    ...     belt_velocity=[1.0, 0.0],
    ... )
    >>> equilibrium(belt).q.round(12).tolist()
    [2.5, 0.0]
    """
    tolerance, step = arrays.positive(tolerance, "tolerance"), arrays.positive(step, "step")
    if isinstance(system, SparseLinearSystem):
        from asperity.steady_sliding.sparse.steady_state import sparse_equilibrium

        for name, given in (("q0", q0 is not None), ("step", step != STEP)):
            if given:
                raise ParameterError(name, "has no effect on a system with sparse matrices")
        return sparse_equilibrium(system, closed, tolerance)
    of = Field(system, start(system, q0))
    touching = closed_contacts(of, closed)
    load = np.array([0.0 if known is None else known for known in of.normal_forces])
    residual = math.inf
    for _ in range(_ITERATIONS):
        near = linearisation(of, load, touching, step=step)
        gap = np.array([near.contacts[i].state.gap for i in touching])
        last, residual = residual, _residual(near)
        balanced = residual <= tolerance and np.abs(gap).max(initial=0.0) <= tolerance
        # Newton's method goes on for as long as it gains digits.
        if balanced and not _EXACT < residual < 0.1 * last:
            return _checked(of, near, load, tolerance)
        delta, change = _correction(near, gap)
        of, load = Field(system, of.moved(delta)), load.copy()
        load[list(touching)] += change
    raise ConvergenceError(
        "no steady sliding was found",
        residual=residual,
        advice="Start from a nearer q0, or name other closed contacts",
    )


def closed_contacts(of: Field, closed: Sequence[int] | None) -> tuple[int, ...]:
    """Return the numbers of the closed unilateral contacts."""
    unilateral = [i for i, known in enumerate(of.normal_forces) if known is None]
    if closed is None:
        return tuple(unilateral)
    numbers = arrays.several(closed, "closed")
    wanted = tuple(sorted({arrays.count(i, "closed", least=0) for i in numbers}))
    for i in wanted:
        if i not in unilateral:
            raise ParameterError("closed", f"must name unilateral contacts {unilateral}, got {i}")
    return wanted


def _residual(near: Linearisation) -> float:
    return float(np.linalg.norm(near.imbalance) / near.size) if near.size else 0.0


def _correction(near: Linearisation, gap: Array) -> tuple[Array, Array]:
    """Solve −K δ + E Δλ_N = −imbalance, W_Nᵀδ = −gap."""
    n, m = near.thrusts.shape
    if m and np.linalg.matrix_rank(near.normals) < m:
        raise ParameterError(
            "closed", "must be contacts with independent normals: their forces are not unique"
        )
    matrix = np.block([[total(near.stiffness), -near.thrusts], [near.normals.T, np.zeros((m, m))]])
    # Rows and columns in units of the matrix itself, so that the condition number is one.
    scale = np.ones(n + m)
    for _ in range(5):
        largest = np.abs(matrix * scale * scale[:, None]).max(axis=1)
        scale /= np.sqrt(np.where(largest > 0.0, largest, 1.0))
    scaled = matrix * scale * scale[:, None]
    if not np.linalg.cond(scaled) < 1e13:
        raise ParameterError(
            "system",
            "has a singular stiffness about steady sliding: its equilibria are not isolated, or "
            "there is none",
        )
    solved = scale * np.linalg.solve(scaled, scale * np.append(near.imbalance, -gap))
    return solved[:n], solved[n:]


def _checked(of: Field, near: Linearisation, load: Array, tolerance: float) -> Equilibrium:
    for i in near.closed:
        if load[i] < -tolerance * near.size:
            raise ParameterError(
                "system", f"contact {i} would open: steady sliding needs λ_N = {load[i]:.6g} N"
            )
    states = of.contacts()
    for i, state in enumerate(states):
        if i not in near.contacts and state.gap < -tolerance:
            raise ParameterError(
                "closed", f"must name contact {i} too: it penetrates by {-state.gap:.6g} m"
            )
    width = max((law.dimension for law in of.laws), default=0)
    force, slip = np.full((2, len(states), width), np.nan)
    for i, state in enumerate(states):
        p = len(state.chi)
        slip[i, :p] = state.chi
        force[i, :p] = near.contacts[i].force if i in near.contacts else 0.0
    return Equilibrium(
        of.q, force, np.maximum(load, 0.0), slip, closed=near.closed, residual=_residual(near)
    )
