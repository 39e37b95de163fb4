"""Figure 17: The limit cycle
=============================

What does the mass do where steady sliding is unstable? It sticks and slips on a limit cycle, found
here by shooting and compared with time stepping.
"""

import asperity as asp
import numpy as np
from asperity.demo import Check
from asperity.demo import belt as stepped
from asperity.plot import plot_forces_in_reservoir, plot_path
from matplotlib.axes import Axes
from paper.curves import named
from paper.drawing import INK, SLIDING, draw_arrows
from paper.frame import Redrawn, drawn, panels, show

# Crosses on the orbit and arrows at the forces, evenly spaced in time.
_MARKS, _ARROWS = 80, 50

# The transient of the time stepping shrinks by 0.6 per turn.
_TURNS = 30


def _every(cycle: asp.LimitCycle, marks: int) -> np.ndarray:
    times = cycle.period * np.arange(marks) / marks
    return np.unique(np.searchsorted(cycle.motion.t, times).clip(0, len(cycle.motion.t) - 1))


def _draw_orbit(cycle: asp.LimitCycle, rest: np.ndarray, ax: Axes) -> None:
    plot_path(cycle, ax=ax, contact=0)
    at = _every(cycle, _MARKS)
    ax.plot(*cycle.motion.q[at].T, "x", color=INK, markersize=3.5, gid="equal times")
    ax.plot(*rest, "+", color=INK, markersize=10.0, label="equilibrium")
    ax.set(title=f"(a) orbit, period {cycle.period:.6f} s", xlabel="$x$ in m", ylabel="$y$ in m")
    ax.legend(loc="upper left", frameon=False)


def _draw_forces(cycle: asp.LimitCycle, ax: Axes) -> None:
    outline, *_ = drawn(plot_forces_in_reservoir, cycle, ax, law=stepped.LAW)
    named("bdry C", [outline])
    force, slip = -cycle.motion.force[:, 0], cycle.motion.slip[:, 0]
    at = _every(cycle, _ARROWS)
    at = at[cycle.motion.phase[at, 0] == asp.Phase.SLIP]
    draw_arrows(ax, force[at], 1.2 * slip[at], color=SLIDING, gid="relative velocity")
    ax.set_title("(b) friction force and relative velocity")


def _checks(cycle: asp.LimitCycle) -> list[Check]:
    lower, upper, share = cycle.minimum, cycle.maximum, cycle.share(asp.Phase.STICK)
    belt, start = stepped.system(), {"q0": cycle.motion.q[0], "u0": cycle.motion.u[0]}
    dt = 1e-3
    motion = asp.simulate(belt, dt=dt, t_end=_TURNS * cycle.period, **start)
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


def draw() -> Redrawn:
    """Draw (a) the orbit and (b) forces and relative velocities of the mass on the belt."""
    belt = stepped.system()
    cycle = asp.limit_cycle(belt)
    figure, axes = panels(
        17, "limit cycle, belt at 50°", 2, figsize=(11.0, 5.4), parameters="parameters of §4.3"
    )
    _draw_orbit(cycle, belt.equilibrium, axes[0])
    _draw_forces(cycle, axes[1])
    data = [("a", "orbit", cycle.motion.q), ("b", "force", -cycle.motion.force[:, 0])]
    return Redrawn(figure, _checks(cycle), data)


# %%
if __name__ == "__main__":
    show(draw)
