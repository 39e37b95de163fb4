"""Colours, directions, outlines and arrows that the figures share."""

from typing import Any

import asperity as asp
import numpy as np
from matplotlib.axes import Axes
from matplotlib.patches import Polygon
from matplotlib.quiver import Quiver
from numpy.typing import ArrayLike, NDArray

Array = NDArray[np.float64]

# Okabe and Ito's palette, distinguishable with every kind of colour vision.
BLUE, ORANGE, GREEN, PURPLE = "#0072B2", "#D55E00", "#009E73", "#CC79A7"
SKY, INK, GREY = "#56B4E9", "#222222", "#8A8A8A"
RESERVOIR, DIRECTION, SLIDING = BLUE, ORANGE, GREEN
STICK, SLIP = BLUE, ORANGE


def unit_vectors(angle: ArrayLike) -> Array:
    """Return (cos φ, sin φ) for angles in rad."""
    phi = np.asarray(angle, dtype=float)
    return np.stack([np.cos(phi), np.sin(phi)], axis=-1)


def circle(n: int) -> Array:
    """Return n angles, none of them on an axis of symmetry."""
    return 2.0 * np.pi * (np.arange(n) + 0.37) / n


def closed_outline(star: asp.StarSet) -> Array:
    """Return boundary points of a planar set, the first one repeated at the end."""
    outline = star.boundary(1440)
    return np.vstack([outline, outline[:1]])


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
) -> None:
    """Fill the sector of a disk between two angles."""
    rim = apex + radius * unit_vectors(np.linspace(start, start + sweep, 60))
    ax.add_patch(Polygon(np.vstack([apex, rim]), closed=True, linewidth=0.0, **kwargs))
    ax.autoscale_view()
