"""Figure 4: Planar contact and isotropic friction
==================================================

Which forces act in the contact plane, in stick and in slip? The paper gives no numbers for these
sets; those here are our own.
"""

import asperity as asp
import numpy as np
from paper.drawing import INK, circle, draw_arrows, unit_vectors
from paper.frame import Redrawn, cross, draw_law, note, panels, shared_legend, show
from paper.sketches.laws import contact_plane
from paper.statements import vanishes

MU = 0.3
"""Friction coefficient of Fig. 4."""


def draw() -> Redrawn:
    """Draw (a) the contact plane and the forces on body 1, (b) isotropic friction."""
    figure, (left, right) = panels(4, "planar contact and isotropic friction", 2)
    law = asp.FrictionLaw.isotropic(MU)
    stick, slip = 0.55 * MU * unit_vectors(-0.6), np.array([0.3, 2.5, 4.4])
    contact_plane(left)
    left.set_title("(a) contact forces on body 1")
    draw_law(law, right, angles=slip, forces="arrows")
    draw_arrows(right, np.zeros((1, 2)), stick[None], color=INK, gid="force in stick")
    note(right, r"stick: $\gamma = 0$", stick, (-24, -14))
    note(right, "slip", MU * unit_vectors(slip[0]), (12, -12))
    right.set_title(r"(b) isotropic friction, $\mu = 0.3$")
    cross(right)
    shared_legend(figure, [right])
    slips = 2.0 * unit_vectors(circle(720))
    checks = [
        vanishes("Fig. 4b (33) λ + μ γ/‖γ‖", law.force(slips) + MU * slips / 2.0, 1e-12),
        vanishes("Fig. 4b γ in stick", law.slip_direction(-stick), 0.0),
    ]
    return Redrawn(figure, checks)


# %%
if __name__ == "__main__":
    show(draw)
