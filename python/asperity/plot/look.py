"""Colours, looks, arrows and files."""

from __future__ import annotations

import io
import os
from collections.abc import Iterator, Mapping
from contextlib import AbstractContextManager, contextmanager
from pathlib import Path
from typing import Any

import matplotlib as mpl
import numpy as np
from cycler import cycler
from matplotlib.axes import Axes
from matplotlib.cbook import normalize_kwargs
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from matplotlib.patches import Polygon
from matplotlib.quiver import Quiver

from asperity._base import arrays
from asperity._base.arrays import Array, positive, unit_vectors
from asperity._base.storage.files import atomic
from asperity.errors import DimensionError, ParameterError
from asperity.law import FrictionLaw

# Okabe and Ito's palette, distinguishable with every kind of colour vision.
BLUE, ORANGE, GREEN, PURPLE = "#0072B2", "#D55E00", "#009E73", "#CC79A7"
SKY, INK, GREY = "#56B4E9", "#222222", "#8A8A8A"

RESERVOIR, DIRECTION, SLIDING = BLUE, ORANGE, GREEN
NORMAL, TANGENT = GREEN, PURPLE
STICK, SLIP, OPEN = BLUE, ORANGE, GREY

_LOOK: dict[Any, Any] = {
    "axes.axisbelow": True,
    "axes.edgecolor": GREY,
    "axes.grid": True,
    "axes.labelcolor": INK,
    "axes.prop_cycle": cycler(color=[BLUE, ORANGE, GREEN, PURPLE, SKY]),
    "axes.spines.right": False,
    "axes.spines.top": False,
    "axes.titlelocation": "left",
    "axes.titlesize": "medium",
    "axes.titleweight": "bold",
    # At 85 mm, the width of a column, letters of 10 pt are then 7 pt high.
    "figure.figsize": [4.6, 3.45],
    "font.size": 10.0,
    "grid.color": "#E6E6E6",
    "grid.linewidth": 0.8,
    # No border, but what lies below fades.
    "legend.edgecolor": "none",
    "legend.framealpha": 0.75,
    "lines.linewidth": 1.6,
    "lines.solid_capstyle": "round",
    "xtick.color": INK,
    "ytick.color": INK,
}


def style() -> AbstractContextManager[None]:
    """Return a context in which figures have the house look; nothing is set globally.

    The functions of `asperity.plot` need none: they draw in this look by themselves. It is for what
    is drawn beside them, such as the figure that holds their axes. Settings that differ from
    matplotlib's defaults, as of ``plt.style.use``, win over the house look here as there.
    """
    return mpl.rc_context(_house_look())


@contextmanager
def drawing(ax: Axes | None, *, projection: str | None = None) -> Iterator[Axes]:
    """Yield `ax`, or new axes, of this projection if it is given, in the house look.

    Axes that are still empty take it on; those that hold something keep the look they have.
    """
    arrays.of_kind(ax, "ax", Axes | None, "axes of matplotlib or None")
    if ax is not None and projection is not None and ax.name != projection:
        reason = " for a polar plot" if projection == "polar" else ""
        raise ParameterError("ax", f'must be made with projection="{projection}"{reason}')
    with style():
        if ax is None:
            import matplotlib.pyplot as plt

            ax = plt.figure(layout="constrained").add_subplot(projection=projection)
        elif not ax.has_data():
            _dress(ax)
        yield ax


def _house_look() -> dict[Any, Any]:
    """Return the settings of the house for which the user has none of their own."""
    now: Mapping[Any, Any] = mpl.rcParams
    unset: Mapping[Any, Any] = mpl.rcParamsDefault
    return {name: value for name, value in _LOOK.items() if now[name] == unset[name]}


def _dress(ax: Axes) -> None:
    """Give axes that were made elsewhere the look that new ones would have."""
    now: Mapping[Any, Any] = mpl.rcParams
    for side in ("top", "right"):
        if side in ax.spines:
            ax.spines[side].set_visible(now[f"axes.spines.{side}"])
    for spine in ax.spines.values():
        spine.set_edgecolor(now["axes.edgecolor"])
    ax.tick_params(axis="both", color=now["xtick.color"], labelcolor=now["xtick.color"])
    for axis in (ax.xaxis, ax.yaxis):
        axis.label.set_color(now["axes.labelcolor"])
    ax.set_axisbelow(now["axes.axisbelow"])
    if now["axes.grid"]:
        ax.grid(True, color=now["grid.color"], linewidth=now["grid.linewidth"])
    ax.set_prop_cycle(now["axes.prop_cycle"])


def color(number: int) -> str:
    """Return a colour of the cycle by its number.

    The names ``C0``, ``C1``… would be looked up only when the figure is drawn, in whatever look is
    set by then.
    """
    colors = mpl.rcParams["axes.prop_cycle"].by_key()["color"]
    return str(colors[number % len(colors)])


BELOW: dict[str, Any] = {
    "loc": "upper left",
    "bbox_to_anchor": (0.0, 0.0),
    # In units of the font, so that the labels of low axes stay free as well.
    "borderaxespad": 3.6,
    "columnspacing": 1.2,
}
"""Place of a legend that would hide what is drawn: below the axes, since titles are above."""


def line_options(kwargs: dict[str, Any]) -> dict[str, Any]:
    """Return keywords of ``Axes.plot`` with short names such as ``c`` and ``ls`` spelled out."""
    return normalize_kwargs(kwargs, Line2D)


def planar_law(law: FrictionLaw) -> FrictionLaw:
    """Return `law` if it is a law of the plane."""
    arrays.of_kind(law, "law", FrictionLaw, "a FrictionLaw")
    if law.dimension != 2:
        raise DimensionError("law", f"must be planar to be drawn, its dimension is {law.dimension}")
    return law


def draw_arrows(ax: Axes, tails: Array, vectors: Array, **kwargs: Any) -> Quiver:
    """Draw arrows in units of the axes, whose limits grow with them."""
    look = {"units": "inches", "width": 0.018, "headwidth": 4.5, "headlength": 6.0, "zorder": 3.0}
    arrows = ax.quiver(
        *tails.T, *vectors.T, angles="xy", scale_units="xy", scale=1.0, **{**look, **kwargs}
    )
    ax.update_datalim(tails + vectors)
    ax.autoscale_view()
    return arrows


def draw_sector(
    ax: Axes, apex: Array, start: float, sweep: float, radius: float, **kwargs: Any
) -> Polygon:
    """Fill the sector of a disk between two angles."""
    arc = np.linspace(start, start + sweep, 60)
    rim = apex + radius * unit_vectors(arc)
    sector = Polygon(np.vstack([apex, rim]), closed=True, **{"linewidth": 0.0, **kwargs})
    ax.add_patch(sector)
    ax.autoscale_view()
    return sector


def png(figure: Figure, dpi: float = 110) -> bytes:
    """Return a figure as the bytes of a PNG file."""
    file = io.BytesIO()
    figure.savefig(file, dpi=dpi, format="png")
    return file.getvalue()


def save_figure(figure: Figure, path: str | os.PathLike[str], *, dpi: float = 150) -> None:
    """Write a figure in the format of the file's suffix; the file is complete or not there."""
    kind = Path(path).suffix.lstrip(".").lower()
    if kind not in figure.canvas.get_supported_filetypes():
        raise ParameterError("path", f"must end in .png, .pdf or .svg, got {os.fspath(path)!r}")
    resolution = positive(dpi, "dpi")
    with atomic(path) as file:
        figure.savefig(file, dpi=resolution, format=kind)
