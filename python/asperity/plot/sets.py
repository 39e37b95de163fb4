"""Plots of sets and laws."""

from __future__ import annotations

from typing import Any

import numpy as np
from matplotlib.axes import Axes

from asperity import _arrays
from asperity._arrays import Array
from asperity.errors import DimensionError
from asperity.law import FrictionLaw
from asperity.plot import look
from asperity.sets import StarSet

_NODES = 720


def plot_set(set: StarSet, ax: Axes | None = None, **kwargs: Any) -> Axes:
    """Draw a planar set.

    Args:
        set: the set.
        ax: axes; default new ones.
        **kwargs: of the outline, as for ``Axes.plot``; the filling takes its colour.

    >>> import matplotlib
    >>> matplotlib.use("Agg")
    >>> from asperity import Ellipse
    >>> from asperity.plot import plot_set
    >>> ax = plot_set(Ellipse(0.6, 0.2), label="C")
    """
    ax = look.axes_or_new(ax)
    outline = closed_outline(set)
    (line,) = ax.plot(*outline.T, **{"color": look.RESERVOIR, **kwargs})
    ax.fill(*outline.T, color=line.get_color(), alpha=0.08, linewidth=0.0)
    ax.set_aspect("equal")
    ax.set_xlabel(r"$x_1$")
    ax.set_ylabel(r"$x_2$")
    return ax


def plot_law(law: FrictionLaw, ax: Axes | None = None, *, arrows: int = 16) -> Axes:
    """Draw the reservoir C, the direction set D and pairs of force and slip direction.

    Each dot on bdry C is a force −λ in slip, its arrow the slip direction, its thin line leads to
    the point −αλ of bdry D to which the slip is normal.

    Args:
        law: planar law.
        ax: axes; default new ones.
        arrows: number of slip directions, equidistant in angle.

    >>> import matplotlib
    >>> matplotlib.use("Agg")
    >>> from asperity import Ellipse, FrictionLaw
    >>> from asperity.plot import plot_law
    >>> ax = plot_law(FrictionLaw(Ellipse(0.6, 0.2, angle=0.3), Ellipse(3.0, 1.0)))
    """
    ax = look.axes_or_new(ax)
    plot_set(law.reservoir, ax, color=look.RESERVOIR, label="reservoir $C$")
    ax.plot(
        *closed_outline(law.direction).T,
        color=look.DIRECTION,
        linestyle="--",
        label="direction set $D$",
    )
    phi = 2.0 * np.pi * (np.arange(_arrays.count(arrows, "arrows")) + 0.5) / arrows
    slip = np.stack([np.cos(phi), np.sin(phi)], axis=-1)
    force = -law.force(slip)
    feet = force / law.direction.gauge(force)[:, None]
    ax.plot(*np.stack([feet, force]).swapaxes(1, 2).swapaxes(0, 1), color=look.GREY, lw=0.7)
    ax.plot(*force.T, "o", color=look.INK, markersize=3.5, label=r"force $-\lambda$")
    ax.quiver(*force.T, *slip.T, color=look.INK, angles="xy", scale=12.0, width=0.004, zorder=3)
    ax.margins(0.25)
    ax.set_xlabel(r"$-\lambda_1/\lambda_N$")
    ax.set_ylabel(r"$-\lambda_2/\lambda_N$")
    ax.legend(loc="upper left", bbox_to_anchor=(0.0, -0.14), ncols=3, frameon=False)
    return ax


def closed_outline(set: StarSet) -> Array:
    """Return boundary points of a planar set, the first one repeated at the end."""
    if set.dimension != 2:
        raise DimensionError("set", f"must be planar to be drawn, its dimension is {set.dimension}")
    outline = set.boundary(_NODES)
    return np.vstack([outline, outline[:1]])
