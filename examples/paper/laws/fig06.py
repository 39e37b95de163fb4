"""Figure 6: The X–Y table
==========================

Which law do two slide bearings at right angles make? Its reservoir is a rectangle. The paper gives
no numbers for these sets; those here are our own.
"""

import asperity as asp
import numpy as np
from paper.frame import Redrawn, cross, draw_law, panels, shared_legend, show
from paper.laws.fig05 import PAIR
from paper.sketches.laws import xy_table
from paper.statements import truth, vanishes

_HALF = np.array([[1, -1], [1, 0], [1, 1], [0.5, 1], [0, 1], [-0.5, 1]], dtype=float)

_SIDES = np.vstack([_HALF, -_HALF])
"""Corners and points between them on the square |xᵢ| ≤ 1."""


def draw() -> Redrawn:
    """Draw (a) an X–Y table, (b) its associated law with rectangular reservoir."""
    figure, (left, right) = panels(6, "X–Y table", 2, figsize=(9.6, 4.4))
    law = asp.FrictionLaw.associated(asp.Rectangle(*PAIR))
    x, y = PAIR[0] * _SIDES[:, 0], PAIR[1] * _SIDES[:, 1]
    xy_table(left)
    left.set_title("(a) two slide bearings, from above")
    draw_law(law, right, angles=np.arctan2(y, x))
    right.set_title(r"(b) $\mu_1 = 0.6$, $\mu_2 = 0.3$")
    cross(right)
    shared_legend(figure, [right])
    slips = np.random.default_rng(3).normal(size=(1000, 2))
    along = np.array([[2.0, 0.0], [0.0, -3.0]])
    checks = [
        vanishes("Fig. 6b (35) −λ − μ Sign(γ)", law.force(slips) + PAIR * np.sign(slips), 1e-12),
        vanishes(
            "Fig. 6b dissipation along an axis",
            law.dissipation(along) - np.abs(along) @ PAIR,
            1e-12,
        ),
        truth("Fig. 6b is convex", law.reservoir.is_convex),
        truth("Fig. 6b is not strictly convex", not law.reservoir.is_strictly_convex),
    ]
    return Redrawn(figure, checks)


# %%
if __name__ == "__main__":
    show(draw)
