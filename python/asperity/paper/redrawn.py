"""What a redrawn figure of [WL19] consists of, and the frame that all of them share."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import matplotlib.pyplot as plt
import numpy as np
from matplotlib.artist import Artist
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from asperity._arrays import Array
from asperity.paper.checks import Check
from asperity.paper.data import Curves
from asperity.plot.look import GREY, INK, style


@dataclass(frozen=True)
class Redrawn:
    """A figure, its data and the checks of what the paper states with it."""

    figure: Figure
    curves: Curves
    checks: list[Check]


def panels(number: int, title: str, count: int, **kwargs: Any) -> tuple[Figure, Sequence[Axes]]:
    """Return a figure with `count` panels in a row."""
    look = {"figsize": (4.6 * count, 4.6), "layout": "constrained", "squeeze": False, **kwargs}
    with style():
        figure, axes = plt.subplots(1, count, **look)
        figure.suptitle(f"Fig. {number} of Walker & Leine (2019), redrawn: {title}", color=INK)
    return figure, axes[0]


def shared_legend(figure: Figure, axes: Sequence[Axes], *, columns: int = 4) -> None:
    """Draw one legend below all panels; a label that occurs twice is shown once."""
    entries: dict[str, Artist] = {}
    for ax in axes:
        for handle, label in zip(*ax.get_legend_handles_labels(), strict=True):
            entries.setdefault(label, handle)
    figure.legend(
        list(entries.values()),
        list(entries),
        loc="outside lower center",
        ncols=min(columns, len(entries)),
        frameon=False,
    )


def bare(ax: Axes) -> None:
    """Hide the axes of a schematic drawing, not its title."""
    ax.set_aspect("equal")
    ax.grid(False)
    ax.set(xticks=[], yticks=[])
    for spine in ax.spines.values():
        spine.set_visible(False)


def note(
    ax: Axes, text: str, point: Array, offset: tuple[float, float] = (0.0, 0.0), **kwargs: Any
) -> None:
    """Write a text at a point, moved by `offset` in units of 1/72 inch."""
    x, y = point
    look = {"textcoords": "offset points", "color": INK, **kwargs}
    ax.annotate(text, (float(x), float(y)), offset, **look)


def cross(ax: Axes) -> None:
    """Draw the two axes through the origin."""
    ax.axhline(0.0, color=GREY, linewidth=0.7, zorder=0.9)
    ax.axvline(0.0, color=GREY, linewidth=0.7, zorder=0.9)


def circle(n: int) -> Array:
    """Return n angles, none of them on an axis of symmetry."""
    return 2.0 * np.pi * (np.arange(n) + 0.37) / n
