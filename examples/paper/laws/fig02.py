"""Figure 2: Gauge, cones and proximal points
=============================================

How is a set told to a computer? By its gauge, whose level set it is; normal and tangent cones and
the nearest points follow from it. The paper gives no numbers for these sets; those here are our
own.
"""

import asperity as asp
import numpy as np
from asperity.demo import Check
from asperity.plot import plot_cones, plot_gauge, plot_projection, plot_set
from matplotlib.axes import Axes
from paper.curves import named
from paper.drawing import INK, Array, closed_outline, unit_vectors
from paper.frame import Redrawn, drawn, panels, show
from paper.statements import never_positive, vanishes

CORNERED = asp.Ellipse(1.0, 0.7) & asp.Rectangle(0.8, 1.0)
"""A convex set with two flats, four corners and two arcs."""

CORNER = np.array([0.8, 0.42])
"""Corner of `CORNERED`."""

_HEIGHT = 1.3
"""Value of the gauge at which its surface in Fig. 2a ends."""


def _draw_projection(ax: Axes, z: Array) -> None:
    *lines, points, feet = drawn(plot_projection, CORNERED, ax, z=z)
    for name, artists in (("z", [points]), ("prox(z)", [feet]), ("line from z to prox(z)", lines)):
        named(name, artists)


def _draw_cones(ax: Axes, name: str, x: Array) -> None:
    point, *normals = drawn(plot_cones, CORNERED, ax, x=x, tangent=False, size=0.36)
    _, *tangents = drawn(plot_cones, CORNERED, ax, x=x, normal=False, size=0.36)
    named(name, [point])
    named(f"N_C({name})", normals)
    named(f"edge of T_C({name})", tangents)


def _cone_checks(set: asp.StarSet, points: list[Array]) -> list[Check]:
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


def draw() -> Redrawn:
    """Draw (a) a gauge with its level curve C, (b) normal and tangent cones and proximal points."""
    figure, (left, right) = panels(2, "gauge, cones and proximal points", 2, figsize=(10.4, 4.8))
    left.remove()
    smooth = float(CORNERED.radius(2.1)) * unit_vectors(2.1)
    outside = np.array([CORNER + 0.55 * unit_vectors(0.35), [1.25, -0.2], [-0.35, -1.1]])
    space = figure.add_subplot(1, 2, 1, projection="3d")
    plot_gauge(CORNERED, ax=space, height=_HEIGHT)
    for name, line in zip(("level curve", "boundary"), space.lines, strict=True):
        named(name, [line])
    space.set_title(r"(a) gauge $k_C$ and level set $C = \{k_C \leq 1\}$")
    named("boundary", drawn(plot_set, CORNERED, right, label="$C$"))
    _draw_projection(right, outside)
    for name, point in (("smooth point", smooth), ("corner", CORNER)):
        _draw_cones(right, name, point)
    right.annotate("$N_C(x)$", (1.06, 0.74), color=INK)
    right.annotate("$T_C(x)$", (0.61, 0.22), color=INK, ha="center")
    right.set_title("(b) normal and tangent cones, proximal points")
    right.legend(loc="upper left", bbox_to_anchor=(0.0, -0.13), ncols=3)
    outline = closed_outline(CORNERED)
    k = np.linspace(0.0, _HEIGHT, 27)[:, None, None] * np.ones((1, len(outline), 1))
    gauge = np.concatenate([k * outline, k], axis=-1)[:, ::4].reshape(-1, 3)
    return Redrawn(figure, _cone_checks(CORNERED, [smooth, CORNER]), [("a", "gauge", gauge)])


# %%
if __name__ == "__main__":
    show(draw)
