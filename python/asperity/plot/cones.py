"""Plots of cones and proximal points of a set."""

from __future__ import annotations

from typing import Any

import numpy as np
from matplotlib.axes import Axes
from numpy.typing import ArrayLike

from asperity._base import arrays
from asperity._base.arrays import Array
from asperity.errors import ParameterError
from asperity.plot import look
from asperity.plot.sets import closed_outline, planar_set
from asperity.sets import Cone, StarSet

# Angles that differ by less count as one.
_SLACK = 1e-9


def plot_cones(
    set: StarSet,
    *,
    x: ArrayLike,
    ax: Axes | None = None,
    normal: bool = True,
    tangent: bool = True,
    size: float | None = None,
) -> Axes:
    """Draw the normal cone N_C(x) and the tangent cone T_C(x), both moved to the point x.

    Args:
        set: planar set C.
        x: point of C, shape ``(2,)``; in the interior N_C(x) is {0} and T_C(x) the whole plane.
        ax: axes; default new ones.
        normal: whether to draw N_C(x), for which C must be convex.
        tangent: whether to draw T_C(x).
        size: radius at which the cones are cut off, in the unit of x; default half the largest
            radius of C.

    Returns:
        The axes.

    Raises:
        ParameterError: if x lies outside C, or if N_C(x) of a set that is not convex is wanted.

    Reference: [WL19] Def. 6, 7, Fig. 2b.

    >>> import matplotlib
    >>> matplotlib.use("Agg")
    >>> from asperity import Rectangle
    >>> from asperity.plot import plot_cones, plot_set
    >>> rectangle = Rectangle(2.0, 1.0)
    >>> ax = plot_cones(rectangle, x=[2.0, 1.0], ax=plot_set(rectangle))
    """
    reach = float(np.linalg.norm(closed_outline(set), axis=1).max())
    size = 0.5 * reach if size is None else arrays.positive(size, "size")
    point = arrays.array(x, "x", (2,))
    if not set.contains(point, tolerance=1e-9):
        raise ParameterError("x", f"must lie in the set, got {point.tolist()}")
    normals = set.normal_cone(point) if normal else None
    tangents = set.tangent_cone(point).parts if tangent else ()
    with look.drawing(ax) as ax:
        ax.plot(*point, "o", color=look.INK, markersize=4.5, zorder=4.0)
        if normals is not None:
            draw_normals(ax, point, normals, size)
        _draw_tangents(ax, point, tangents, size)
        ax.set_aspect("equal")
        return ax


def draw_normals(ax: Axes, point: Array, cone: Cone, size: float) -> None:
    """Draw the arrows that span a convex cone of the plane, and the sector between them."""
    generators = cone.generators
    if len(generators) > 1:
        start, sweep = _sector(generators)
        look.draw_sector(ax, point, start, sweep, size, color=look.NORMAL, alpha=0.22, zorder=1.6)
    if len(generators):
        tails = np.broadcast_to(point, generators.shape)
        look.draw_arrows(ax, tails, size * generators, color=look.NORMAL)


def _draw_tangents(ax: Axes, point: Array, parts: tuple[Array, ...], size: float) -> None:
    sectors = [_sector(generators) for generators in parts]
    for sector in sectors:
        look.draw_sector(ax, point, *sector, size, color=look.TANGENT, alpha=0.18, zorder=1.5)
    for edge in _outer_edges(sectors):
        ends = np.stack([point, point + size * arrays.unit_vectors(edge)])
        ax.plot(*ends.T, color=look.TANGENT, linewidth=1.2)


def _outer_edges(sectors: list[tuple[float, float]]) -> list[float]:
    """Return the angles at which sectors end without another one going on there."""
    edges = []
    for own, (start, sweep) in enumerate(sectors):
        others = sectors[:own] + sectors[own + 1 :]
        for edge in (start, start + sweep) if sweep < 2.0 * np.pi - _SLACK else ():
            inside = [(edge - first + _SLACK) % (2.0 * np.pi) for first, _ in others]
            if all(a > width + 2 * _SLACK for a, (_, width) in zip(inside, others, strict=True)):
                edges.append(edge)
    return edges


def plot_projection(set: StarSet, *, z: ArrayLike, ax: Axes | None = None) -> Axes:
    """Draw points z and their proximal points prox_C(z), joined by lines normal to the set.

    Args:
        set: planar convex set C.
        z: points, shape ``(..., 2)``.
        ax: axes; default new ones.

    Returns:
        The axes.

    Raises:
        ParameterError: if the set is not convex.
        DimensionError: if the set is not planar.

    Reference: [WL19] (11)(12), Fig. 2b.

    >>> import matplotlib
    >>> matplotlib.use("Agg")
    >>> from asperity import Rectangle
    >>> from asperity.plot import plot_projection
    >>> ax = plot_projection(Rectangle(2.0, 1.0), z=[[3.0, 0.5], [3.0, 2.0]])
    >>> ax.lines[-1].get_xydata().tolist()
    [[2.0, 0.5], [2.0, 1.0]]
    """
    planar = planar_set(set)
    points, _ = arrays.points(z, "z", 2)
    feet = planar.project(points)
    with look.drawing(ax) as ax:
        for line in zip(points, feet, strict=True):
            ax.plot(*np.transpose(line), color=look.GREY, linewidth=1.1, linestyle="--")
        dots: dict[str, Any] = {"color": look.INK, "linestyle": "none", "marker": "o"}
        ax.plot(*points.T, markersize=4.5, label="$z$", **dots)
        ax.plot(*feet.T, markerfacecolor="white", markersize=5.5, label="prox$_C(z)$", **dots)
        ax.set_aspect("equal")
        return ax


def _sector(generators: Array) -> tuple[float, float]:
    """Return first angle and sweep of the plane convex cone spanned by unit vectors."""
    if not len(generators):
        return 0.0, 0.0
    angles = np.sort(np.arctan2(generators[:, 1], generators[:, 0]))
    gaps = np.diff(angles, append=angles[0] + 2.0 * np.pi)
    widest = int(np.argmax(gaps))
    # Without an open half-plane that holds no generator, the cone is the whole plane.
    if gaps[widest] < np.pi - _SLACK:
        return 0.0, 2.0 * np.pi
    return float(angles[(widest + 1) % len(angles)]), float(2.0 * np.pi - gaps[widest])
