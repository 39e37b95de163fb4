"""Plot of a law as a pair of sets."""

from __future__ import annotations

from typing import Literal

import numpy as np
from matplotlib.axes import Axes
from numpy.typing import ArrayLike

from asperity._base import arrays
from asperity._base.arrays import Array
from asperity.law import FrictionLaw
from asperity.plot import look
from asperity.plot.cones import draw_normals
from asperity.plot.sets import closed_outline, draw_set
from asperity.sets import StarSet


def plot_law(
    law: FrictionLaw,
    *,
    ax: Axes | None = None,
    angles: int | ArrayLike = 16,
    forces: Literal["dots", "arrows"] = "dots",
    legend: bool = True,
) -> Axes:
    """Draw the reservoir C, the direction set D and pairs of force −λ and sliding direction γ.

    Each force on bdry C carries the arrow of its sliding direction; a thin line leads to the point
    −αλ of bdry D to which γ is normal. At a corner of D all normals are admissible: a sector.

    Args:
        law: planar law.
        ax: axes; default new ones.
        angles: polar angles θ of the forces −λ in rad, or a number of forces, which are then
            spread evenly along bdry C.
        forces: whether a force is drawn as a dot or as an arrow from the origin.
        legend: whether to add a legend below the axes.

    Returns:
        The axes.

    Raises:
        DimensionError: if the law is not planar.

    Reference: [WL19] Def. 16, Fig. 11.

    >>> import matplotlib
    >>> matplotlib.use("Agg")
    >>> from asperity import Ellipse, FrictionLaw
    >>> from asperity.plot import plot_law
    >>> law = FrictionLaw(Ellipse(0.6, 0.2, angle=0.3), Ellipse(3.0, 1.0))
    >>> ax = plot_law(law, angles=[0.0, 1.0, 2.0], forces="arrows")
    >>> ax.lines[0].get_label()
    'reservoir $C$'
    """
    arrays.choice(forces, "forces", ("dots", "arrows"))
    theta = _polar_angles(closed_outline(look.planar_law(law).reservoir), angles)
    force, feet = (_on_boundary(set, theta) for set in (law.reservoir, law.direction))
    normals = [law.direction.normal_cone(foot) for foot in feet]
    size = 0.3 * float(np.linalg.norm(closed_outline(law.reservoir), axis=1).max())
    with look.drawing(ax) as ax:
        _draw_sets(ax, law)
        if law.direction != law.reservoir:
            lines = np.stack([feet, force]).transpose(2, 0, 1)
            ax.plot(*lines, color=look.GREY, linewidth=0.7)
        for point, cone in zip(force, normals, strict=True):
            draw_normals(ax, point, cone, size)
        _draw_forces(ax, force, arrows=forces == "arrows")
        ax.plot([], [], color=look.SLIDING, label=r"sliding direction $\gamma$")
        ax.margins(0.08)
        ax.set(xlabel=r"$-\lambda_1/\lambda_N$", ylabel=r"$-\lambda_2/\lambda_N$")
        if legend:
            ax.legend(ncols=2, **look.BELOW)
        return ax


def _draw_sets(ax: Axes, law: FrictionLaw) -> None:
    if law.direction == law.reservoir:
        draw_set(ax, law.reservoir, label="reservoir $C$ = direction set $D$")
        return
    draw_set(ax, law.reservoir, label="reservoir $C$")
    outline = closed_outline(law.direction)
    ax.plot(*outline.T, color=look.DIRECTION, linestyle="--", label="direction set $D$")


def _polar_angles(outline: Array, angles: int | ArrayLike) -> Array:
    if np.ndim(angles):
        return arrays.array(angles, "angles", (None,))
    n = arrays.count(angles, "angles")
    lengths = np.linalg.norm(np.diff(outline, axis=0), axis=1)
    along = np.concatenate([[0.0], np.cumsum(lengths)])
    turned = np.unwrap(np.arctan2(outline[:, 1], outline[:, 0]))
    return np.interp(along[-1] * np.arange(n) / n, along, turned)


def _on_boundary(set: StarSet, theta: Array) -> Array:
    return set.radius(theta)[:, None] * arrays.unit_vectors(theta)


def _draw_forces(ax: Axes, force: Array, *, arrows: bool) -> None:
    label = r"force $-\lambda$"
    if not arrows:
        ax.plot(*force.T, "o", color=look.INK, markersize=3.5, zorder=4.0, label=label)
        return
    ax.plot([], [], color=look.INK, label=label)
    look.draw_arrows(ax, np.zeros_like(force), force, color=look.INK)
