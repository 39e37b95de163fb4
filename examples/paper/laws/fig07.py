"""Figure 7: Further force reservoirs
=====================================

What lies between an ellipse and a rectangle? Superellipses, and a rectangle with two half-ellipses.
The paper gives no numbers for these sets; those here are our own.
"""

import asperity as asp
import numpy as np
from asperity.demo import Check
from paper.curves import named
from paper.drawing import BLUE, GREEN, GREY, INK, ORANGE, SKY, circle, closed_outline, unit_vectors
from paper.frame import Redrawn, cross, draw_law, panels, shared_legend, show
from paper.laws.fig05 import PAIR
from paper.statements import never_positive, truth, vanishes

ROUNDNESS = (0.7, 1.0, 1.5, 2.0, 4.0, 30.0)
"""Roundness factors of Fig. 7a; only the first gives a set that is not convex."""

_COLORS = (GREY, SKY, GREEN, BLUE, ORANGE, INK)

RUNNER = asp.CappedRectangle(0.35, 0.3, cap=0.25)
"""Rectangle of half-widths 0.35, 0.3 with half-ellipses of semi-axis 0.25 on both ends."""


def _superellipse_checks() -> list[Check]:
    diagonal = np.array([1.0, 1.0])
    sets = [asp.Superellipse(*PAIR, s) for s in ROUNDNESS]
    expected = [float(np.sum(np.power(PAIR, -s)) ** (1.0 / s)) for s in ROUNDNESS]
    found = [float(star.gauge(diagonal)) for star in sets]
    return [
        vanishes("Fig. 7a (37) gauge at (1, 1)", np.subtract(found, expected), 1e-9),
        truth(
            "Fig. 7a convex exactly for s ≥ 1",
            all(bool(star.is_convex) == (star.exponent >= 1.0) for star in sets),
        ),
        truth("Fig. 7a s = 1 is not strictly convex", not sets[1].is_strictly_convex),
        truth("Fig. 7a s = 2 is the ellipse", asp.Superellipse(*PAIR, 2.0).is_strictly_convex),
    ]


def _runner_checks() -> list[Check]:
    # The set is the sum of a segment and an ellipse, and so is its support function.
    normals = unit_vectors(circle(720))
    ellipse = np.hypot(RUNNER.cap * normals[:, 0], RUNNER.b * normals[:, 1])
    expected = RUNNER.a * np.abs(normals[:, 0]) + ellipse
    points = RUNNER.boundary(240)
    middles = 0.5 * (points[:, None] + points)
    return [
        vanishes("Fig. 7b support function", RUNNER.support(normals) - expected, 1e-9),
        never_positive("Fig. 7b gauge of chords' midpoints − 1", RUNNER.gauge(middles) - 1.0, 1e-9),
        truth("Fig. 7b is convex", RUNNER.is_convex),
        truth("Fig. 7b is not strictly convex", not RUNNER.is_strictly_convex),
    ]


def draw() -> Redrawn:
    """Draw (a) superelliptic reservoirs, (b) a rectangle with two half-ellipses."""
    figure, (left, right) = panels(7, "further force reservoirs", 2, figsize=(10.6, 4.0))
    for s, color in zip(ROUNDNESS, _COLORS, strict=True):
        star = asp.Superellipse(*PAIR, s)
        dash = "-" if star.is_convex else "--"
        left.plot(*closed_outline(star).T, dash, color=color, label=f"$s = {s:g}$")
    left.set(title="(a) superellipses with roundness factor $s$", aspect="equal")
    left.legend(loc="upper center", ncols=3, fontsize="small")
    draw_law(asp.FrictionLaw.associated(RUNNER), right, angles=20)
    x, y = np.array([[-RUNNER.a], [RUNNER.a]]), np.array([-RUNNER.b, RUNNER.b])
    seams = [line for at in x for line in right.plot(np.tile(at, 2), y, ":", color=GREY)]
    named("end of the rectangle", seams)
    right.set_title("(b) rectangle and two half-ellipses")
    for ax in (left, right):
        cross(ax)
        ax.set(xlabel=r"$-\lambda_1/\lambda_N$", ylabel=r"$-\lambda_2/\lambda_N$")
        ax.set(xlim=(-0.85, 0.85), ylim=(-0.55, 0.62))
    shared_legend(figure, [right])
    return Redrawn(figure, [*_superellipse_checks(), *_runner_checks()])


# %%
if __name__ == "__main__":
    show(draw)
