"""Many runs of Moreau's midpoint time stepping."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

from numpy.typing import ArrayLike

import asperity._core as _core
from asperity._base import arrays
from asperity._base.progress import Progress, Report
from asperity.ensemble import reductions, running
from asperity.ensemble.ends import Ensemble
from asperity.ensemble.members import Again, Members, Part
from asperity.ensemble.reductions import Reduction
from asperity.ensemble.variants import Variants
from asperity.runs import time_stepping
from asperity.runs.model import Model
from asperity.runs.state import State
from asperity.solvers import Solver, chosen
from asperity.system.rigid import plane_motion


def simulate_many(
    systems: Model | Sequence[Model],
    *,
    dt: float,
    t_end: float,
    q0: ArrayLike | None = None,
    u0: ArrayLike | None = None,
    replace: Mapping[str, Any] | None = None,
    axes: str | Sequence[str] | None = None,
    keep: int | Reduction | str | Sequence[Reduction | str] = "end",
    after: float = 0.0,
    solver: Solver | None = None,
    tolerance: float = 1e-10,
    until_rest: bool = False,
    on_failure: str = "record",
    threads: int | None = None,
    lanes: bool = False,
    progress: Progress = None,
) -> Ensemble:
    """Simulate a system from many start states, or many systems, each as `simulate` does.

    Threads take the runs in chunks. Every run is to the bit what it is alone, for any number of
    threads and whatever its neighbours do; one that fails is recorded and ends alone.

    Args:
        systems: a system, or a sequence of systems with as many coordinates and contacts.
        dt: step Δt > 0 in s.
        t_end: end time in s; all runs start at the time 0.
        q0: initial coordinates, shape ``(..., n)``; default as in `simulate`.
        u0: initial velocities, shape ``(..., n)``; default likewise.
        replace: values by dotted names of what they replace in the system, such as ``"mass"``,
            ``"law.reservoir.angle"``, ``"bodies[3].mass"`` or ``"pairs[*].law.reservoir.a"``:
            numbers of shape ``(...)``, arrays whose last axes are those of the part, or a sequence
            of objects such as laws. What is made of them is what the constructors make of these
            and of all else that they were given.
        axes: names of the axes to which systems, values and start states are broadcast.
        keep: ``"end"``; or every how many steps a sample is kept; or quantities that are found
            on the way: ``"extent"`` of the coordinates, ``"stick_share"``, ``"rest_time"``, a
            `Section` whose crossings are counted, or several of these. The ends are always kept.
        after: time in s before which such quantities do not look, until which a motion settles.
        solver: contact solver. Default `Auto`; with several threads of the ensemble it uses one.
        tolerance: of each step's contact problem, see `ContactProblem.solve`.
        until_rest: end a run after two steps in which all its velocities vanish.
        on_failure: ``"record"``: a run ends at a step whose contact problem is not solved, and the
            others go on; or ``"raise"`` what the first of them raises.
        threads: number of threads; default the number of cores, one in a worker process. Systems
            with functions of Python are run one after the other.
        lanes: whether a thread runs several members side by side in the wide registers of the
            processor, which makes most steps two to four times as fast. It does so for
            `SlidingPoint`, `MassOnBelt` and a `LinearSystem` with two degrees of freedom and one
            contact with p = 2, a given normal force and a law of ellipses or superellipses (of
            exponents from 1.1 to 20) without a factor of the speed, if ``tolerance`` is at least
            1e-11; all others run as without. Results are then those of `simulate` up to rounding,
            and still the same to the bit for any number of threads and lanes.
        progress: ``True`` for a bar of tqdm, or a function of (runs done, runs).

    Returns:
        The ensemble. Crossings of a section lie on straight lines between states, and the extent
        is that of the states at the ends of steps, both exact to O(Δt), as the method is.

    Raises:
        ParameterError: naming the argument; of ``replace`` with the nearest names.
        EnsembleInterrupted: on Ctrl-C, with what is done as ``ensemble``.

    >>> import numpy as np
    >>> from asperity import Ellipse, FrictionLaw, MassOnBelt, simulate_many
    >>> belt = MassOnBelt(
    ...     1.0,
    ...     stiffness=1.0,
    ...     law=FrictionLaw(Ellipse(0.6, 0.3), Ellipse(0.3, 0.6)),
    ...     normal_force=1.0,
    ...     belt_velocity=[0.1, 0.0],
    ... )
    >>> many = simulate_many(
    ...     belt,
    ...     dt=0.01,
    ...     t_end=60.0,
    ...     replace={"law.reservoir.angle": np.linspace(0.0, np.pi / 2, 3)},
    ...     keep=["extent", "stick_share"],
    ...     after=30.0,
    ... )
    >>> many.extent.shape, many.status.tolist()
    ((3, 2), ['finished', 'finished', 'finished'])
    """
    dt, t_end = arrays.positive(dt, "dt"), arrays.positive(t_end, "t_end")
    tolerance, method = arrays.positive(tolerance, "tolerance"), chosen(solver)
    members = Members(Variants(systems, replace), q0, u0, axes)
    kept = reductions.kept(keep, after, members.sizes)
    every = None if kept.every is None else arrays.count(keep, "keep")
    number = running.threads(threads, members)
    steps = time_stepping.steps_from(State([], []), dt, t_end)

    def compute(part: Part, report: Report | None) -> tuple[dict[str, Any], BaseException | None]:
        return _core.simulate_many(
            part.runs,
            dt,
            steps,
            method._core,
            tolerance,
            bool(until_rest),
            kept.arguments(every),
            number,
            bool(lanes),
            report,
        )

    options = {"dt": dt, "t_end": t_end, "solver": method, "tolerance": tolerance}
    return running.all_runs(
        members,
        compute,
        lambda system: plane_motion.check_rates(system, 0.0, t_end),
        lambda failure, system: time_stepping.unsolved(failure["unsolved"], system),
        Again(members, time_stepping.simulate, {**options, "until_rest": bool(until_rest)}),
        kept.names,
        on_failure=on_failure,
        progress=progress,
    )
