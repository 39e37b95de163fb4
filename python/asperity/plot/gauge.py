"""Plot of a gauge as a surface."""

from __future__ import annotations

from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.ticker import MaxNLocator
from mpl_toolkits.mplot3d.art3d import Poly3DCollection  # type: ignore[import-untyped]

from asperity._base import arrays
from asperity._base.arrays import Array
from asperity.plot import look
from asperity.plot.sets import closed_outline
from asperity.sets import StarSet


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
    nodes: Array = np.concatenate([flat, np.broadcast_to(k, (*flat.shape[:2], 1))], axis=-1)
    return nodes
