"""Motions that pass a section again and again until they recur."""

from __future__ import annotations

import numpy as np

from asperity._base.arrays import Array
from asperity._base.progress import Report
from asperity.errors import NoCycleError
from asperity.runs.event_driven import integrate
from asperity.runs.model import Model
from asperity.runs.motion import Motion
from asperity.runs.section import Section

SAME_TURN = 6
"""Turns of a section that may make up one period."""

RECURRENCE = 0.02
"""Newton's method begins when two passages are so close, relative to the orbit's extent."""

_PASSAGES = 200
# Passages that recur are this many times closer than the turns of a spiral grow.
_WITHIN_A_SPIRAL = 8.0
# Orbits whose extent falls below this part of the first swing have died out.
_DIED_OUT = 1e-3
# A coordinate that hardly moves is compared with this part of the largest extent.
_LEAST_EXTENT = 0.1


def recurring(
    system: Model,
    section: Section,
    q: Array,
    u: Array,
    *,
    t_end: float,
    growth: float = 0.0,
    report: Report | None = None,
) -> tuple[Array, Array, float]:
    """Return scale, state and period when the motion passes the section as it did before.

    Where deviations from an equilibrium grow by the share `growth` per turn, passages of such a
    spiral differ by half of it relative to the extent: closer ones are asked for.
    """
    close = min(RECURRENCE, growth / _WITHIN_A_SPIRAL) if growth > 0.0 else RECURRENCE
    states: list[Array] = []
    times: list[float] = []
    t, scale = 0.0, None
    while len(states) < _PASSAGES and t < t_end:
        wait = 1e-3 * (times[-1] - times[-2] if len(times) > 1 else 0.0)
        motion = integrate(
            system,
            t_end=t_end - t,
            q0=q,
            u0=u,
            section=section.replace(after=wait),
            progress=later(report, t, t_end),
        )
        if not motion.at_section:
            reached = extent(motion) if scale is None else scale
            if has_died_out(second_half(motion), reached):
                raise NoCycleError("the motion settles")
            break
        q, u, t = motion.q[-1], motion.u[-1], t + float(motion.t[-1])
        size = extent(motion)
        scale = size if scale is None else np.maximum(scale, size)
        if has_died_out(motion, scale):
            raise NoCycleError("the motion settles")
        states.append(np.concatenate([q, u]))
        times.append(t)
        for back in range(2, min(SAME_TURN + 2, len(states) + 1)):
            if np.abs((states[-1] - states[-back]) / size).max() < close:
                return scale, states[-1], times[-1] - times[-back]
    raise NoCycleError(
        f"the motion passes the section {len(states)} times in {t_end:.6g} s and does not recur: "
        "try a larger t_end or another start"
    )


def later(report: Report | None, begin: float, t_end: float) -> Report | None:
    """Return what reports the progress of an integration that begins at a later time."""
    if report is None:
        return None
    return lambda t, _: report(begin + t, t_end)


def middle(motion: Motion) -> tuple[Section, Array]:
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


def extent(motion: Motion) -> Array:
    """Return the extent of a motion in every state component; none is zero."""
    extents = []
    for series in (motion.q, motion.u):
        size = np.ptp(series, axis=0)
        extents.append(np.maximum(size, _LEAST_EXTENT * size.max()))
    return np.concatenate(extents)


def has_died_out(motion: Motion, scale: Array) -> bool:
    """Whether hardly anything is left of a motion with the extent `scale`."""
    n = motion.q.shape[1]
    return bool((np.ptp(motion.q, axis=0) < _DIED_OUT * scale[:n]).all())


def second_half(motion: Motion) -> Motion:
    """Return the second half of a motion."""
    half = motion.t >= 0.5 * motion.t[-1]
    return motion.slice(float(motion.t[half][0]), float(motion.t[-1]))
