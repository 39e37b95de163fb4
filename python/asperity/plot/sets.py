"""Plots of sets, and of their gauges as surfaces."""

from __future__ import annotations

from typing import Any

import numpy as np
from matplotlib.artist import Artist
from matplotlib.axes import Axes
from matplotlib.ticker import MaxNLocator
from mpl_toolkits.mplot3d.art3d import Poly3DCollection

from asperity._base import arrays
from asperity._base.arrays import Array
from asperity.errors import DimensionError
from asperity.plot import look
from asperity.sets import StarSet
from asperity.sets.star import checked_set

_NODES = 1440


def plot_set(set: StarSet, *, ax: Axes | None = None, **kwargs: Any) -> Axes:
    """Draw a planar set.

    Args:
        set: the set.
        ax: axes; default new ones.
        **kwargs: of the outline, as for ``Axes.plot``; the filling takes its colour.

    Returns:
        The axes.

    Raises:
        DimensionError: if the set is not planar.

    >>> import matplotlib
    >>> matplotlib.use("Agg")
    >>> from asperity import Ellipse
    >>> from asperity.plot import plot_set
    >>> plot_set(Ellipse(0.6, 0.2), label="C").lines[0].get_label()
    'C'
    """
    planar_set(set)
    with look.drawing(ax) as ax:
        draw_set(ax, set, **kwargs)
        ax.set(xlabel=r"$x_1$", ylabel=r"$x_2$")
        return ax


def plot_gauge(set: StarSet, *, ax: Axes | None = None, height: float = 1.3) -> Axes:
    """Draw the gauge k_C over the plane, its level curve k_C = 1 and below it the set C.

    Args:
        set: planar set C.
        ax: axes made with ``projection="3d"``; default new ones.
        height: value of the gauge at which the surface ends.

    Returns:
        The axes.

    Raises:
        ParameterError: if the axes have two dimensions.

    Reference: [WL19] Def. 3, Fig. 2a.

    >>> import matplotlib
    >>> matplotlib.use("Agg")
    >>> from asperity import Ellipse
    >>> from asperity.plot import plot_gauge
    >>> plot_gauge(Ellipse(0.6, 0.2)).name
    '3d'
    """
    height = arrays.positive(height, "height")
    outline = closed_outline(set)
    nodes = surface_nodes(outline, height)
    with look.drawing(ax, projection="3d") as ax:
        space: Any = ax
        space.plot_surface(
            *np.moveaxis(nodes, -1, 0), color=look.SKY, alpha=0.35, linewidth=0.0, rcount=len(nodes)
        )
        space.plot(*outline.T, 1.0, color=look.RESERVOIR, label="$k_C = 1$")
        space.plot(*outline.T, 0.0, color=look.RESERVOIR, linewidth=1.0, linestyle="--")
        floor = np.column_stack([outline, np.zeros(len(outline))])
        filling = Poly3DCollection([floor], color=look.RESERVOIR, alpha=0.12, linewidth=0.0)
        space.add_collection3d(filling)
        space.set_box_aspect((*np.ptp(outline, axis=0) / np.ptp(outline), 0.8))
        for axis in (space.xaxis, space.yaxis, space.zaxis):
            axis.set_major_locator(MaxNLocator(4))
        space.set(xlabel="$x_1$", ylabel="$x_2$", zlabel="$k_C(x)$")
        return ax


def surface_nodes(outline: Array, height: float) -> Array:
    """Return points of the surface of a gauge, from 0 up to `height`; shape ``(m, n, 3)``."""
    k = np.linspace(0.0, height, 27)[:, None, None]
    flat = k * outline[::4]
    return np.concatenate([flat, np.broadcast_to(k, (*flat.shape[:2], 1))], axis=-1)


def draw_set(ax: Axes, set: StarSet, **kwargs: Any) -> list[Artist]:
    """Draw outline and filling of a planar set."""
    outline = closed_outline(set)
    # Round ends would show where the outline closes.
    options = {"color": look.RESERVOIR, "solid_capstyle": "butt", **look.line_options(kwargs)}
    (line,) = ax.plot(*outline.T, **options)
    (filling,) = ax.fill(*outline.T, color=line.get_color(), alpha=0.08, linewidth=0.0)
    ax.set_aspect("equal")
    return [line, filling]


def planar_set(set: StarSet) -> StarSet:
    """Return `set` if it is a set of the plane."""
    if checked_set(set, "set").dimension != 2:
        raise DimensionError("set", f"must be planar to be drawn, its dimension is {set.dimension}")
    return set


def closed_outline(set: StarSet) -> Array:
    """Return boundary points of a planar set, the first one repeated at the end."""
    outline = planar_set(set).boundary(_NODES)
    return np.vstack([outline, outline[:1]])
