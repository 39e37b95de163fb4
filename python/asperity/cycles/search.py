"""Search for a limit cycle: follow the motion to the section until it recurs, then Newton."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np
from numpy.typing import ArrayLike

from asperity._base import arrays
from asperity._base.arrays import Array
from asperity._base.log import log
from asperity._base.progress import Progress, Report, reporter
from asperity.cycles.floquet import multipliers
from asperity.cycles.orbit import LimitCycle
from asperity.cycles.recurrence import (
    RECURRENCE,
    SAME_TURN,
    extent,
    has_died_out,
    later,
    middle,
    recurring,
    second_half,
)
from asperity.cycles.shooting import Return, ReturnMap, fixed_point
from asperity.cycles.start import dragged, longest_time, starts
from asperity.errors import NoCycleError, ParameterError
from asperity.runs.event_driven import integrate, touching
from asperity.runs.model import Model
from asperity.runs.run import Run
from asperity.runs.section import Section
from asperity.runs.state import State
from asperity.runs.time_stepping import beginning
from asperity.steady_sliding import Stability, equilibrium, stability
from asperity.system import RigidBodies

# The motion is followed for at most so many of the longest times of the linearised system, and for
# this part of it before a section is chosen.
_LONGEST, _SETTLING = 200.0, 0.05
# Turns of a section that may make up one period, and the accuracy to which they have to agree.
_LOOPS, _SAME = SAME_TURN, 1e-6
# The motion is integrated so much more sharply than the cycle has to close.
_SHARPER = 0.05
# Samples of the period that a cycle keeps.
_SAMPLES = 1000


def limit_cycle(
    system: Model,
    *,
    q0: ArrayLike | None = None,
    u0: ArrayLike | None = None,
    start: Run | State | None = None,
    section: Section | None = None,
    t_end: float | None = None,
    near: LimitCycle | None = None,
    tolerance: float = 1e-9,
    progress: Progress = None,
) -> LimitCycle:
    """Find a limit cycle: a fixed point x = P(x) of the return map of a section.

    The motion from (q₀, u₀) is followed until passages of the section recur, then Newton's method
    finds the fixed point. The motion is integrated phase by phase (`integrate`), not by time steps.

    Args:
        system: the system; its forces must not depend on time.
        q0: coordinates to start from, shape ``(n,)``. Default: the equilibrium; without `u0`
            several velocities are tried there, beginning with those with which all contacts stick.
        u0: velocities to start from, shape ``(n,)``. Default: those with which all contacts stick.
        start: a run or its ``end`` to start from, instead of `q0` and `u0`; its time is ignored.
        section: hyperplane that the cycle passes once per turn. Default: the middle of the widest
            swing of a coordinate, in the sense in which slip is faster.
        t_end: longest time in s until the motion recurs. Default 200 times the longest period of
            the linearised system and the longest stick.
        near: cycle of a similar system; Newton's method starts from it at once and keeps to its
            branch up to where that turns back. Excludes the other starts.
        tolerance: largest ‖P(x) − x‖ relative to the orbit's extent.
        progress: ``True`` for a bar of tqdm, or a function of (t, longest time) that is called a
            few times a second while the motion is followed; most recur long before the longest
            time, and each start begins at 0.

    Returns:
        The cycle, stable or not; the motion's own recurrence leads to stable ones, and to others
        that it passes closely. Its multipliers are accurate to about 1e-6.

    Raises:
        NoCycleError: if the motion settles, does not recur, or if periodic orbits form a continuum
            (as the undamped ones of a mass that never stops sliding). Also where there may be a
            cycle: beside an equilibrium whose deviations grow by less than 2 % per turn, as on
            very fast belts, turns of the spiral are not told from a cycle. Start near it then, by
            `q0`, `u0` and `section`, or continue that of a slower belt by `near`.
        ParameterError, ConvergenceError: as `integrate`, `equilibrium` and `stability`; the last
            two are not needed if `q0` or `start`, and `t_end`, are given.

    Reference: [WL19] §4.3, Fig. 17; [LeineNijmeijer2004] ch. 8 on shooting in nonsmooth systems.

    >>> from asperity import FrictionLaw, MassOnBelt, Stribeck, limit_cycle
    >>> law = FrictionLaw.isotropic(1.0, dimension=1)
    >>> falling = law.replace(rate=Stribeck(1.0 / 3.0, shape="hyperbolic"))
    >>> cycle = limit_cycle(
    ...     MassOnBelt(1.0, stiffness=1.0, law=falling, normal_force=1.0, belt_velocity=[0.2])
    ... )
    >>> round(cycle.period, 6)
    12.001031
    """
    tolerance = arrays.positive(tolerance, "tolerance")
    if isinstance(system, RigidBodies) and len(system.q0) != system.dof:
        raise ParameterError("system", "must have as many coordinates as velocities")
    if isinstance(system, RigidBodies) and system.depends_on_time:
        raise ParameterError(
            "system",
            "must not depend on time, as it does by a load, the length of a spring or a surface: "
            "a motion that returns to its state does not go on as before",
        )
    arrays.of_kind(section, "section", Section | None, "a Section or None")
    if near is not None:
        if any(given is not None for given in (q0, u0, start, section, t_end)):
            raise ParameterError("near", "excludes q0, u0, start, section and t_end")
        return _continued(system, near, tolerance)
    if start is not None:
        state = touching(system, beginning(system, q0, u0, start))
        q0, u0 = state.q, state.u
    horizon, states, growth = _beginnings(system, q0, u0, t_end)
    failure = None
    with reporter(progress, "s") as report:
        for q, u in states:
            try:
                return _followed(system, section, (q, u), horizon, tolerance, growth, report)
            except NoCycleError as error:
                log.info("limit_cycle: the motion from u0 = %s leads to none: %s", u, error)
                failure = failure or error
    assert failure is not None
    if 0.0 < growth < RECURRENCE:
        raise NoCycleError(
            "deviations from the unstable equilibrium grow by a share of only "
            f"{growth:.2g} per turn: the search does not tell turns of so slow a spiral from a "
            "cycle. Give q0, u0 and a section near it, or continue one of a slower belt by near="
        ) from failure
    raise failure


def _continued(system: Model, near: LimitCycle, tolerance: float) -> LimitCycle:
    arrays.of_kind(near, "near", LimitCycle, "a LimitCycle")
    if near.motion.q.shape[1] != system.dof:
        raise ParameterError("near", f"must be the cycle of a system with {system.dof} coordinates")
    section, state = middle(near.motion)
    returns = ReturnMap(system, section, extent(near.motion), _SHARPER * tolerance)
    found = _found(returns, state, near.period, tolerance, near)
    if found._is_positive != near._is_positive:
        raise NoCycleError(
            "the branch of the cycle near is lost: it may turn back before this system, of which a "
            f"cycle of another branch was found, of period {found.period:.6g} s"
        )
    return found


def _beginnings(
    system: Model, q0: ArrayLike | None, u0: ArrayLike | None, t_end: float | None
) -> tuple[float, Iterator[tuple[Array, Array]], float]:
    """Return the longest time, the states to start from, and the growth per turn beside rest.

    The growth is that of the linearised motion, zero where it is not known or does not turn.
    """
    n = system.dof
    state = (
        None
        if q0 is not None and t_end is not None
        else stability(system, equilibrium=equilibrium(system))
    )
    growth = 0.0 if state is None else _growth_per_turn(state)
    if t_end is not None:
        horizon = arrays.positive(t_end, "t_end")
    else:
        assert state is not None
        horizon = _LONGEST * longest_time(system, state)
    if q0 is None and u0 is None:
        assert state is not None
        return horizon, starts(system, state), growth
    if q0 is None:
        assert state is not None
        q = state.equilibrium.q
    else:
        q = arrays.array(q0, "q0", (n,))
    u = dragged(system, q) if u0 is None else arrays.array(u0, "u0", (n,))
    return horizon, iter([(q, u)]), growth


def _growth_per_turn(state: Stability) -> float:
    """Return by which share deviations are larger a turn later if they leave in a spiral.

    It is zero where the equilibrium is not unstable beyond rounding, or where the fastest growing
    deviation does not turn: the motion has left long before another one has grown.
    """
    fastest = state.eigenvalues[int(state.eigenvalues.real.argmax())]
    if state.kind != "unstable" or abs(fastest.imag) <= abs(fastest.real):
        return 0.0
    return float(np.expm1(2.0 * np.pi * fastest.real / abs(fastest.imag)))


def _followed(
    system: Model,
    section: Section | None,
    start: tuple[Array, Array],
    horizon: float,
    tolerance: float,
    growth: float,
    report: Report | None,
) -> LimitCycle:
    """Follow the motion until it recurs and converge to the cycle."""
    q, u = start
    if section is None:
        swing = integrate(
            system, t_end=_SETTLING * horizon, q0=q, u0=u, progress=later(report, 0.0, horizon)
        )
        section = middle(second_half(swing))[0]
        q, u = swing.q[-1], swing.u[-1]
    scale, state, period = recurring(
        system, section, q, u, t_end=horizon, growth=growth, report=report
    )
    returns = ReturnMap(system, section, scale, _SHARPER * tolerance)
    return _found(returns, state, period, tolerance)


def _found(
    returns: ReturnMap,
    state: Array,
    period: float,
    tolerance: float,
    near: LimitCycle | None = None,
) -> LimitCycle:
    """Converge to the fixed point and measure the cycle."""
    fixed, iterations = fixed_point(returns, state, period, tolerance, near)
    fixed = _once_around(returns, fixed)
    closed = returns(fixed.state, fixed.period, dt=fixed.period / _SAMPLES)
    if has_died_out(closed.motion, returns.scale):
        raise NoCycleError("the motion settles at the equilibrium")
    return LimitCycle(
        closed.period,
        closed.motion,
        returns.section,
        multipliers(returns, Return(fixed.state, closed.period, closed.motion), tolerance),
        residual=returns.defect(fixed.state, closed.state),
        iterations=iterations,
    )


def _once_around(returns: ReturnMap, fixed: Return) -> Return:
    """Return the fixed point with its shortest period."""
    for turns in range(_LOOPS, 1, -1):
        try:
            image = returns(fixed.state, fixed.period / turns)
        except NoCycleError:
            continue
        same = returns.defect(fixed.state, image.state) <= _SAME
        if same and abs(turns * image.period - fixed.period) <= _SAME * fixed.period:
            return Return(fixed.state, image.period, image.motion)
    return fixed
