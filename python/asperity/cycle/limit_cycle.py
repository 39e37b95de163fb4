"""Search for a limit cycle: follow the motion to the section until it recurs, then Newton."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike, NDArray

from asperity import _arrays, _core
from asperity._arrays import Array
from asperity.cycle.orbit import LimitCycle
from asperity.cycle.shooting import Return, ReturnMap, fixed_point
from asperity.errors import NoCycleError, ParameterError
from asperity.integrate import integrate
from asperity.motion import Motion, Section
from asperity.simulate import Model
from asperity.stability import Equilibrium, equilibrium, stability

Complex = NDArray[np.complex128]

# The motion is followed for at most so many of the longest periods of the linearised system, and
# for this part of the time before a section is chosen.
_LONGEST, _SETTLING = 200.0, 0.05
# Turns of a section that may make up one period.
_LOOPS = 6
# The motion is integrated so much more sharply than the cycle has to close.
_SHARPER = 0.05
# Newton's method begins when two passages are so close, in parts of the orbit's extent.
_RECURRENCE = 0.02
_PASSAGES = 200
# Samples of the period that a cycle keeps.
_SAMPLES = 1000
# Turns that agree so far are one period.
_SAME = 1e-6
# Orbits whose extent falls below this part of the first swing have died out.
_DIED_OUT = 1e-3
# Step of the central differences for the multipliers, in parts of the scale of the states.
_ASIDE = 1e-5
# Orbits that are by this share smaller or larger are tried.
_NEXT = 1e-2
# A multiplier that is one to this accuracy belongs to a continuum of periodic orbits.
_ISOLATED = 1e-4


def limit_cycle(
    system: Model,
    *,
    q0: ArrayLike | None = None,
    u0: ArrayLike | None = None,
    section: Section | None = None,
    t_end: float | None = None,
    near: LimitCycle | None = None,
    tolerance: float = 1e-9,
) -> LimitCycle:
    """Find a limit cycle: a fixed point x = P(x) of the return map of a section.

    The motion from (q₀, u₀) is followed until passages of the section recur, then Newton's method
    finds the fixed point. The motion is integrated phase by phase (`integrate`), not by time steps.

    Args:
        system: the system; its forces must not depend on time.
        q0: coordinates to start from, shape ``(n,)``. Default: the equilibrium.
        u0: velocities to start from, shape ``(n,)``. Default: those with which all contacts stick.
        section: hyperplane that the cycle passes once per turn. Default: the middle of the widest
            swing of a coordinate, in the sense in which slip is faster.
        t_end: longest time in s until the motion recurs. Default 200 times the longest period of
            the linearised system.
        near: cycle of a similar system; Newton's method starts from it at once.
        tolerance: largest ‖P(x) − x‖ in parts of the orbit's extent.

    Returns:
        The cycle, stable or not; from the motion's own recurrence only stable ones are found.

    Raises:
        NoCycleError: if the motion settles, does not recur, or if periodic orbits form a continuum
            (as the undamped ones of a mass that never stops sliding).

    Reference: [WL19] §4.3, Fig. 17; [LeineNijmeijer2004] ch. 8 on shooting in nonsmooth systems.

    >>> from asperity import FrictionLaw, MassOnBelt, Stribeck, limit_cycle
    >>> law = FrictionLaw.isotropic(1.0, dimension=1)
    >>> falling = law.replace(rate=Stribeck(1.0 / 3.0, shape="hyperbolic"))
    >>> cycle = limit_cycle(MassOnBelt(1.0, 1.0, falling, 1.0, [0.2]))
    >>> round(cycle.period, 6)
    12.001031
    """
    tolerance = _arrays.positive(tolerance, "tolerance")
    if near is not None:
        section, state = _middle(near.motion)
        scale, period = _extent(near.motion), near.period
    else:
        rest = equilibrium(system) if q0 is None or t_end is None else None
        q, u = _start(system, rest, q0, u0)
        horizon = _horizon(system, rest) if t_end is None else _arrays.positive(t_end, "t_end")
        if section is None:
            swing = integrate(system, t_end=_SETTLING * horizon, q0=q, u0=u)
            section = _middle(_second_half(swing))[0]
            q, u = swing.q[-1], swing.u[-1]
        scale, state, period = _recurring(system, section, q, u, horizon)
    returns = ReturnMap(system, section, scale, _SHARPER * tolerance)
    return _found(returns, state, period, tolerance)


def _found(returns: ReturnMap, state: Array, period: float, tolerance: float) -> LimitCycle:
    """Converge to the fixed point and measure the cycle."""
    fixed, iterations = fixed_point(returns, state, period, tolerance)
    fixed = _once_around(returns, fixed)
    dt = fixed.period / _SAMPLES
    closed = returns(fixed.state, fixed.period, dt=dt)
    if _has_died_out(closed.motion, returns.scale):
        raise NoCycleError("the motion settles at the equilibrium")
    multipliers = _multipliers(returns, fixed)
    return LimitCycle(
        closed.period,
        closed.motion,
        returns.section,
        multipliers,
        residual=returns.defect(fixed.state, closed.state),
        iterations=iterations,
    )


def _multipliers(returns: ReturnMap, fixed: Return) -> Complex:
    """Return the Floquet multipliers by falling modulus.

    Raises:
        NoCycleError: if there are periodic orbits next to this one.
    """
    ahead, behind = (returns.jacobian(fixed.state, fixed, step) for step in (_ASIDE, -_ASIDE))
    known = np.linalg.eigvals(0.5 * (ahead + behind))
    if np.abs(known - 1.0).min(initial=np.inf) < _ISOLATED or _has_neighbours(returns, fixed):
        raise NoCycleError(f"periodic orbits form a continuum, of period {fixed.period:.6g} s")
    # Deviations from contacts that stay closed or stick are gone at the next turn.
    multipliers = np.zeros(len(fixed.state) - 1, dtype=complex)
    multipliers[: len(known)] = known[np.argsort(-np.abs(known), kind="stable")]
    return multipliers


def _has_neighbours(returns: ReturnMap, fixed: Return) -> bool:
    """Whether a slightly smaller or larger orbit is periodic, too.

    The largest of the harmonic motions along γ is the rim of a continuum, where derivatives to
    both sides differ: multipliers do not show that.
    """
    motion = fixed.motion
    steps = np.diff(motion.t)[:, None]
    states = np.concatenate([motion.q, motion.u], axis=1)
    middle = (0.5 * (states[1:] + states[:-1]) * steps).sum(axis=0) / motion.t[-1]
    place = returns.place(fixed)
    for share in (1.0 - _NEXT, 1.0 + _NEXT):
        state = place.onto(middle + share * (fixed.state - middle))
        image = returns(state, fixed.period)
        if returns.defect(state, image.state) < _ISOLATED * returns.defect(state, fixed.state):
            return True
    return False


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


def _start(
    system: Model, rest: Equilibrium | None, q0: ArrayLike | None, u0: ArrayLike | None
) -> tuple[Array, Array]:
    """Return the initial state; by default everything sticks where the equilibrium is."""
    n = system.dof
    if q0 is not None:
        q = _arrays.array(q0, "q0", (n,))
    else:
        assert rest is not None
        q = rest.q
    if u0 is not None:
        return q, _arrays.array(u0, "u0", (n,))
    contacts = _core.evaluate(system._core, 0.0, q, np.zeros(n))["contacts"]
    rows = np.vstack([np.zeros((0, n)), *(contact["tangent"] for contact in contacts)])
    belts = np.concatenate([np.zeros(0), *(contact["velocity"] for contact in contacts)])
    return q, np.linalg.lstsq(rows, -belts, rcond=None)[0]


def _horizon(system: Model, rest: Equilibrium | None) -> float:
    frequencies = np.abs(stability(system, rest).eigenvalues.imag)
    frequencies = frequencies[frequencies > 1e-6 * frequencies.max(initial=0.0)]
    if not frequencies.size:
        raise ParameterError("t_end", "must be given where the equilibrium does not oscillate")
    return float(_LONGEST * 2.0 * np.pi / frequencies.min())


def _middle(motion: Motion) -> tuple[Section, Array]:
    """Return the section through the middle of the widest swing, and the state that passes it.

    Of all passages, in both senses, the one with the fastest slip is taken: where the contacts
    stick, the return map would be singular.
    """
    k = int(np.ptp(motion.q, axis=0).argmax())
    height = motion.q[:, k] - 0.5 * (motion.q[:, k].max() + motion.q[:, k].min())
    passages = np.flatnonzero(np.diff(np.signbit(height)))
    if not passages.size:
        raise NoCycleError("the motion does not oscillate: give q0, u0 that disturb it more")
    speed = np.nan_to_num(np.linalg.norm(motion.slip, axis=-1)).sum(axis=-1)
    at = int(passages[np.minimum(speed[passages], speed[passages + 1]).argmax()])
    share = height[at] / (height[at] - height[at + 1])
    states = np.concatenate([motion.q, motion.u], axis=-1)
    state = states[at] + share * (states[at + 1] - states[at])
    normal = np.zeros(states.shape[-1])
    normal[k] = np.sign(height[at + 1] - height[at])
    return Section(normal, float(normal @ state)), state


def _extent(motion: Motion) -> Array:
    """Return the extent of a motion in every state component; none is zero."""
    extents = []
    for series in (motion.q, motion.u):
        extent = np.ptp(series, axis=0)
        extents.append(np.maximum(extent, 1e-3 * extent.max()))
    return np.concatenate(extents)


def _recurring(
    system: Model, section: Section, q: Array, u: Array, t_end: float
) -> tuple[Array, Array, float]:
    """Return scale, state and period when the motion passes the section as it did before."""
    states: list[Array] = []
    times: list[float] = []
    t, scale = 0.0, None
    while len(states) < _PASSAGES and t < t_end:
        wait = 1e-3 * (times[-1] - times[-2] if len(times) > 1 else 0.0)
        motion = integrate(system, t_end=t_end - t, q0=q, u0=u, section=section.replace(after=wait))
        if not motion.at_section:
            if scale is not None and _has_died_out(_second_half(motion), scale):
                raise NoCycleError("the motion settles")
            break
        q, u, t = motion.q[-1], motion.u[-1], t + float(motion.t[-1])
        extent = _extent(motion)
        scale = extent if scale is None else np.maximum(scale, extent)
        if _has_died_out(motion, scale):
            raise NoCycleError("the motion settles")
        states.append(np.concatenate([q, u]))
        times.append(t)
        for back in range(2, min(_LOOPS + 2, len(states) + 1)):
            if np.abs((states[-1] - states[-back]) / extent).max() < _RECURRENCE:
                return scale, states[-1], times[-1] - times[-back]
    raise NoCycleError(
        f"the motion passes the section {len(states)} times in {t_end:.6g} s and does not recur"
    )


def _has_died_out(motion: Motion, scale: Array) -> bool:
    n = motion.q.shape[1]
    return bool((np.ptp(motion.q, axis=0) < _DIED_OUT * scale[:n]).all())


def _second_half(motion: Motion) -> Motion:
    half = motion.t >= 0.5 * motion.t[-1]
    return motion.slice(float(motion.t[half][0]), float(motion.t[-1]))
