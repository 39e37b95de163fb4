"""The figures of the demo."""

from __future__ import annotations

from collections.abc import Sequence

import matplotlib.pyplot as plt
import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from asperity.paper import fig17, fig27
from asperity.plot import plot_forces_in_reservoir, plot_path
from asperity.plot.look import GREY, style
from asperity.runs.trajectory import Trajectory


def draw_fig17(cycle: fig17.LimitCycle) -> Figure:
    """Draw the limit cycle, its forces within the reservoir and its coordinates over time."""
    once = cycle.trajectory
    with style():
        figure = plt.figure(figsize=(11.0, 7.4), layout="constrained")
        grid = figure.add_gridspec(2, 2, height_ratios=(1.8, 1.0))
        orbit = figure.add_subplot(grid[0, 0])
        plot_path(once, ax=orbit, contact=0)
        equilibrium = fig17.system().equilibrium
        orbit.plot(*equilibrium, "+", color="black", markersize=9, label="sliding equilibrium")
        orbit.set(title="Limit cycle", xlabel="$x$ in m", ylabel="$y$ in m")
        orbit.legend(loc="upper left")
        forces = figure.add_subplot(grid[0, 1])
        plot_forces_in_reservoir(once, law=fig17.LAW, ax=forces)
        forces.set_title("Friction force within the reservoir")
        _draw_time(once, figure.add_subplot(grid[1, :]))
        figure.suptitle(
            f"Mass on a belt, $v$ = 1 m/s at 50°: period {cycle.period:.3f} s, "
            f"sticking {cycle.stick_share:.1%}"
        )
    return figure


def _draw_time(once: Trajectory, ax: Axes) -> None:
    time = once.t - once.t[0]
    for values, label in zip(once.q.T, ("$x$", "$y$"), strict=True):
        ax.plot(time, values, label=label)
    ax.margins(x=0.0)
    ax.set(xlabel="time in s", ylabel="coordinates in m", title="One period")
    ax.legend(loc="upper left", ncols=2)


def draw_fig27(paths: Sequence[fig27.SlidingPath]) -> Figure:
    """Draw the sliding paths of the four laws, one panel per initial direction."""
    with style():
        figure, panels = plt.subplots(
            1,
            len(fig27.ANGLES),
            figsize=(11.0, 6.0),
            layout="constrained",
            sharex=True,
            sharey=True,
        )
        for ax, angle in zip(panels, fig27.ANGLES, strict=True):
            chosen = [path for path in paths if path.angle == angle]
            for path in chosen:
                motion = path.trajectory
                plot_path(motion.replace(q=1e3 * motion.q), ax=ax, label=path.law)
            reach = max(np.hypot(*path.end) for path in chosen)
            direction = np.deg2rad(angle)
            ax.plot(
                [0.0, reach * np.cos(direction)],
                [0.0, reach * np.sin(direction)],
                color=GREY,
                linewidth=0.9,
                linestyle=":",
                zorder=1,
            )
            ax.set(
                title=f"{angle:.0f}° from the transverse axis",
                xlabel="$x$ across the grooves in mm",
                ylabel="$y$ along the grooves in mm",
            )
            ax.label_outer()
        figure.suptitle("Sliding path of a PVC disk on ground steel, $v_0$ = 1.52 m/s")
        handles, labels = panels[0].get_legend_handles_labels()
        figure.legend(handles, labels, loc="outside lower center", ncols=2)
    return figure
