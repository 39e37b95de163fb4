"""Figure 1: Convex, star-shaped and other sets
===============================================

Which sets can hold friction forces? A force may be reduced to any share of it, so that the segment
from the origin to each point must lie in the set: it is star-shaped. Convexity asks for all
segments. The paper gives no numbers for these sets; those here are our own.
"""

import asperity as asp
import numpy as np
from asperity.demo import Check
from matplotlib.axes import Axes
from matplotlib.path import Path
from paper.drawing import GREEN, INK, ORANGE, RESERVOIR, Array, closed_outline, unit_vectors
from paper.frame import Redrawn, panels, shared_legend, show
from paper.statements import never_positive, truth

_ANGLE = 2.0 * np.pi * np.arange(72) / 72

CONVEX = asp.SupportCurve(_ANGLE, 1.0 + 0.10 * np.cos(2.0 * _ANGLE) + 0.04 * np.sin(3.0 * _ANGLE))
"""A strictly convex set; h + h″ = 1 − 0.30 cos 2φ − 0.32 sin 3φ > 0."""

STAR = asp.PolarCurve(_ANGLE, 0.85 + 0.22 * np.cos(3.0 * _ANGLE + 0.5) + 0.08 * np.sin(_ANGLE))
"""A star-shaped set with three lobes."""


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
    return behind[np.argmax(np.linalg.norm(behind, axis=1))]


def _draw_segment(ax: Axes, ends: Array, *, inside: bool) -> None:
    color, label = (GREEN, "segment in the set") if inside else (ORANGE, "segment leaving the set")
    ax.plot(*ends.T, "o-", color=color, markersize=4.5, label=label, zorder=1.9)


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
        truth("Fig. 1b is star-shaped", asp.star_shape(STAR.boundary(720))),
        truth("Fig. 1c is not star-shaped", not asp.star_shape(outline)),
        truth(
            "Fig. 1c the segment shown leaves the set",
            not Path(outline).contains_points(np.outer([0.4, 0.6, 0.8], hidden(outline))).all(),
        ),
    ]


def draw() -> Redrawn:
    """Draw a convex, a star-shaped and a not star-shaped set with segments that tell them apart."""
    figure, axes = panels(1, "convex, star-shaped and other sets", 3)
    outline = hooked()
    chord, ray = CONVEX.boundary(72)[[10, 40]], STAR.boundary(72)[38]
    leaving = STAR.is_convex.witness
    outlines = [closed_outline(CONVEX), closed_outline(STAR), np.vstack([outline, outline[:1]])]
    titles = ("(a) convex", "(b) star-shaped, not convex", "(c) not star-shaped")
    for ax, title, closed in zip(axes, titles, outlines, strict=True):
        ax.plot(*closed.T, color=RESERVOIR, gid="boundary")
        ax.fill(*closed.T, color=RESERVOIR, alpha=0.08, linewidth=0.0)
        ax.plot(0.0, 0.0, "o", color=INK, markersize=3.5, label="origin")
        ax.set(title=title, xlabel="$x_1$", ylabel="$x_2$", aspect="equal")
        ax.set(xlim=(-1.2, 1.2), ylim=(-1.1, 1.2))
    _draw_segment(axes[0], chord, inside=True)
    _draw_segment(axes[1], np.stack([np.zeros(2), ray]), inside=True)
    if leaving is not None:
        _draw_segment(axes[1], leaving, inside=False)
    far = np.stack([np.zeros(2), hidden(outline)])
    _draw_segment(axes[2], far, inside=False)
    shared_legend(figure, axes)
    return Redrawn(figure, _kinds(outline))


# %%
if __name__ == "__main__":
    show(draw)
