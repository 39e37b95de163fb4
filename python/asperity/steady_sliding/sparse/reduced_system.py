"""Dense systems on few displacement shapes of a sparse one."""

from __future__ import annotations

import inspect
from collections.abc import Sequence
from functools import cached_property
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from asperity._base import arrays
from asperity._base.arrays import Array
from asperity._base.result import counted
from asperity.errors import DimensionError
from asperity.steady_sliding.linearised.pencil import Complex
from asperity.steady_sliding.sparse.sliding_state import SlidingState, SlidingStates
from asperity.steady_sliding.sparse.static_modes import StaticModes
from asperity.system import Contact, LinearSystem, SparseLinearSystem

# Largest number of entries of a basis that its text holds.
_PRINTED = 100


class ReducedSystem(LinearSystem):
    """A `LinearSystem` for displacements q = V y of a sparse system, as `reduce` makes it.

    The first coordinates are the gaps of the unilateral contacts less their gaps at rest, in m; the
    others are amplitudes of modes within closed contacts. Steady sliding has the loads and the open
    contacts of the whole system.

    Args:
        mass, stiffness, damping, force, contacts, coordinate_names, coordinate_units: of y, as of
            `LinearSystem`.
        full: the sparse system.
        basis: V, shape ``(full.dof, dof)``.
    """

    full: SparseLinearSystem
    basis: Array

    def __new__(cls, *_: Any, **__: Any) -> ReducedSystem:
        """Make the class itself, whatever the matrices are."""
        return object.__new__(cls)

    def __init__(
        self,
        mass: ArrayLike,
        *,
        full: SparseLinearSystem,
        basis: ArrayLike,
        stiffness: ArrayLike | None = None,
        damping: ArrayLike | None = None,
        force: ArrayLike | None = None,
        contacts: Sequence[Contact] | Contact = (),
        coordinate_names: Sequence[str] | None = None,
        coordinate_units: Sequence[str] | None = None,
    ) -> None:
        super().__init__(
            mass,
            stiffness=stiffness,
            damping=damping,
            force=force,
            contacts=contacts,
            coordinate_names=coordinate_names,
            coordinate_units=coordinate_units,
        )
        of = arrays.of_kind(full, "full", SparseLinearSystem, "a system with sparse matrices")
        V = arrays.constant(basis, "basis", (of.dof, self.dof))
        taken = inspect.signature(type(self)).parameters
        given = {name: one for name, one in self._parameters.items() if name in taken}
        self._set(**given, full=of, basis=V)

    @cached_property
    def states(self) -> SlidingStates:
        """Steady sliding over friction, direction and speed."""
        return SlidingStates(self)

    def expand(self, y: ArrayLike) -> Array:
        """Return displacements or velocities of the whole system.

        Args:
            y: those of this system, shape ``(…, dof)``.

        Returns:
            V y, shape ``(…, full.dof)``.
        """
        given = arrays.array(y, "y", (None,) * (np.ndim(y) - 1) + (self.dof,))
        return np.asarray(given @ self.basis.T)

    # Python would show the one of `__new__`.
    __signature__ = inspect.Signature(list(inspect.signature(__init__).parameters.values())[1:])

    def __repr__(self) -> str:
        if self.basis.size <= _PRINTED:
            return super().__repr__()
        return (
            f"<ReducedSystem: {counted(self.dof, 'coordinate')} for {self.full.dof}, "
            f"{counted(len(self.contacts), 'contact')}>"
        )


def projected(statics: StaticModes, modes: Array) -> ReducedSystem:
    """Project a system on its static modes and on modes within closed contacts."""
    full, columns = statics.system, statics.system.columns
    V = np.concatenate([statics.vectors, modes], axis=1)
    M, C, K = (V.T @ (part @ V) for part in (full.mass, full.damping, full.stiffness))
    tangents = np.asarray(columns.tangents.T @ V)
    units = iter(np.eye(V.shape[1]))
    contacts = [
        Contact(
            law,
            direction=tangents[columns.first[i] : columns.first[i + 1]].T,
            velocity=columns.slip[columns.first[i] : columns.first[i + 1]],
            **(
                {"normal": next(units), "gap": columns.gap[i]}
                if columns.unilateral[i]
                else {"normal_force": columns.normal_force[i]}
            ),
        )
        for i, law in enumerate(columns.laws)
    ]
    return ReducedSystem(
        0.5 * (M + M.T),
        full=full,
        basis=V,
        stiffness=0.5 * (K + K.T),
        damping=C,
        force=V.T @ full.force,
        contacts=contacts,
    )


def estimated_errors(
    system: ReducedSystem, statics: StaticModes, state: SlidingState, s: Complex, shapes: Complex
) -> tuple[Complex, Complex]:
    """Estimate what eigenvalues and modes lack, δs and δx, by residuals of the whole system.

    With right and left vectors x, y of the reduced system, δs = −rᵀP⁻¹ρ/(yᵀP′x) for the residuals
    ρ = P(s)x and r = P(s)ᵀy, to second order, and δx = −P⁻¹ρ; K⁻¹ of the motion within all contacts
    stands for P⁻¹.

    Args:
        system: the reduced system.
        statics: static modes of the whole system.
        state: steady sliding.
        s: eigenvalues, shape ``(k,)``.
        shapes: their modes, one column each.
    """
    full, V = system.full, system.basis
    columns = full.columns
    W = columns.tangents
    C = full.damping - W @ state.jacobian @ W.T
    left = np.stack([_left_vector(state.at(z)) for z in s], axis=1)
    slopes = 2.0 * s * (state.mass @ shapes) + state.damping @ shapes
    slope = np.sum(left * slopes, axis=0)
    x, y = V @ state.spread(shapes), V @ (state.left.T @ left)
    held = np.flatnonzero(columns.unilateral)[state.closed]
    N, E = columns.normals[:, held], (columns.normals + W @ state.contacts.unit_force)[:, held]
    rho = full.mass @ x * s**2 + C @ x * s + full.stiffness @ x
    rho = rho - E @ np.linalg.solve((N.T @ E).toarray(), N.T @ rho)
    r = full.mass @ y * s**2 + C.T @ y * s + full.stiffness @ y
    inner = statics.responses(np.concatenate([rho.real, rho.imag], axis=1))
    k = len(s)
    corrected = inner[:, :k] + 1j * inner[:, k:]
    return np.asarray(-np.sum(r * corrected, axis=0) / slope), -corrected


def _left_vector(matrix: Complex) -> Complex:
    """Return y with yᵀP = 0 by inverse iteration with a matrix that is singular to rounding."""
    from scipy.linalg import lu_factor, lu_solve

    tiny = np.finfo(float).eps * np.abs(matrix).max()
    factors = lu_factor(matrix + tiny * np.eye(len(matrix)), check_finite=False)
    y = np.cos(np.arange(1.0, len(matrix) + 1.0)).astype(np.complex128)
    for _ in range(2):
        y = lu_solve(factors, y, trans=1, check_finite=False)
        y /= np.linalg.norm(y)
    return y


def checked_full(system: Any) -> SparseLinearSystem:
    """Return the sparse system that is to be reduced."""
    if not isinstance(system, SparseLinearSystem):
        raise DimensionError(
            "system", f"must have sparse matrices to be reduced, got {type(system).__name__}"
        )
    return system
