"""Fig. 17 of [WL19]: limit cycle of a mass on a moving belt."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from asperity._base.arrays import Array
from asperity.errors import ParameterError
from asperity.law import FrictionLaw
from asperity.paper.checks import Check
from asperity.runs.time_stepping import simulate
from asperity.runs.trajectory import Trajectory
from asperity.sets import Ellipse
from asperity.status import Phase
from asperity.system import MassOnBelt

LAW = FrictionLaw(Ellipse(30.0, 10.0, angle=np.deg2rad(30.0)), Ellipse(3.0, 1.0))
"""Reservoir C with semi-axes 30 N and 10 N at ζ = 30°, direction set D 3:1 along e₁."""

_DIRECTION = np.deg2rad(50.0)
# Deviations from the limit cycle change sign and shrink by 0.6 per period of 28.7 s.
_TRANSIENT = 600.0
_OBSERVED = 120.0


@dataclass(frozen=True)
class LimitCycle:
    """A motion that has reached its limit cycle, and what was measured on the cycle."""

    trajectory: Trajectory
    """The last whole cycle."""
    period: float
    """Mean time between passages of the section, in s."""
    lower: Array
    """Least coordinates in m."""
    upper: Array
    """Greatest coordinates in m."""
    stick_share: float
    """Share of the period in which the mass sticks to the belt."""
    stick_drift: float
    """Largest relative velocity in any component while sticking, in m/s."""


def system(speed: float = 1.0) -> MassOnBelt:
    """Return the paper's system, m = 1 kg, k = 1 N/m; the belt moves at φ = 50°."""
    velocity = speed * np.array([np.cos(_DIRECTION), np.sin(_DIRECTION)])
    return MassOnBelt(1.0, stiffness=1.0, law=LAW, normal_force=1.0, belt_velocity=velocity)


def run(dt: float = 1e-3) -> LimitCycle:
    """Simulate the belt at 1 m/s from rest and measure the limit cycle."""
    belt = system()
    t_end = _TRANSIENT + _OBSERVED
    motion = simulate(belt, dt=dt, t_end=t_end).slice(_TRANSIENT, t_end)
    return measure(motion, float(belt.equilibrium[0]))


def measure(motion: Trajectory, section: float) -> LimitCycle:
    """Measure the last cycle between the passages through q₁ = `section` with rising q₁.

    The times of passage are interpolated linearly between samples, so that the period is not
    rounded to the sampling interval.

    Args:
        motion: several cycles without transients.
        section: value of q₁ in m that is passed upwards once per cycle.

    Raises:
        ParameterError: if there is no whole cycle.
    """
    passages = _upward_passages(motion.t, motion.q[:, 0] - section)
    if len(passages) < 2:
        raise ParameterError("section", f"must be passed at least twice, got {section!r}")
    cycle = motion.slice(passages[-2], passages[-1])
    sticking = cycle.phase[:, 0] == Phase.STICK
    return LimitCycle(
        trajectory=cycle,
        period=float((passages[-1] - passages[0]) / (len(passages) - 1)),
        lower=cycle.q.min(axis=0),
        upper=cycle.q.max(axis=0),
        stick_share=float(sticking.mean()),
        stick_drift=float(np.abs(cycle.slip[sticking, 0]).max(initial=0.0)),
    )


def checks(cycle: LimitCycle, belt: MassOnBelt) -> list[Check]:
    """Compare with the converged values."""
    x_eq, y_eq = belt.equilibrium
    return [
        Check("Fig. 17 equilibrium x", 20.201550, float(x_eq), 1e-6, "m"),
        Check("Fig. 17 equilibrium y", 2.675030, float(y_eq), 1e-6, "m"),
        Check("Fig. 17 period", 28.703, cycle.period, 0.02, "s"),
        Check("Fig. 17 smallest x", 13.093, float(cycle.lower[0]), 0.02, "m"),
        Check("Fig. 17 largest x", 26.918, float(cycle.upper[0]), 0.02, "m"),
        Check("Fig. 17 smallest y", -4.148, float(cycle.lower[1]), 0.02, "m"),
        Check("Fig. 17 largest y", 15.565, float(cycle.upper[1]), 0.02, "m"),
        Check("Fig. 17 share of sticking", 0.689, cycle.stick_share, 0.005),
        Check("Fig. 17 drift in stick", 0.0, cycle.stick_drift, 1e-12, "m/s"),
    ]


def _upward_passages(t: Array, height: Array) -> Array:
    below = np.flatnonzero((height[:-1] < 0.0) & (height[1:] >= 0.0))
    share = height[below] / (height[below] - height[below + 1])
    passages: Array = t[below] + share * (t[below + 1] - t[below])
    return passages
