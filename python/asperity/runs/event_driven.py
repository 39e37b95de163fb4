"""Event-driven integration: smooth phases, and the events between them."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import ArrayLike

import asperity._core as _core
from asperity._base import arrays
from asperity._base.log import log
from asperity._base.progress import Progress, reporter
from asperity.errors import (
    ConvergenceError,
    DimensionError,
    NoSolutionError,
    ParameterError,
)
from asperity.runs.event import Event
from asperity.runs.model import Model, labels_of
from asperity.runs.motion import Motion
from asperity.runs.origin import EventDriven, Origin
from asperity.runs.run import Run
from asperity.runs.section import Section
from asperity.runs.state import State
from asperity.runs.time_stepping import (
    beginning,
    raise_with,
    rounded_overlap,
    without_solution,
)
from asperity.status import Outcome, Status
from asperity.system.rigid import RigidBodies, plane_motion

_ENDS = {
    "finished": Outcome.FINISHED,
    "section": Outcome.SECTION,
    "interrupted": Outcome.INTERRUPTED,
}

# Newton steps that move overlapping contacts apart: the gaps of bodies that turn are curved.
_CORRECTIONS = 3

_FAILURES = {
    "too_many_events": (
        "there were max_events events",
        "Impacts or stick-slip may follow each other ever faster: try a larger max_events or a "
        "restitution further from 1",
    ),
    "step": (
        "steps fail however short they are",
        "Forces may grow without bound, or jump where the method does not know it: try simulate",
    ),
    "rejections": (
        "most steps fail, and time hardly passes",
        "The motion may change faster than steps resolve, such as where a contact hardly slips: "
        "try simulate",
    ),
    "events": (
        "events follow each other without time passing",
        "The contacts may not find what to do, such as when they are redundant: try simulate",
    ),
    "unsolved": (
        "the contact forces or percussions at an event were not found",
        "The contacts may depend on each other, so that rounding decides what they do: try "
        "simulate",
    ),
    "no_impact": (
        "no percussion was found that stops the slip without a collision",
        "Friction and normal force enforce each other (Painlevé), but that no percussion satisfies "
        "the laws is not proven: try simulate",
    ),
    "unbounded": (Status.UNBOUNDED.message, Status.UNBOUNDED.advice),
    "no_solution": (Status.NO_SOLUTION.message, Status.NO_SOLUTION.advice),
}


def integrate(
    system: Model,
    *,
    t_end: float,
    q0: ArrayLike | None = None,
    u0: ArrayLike | None = None,
    start: Run | State | None = None,
    tolerance: float = 1e-10,
    sample_every: float | None = None,
    max_step: float | None = None,
    section: Section | None = None,
    max_events: int = 10_000,
    progress: Progress = None,
) -> Motion:
    """Integrate a system from event to event: M u̇ = h + W_N λ_N + W λ, q̇ = u.

    Between events every contact is open, sticks (γ̇ = 0) or slips (λ = λ_N f(γ)), and the motion is
    smooth: Radau IIA collocation of order 9. The beginning and the end of stick, opening and
    impacts are located to rounding. Gaps are followed between the stages of a step, in pieces in
    which they are polynomials to 1e-12 of their extent, so that none closes unseen. Contact
    problems of accelerations and of impacts decide what comes next, by the rule of selection of
    `simulate`. What `simulate` converges to for Δt → 0.

    Parts of a `RigidBodies` or `LinearSystem` that no contact, spring or matrix entry can connect
    are integrated one by one, each as it would move alone.

    Args:
        system: a system with as many coordinates as velocities but for ``rotations``; the
            direction sets of its laws must be strictly convex.
        t_end: end time in s, after the time of `start`, which is 0 without it. Of a force that
            jumps there the limit from the left counts. What is short is told by it: events in its
            last 2e-14 are not looked for, and the integration gives up where 2000 steps, made or
            rejected, do not pass 1e-10 of the time from start to end.
        q0: initial coordinates, shape ``(n,)``. Default 0, of `RigidBodies` that of the bodies.
            Quaternions are normalised, and no rotation by default.
        u0: initial velocities, shape ``(n,)``; default likewise. At the beginning gaps and
            velocities count as none below 2.2e-16 of the way and of the velocity that the loads
            give until ``t_end`` where nothing stops them, and 2.2e-16 m and m/s at most.
        start: a run or its ``end`` to go on from, instead of `q0` and `u0`, at its time, which must
            not be negative. What contacts did before is not handed over: where they have a choice
            they decide afresh. Those that the steps of `simulate` have let overlap touch: they are
            moved apart the shortest way, in the metric of M, until their gaps vanish.
        tolerance: error that is aimed at, relative to the largest coordinate and the largest
            velocity so far of each part that nothing connects with others, as far as rounding of
            forces and of functions of time allows; between 1e-14 and 1e-2. Functions of the user
            are asked at the start how large they become up to ``t_end``.
        sample_every: time between samples in s. Default: every step of the method, before and after
            events. Parts of the system that nothing connects have steps of their own; between
            events there are then as many samples as each part has steps on average.
        max_step: longest step in s. Default: as the error allows. Functions of time of the user are
            seen at five times of a step: set this to the length of pulses, else they are missed.
            At least 1e-10 of all the time. A `Signal` needs none: steps end where it is not smooth.
        section: where to stop; its ``after`` is by the same clock.
        max_events: number of events after which the integration gives up, kinks apart.
        progress: ``True`` for a bar of tqdm, or a function of (t, t_end) called a few times a
            second.

    Returns:
        The motion, from the state before any impact at 0 on. Bounces that are lower than 1e-13 of
        the contact's reach, the largest |w_N|ᵀ|q| so far, end a sequence of impacts, of one contact
        or of several between which a body rocks: they stay closed from there. Closed contacts whose
        normal forces or percussions equilibrium leaves open share them as contacts of equal
        compliance do. One
        whose share would pull is closed without load, `Phase.OPEN`, until its share presses.

    Raises:
        NoSolutionError: no forces or percussions satisfy the laws; it holds the proof.
        ConvergenceError: too many events, no step succeeds, or no impact was found that ends a
            Painlevé paradox. Either holds the time, the
            contact and the part before as ``trajectory``.
        SimulationInterrupted: on Ctrl-C, with the part before as ``trajectory``.

    Reference: [HairerWanner1996] IV.5, IV.8; [WL19] §4.3, Fig. 17; [LeineNijmeijer2004] ch. 8.

    >>> from asperity import FrictionLaw, SlidingPoint, integrate
    >>> block = SlidingPoint(1.0, law=FrictionLaw.isotropic(0.5), gravity=10.0)
    >>> motion = integrate(block, t_end=1.0, u0=[2.0, 0.0])
    >>> [(event.kind, round(event.time, 12)) for event in motion.events]
    [(EventKind.STICK, 0.4)]
    >>> round(float(motion.q[-1, 0]), 12)
    0.4
    """
    arrays.of_kind(system, "system", Model, "a system such as SlidingPoint")
    check(system)
    state = touching(system, beginning(system, q0, u0, start))
    if state.t < 0.0:
        raise ParameterError("start", f"must not be at a negative time, is at {state.t:.9g} s")
    t_end = arrays.positive(t_end, "t_end")
    if t_end <= state.t:
        raise ParameterError(
            "t_end", f"must lie after the time of start, {state.t:.9g} s, got {t_end:.9g}"
        )
    options = EventDriven(
        t_end=t_end,
        start=state,
        tolerance=tolerance,
        sample_every=sample_every,
        max_step=max_step,
        section=section,
        max_events=max_events,
    )
    plane_motion.check_rates(system, state.t, options.t_end)
    with reporter(progress, "s") as report:
        run, exception = _core.integrate(
            system._core,
            (state.t, options.t_end),
            state.q,
            state.u,
            options.tolerance,
            options.sample_every,
            options.max_step,
            None if section is None else (section.normal, section.level, section.after),
            options.max_events,
            report,
        )
    ended, contact = run.pop("ended"), run.pop("contact")
    unsolvable = run.pop("unsolvable", None)
    events = [
        Event(time, kind, number, phase, ambiguous=ambiguous)
        for time, number, kind, phase, ambiguous in run.pop("events")
    ]
    motion = Motion(
        **run,
        events=events,
        status=_ENDS.get(ended, Outcome.FAILED),
        labels=labels_of(system),
        origin=Origin(system, options),
    )
    if exception is not None:
        reached = f"after t = {motion.t[-1]:.9g} s" if len(motion) > 0 else "at the start"
        raise_with(exception, motion, reached)
    if motion.ambiguous_events:
        log.info(
            "integrate: at %d of %d events a contact might have done something else",
            motion.ambiguous_events,
            len(motion.events),
        )
    if ended in _FAILURES:
        time = float(motion.t[-1]) if len(motion) else 0.0
        found = {"ended": ended, "contact": contact, "time": time, "unsolvable": unsolvable}
        raise unfinished(found, system, motion)
    return motion


def touching(system: Model, state: State) -> State:
    """Return the state with contacts that overlap but touch moved apart.

    Those touch that do so by rounding of places, as in `simulate`. Its steps close a contact up to
    half a step late, and it stays as deep as it then is: in a state with the memory of contacts,
    which only steps leave, it touches if its gap is not positive.
    """
    bodies = system if state.contacts is None and isinstance(system, RigidBodies) else None
    if state.contacts is None and bodies is None:
        return state
    try:
        deepest = _core.deepest_overlap(system._core, state.t, state.q)
    except DimensionError:
        return state  # The run refuses the state by its name.
    if deepest is None or (bodies is not None and -deepest[1] > rounded_overlap(bodies, state.q)):
        return state
    q, touch = state.q, np.array(False)
    for _ in range(_CORRECTIONS):
        here = _core.evaluate(system._core, state.t, q, state.u)
        gaps = np.array([one.get("gap", 0.0) for one in here["contacts"]])
        touch = touch | (gaps < 0.0)
        factor = np.linalg.cholesky(here["mass"])
        normals = [here["contacts"][k]["normal"] for k in np.flatnonzero(touch)]
        rows = np.linalg.solve(factor, np.transpose(normals)).T
        way = np.linalg.lstsq(rows, -gaps[touch], rcond=None)[0]
        q = _core.advance(system._core, q, np.linalg.solve(factor.T, way), 1.0)
    return state.replace(q=q)


def check(system: Model) -> None:
    """Refuse systems whose coordinates do not have the velocities as rates."""
    if getattr(system, "_advances", False):
        raise ParameterError(
            "system", "must have its velocities as rates, but has its own `advance`"
        )


def unfinished(
    found: dict[str, Any], system: Model, motion: Motion | None = None
) -> ConvergenceError:
    """Return the error of an integration that has not come to its end, with the part before."""
    message, advice = _FAILURES[found["ended"]]
    details: dict[str, Any] = {
        "time": found["time"],
        "contact": found["contact"],
        "advice": advice,
        "trajectory": motion,
    }
    if found["ended"] == "no_solution":
        proven = without_solution(found.get("unsolvable"), system)
        return NoSolutionError(message, **details, **proven)
    return ConvergenceError(message, **details)
