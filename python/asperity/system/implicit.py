"""What steps with implicit stiffness and damping say of the forces of constraints."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, TypeVar

import numpy as np

from asperity._base.arrays import Array
from asperity.errors import ParameterError

if TYPE_CHECKING:
    from asperity.system.linear import LinearSystem

_Matrix = TypeVar("_Matrix", bound=Any)

# Sine of the angle between rows, in whatever metric, that is rounding.
DEPENDENT = 1e-7
# Part of M̂ below which the beginning of a step has less than six digits from its end.
_ROUNDED = 1e-10


def effective_mass(mass: _Matrix, damping: _Matrix, stiffness: _Matrix, h: float) -> _Matrix:
    """Return M̂, of the symmetric parts: the core's masses are symmetric."""
    whole = damping + h * stiffness
    return mass + 0.5 * h * (whole + whole.T)


def loads(
    system: LinearSystem, dt: float, theta: float, samples: tuple[Array, Array, Array]
) -> tuple[Array, Array]:
    """Return M̂ and what constraints bear in the steps that end at samples q, u, λ, −JᵀΛ.

    With a = (u_E − u_B)/Δt and the damping B̃ = B + Δt (2θ − 1) K of the step in `runs.implicit`,

        (M̂ − Δt B̃) a = f − B̃ u_E − K (q_E − Δt θ u_E) + W λ + JᵀΛ,    J a = 0:

    Λ follows from the end of a step wherever its beginning does.

    Raises:
        ParameterError: where it does not, as M̂ − Δt B̃ is singular among motions with J a = 0.
    """
    mass = effective_mass(system.mass, system.damping, system.stiffness, dt * theta)
    damping = system.damping + dt * (2.0 * theta - 1.0) * system.stiffness
    q, u, force = samples
    load = system.force - u @ damping.T - (q - dt * theta * u) @ system.stiffness.T
    first = 0
    for contact in system.contacts:
        for columns in (contact.normal, contact.direction):
            if columns is not None:
                part = columns.reshape(len(mass), -1)
                load += force[:, first : first + part.shape[1]] @ part.T
                first += part.shape[1]
    rows = system.constraint_rows
    assert rows is not None
    sizes = np.linalg.norm(rows, axis=1, keepdims=True)
    _, values, right = np.linalg.svd(rows / np.where(sizes > 0.0, sizes, 1.0))
    free = right[np.count_nonzero(values > DEPENDENT) :].T
    back = mass - dt * damping
    among = free.T @ back @ free
    if np.linalg.matrix_rank(among, _ROUNDED * np.linalg.norm(mass)) < len(among):
        raise ParameterError(
            "trajectory",
            "must have steps whose beginnings follow from their ends: M − dt (1 − implicit) B + "
            "dt² (1 − implicit)² K is singular; take another dt",
        )
    return mass, load - load @ free @ np.linalg.solve(among.T, free.T) @ back.T
