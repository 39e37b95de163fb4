"""Figure 8: The collinear friction law
=======================================

Can the force oppose the sliding direction although its size depends on it? Then the law is not
associated with its own reservoir. The parameters are our own. Fig. 9, a sketch of a spring on an
inclined plane, is left out.
"""

import asperity as asp
import numpy as np
from asperity.demo import Check
from paper.drawing import Array, circle, unit_vectors
from paper.frame import Redrawn, cross, draw_law, panels, shared_legend, show
from paper.statements import truth, vanishes

PAIR = (0.6, 0.3)
"""Friction coefficients μ₁, μ₂ of Fig. 8."""

COLLINEAR = asp.FrictionLaw.collinear(asp.Ellipse(*PAIR))
"""The law of Fig. 8."""


def _collinear_checks() -> list[Check]:
    slip = unit_vectors(circle(720))
    force = -COLLINEAR.force(slip)
    coefficient = 1.0 / np.hypot(*(slip / PAIR).T)
    ellipse = COLLINEAR.reservoir
    twice = slip / np.square(PAIR)
    return [
        vanishes(
            "Fig. 8 (42) friction coefficient", np.linalg.norm(force, axis=1) - coefficient, 1e-12
        ),
        vanishes(
            "Fig. 8 (43) Fenchel gap in T C", _gap(asp.Disk(1.0), force / PAIR, slip / PAIR), 1e-12
        ),
        vanishes("Fig. 8 (44) Fenchel gap in C", _gap(ellipse, force, twice), 1e-12),
        vanishes("Fig. 8 deflection", np.rad2deg(COLLINEAR.deflection(circle(720))), 1e-9, "deg"),
        truth("Fig. 8 found collinear", COLLINEAR.is_collinear),
        truth("Fig. 8 found not associated", not COLLINEAR.is_associated),
    ]


def _gap(convex: asp.StarSet, x: Array, y: Array) -> Array:
    """Ψ*_C(y) − xᵀy at boundary points x, 0 exactly for y ∈ N_C(x)."""
    return convex.support(y) - np.sum(x * y, axis=-1)


def draw() -> Redrawn:
    """Draw the collinear law (a) transformed to the unit disk, (b) with its elliptic reservoir."""
    figure, (left, right) = panels(8, "collinear friction law", 2, width_ratios=(1.0, 1.45))
    phi = 2.0 * np.pi * np.arange(16) / 16
    force = -COLLINEAR.force(unit_vectors(phi))
    transformed = np.arctan2(*(force / PAIR).T[::-1])
    draw_law(asp.FrictionLaw.isotropic(1.0), left, prefix="T ", angles=transformed)
    left.set(
        title=r"(a) $T\gamma \in N_{TC}(-T\lambda)$",
        xlabel=r"$-\lambda_1/(\mu_1\lambda_N)$",
        ylabel=r"$-\lambda_2/(\mu_2\lambda_N)$",
    )
    draw_law(COLLINEAR, right, angles=phi)
    right.set_title(r"(b) $\mu_1 = 0.6$, $\mu_2 = 0.3$")
    for ax in (left, right):
        cross(ax)
    shared_legend(figure, [right])
    return Redrawn(figure, _collinear_checks())


# %%
if __name__ == "__main__":
    show(draw)
