"""Plots of sets."""

from __future__ import annotations

from typing import Any

import numpy as np
from matplotlib.artist import Artist
from matplotlib.axes import Axes

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
