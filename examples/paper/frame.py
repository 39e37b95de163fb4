"""What a redrawn figure of [WL19] consists of, and the frame that all of them share."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from typing import Any

import asperity as asp
import matplotlib.pyplot as plt
import numpy as np
from asperity.demo import Check
from asperity.plot import plot_law
from matplotlib.artist import Artist
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from matplotlib.quiver import Quiver
from paper.curves import Curve, drawn_curves, named
from paper.drawing import GREY, INK, Array


@dataclass(frozen=True)
class Redrawn:
    """A figure and the checks of what the paper states with it."""

    figure: Figure
    checks: list[Check]
    others: list[Curve] = field(default_factory=list)
    """Data of what is neither a line nor an arrow."""

    @property
    def curves(self) -> list[Curve]:
        """The data of the figure."""
        return drawn_curves(self.figure) + self.others


OWN = "own parameters: the paper gives none"
"""What a figure says of its parameters unless the paper gives them."""

# Inches beside, above and below what a figure holds.
_SIDE, _ABOVE = 0.14, 0.08


def panels(
    number: int, title: str, count: int, *, parameters: str = OWN, **kwargs: Any
) -> tuple[Figure, Sequence[Axes]]:
    """Return a figure with `count` panels in a row, which says where its parameters come from."""
    look = {"figsize": (4.6 * count, 4.6), "layout": "constrained", "squeeze": False, **kwargs}
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


def drawn(plot: Callable[..., Axes], what: object, ax: Axes, **options: Any) -> list[Artist]:
    """Return the artists that a function of `asperity.plot` adds to axes."""
    before = list(ax.get_children())
    plot(what, ax=ax, **options)
    return [one for one in ax.get_children() if one not in before]


def draw_law(law: asp.FrictionLaw, ax: Axes, *, prefix: str = "", **options: Any) -> None:
    """Draw a law without legend and name its sets, forces, sliding directions and lines."""
    artists = drawn(plot_law, law, ax, legend=False, **options)
    shown = [one for one in artists if isinstance(one, Line2D)]
    # Lines without points are there for the legend.
    outline, *lines = (one for one in shown if np.size(one.get_xdata()))
    arrows: list[Artist] = [one for one in artists if isinstance(one, Quiver)]
    # The forces are drawn last, as dots or arrows.
    force = arrows.pop() if options.get("forces") == "arrows" else lines.pop()
    direction = [one for one in lines if str(one.get_label()).startswith("direction set")]
    groups: tuple[tuple[str, Sequence[Artist]], ...] = (
        ("bdry C", [outline]),
        ("bdry D", direction),
        ("line from D to C", [one for one in lines if one not in direction]),
        ("sliding direction", arrows),
        ("force", [force]),
    )
    for name, group in groups:
        named(prefix + name, group)


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


def report(checks: Sequence[Check]) -> None:
    """Print computed numbers beside expected ones."""
    for check in checks:
        verdict = "ok" if check.ok else "OFF"
        numbers = (
            f"{check.expected:12.6f} {check.computed:12.6f} ±{check.tolerance:.1e} {check.unit}"
        )
        print(f"{check.quantity:<64}{numbers} {verdict}")


def show(draw: Callable[[], Redrawn]) -> None:
    """Draw a figure, print its checks, and show it."""
    with asp.plot.style():
        report(draw().checks)
    plt.show()
