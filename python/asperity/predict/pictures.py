"""Pictures of a simulated scenario."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from asperity.plot import look, plot_history
from asperity.plot.look import style
from asperity.predict.bands import PredictionBands
from asperity.predict.kinds import Quantity
from asperity.predict.scenario import Scenario
from asperity.runs.run import Run
from asperity.status import Phase

# So many of the contacts that close are drawn.
_CONTACTS = 8


def paths(
    scenario: Scenario, run: Run, quantities: Sequence[Quantity], bands: PredictionBands | None
) -> Figure:
    """Draw what moves from above, and where it ends under the laws that were drawn."""
    with style():
        figure = Figure(figsize=(6.4 if bands is None else 9.6, 4.8), layout="constrained")
        found = scenario.kind.paths(scenario.setup()[0], run.q)
        if bands is None or bands.ends is None or bands.region is None:
            ax = figure.add_subplot()
        else:
            ax, near = figure.subplots(1, 2)
            near.plot(*(1e3 * bands.ends.T), ".", color=look.GREY, markersize=3.0)
            near.plot(*(1e3 * bands.region.outline().T), color=look.INK, linewidth=1.1)
            near.plot(*(1e3 * one.value for one in quantities[:2]), "o")
            near.set_title(
                f"{len(bands.ends)} drawn laws: ellipse of {100 * bands.confidence:g} % of the ends"
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


def history(scenario: Scenario, run: Run) -> Figure:
    """Draw positions over time, and friction forces with bars of stick, slip and open."""
    closed = np.flatnonzero(((run.phase == Phase.STICK) | (run.phase == Phase.SLIP)).any(axis=0))
    shown = closed[:_CONTACTS].tolist()
    with style():
        figure = Figure(figsize=(8.0, 5.4), layout="constrained")
        place, forces = figure.subplots(2, 1, sharex=True)
        found = scenario.kind.paths(scenario.setup()[0], run.q)
        for name, path in found.items():
            for axis, values in zip(("e1", "e2", "z"), path.T, strict=False):
                if len(found) == 1 or axis != "z":
                    label = axis if len(found) == 1 else f"{name}, {axis}"
                    place.plot(run.t, 1e3 * values, label=label)
        place.set_ylabel("position in mm")
        place.legend(ncols=2, fontsize="small")
        if shown:
            plot_history(run, quantity="friction", contacts=shown, ax=forces)
    return figure
