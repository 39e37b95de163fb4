"""Fig. 17 of [WL19] by shooting: the limit cycle and its friction forces."""

from __future__ import annotations

import numpy as np
from matplotlib.axes import Axes

from asperity.cycles import LimitCycle, limit_cycle
from asperity.paper import fig17 as stepped
from asperity.paper.checks import Check
from asperity.paper.data import Curves
from asperity.paper.redrawn import Redrawn, drawn, panels, record
from asperity.plot import plot_forces_in_reservoir, plot_path
from asperity.plot.look import INK, SLIDING, draw_arrows, style
from asperity.runs.time_stepping import simulate
from asperity.status import Phase

# Crosses on the orbit and arrows at the forces, evenly spaced in time.
_MARKS, _ARROWS = 80, 50
# The transient of the time stepping shrinks by 0.6 per turn.
_TURNS = 30


def fig17() -> Redrawn:
    """Draw (a) the orbit and (b) forces and relative velocities of the mass on the belt."""
    belt = stepped.system()
    cycle = limit_cycle(belt)
    figure, axes = panels(
        17, "limit cycle, belt at 50°", 2, figsize=(11.0, 5.4), parameters="parameters of §4.3"
    )
    curves = Curves()
    with style():
        _draw_orbit(curves, cycle, belt.equilibrium, axes[0])
        _draw_forces(curves, cycle, axes[1])
    return Redrawn(figure, curves, _checks(cycle))


def _every(cycle: LimitCycle, marks: int) -> np.ndarray:
    times = cycle.period * np.arange(marks) / marks
    return np.unique(np.searchsorted(cycle.motion.t, times).clip(0, len(cycle.motion.t) - 1))


def _draw_orbit(curves: Curves, cycle: LimitCycle, rest: np.ndarray, ax: Axes) -> None:
    plot_path(cycle, ax=ax, contact=0)
    at = _every(cycle, _MARKS)
    (marks,) = ax.plot(*cycle.motion.q[at].T, "x", color=INK, markersize=3.5)
    (equilibrium,) = ax.plot(*rest, "+", color=INK, markersize=10.0, label="equilibrium")
    curves.add("a", "orbit", cycle.motion.q)
    record(curves, "a", "equal times", [marks])
    record(curves, "a", "equilibrium", [equilibrium])
    ax.set(title=f"(a) orbit, period {cycle.period:.6f} s", xlabel="$x$ in m", ylabel="$y$ in m")
    ax.legend(loc="upper left", frameon=False)


def _draw_forces(curves: Curves, cycle: LimitCycle, ax: Axes) -> None:
    outline, *_ = drawn(plot_forces_in_reservoir, cycle, ax, law=stepped.LAW)
    record(curves, "b", "bdry C", [outline])
    force, slip = -cycle.motion.force[:, 0], cycle.motion.slip[:, 0]
    curves.add("b", "force", force)
    at = _every(cycle, _ARROWS)
    at = at[cycle.motion.phase[at, 0] == Phase.SLIP]
    arrows = draw_arrows(ax, force[at], 1.2 * slip[at], color=SLIDING)
    record(curves, "b", "relative velocity", [arrows])
    ax.set_title("(b) friction force and relative velocity")


def _checks(cycle: LimitCycle) -> list[Check]:
    lower, upper, share = cycle.minimum, cycle.maximum, cycle.share(Phase.STICK)
    belt, start = stepped.system(), {"q0": cycle.motion.q[0], "u0": cycle.motion.u[0]}
    dt = 1e-3
    motion = simulate(belt, dt=dt, t_end=_TURNS * cycle.period, **start)
    rest = float(belt.equilibrium[0])
    turns = stepped.measure(motion.slice(10.0 * cycle.period, float(motion.t[-1])), rest)
    return [
        Check("Fig. 17 period", 28.703, cycle.period, 2e-3, "s"),
        Check("Fig. 17 smallest x", 13.093, float(lower[0]), 2e-3, "m"),
        Check("Fig. 17 largest x", 26.918, float(upper[0]), 2e-3, "m"),
        Check("Fig. 17 smallest y", -4.148, float(lower[1]), 2e-3, "m"),
        Check("Fig. 17 largest y", 15.565, float(upper[1]), 2e-3, "m"),
        Check("Fig. 17 share of sticking", 0.689, share, 1e-3),
        Check("Fig. 17 orbit closes", 0.0, cycle.residual, 1e-8),
        Check("Fig. 17 largest multiplier below 1", 1.0, float(cycle.is_stable), 0.0),
        Check(f"Fig. 17 period in time steps of {dt:g} s", cycle.period, turns.period, 0.02, "s"),
    ]
