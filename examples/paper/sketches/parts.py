"""Parts of schematic drawings: springs, dampers, belts, walls, masses."""

from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.patches import Circle, FancyBboxPatch, Polygon, Rectangle
from numpy.typing import ArrayLike
from paper.drawing import GREEN, GREY, INK, Array, draw_arrows, unit_vectors

METAL, PLATE = "#C9CED6", "#DCE6F0"
"""Fillings of masses, and of belts."""

_ZIGZAG = np.array(
    [
        [0.0, 0.2, 0.25, 0.35, 0.45, 0.55, 0.65, 0.75, 0.8, 1.0],
        [0.0, 0.0, 1.0, -1.0, 1.0, -1.0, 1.0, -1.0, 0.0, 0.0],
    ]
).T
_PISTON = np.array([[0, 0], [0.5, 0], [0.5, 0.8], [0.5, -0.8]], dtype=float)
_CYLINDER = np.array([[0.35, 1], [0.65, 1], [0.65, 0], [1, 0], [0.65, 0], [0.65, -1], [0.35, -1]])


def spring(ax: Axes, start: ArrayLike, end: ArrayLike, *, width: float = 0.09) -> None:
    """Draw a spring between two points."""
    ax.plot(*_along(_ZIGZAG, start, end, width).T, color=INK, linewidth=1.1)


def damper(ax: Axes, start: ArrayLike, end: ArrayLike, *, width: float = 0.09) -> None:
    """Draw a damper between two points."""
    for piece in (_PISTON, _CYLINDER):
        ax.plot(*_along(piece, start, end, width).T, color=INK, linewidth=1.1)


def coil(ax: Axes, center: ArrayLike, *, radius: float = 0.2, start: float, sweep: float) -> None:
    """Draw a rotational spring, a spiral about a joint that ends at the angle start + sweep."""
    angle = np.linspace(start - 2.0 * np.pi, start + sweep, 120)
    reach = np.linspace(0.35, 1.0, len(angle)) * radius
    ax.plot(
        *(np.asarray(center) + reach[:, None] * unit_vectors(angle)).T, color=INK, linewidth=1.0
    )


def wall(ax: Axes, start: ArrayLike, end: ArrayLike) -> None:
    """Draw a fixed wall; its body lies to the right, seen from start to end."""
    first, last = np.asarray(start, dtype=float), np.asarray(end, dtype=float)
    length = float(np.linalg.norm(last - first))
    along = (last - first) / length
    inward = np.array([along[1], -along[0]])
    ax.plot(*np.stack([first, last]).T, color=INK, linewidth=1.4)
    for place in np.linspace(0.0, length, round(length / 0.1) + 1)[1:]:
        foot = first + place * along
        ax.plot(*np.stack([foot, foot + 0.1 * (inward - along)]).T, color=GREY, linewidth=0.8)


def belt(
    ax: Axes, left: float, right: float, top: float, *, forward: bool = True, height: float = 0.34
) -> None:
    """Draw a belt on two rollers and the arrow of its velocity v."""
    radius = 0.5 * height
    shape = FancyBboxPatch(
        (left + radius, top - height + radius),
        right - left - height,
        0.0,
        boxstyle=f"round,pad={radius},rounding_size={radius}",
        facecolor=PLATE,
        edgecolor=INK,
        linewidth=1.2,
    )
    ax.add_patch(shape)
    for x in (left + radius, right - radius):
        ax.add_patch(Circle((x, top - radius), 0.62 * radius, facecolor="white", edgecolor=GREY))
    middle, reach = 0.5 * (left + right), 0.5 if forward else -0.5
    arrow(ax, [middle - 0.5 * reach, top - radius], [reach, 0.0], color=GREEN)
    ax.annotate("$v$", (middle + 0.75 * reach, top - radius), color=GREEN, ha="center", va="center")


def block(ax: Axes, center: ArrayLike, size: tuple[float, float], text: str = "") -> None:
    """Draw a block-shaped mass."""
    x, y = np.asarray(center, dtype=float)
    width, height = size
    ax.add_patch(
        Rectangle(
            (x - 0.5 * width, y - 0.5 * height),
            width,
            height,
            facecolor=METAL,
            edgecolor=INK,
            zorder=3.0,
        )
    )
    ax.annotate(text, (x, y), color=INK, ha="center", va="center", zorder=4.0)


def point_mass(ax: Axes, center: ArrayLike, radius: float = 0.13) -> None:
    """Draw a point mass."""
    x, y = np.asarray(center, dtype=float)
    ax.add_patch(Circle((x, y), radius, facecolor=METAL, edgecolor=INK, zorder=3.0))


def rod(ax: Axes, start: ArrayLike, end: ArrayLike) -> None:
    """Draw a rigid rod."""
    first, last = np.asarray(start, dtype=float), np.asarray(end, dtype=float)
    along = (last - first) / np.linalg.norm(last - first)
    across = 0.035 * np.array([-along[1], along[0]])
    corners = np.stack([first + across, last + across, last - across, first - across])
    ax.add_patch(Polygon(corners, facecolor="white", edgecolor=INK, linewidth=1.1, zorder=2.5))


def joint(ax: Axes, center: ArrayLike) -> None:
    """Draw a joint."""
    x, y = np.asarray(center, dtype=float)
    ax.add_patch(Circle((x, y), 0.05, facecolor="white", edgecolor=INK, zorder=5.0))


def arrow(ax: Axes, tail: ArrayLike, vector: ArrayLike, **kwargs: Any) -> None:
    """Draw one arrow."""
    draw_arrows(
        ax,
        np.atleast_2d(tail),
        np.atleast_2d(np.asarray(vector, float)),
        **{"zorder": 6.0, **kwargs},
    )


def label(
    ax: Axes, text: str, place: ArrayLike, *, offset: ArrayLike = (0.0, 0.0), **kwargs: Any
) -> None:
    """Write a text centred at a place, moved by `offset`."""
    x, y = np.add(place, offset).tolist()
    look = {"color": INK, "ha": "center", "va": "center", "zorder": 7.0, **kwargs}
    ax.annotate(text, (x, y), **look)


def _along(shape: Array, start: ArrayLike, end: ArrayLike, width: float) -> Array:
    """Return a shape given in shares of the length and of the width between two points."""
    first, last = np.asarray(start, dtype=float), np.asarray(end, dtype=float)
    length = np.linalg.norm(last - first)
    along = (last - first) / length
    across = np.array([-along[1], along[0]])
    return first + shape[:, :1] * (last - first) + width * shape[:, 1:] * across
