"""Moreau's midpoint time stepping."""

from __future__ import annotations

import math
from typing import Any, NoReturn

import numpy as np
from numpy.typing import ArrayLike

import asperity._core as _core
from asperity._base import arrays
from asperity._base.arrays import Array
from asperity._base.log import log
from asperity._base.progress import Progress, reporter
from asperity.contact.problem import ContactProblem
from asperity.contact.solution import infeasibility
from asperity.errors import (
    ConvergenceError,
    DivergenceError,
    NoSolutionError,
    ParameterError,
    SimulationInterrupted,
)
from asperity.runs.implicit import implicit_steps
from asperity.runs.model import Model, labels_of
from asperity.runs.origin import Origin, TimeStepping
from asperity.runs.run import Run
from asperity.runs.state import State
from asperity.runs.trajectory import Trajectory
from asperity.solvers import Solver, chosen
from asperity.status import Status
from asperity.system import LinearSystem
from asperity.system.custom import System
from asperity.system.rigid import RigidBodies, plane_motion

# Overlap at the start, relative to the coordinates, that rounding of what a user computes explains.
_ROUNDED_OVERLAP = 1e-9
# Relative tolerance within which t_end counts as a multiple of dt.
_MULTIPLE = 1e-9


def simulate(
    system: Model,
    *,
    dt: float,
    t_end: float,
    q0: ArrayLike | None = None,
    u0: ArrayLike | None = None,
    start: Run | State | None = None,
    solver: Solver | None = None,
    tolerance: float = 1e-10,
    sample_every: float | None = None,
    until_rest: bool = False,
    on_failure: str = "raise",
    implicit: float | None = None,
    progress: Progress = None,
) -> Trajectory:
    """Integrate a system with Moreau's midpoint scheme.

    q_M = q_B + ½Δt u_B; M (u_E − u_B) − h Δt = W_N P_N + W P at q_M with the contact laws on u_E;
    q_E = q_M + ½Δt u_E. Steps are counted, t = k Δt. The method is of first order and has no event
    location: contact changes are resolved to one step. Contact forces and friction that depends on
    the speed are implicit. All other forces are explicit, h at (q_M, u_B): springs need Δt² k < 4 m
    and dampers Δt d < 2 m, both together Δt² k + 2 Δt d < 4 m.

    Of a `LinearSystem` and what is made of it the step is checked at the start. It is refused if
    more motions that contacts do not hold grow in steps than there are that grow: flutter runs,
    motions that the scheme alone amplifies do not. Growth by less than 1e-3 per radian of a motion
    with more than four steps per turn is an error of first order and runs; gyroscopic forces, which
    are amplified by O(Δt) at every step, need steps that are short enough for it.

    Args:
        system: `LinearSystem`, `SlidingPoint`, `MassOnBelt`, `RigidBodies` or a `System`.
        dt: step Δt > 0 in s. Rigid bodies of unequal moments should turn by less than about a
            radian in it; from half a turn on the run ends, unless they spin steadily.
        t_end: end time in s, after the time of `start`, which is 0 without it; the last step is
            the first with k Δt ≥ `t_end` (to 1e-9 relative).
        q0: initial coordinates, shape ``(n,)``, of `RigidBodies` ``(coordinates,)``, whose
            quaternions are normalised. Default 0, of `RigidBodies` the state of the bodies.
            Rigid bodies must not overlap there: time stepping would leave them so.
        u0: initial velocities, shape ``(n,)``; default likewise.
        start: a run or its ``end`` to go on from, instead of `q0` and `u0`, at its time: `t_end` is
            then still the time at the end, counts are those of the new run. Of a trajectory phases,
            slip directions and percussions are handed over, so that with the same options what
            follows is what an unbroken run would have had, to the bit. Overlaps are taken as they
            are, as time stepping leaves them.
        solver: contact solver. Default `Auto`.
        tolerance: of each step's contact problem, see `ContactProblem.solve`.
        sample_every: time between samples in s, a multiple of `dt`. Default `dt`. The initial and
            the last state are kept always.
        until_rest: stop after two steps in which all velocities vanish; a load that starts to act
            later does not start the motion again.
        on_failure: ``"raise"``, or ``"record"`` to go on with the best iterate and count the step.
        implicit: θ in [½, 1] of the scheme of Moreau and Jean for a `LinearSystem` and what is made
            of it: the symmetric parts of K and B act implicitly, and no step is too long for them.
            ½ is of second order while no contact changes and no sliding direction turns, and keeps
            the energy of free vibrations; more damps what steps do not resolve, as coordinates
            without mass need it. A contact is closed where its gap has vanished at
            q_B + (1 − θ) Δt u_B. Default: explicit. Sparse systems must have it; they take neither
            `until_rest` nor contacts with dependent directions.
        progress: ``True`` for a bar of tqdm, or a function of (step, steps) called a few times a
            second.

    Returns:
        The trajectory.

    Raises:
        NoSolutionError: a contact has no solution (Painlevé).
        ConvergenceError: a contact problem was not solved to `tolerance`. Either holds the step,
            the time, the contact, the residual and the part before as ``trajectory``.
        DivergenceError: the state is no longer finite, or velocities have reversed and grown in
            each of eight steps or more, a thousandfold in all, as in steps that are too long for
            stiff springs; with the part before as ``trajectory``.
        ParameterError: naming the argument, ``system`` or ``q0`` with the contact where bodies
            overlap; ``dt`` where a body turns too far in a step, and with the longest step where it
            is too long for a linear system.
        SimulationInterrupted: on Ctrl-C, with the part before as ``trajectory``.

    Reference: [WL19] (19)–(22); implicit: [Jean1999].

    >>> from asperity import FrictionLaw, SlidingPoint, simulate
    >>> block = SlidingPoint(1.0, law=FrictionLaw.isotropic(0.5), gravity=10.0)
    >>> path = simulate(block, dt=0.01, t_end=1.0, u0=[2.0, 0.0], sample_every=0.2)
    >>> path.u[:, 0].round(9).tolist()
    [2.0, 1.0, 0.0, 0.0, 0.0, 0.0]
    """
    # Asking a sparse system for the whole protocol would refuse it.
    arrays.of_kind(system, "system", LinearSystem | Model, "a system such as SlidingPoint")
    dt = arrays.positive(dt, "dt")
    t_end = arrays.number(t_end, "t_end")
    if start is None:
        t_end = arrays.positive(t_end, "t_end")
    state = beginning(system, q0, u0, start)
    steps = steps_from(state, dt, t_end)
    options = TimeStepping(
        dt=dt,
        t_end=t_end,
        start=state,
        solver=chosen(solver),
        tolerance=tolerance,
        sample_every=sample_every,
        until_rest=until_rest,
        on_failure=on_failure,
        implicit=implicit,
    )
    plane_motion.check_rates(system, state.t, t_end)
    stride = _stride(sample_every, dt)
    scheme = None
    if options.implicit is not None:
        scheme = implicit_steps(
            system, dt, options.implicit, state, stride, until_rest=options.until_rest
        )
    with reporter(progress, "step") as report:
        run, exception = _core.simulate(
            system._core if scheme is None else scheme.core,
            dt,
            steps,
            *(state if scheme is None else scheme.start)._arguments(),
            options.solver._core,
            options.tolerance,
            stride,
            options.until_rest,
            on_failure == "raise",
            report,
        )
    if scheme is not None:
        run = scheme.finished(run)
    failure, end = run.pop("failure"), run.pop("end")
    trajectory = Trajectory(
        dt=dt,
        end=None if end is None else State(**end),
        labels=labels_of(system),
        origin=Origin(system, options),
        **run,
    )
    if exception is not None:
        if isinstance(exception, DivergenceError):
            raise DivergenceError(exception.message, trajectory)
        reached = "at the start"
        if len(trajectory) > 0:
            reached = f"in step {trajectory.steps + 1}, after t = {trajectory.t[-1]:.9g} s"
        raise_with(exception, trajectory, reached)
    if trajectory.failed_steps and on_failure == "record":
        log.warning(
            "simulate: %d of %d steps did not converge to the tolerance %g and were recorded",
            trajectory.failed_steps,
            trajectory.steps,
            tolerance,
        )
    if trajectory.ambiguous_steps:
        log.info(
            "simulate: in %d of %d steps a contact had several solutions",
            trajectory.ambiguous_steps,
            trajectory.steps,
        )
    if failure is not None and on_failure == "raise":
        raise unsolved(failure, system, trajectory)
    return trajectory


def beginning(
    system: Model, q0: ArrayLike | None, u0: ArrayLike | None, start: Run | State | None
) -> State:
    """Return the state from which a run begins, or goes on."""
    if start is None:
        state = State(*initial_state(system, q0, u0))
        if isinstance(system, RigidBodies):
            _refuse_overlap(system, state.q, "system" if q0 is None else "q0")
        return state
    if q0 is not None or u0 is not None:
        raise ParameterError("start", "excludes q0 and u0")
    found = start.end if isinstance(start, Run) else start
    if found is None:
        raise ParameterError(
            "start",
            "does not know what its contacts did at its end: it was cut, its state was not finite, "
            "or it is from a file of an earlier version. A fresh start is "
            "start=State(run.q[-1], run.u[-1], t0=run.t[-1])",
        )
    if not isinstance(found, State):
        raise ParameterError("start", f"must be a run or a State, got {start!r}")
    return found


def rounded_overlap(system: RigidBodies, q: Array) -> float:
    """Return the overlap in m up to which bodies touch: rounding of their places by their users."""
    positions = q.reshape(len(system.bodies), -1)[:, : len(system.gravity)]
    return _ROUNDED_OVERLAP * float(np.abs(positions).max())


def _refuse_overlap(system: RigidBodies, q: Array, argument: str) -> None:
    """Refuse bodies that lie in each other or in a plane at the time 0."""
    if not system.planar:
        q = q.copy()
        attitudes = q.reshape(-1, 7)[:, 3:]
        lengths = np.linalg.norm(attitudes, axis=1, keepdims=True)
        if not lengths.all():
            return  # The core names the body.
        attitudes /= lengths
    deepest = _core.deepest_overlap(system._core, 0.0, q)
    if deepest is None:
        return
    contact, gap = deepest
    if -gap > rounded_overlap(system, q):
        raise ParameterError(
            argument,
            f"must not let bodies overlap: {system.labels.contacts[contact]} does by "
            f"{-gap:.3g} m; time stepping does not remove penetration. To start anyway pass "
            "start=State(q, u) to simulate",
        )


def steps_from(state: State, dt: float, t_end: float) -> int:
    """Return the number of steps that are left until `t_end`, as far as the clock counts them."""
    if state.dt == dt:
        steps = _step_count(dt, t_end - state.t0) - state.steps
    else:
        steps = _step_count(dt, t_end - state.t)
    if steps < 1:
        raise ParameterError(
            "t_end", f"must lie after the time of start, {state.t:.9g} s, got {t_end:.9g}"
        )
    _check_clock(state, dt, steps)
    return steps


def _stride(sample_every: float | None, dt: float) -> int:
    """Return the number of steps from one sample to the next."""
    if sample_every is None:
        return 1
    interval = arrays.positive(sample_every, "sample_every")
    steps = round(interval / dt) if interval / dt < 2.0**53 else 0
    if steps < 1 or abs(interval / dt - steps) > _MULTIPLE * steps:
        raise ParameterError(
            "sample_every", f"must be a multiple of dt = {dt!r}, got {sample_every!r}"
        )
    return steps


def _step_count(dt: float, t_end: float) -> int:
    ratio = t_end / dt
    if not ratio < 2.0**53:
        raise ParameterError("dt", f"is too small for t_end = {t_end!r}, got {dt!r}")
    nearest = round(ratio)
    return nearest if abs(ratio - nearest) <= _MULTIPLE * nearest else math.ceil(ratio)


def _check_clock(state: State, dt: float, steps: int) -> None:
    """Refuse steps that the clock cannot count: rounding would give several the same time."""
    first = state.t0 if state.dt == dt else state.t
    done = state.steps if state.dt == dt else 0
    latest = max(abs(first), abs(first + (done + steps) * dt))
    # k Δt is rounded, and so is its sum with t₀: by half a spacing of numbers each.
    least = 2.0 * math.ulp(latest)
    if not dt >= least:
        raise ParameterError(
            "dt",
            f"must be at least {least:.3g} s, twice the spacing of numbers at t = {latest:.9g} s, "
            f"got {dt!r}",
        )


def initial_state(system: Model, q0: ArrayLike | None, u0: ArrayLike | None) -> tuple[Array, Array]:
    """Return the initial coordinates and velocities, the system's own where none are given."""
    if isinstance(system, RigidBodies):
        q, u = system.q0, system.u0
    else:
        q = u = np.zeros(system.dof)
        if isinstance(system, System):
            q = system._origin()
            if q0 is None and system.coordinates is not None:
                raise ParameterError("q0", "must be given where a system has its own coordinates")
    return (
        arrays.array(q if q0 is None else q0, "q0", q.shape),
        arrays.array(u if u0 is None else u0, "u0", u.shape),
    )


def raise_with(exception: BaseException, part: Run, when: str) -> NoReturn:
    """Raise what stopped a run from outside, Ctrl-C or an exception in the user's code.

    It holds the part before as ``trajectory``.
    """
    if isinstance(exception, KeyboardInterrupt):
        raise SimulationInterrupted(part) from exception
    vars(exception)["trajectory"] = part
    exception.add_note(f"asperity: raised {when}")
    raise exception


def unsolved(
    failure: dict[str, Any], system: Model, trajectory: Trajectory | None = None
) -> ConvergenceError:
    """Return the error of a contact problem that was not solved, with the part before."""
    status = Status(failure["status"])
    details: dict[str, Any] = {
        "advice": status.advice,
        "trajectory": trajectory,
        **{name: failure[name] for name in ("step", "time", "contact", "residual")},
    }
    if status is Status.NO_SOLUTION:
        return NoSolutionError(
            status.message, **details, **without_solution(failure["unsolvable"], system)
        )
    return ConvergenceError(status.message, **details)


def without_solution(found: dict[str, Any] | None, system: Model) -> dict[str, Any]:
    """Return the problem of a motion that has no solution, and the proof, as far as known."""
    if found is None:
        return {}
    laws = [getattr(system.contacts[i], "law", None) for i in found["contacts"]]
    problem = None
    if "delassus" in found and None not in laws:
        # Factors of the speed are in the operator.
        problem = ContactProblem(
            found["delassus"],
            free_velocity=found["free_velocity"],
            laws=[law.replace(rate=None) for law in laws if law is not None],
            normal_force=found["normal_force"],
        )
    return {"infeasibility": infeasibility(found["infeasibility"]), "problem": problem}
