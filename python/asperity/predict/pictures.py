"""Pictures of a simulated scenario."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from asperity.plot import look
from asperity.plot.look import style
from asperity.status import Phase

if TYPE_CHECKING:
    from asperity.predict.simulation import Simulation

_PHASES = {Phase.STICK: "stick", Phase.SLIP: "slip", Phase.OPEN: "open"}
# So many of the contacts that close are drawn.
_CONTACTS = 8


def paths(simulation: Simulation) -> Figure:
    """Draw what moves from above, and where it ends under the laws that were drawn."""
    scenario, bands = simulation.scenario, simulation.bands
    with style():
        figure = Figure(figsize=(6.4 if bands is None else 9.6, 4.8), layout="constrained")
        found = scenario.kind.paths(scenario.setup().system, simulation.run)
        if bands is None or bands.ends is None or bands.region is None:
            ax = figure.add_subplot()
        else:
            ax, near = figure.subplots(1, 2)
            near.plot(*(1e3 * bands.ends.T), ".", color=look.GREY, markersize=3.0)
            near.plot(*(1e3 * bands.region.outline().T), color=look.INK, linewidth=1.1)
            near.plot(
                1e3 * simulation.quantities[0].value, 1e3 * simulation.quantities[1].value, "o"
            )
            near.set_title(
                f"end points of {len(bands.ends)} drawn laws, "
                f"{100 * bands.confidence:g} % within the ellipse"
            )
            _label(near)
        for name, path in found.items():
            (line,) = ax.plot(1e3 * path[:, 0], 1e3 * path[:, 1], label=name)
            ax.plot(*(1e3 * path[0, :2]), "o", color=line.get_color(), markerfacecolor="white")
            ax.plot(*(1e3 * path[-1, :2]), "o", color=line.get_color())
        if len(found) > 1:
            ax.legend()
        ax.set_title(scenario.title)
        _label(ax)
    return figure


def _label(ax: Axes) -> None:
    ax.set_aspect("equal", adjustable="datalim")
    ax.set_xlabel("along e1 in mm")
    ax.set_ylabel("along e2 in mm")


def history(simulation: Simulation) -> Figure:
    """Draw positions and friction forces over time, and below what the contacts do."""
    scenario, run = simulation.scenario, simulation.run
    found = scenario.kind.paths(scenario.setup().system, run)
    with style():
        figure = Figure(figsize=(6.4, 5.4), layout="constrained")
        closed = np.flatnonzero(
            ((run.phase == Phase.STICK) | (run.phase == Phase.SLIP)).any(axis=0)
        )
        shown = [int(contact) for contact in closed[:_CONTACTS]]
        heights = [3.0, 2.0, 0.4 + 0.2 * len(shown)]
        place, forces, phases = figure.subplots(3, 1, sharex=True, height_ratios=heights)
        for name, path in found.items():
            for axis, values in zip(("e1", "e2", "z"), path.T, strict=False):
                if len(found) == 1 or axis != "z":
                    label = axis if len(found) == 1 else f"{name}, {axis}"
                    place.plot(run.t, 1e3 * values, label=label)
        place.set_ylabel("position in mm")
        place.legend(ncols=2, fontsize="small")
        for contact in shown:
            size = np.linalg.norm(np.nan_to_num(run.force[:, contact]), axis=-1)
            # The first sample of time stepping has no force.
            forces.plot(run.t[1:], size[1:], label=f"contact {contact}")
        forces.set_ylabel("friction in N")
        colours = {Phase.STICK: look.STICK, Phase.SLIP: look.SLIP, Phase.OPEN: look.OPEN}
        for phase, name in _PHASES.items():
            for row, contact in enumerate(shown):
                on = run.phase[:, contact] == phase
                phases.fill_between(
                    run.t,
                    row - 0.4,
                    row + 0.4,
                    where=on,
                    step="pre",
                    color=colours[phase],
                    linewidth=0.0,
                    label=name if row == 0 else None,
                )
        phases.set_yticks(range(len(shown)), [str(contact) for contact in shown])
        phases.set_ylabel("contact")
        phases.set_xlabel("time in s")
        phases.legend(ncols=3, fontsize="small", loc="lower left", bbox_to_anchor=(0.0, 1.0))
    return figure
