"""Distance of two motions of one system."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from asperity._base.arrays import Array
from asperity.errors import DimensionError, ParameterError
from asperity.runs.run import Run
from asperity.steady_sliding.linearised.field import constant
from asperity.system import LinearSystem, MassOnBelt, SlidingPoint

# Times that differ by less than this share of the mean step are the same.
_SAME = 1e-6


def incremental_distance(
    run_a: Run,
    run_b: Run,
    *,
    system: LinearSystem | MassOnBelt | SlidingPoint,
) -> tuple[Array, Array]:
    """Return V = ½ Δuᵀ M Δu + ½ Δqᵀ K Δq of two motions at the times that both have.

    With an associated law, a symmetric positive semidefinite K, no negative damping and prescribed
    normal forces V never grows, but for the error of the time steps.

    Nothing is interpolated: give both runs the same times, `integrate` by its `dt`. At an event,
    which has two samples, the second counts.

    Args:
        run_a: what `simulate` or `integrate` made of `system`; of another one V means nothing, and
            only the number of coordinates is checked.
        run_b: another such run.
        system: `LinearSystem`, `MassOnBelt` or `SlidingPoint`.

    Returns:
        The common times in s and V in J, both of shape ``(m,)``.

    Raises:
        ParameterError: if the system is not linear, its K not symmetric or not positive
            semidefinite, or no time is common.
        DimensionError: if a run has other coordinates than the system.

    Reference: [WL19] Thm. 1.

    >>> from asperity import Ellipse, FrictionLaw, MassOnBelt, incremental_distance, simulate
    >>> belt = MassOnBelt(
    ...     1.0,
    ...     stiffness=1.0,
    ...     law=FrictionLaw.associated(Ellipse(3.0, 1.0)),
    ...     normal_force=1.0,
    ...     belt_velocity=[1.0, 1.0],
    ... )
    >>> runs = [simulate(belt, dt=0.01, t_end=5.0, q0=q0) for q0 in ([0.0, 0.0], [1.0, -1.0])]
    >>> t, V = incremental_distance(*runs, system=belt)
    >>> bool(V[-1] < V[0]), round(float(V[0]), 6)
    (True, 1.0)
    """
    linear = constant(system)
    if linear is None:
        raise ParameterError(
            "system", f"must be a LinearSystem, MassOnBelt or SlidingPoint, got {system!r}"
        )
    M, K = linear.mass, linear.stiffness
    if np.abs(K - K.T).max() > 1e-12 * np.abs(K).max():
        raise ParameterError("system", "must have a symmetric stiffness for V to be an energy")
    lowest, highest = np.linalg.eigvalsh(K)[[0, -1]]
    if lowest < -1e-12 * abs(highest):
        raise ParameterError(
            "system",
            "must have a positive semidefinite stiffness for V to be a distance, its lowest "
            f"eigenvalue is {lowest:.6g} N/m",
        )
    for name, run in (("run_a", run_a), ("run_b", run_b)):
        if not isinstance(run, Run):
            raise ParameterError(name, f"must be a Trajectory or a Motion, got {run!r}")
        if run.q.shape[1] != linear.dof:
            raise DimensionError(
                name, f"must have {linear.dof} coordinates as the system, has {run.q.shape[1]}"
            )
    a, b = _common(run_a, run_b)
    du, dq = run_a.u[a] - run_b.u[b], run_a.q[a] - run_b.q[b]
    V = 0.5 * np.einsum("ti,ij,tj->t", du, M, du) + 0.5 * np.einsum("ti,ij,tj->t", dq, K, dq)
    return run_a.t[a], V


def _common(run_a: Run, run_b: Run) -> tuple[NDArray[np.intp], NDArray[np.intp]]:
    """Return the samples at the same times, the last where there are several."""
    unit = _SAME * min(
        float(run.t[-1] - run.t[0]) / max(len(run.t) - 1, 1) for run in (run_a, run_b)
    )
    a = np.flatnonzero(np.diff(run_a.t, append=np.inf) > unit)
    nearest = np.searchsorted(run_b.t, run_a.t[a] + unit, side="right") - 1
    same = (nearest >= 0) & (np.abs(run_b.t[nearest] - run_a.t[a]) <= unit)
    if not same.any():
        raise ParameterError("run_b", "must have a time in common with run_a")
    return a[same], nearest[same]
