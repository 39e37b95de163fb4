"""Figs. 1 and 2 of [WL19]: kinds of sets, the gauge, cones and proximal points.

The paper gives no numbers for these sets; the ones here are own.
"""

from __future__ import annotations

import numpy as np
from matplotlib.axes import Axes
from matplotlib.path import Path

from asperity._base.arrays import Array, unit_vectors
from asperity.paper.checks import Check
from asperity.paper.data import Curves
from asperity.paper.redrawn import Redrawn, drawn, panels, record, shared_legend
from asperity.paper.statements import never_positive, truth, vanishes
from asperity.plot import plot_cones, plot_gauge, plot_projection, plot_set
from asperity.plot.gauge import surface_nodes
from asperity.plot.look import GREEN, INK, ORANGE, RESERVOIR, style
from asperity.plot.sets import closed_outline
from asperity.sets import Ellipse, PolarCurve, Rectangle, StarSet, SupportCurve, star_shape

_ANGLE = 2.0 * np.pi * np.arange(72) / 72

CONVEX = SupportCurve(_ANGLE, 1.0 + 0.10 * np.cos(2.0 * _ANGLE) + 0.04 * np.sin(3.0 * _ANGLE))
"""A strictly convex set; h + h″ = 1 − 0.30 cos 2φ − 0.32 sin 3φ > 0."""

STAR = PolarCurve(_ANGLE, 0.85 + 0.22 * np.cos(3.0 * _ANGLE + 0.5) + 0.08 * np.sin(_ANGLE))
"""A star-shaped set with three lobes."""

CORNERED = Ellipse(1.0, 0.7) & Rectangle(0.8, 1.0)
"""A convex set with two flats, four corners and two arcs."""

CORNER = np.array([0.8, 0.42])
"""Corner of `CORNERED`."""

_HEIGHT = 1.3
"""Value of the gauge at which its surface in Fig. 2a ends."""


def hooked(n: int = 720) -> Array:
    """Return the outline of a set that is not star-shaped: one lobe overhangs its neighbour.

    Returns:
        Vertices, counter-clockwise, shape ``(n, 2)``.
    """
    t = 2.0 * np.pi * np.arange(n) / n
    bump = np.exp(-(((t - 1.5) / 0.42) ** 2))
    notch = np.exp(-(((t - 0.75) / 0.32) ** 2))
    radius = 0.75 + 0.35 * bump - 0.38 * notch + 0.1 * np.cos(t - 3.6)
    return radius[:, None] * unit_vectors(t - 0.85 * bump)


def hidden(outline: Array) -> Array:
    """Return the farthest point of an outline that turns back there, seen from the origin.

    The segment to it leaves the set behind the overhang.
    """
    angle = np.unwrap(np.arctan2(outline[:, 1], outline[:, 0]))
    behind = outline[1:-1][(angle[2:] < angle[1:-1]) & (angle[1:-1] < angle[:-2])]
    farthest: Array = behind[np.argmax(np.linalg.norm(behind, axis=1))]
    return farthest


def fig01() -> Redrawn:
    """Draw a convex, a star-shaped and a not star-shaped set with segments that tell them apart."""
    figure, axes = panels(1, "convex, star-shaped and other sets", 3)
    curves, outline = Curves(), hooked()
    chord, ray = CONVEX.boundary(72)[[10, 40]], STAR.boundary(72)[38]
    leaving = STAR.is_convex.witness
    outlines = [closed_outline(CONVEX), closed_outline(STAR), np.vstack([outline, outline[:1]])]
    titles = ("(a) convex", "(b) star-shaped, not convex", "(c) not star-shaped")
    with style():
        for ax, panel, title, closed in zip(axes, "abc", titles, outlines, strict=True):
            ax.plot(*closed.T, color=RESERVOIR)
            ax.fill(*closed.T, color=RESERVOIR, alpha=0.08, linewidth=0.0)
            ax.plot(0.0, 0.0, "o", color=INK, markersize=3.5, label="origin")
            ax.set(title=title, xlabel="$x_1$", ylabel="$x_2$", aspect="equal")
            ax.set(xlim=(-1.2, 1.2), ylim=(-1.1, 1.2))
            curves.add(panel, "boundary", closed)
            curves.add(panel, "origin", np.zeros(2))
        _draw_segment(axes[0], chord, curves, "a", inside=True)
        _draw_segment(axes[1], np.stack([np.zeros(2), ray]), curves, "b", inside=True)
        if leaving is not None:
            _draw_segment(axes[1], leaving, curves, "b", inside=False)
        far = np.stack([np.zeros(2), hidden(outline)])
        _draw_segment(axes[2], far, curves, "c", inside=False)
        shared_legend(figure, axes)
    return Redrawn(figure, curves, _kinds(outline))


def _draw_segment(ax: Axes, ends: Array, curves: Curves, panel: str, *, inside: bool) -> None:
    color, label = (GREEN, "segment in the set") if inside else (ORANGE, "segment leaving the set")
    ax.plot(*ends.T, "o-", color=color, markersize=4.5, label=label, zorder=1.9)
    curves.add(panel, label, ends)


def _kinds(outline: Array) -> list[Check]:
    points = CONVEX.boundary(240)
    middles = 0.5 * (points[:, None] + points)
    witness = STAR.is_convex.witness
    return [
        truth("Fig. 1a is convex", CONVEX.is_convex),
        never_positive("Fig. 1a gauge of chords' midpoints − 1", CONVEX.gauge(middles) - 1.0, 1e-9),
        truth("Fig. 1b is not convex", not STAR.is_convex),
        truth(
            "Fig. 1b midpoint of the chord shown lies outside",
            witness is not None and STAR.gauge(witness.mean(axis=0)) > 1.0,
        ),
        truth("Fig. 1b is star-shaped", star_shape(STAR.boundary(720))),
        truth("Fig. 1c is not star-shaped", not star_shape(outline)),
        truth(
            "Fig. 1c the segment shown leaves the set",
            not Path(outline).contains_points(np.outer([0.4, 0.6, 0.8], hidden(outline))).all(),
        ),
    ]


def fig02() -> Redrawn:
    """Draw (a) a gauge with its level curve C, (b) normal and tangent cones and proximal points."""
    figure, (left, right) = panels(2, "gauge, cones and proximal points", 2, figsize=(10.4, 4.8))
    left.remove()
    curves = Curves(("x", "y", "z"))
    smooth = float(CORNERED.radius(2.1)) * unit_vectors(2.1)
    outside = np.array([CORNER + 0.55 * unit_vectors(0.35), [1.25, -0.2], [-0.35, -1.1]])
    with style():
        space = figure.add_subplot(1, 2, 1, projection="3d")
        plot_gauge(CORNERED, ax=space, height=_HEIGHT)
        space.set_title(r"(a) gauge $k_C$ and level set $C = \{k_C \leq 1\}$")
        plot_set(CORNERED, ax=right, label="$C$")
        _draw_projection(right, outside, curves)
        for name, point in (("smooth point", smooth), ("corner", CORNER)):
            _draw_cones(right, name, point, curves)
        right.annotate("$N_C(x)$", (1.06, 0.74), color=INK)
        right.annotate("$T_C(x)$", (0.61, 0.22), color=INK, ha="center")
        right.set_title("(b) normal and tangent cones, proximal points")
        right.legend(loc="upper left", bbox_to_anchor=(0.0, -0.13), ncols=3)
    outline = closed_outline(CORNERED)
    for name, height in (("level curve", 1.0), ("boundary", 0.0)):
        level = np.full((len(outline), 1), height)
        curves.add("a", name, np.hstack([outline, level]))
    curves.add("a", "gauge", surface_nodes(outline, _HEIGHT).reshape(-1, 3))
    curves.add("b", "boundary", outline)
    return Redrawn(figure, curves, _cone_checks(CORNERED, [smooth, CORNER]))


def _draw_projection(ax: Axes, z: Array, curves: Curves) -> None:
    *lines, points, feet = drawn(plot_projection, CORNERED, ax, z=z)
    for name, artists in (("z", [points]), ("prox(z)", [feet]), ("line from z to prox(z)", lines)):
        record(curves, "b", name, artists)


def _draw_cones(ax: Axes, name: str, x: Array, curves: Curves) -> None:
    point, *normals = drawn(plot_cones, CORNERED, ax, x=x, tangent=False, size=0.36)
    _, *tangents = drawn(plot_cones, CORNERED, ax, x=x, normal=False, size=0.36)
    record(curves, "b", name, [point])
    record(curves, "b", f"N_C({name})", normals)
    record(curves, "b", f"edge of T_C({name})", tangents)


def _cone_checks(set: StarSet, points: list[Array]) -> list[Check]:
    x = np.random.default_rng(2).normal(size=(1000, 2))
    checks = [
        vanishes("Fig. 2a k(3x) − 3 k(x)", set.gauge(3.0 * x) - 3.0 * set.gauge(x), 1e-12),
        vanishes("Fig. 2a k − 1 on the boundary", set.gauge(set.boundary(720)) - 1.0, 1e-12),
    ]
    for name, point in zip(("smooth point", "corner"), points, strict=True):
        normals = set.normal_cone(point).generators
        tangents = set.tangent_cone(point).generators
        steps = np.array([0.1, 1.0, 10.0])[:, None, None] * normals
        gaps = [set.fenchel_gap(point, normal) for normal in normals]
        checks += [
            never_positive(f"Fig. 2b N·T at the {name}", normals @ tangents.T, 1e-9),
            vanishes(
                f"Fig. 2b (12) x − prox(x + r y) at the {name}",
                set.project(point + steps) - point,
                1e-9,
            ),
            vanishes(f"Fig. 2b (5) Fenchel gap at the {name}", np.array(gaps), 1e-9),
        ]
    return checks
