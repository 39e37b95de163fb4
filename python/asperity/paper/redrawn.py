"""What a redrawn figure of [WL19] consists of, and the frame that all of them share."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Any

import matplotlib.pyplot as plt
import numpy as np
from matplotlib.artist import Artist
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from matplotlib.quiver import Quiver
from matplotlib.text import Annotation

from asperity._base.arrays import Array
from asperity.law import FrictionLaw
from asperity.paper.checks import Check
from asperity.paper.data import Curves
from asperity.plot import plot_law
from asperity.plot.look import GREY, INK, style


@dataclass(frozen=True)
class Redrawn:
    """A figure, its data and the checks of what the paper states with it."""

    figure: Figure
    curves: Curves
    checks: list[Check]


OWN = "own parameters: the paper gives none"
"""What a figure says of its parameters unless the paper gives them."""


# Inches beside, above and below what a figure holds.
_SIDE, _ABOVE = 0.14, 0.08


def panels(
    number: int, title: str, count: int, *, parameters: str = OWN, **kwargs: Any
) -> tuple[Figure, Sequence[Axes]]:
    """Return a figure with `count` panels in a row, which says where its parameters come from."""
    look = {"figsize": (4.6 * count, 4.6), "layout": "constrained", "squeeze": False, **kwargs}
    with style():
        figure, axes = plt.subplots(1, count, **look)
        heading(figure, number, title, parameters)
    # The default leaves labels at the edge of the image, where equal scales move them over it.
    if (engine := figure.get_layout_engine()) is not None:
        engine.set(w_pad=_SIDE, h_pad=_ABOVE)
    return figure, axes[0]


def heading(figure: Figure, number: int, title: str, parameters: str) -> None:
    """Write what a figure redraws, and where its parameters come from."""
    text = f"Fig. {number} of Walker & Leine (2019), redrawn: {title}"
    figure.suptitle(text, x=0.01, ha="left", color=INK)
    top = 1.0 - (_ABOVE + 0.02) / figure.get_figheight()
    figure.text(0.99, top, parameters, ha="right", va="top", color=GREY, fontsize="small")


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


def record(curves: Curves, panel: str, curve: str, artists: Sequence[Artist]) -> None:
    """Put what lines and arrows show into the table; several lines are numbered.

    NaN, which interrupts a line, is left out.
    """
    lines = [one for one in artists if isinstance(one, Line2D)]
    for k, line in enumerate(lines, start=1):
        name = curve if len(lines) == 1 else f"{curve} {k}"
        points = np.column_stack(line.get_data(orig=True))
        curves.add(panel, name, points[np.isfinite(points).all(axis=1)])
    for arrows in artists:
        if isinstance(arrows, Quiver):
            vectors = np.column_stack([arrows.U, arrows.V])
            curves.add_arrows(panel, curve, np.asarray(arrows.get_offsets()), vectors)


def drawn(plot: Callable[..., Axes], what: object, ax: Axes, **options: Any) -> list[Artist]:
    """Return the artists that a function of `asperity.plot` adds to axes."""
    before = list(ax.get_children())
    plot(what, ax=ax, **options)
    return [one for one in ax.get_children() if one not in before]


def record_texts(curves: Curves, panel: str, ax: Axes) -> None:
    """Put the texts of a schematic drawing and the points they belong to into the table."""
    for text in ax.texts:
        place = text.xy if isinstance(text, Annotation) else text.get_position()
        if name := " ".join(text.get_text().split()):
            curves.add(panel, name, np.array(place, dtype=float))


def draw_law(
    curves: Curves, panel: str, law: FrictionLaw, ax: Axes, *, prefix: str = "", **options: Any
) -> None:
    """Draw a law without legend and record its sets, forces, sliding directions and lines."""
    artists = drawn(plot_law, law, ax, legend=False, **options)
    shown = [one for one in artists if isinstance(one, Line2D)]
    # Lines without points are there for the legend.
    outline, *lines = (one for one in shown if np.size(one.get_xdata()))
    quivers: list[Artist] = [one for one in artists if isinstance(one, Quiver)]
    # The forces are drawn last, as dots or arrows.
    force = quivers.pop() if options.get("forces") == "arrows" else lines.pop()
    direction = [one for one in lines if str(one.get_label()).startswith("direction set")]
    table: tuple[tuple[str, Sequence[Artist]], ...] = (
        ("bdry C", [outline]),
        ("bdry D", direction),
        ("line from D to C", [one for one in lines if one not in direction]),
        ("sliding direction", quivers),
        ("force", [force]),
    )
    for name, recorded in table:
        record(curves, panel, prefix + name, recorded)


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
