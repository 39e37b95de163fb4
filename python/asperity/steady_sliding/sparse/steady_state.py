"""Steady sliding of a sparse system whose contacts may open."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from asperity._base import arrays
from asperity._base.arrays import Array
from asperity.errors import ParameterError
from asperity.steady_sliding.sparse.active_set import LinearContact
from asperity.steady_sliding.sparse.friction import SlidingContacts
from asperity.steady_sliding.steady_state import Equilibrium
from asperity.system import SparseLinearSystem

# Difference of friction forces, relative to the largest, that is rounding of who computed them.
_ROUNDED = 1e-9


def sparse_equilibrium(
    system: SparseLinearSystem, closed: Sequence[int] | None, tolerance: float
) -> Equilibrium:
    """Solve K q = f + E λ_N with loads and gaps that are complementary.

    Args:
        system: the system.
        closed: contacts to begin with; default all.
        tolerance: of the residual.

    Raises:
        ParameterError, ConvergenceError: if there is none, or none is found.
    """
    of = system.columns
    contacts = SlidingContacts.of(of)
    unilateral = np.flatnonzero(of.unilateral)
    linear = LinearContact(
        system.stiffness, of.normals[:, unilateral], contacts.thrusts[:, unilateral]
    )
    force = system.force + contacts.prescribed_force()
    found = linear.solve(force, of.gap[unilateral], _guess(of.unilateral, closed)[unilateral])
    touching = unilateral[found.closed]
    load = np.where(of.unilateral, 0.0, of.normal_force)
    load[touching] = np.maximum(found.load, 0.0)
    friction = contacts.unit_force @ load
    residual = _residual(system, contacts, found.q, load)
    if not residual <= tolerance:
        raise ParameterError(
            "system",
            "has a nearly singular stiffness about steady sliding: its forces balance only to "
            f"{residual:.2g}",
        )
    return Equilibrium(
        found.q,
        _by_contact(of.first, friction),
        load,
        _by_contact(of.first, of.slip),
        closed=touching.tolist(),
        residual=residual,
    )


def residual_of(system: SparseLinearSystem, steady: Equilibrium) -> float:
    """Return the residual of a state that is said to be an equilibrium.

    Raises:
        DimensionError, ParameterError: if it is one of other coordinates or contacts.
    """
    of = system.columns
    load = arrays.array(steady.normal_force, "equilibrium", (len(of.laws),))
    wrong = set(steady.closed) - set(np.flatnonzero(of.unilateral).tolist())
    loaded = set(np.flatnonzero(of.unilateral & (load > 0.0)).tolist()) - set(steady.closed)
    for number in wrong:
        raise ParameterError(
            "equilibrium", f"must name closed unilateral contacts of the system, names {number}"
        )
    for number in loaded:
        raise ParameterError("equilibrium", f"loads contact {number}, which is not closed")
    q = arrays.array(steady.q, "equilibrium", (system.dof,))
    contacts = SlidingContacts.of(of)
    friction = _by_contact(of.first, np.asarray(contacts.unit_force @ load))
    size = np.nanmax(np.abs(friction), initial=0.0)
    if friction.shape != steady.force.shape or not np.allclose(
        steady.force, friction, rtol=0.0, atol=_ROUNDED * size, equal_nan=True
    ):
        raise ParameterError("equilibrium", "must have the friction of its loads and velocities")
    return _residual(system, contacts, q, load)


def _residual(
    system: SparseLinearSystem, contacts: SlidingContacts, q: Array, load: Array
) -> float:
    """Return ‖K q − f − E λ_N‖ over the sum of the norms of |K||q|, f and E λ_N.

    Large forces of springs that nearly balance each other at a node are rounded as such.
    """
    pushed = np.asarray(contacts.thrusts @ load)
    left = np.asarray(system.stiffness @ q) - system.force - pushed
    parts = np.asarray(abs(system.stiffness) @ np.abs(q)), system.force, pushed
    size = float(sum(np.linalg.norm(part) for part in parts))
    return float(np.linalg.norm(left) / size) if size else 0.0


def _guess(unilateral: NDArray[np.bool_], closed: Sequence[int] | None) -> NDArray[np.bool_]:
    if closed is None:
        return unilateral
    guess = np.zeros(len(unilateral), dtype=bool)
    for i in arrays.several(closed, "closed"):
        number = arrays.count(i, "closed", least=0)
        if number >= len(unilateral) or not unilateral[number]:
            raise ParameterError("closed", f"must name unilateral contacts, got {i}")
        guess[number] = True
    return guess


def _by_contact(first: NDArray[np.intp], values: Array) -> Array:
    """Return the tangential components of each contact, NaN where others have more."""
    sizes = np.diff(first)
    table = np.full((len(sizes), int(sizes.max(initial=0))), np.nan)
    for k in range(table.shape[1]):
        table[sizes > k, k] = values[first[:-1][sizes > k] + k]
    return table
