"""Plots of sets."""

from __future__ import annotations

from typing import Any

import numpy as np
from matplotlib.artist import Artist
from matplotlib.axes import Axes

from asperity._arrays import Array
from asperity.errors import DimensionError
from asperity.plot import look
from asperity.sets import StarSet

_NODES = 1440


def plot_set(set: StarSet, ax: Axes | None = None, **kwargs: Any) -> list[Artist]:
    """Draw a planar set.

    Args:
        set: the set.
        ax: axes; default new ones.
        **kwargs: of the outline, as for ``Axes.plot``; the filling takes its colour.

    Returns:
        The outline and the filling.

    Raises:
        DimensionError: if the set is not planar.

    >>> import matplotlib
    >>> matplotlib.use("Agg")
    >>> from asperity import Ellipse
    >>> from asperity.plot import plot_set
    >>> outline, filling = plot_set(Ellipse(0.6, 0.2), label="C")
    >>> outline.axes.get_aspect()
    1.0
    """
    ax = look.axes_or_new(ax)
    outline = closed_outline(set)
    # Round ends would show where the outline closes.
    (line,) = ax.plot(*outline.T, **{"color": look.RESERVOIR, "solid_capstyle": "butt", **kwargs})
    (filling,) = ax.fill(*outline.T, color=line.get_color(), alpha=0.08, linewidth=0.0)
    ax.set_aspect("equal")
    ax.set_xlabel(r"$x_1$")
    ax.set_ylabel(r"$x_2$")
    return [line, filling]


def closed_outline(set: StarSet) -> Array:
    """Return boundary points of a planar set, the first one repeated at the end."""
    if set.dimension != 2:
        raise DimensionError("set", f"must be planar to be drawn, its dimension is {set.dimension}")
    outline = set.boundary(_NODES)
    return np.vstack([outline, outline[:1]])
