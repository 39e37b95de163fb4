"""Figures of friction coefficients over turns, and of hysteresis loops."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
from matplotlib.figure import Figure

from asperity.plot.look import BLUE, INK, style

if TYPE_CHECKING:
    from asperity.identify.evidence.coefficient.result import FrictionCoefficient, Loop

# More runs, or longer lines of names, have no room above the figure.
_NAMED, _LETTERS = 8, 100


def turns_figure(found: FrictionCoefficient) -> Figure:
    """Return the figure of the coefficient over the turns or strokes of all runs."""
    with style():
        figure = Figure(figsize=(8.0, 3.6), layout="constrained")
        word = "turn" if found.processed.goes_round else "stroke"
        ax = figure.add_subplot(xlabel=word, ylabel=r"friction coefficient $l_t/\lambda_N$")
        turns = found.over_turns
        for number, name in enumerate(found.names):
            at = np.flatnonzero(turns.run == number)
            ax.plot(at, turns.coefficient[at], ".-", markersize=4, linewidth=0.8, label=name)
        if 1 < len(found.names) <= _NAMED:
            columns = _LETTERS // (max(map(len, found.names)) + 8)
            figure.legend(loc="outside upper center", ncols=min(max(columns, 1), 4))
        elif len(found.names) > 1:
            ax.set_xlabel(f"{word}s of {len(found.names)} runs, in the order of the table")
    return figure


def loop_figure(loop: Loop, place: str) -> Figure:
    """Return the figure of a hysteresis loop."""
    with style():
        figure = Figure(figsize=(6.4, 4.4), layout="constrained")
        ax = figure.add_subplot(xlabel=place, ylabel=r"force per unit normal force")
        ax.plot(loop.position, loop.forwards, color=BLUE, label="forwards")
        ax.plot(loop.position, loop.backwards, color=INK, label="backwards")
        ax.legend()
    return figure
