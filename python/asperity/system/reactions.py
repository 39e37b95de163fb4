"""What constraints and joints transmit, from the trajectory of a system."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING, Protocol

import numpy as np

import asperity._core as _core
from asperity._base.arrays import Array
from asperity.errors import DimensionError, ParameterError
from asperity.system.implicit import loads

if TYPE_CHECKING:
    from asperity.law import FrictionLaw
    from asperity.runs.run import Run
    from asperity.system.custom import System
    from asperity.system.linear import LinearSystem


class _Obeying(Protocol):
    """A contact or a pair."""

    @property
    def law(self) -> FrictionLaw: ...
    @property
    def normal_force(self) -> float | None: ...


def states(trajectory: Run, own: tuple[int, int, int]) -> tuple[Array, Array]:
    """Return q and u of a run that may be one of a system with these sizes."""
    q, u = getattr(trajectory, "q", None), getattr(trajectory, "u", None)
    if not isinstance(q, np.ndarray) or not isinstance(u, np.ndarray):
        raise ParameterError("trajectory", f"must be a Trajectory or a Motion, got {trajectory!r}")
    found = q.shape[1], u.shape[1], trajectory.phase.shape[1]
    if found != own:
        raise DimensionError(
            "trajectory",
            f"must have {own} coordinates, velocities and contacts as the system, has {found}",
        )
    return q, u


def row_forces(trajectory: Run, contacts: Sequence[_Obeying]) -> Array:
    """Return the forces of contacts row by row, normal rows first, shape ``(n_t, rows)``."""
    none = np.zeros((len(trajectory.t), 0))
    rows = [none]
    for number, contact in enumerate(contacts):
        normal = none if contact.normal_force is not None else trajectory.normal_force[:, [number]]
        rows += [normal, trajectory.force[:, number, : contact.law.dimension]]
    return np.hstack(rows)


def constraint_forces(system: System | LinearSystem, trajectory: Run) -> Array:
    """Return Λ of a system's constraints in the middle of the step that ends at each sample."""
    own = len(system.labels.coordinates), system.dof, len(system.contacts)
    q, u = states(trajectory, own)
    if not system.constraints:
        return np.zeros((len(q), 0))
    core, dt = system._core, getattr(trajectory, "dt", None)
    if dt is None:
        raise ParameterError("trajectory", f"must be a Trajectory of simulate, got {trajectory!r}")
    options = getattr(trajectory, "options", None)
    # No step ends at the start.
    start, none = None if options is None else options.start.t, np.full(system.constraints, np.nan)
    rows = row_forces(trajectory, system.contacts)
    if options is not None and options.implicit is not None:
        from asperity.system.linear import LinearSystem

        if not isinstance(system, LinearSystem):
            raise ParameterError("trajectory", "must be of this system, which takes no implicit")
        mass, q = loads(system, dt, options.implicit, (q, u, rows))
        # A system whose forces at q are q itself, at rest.
        still, u = np.zeros_like(mass), np.zeros_like(q)
        core = _core.LinearSystem(mass, -np.eye(len(mass)), still, u[0], [], system._constraints)
        rows = rows[:, :0]
    samples = zip(trajectory.t, q, u, rows, strict=True)
    forces = [
        none if t == start else _core.constraint_forces(core, (t, dt), *given)
        for t, *given in samples
    ]
    return np.array(forces)
