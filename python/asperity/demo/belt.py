"""Fig. 17 of [WL19]: limit cycle of a mass on a moving belt."""

from dataclasses import dataclass

import matplotlib.pyplot as plt
import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from numpy.typing import NDArray

import asperity as asp
from asperity.demo.checks import Check

Array = NDArray[np.float64]

LAW = asp.FrictionLaw(asp.Ellipse(30.0, 10.0, angle=np.deg2rad(30.0)), asp.Ellipse(3.0, 1.0))
"""Reservoir C with semi-axes 30 N and 10 N at ζ = 30°, direction set D 3:1 along e₁."""

_DIRECTION = np.deg2rad(50.0)
# Deviations from the limit cycle change sign and shrink by 0.6 per period of 28.7 s.
_TRANSIENT = 600.0
_OBSERVED = 120.0


@dataclass(frozen=True)
class Cycle:
    """A motion that has reached its limit cycle, and what was measured on the cycle."""

    trajectory: asp.Trajectory
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


def system(speed: float = 1.0) -> asp.MassOnBelt:
    """Return the paper's system, m = 1 kg, k = 1 N/m; the belt moves at φ = 50°."""
    velocity = speed * np.array([np.cos(_DIRECTION), np.sin(_DIRECTION)])
    return asp.MassOnBelt(1.0, stiffness=1.0, law=LAW, normal_force=1.0, belt_velocity=velocity)


def run(dt: float = 1e-3) -> Cycle:
    """Simulate the belt at 1 m/s from rest and measure the limit cycle."""
    belt = system()
    t_end = _TRANSIENT + _OBSERVED
    motion = asp.simulate(belt, dt=dt, t_end=t_end).slice(_TRANSIENT, t_end)
    return measure(motion, float(belt.equilibrium[0]))


def measure(motion: asp.Trajectory, section: float) -> Cycle:
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
        raise asp.ParameterError("section", f"must be passed at least twice, got {section!r}")
    cycle = motion.slice(passages[-2], passages[-1])
    sticking = cycle.phase[:, 0] == asp.Phase.STICK
    return Cycle(
        trajectory=cycle,
        period=float((passages[-1] - passages[0]) / (len(passages) - 1)),
        lower=cycle.q.min(axis=0),
        upper=cycle.q.max(axis=0),
        stick_share=float(sticking.mean()),
        stick_drift=float(np.abs(cycle.slip[sticking, 0]).max(initial=0.0)),
    )


def checks(cycle: Cycle) -> list[Check]:
    """Compare with the converged values."""
    x_eq, y_eq = system().equilibrium
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


def draw(cycle: Cycle) -> Figure:
    """Draw the limit cycle, its forces within the reservoir and its coordinates over time."""
    once = cycle.trajectory
    with asp.plot.style():
        figure = plt.figure(figsize=(11.0, 7.4), layout="constrained")
        grid = figure.add_gridspec(2, 2, height_ratios=(1.8, 1.0))
        orbit = figure.add_subplot(grid[0, 0])
        asp.plot.plot_path(once, ax=orbit, contact=0)
        equilibrium = system().equilibrium
        orbit.plot(*equilibrium, "+", color="black", markersize=9, label="sliding equilibrium")
        orbit.set(title="Limit cycle", xlabel="$x$ in m", ylabel="$y$ in m")
        orbit.legend(loc="upper left")
        forces = figure.add_subplot(grid[0, 1])
        asp.plot.plot_forces_in_reservoir(once, law=LAW, ax=forces)
        forces.set_title("Friction force within the reservoir")
        _draw_time(once, figure.add_subplot(grid[1, :]))
        figure.suptitle(
            f"Mass on a belt, $v$ = 1 m/s at 50°: period {cycle.period:.3f} s, "
            f"sticking {cycle.stick_share:.1%}"
        )
    return figure


def _draw_time(once: asp.Trajectory, ax: Axes) -> None:
    time = once.t - once.t[0]
    for values, label in zip(once.q.T, ("$x$", "$y$"), strict=True):
        ax.plot(time, values, label=label)
    ax.margins(x=0.0)
    ax.set(xlabel="time in s", ylabel="coordinates in m", title="One period")
    ax.legend(loc="upper left", ncols=2)


def _upward_passages(t: Array, height: Array) -> Array:
    below = np.flatnonzero((height[:-1] < 0.0) & (height[1:] >= 0.0))
    share = height[below] / (height[below] - height[below + 1])
    return t[below] + share * (t[below + 1] - t[below])
