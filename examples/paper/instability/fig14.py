"""Figure 14: A mass on a moving belt
=====================================

What remains if no other mechanism acts than anisotropic friction? A mass on two springs and a belt;
the model has two degrees of freedom.
"""

import asperity as asp
import numpy as np
from asperity.demo import Check
from asperity.demo.belt import LAW
from paper.drawing import circle, unit_vectors
from paper.frame import Redrawn, panels, show
from paper.sketches.mechanisms import belt_from_above, belt_in_space
from paper.statements import vanishes


def belt(phi: float, speed: float = 1.0) -> asp.MassOnBelt:
    """Return the paper's mass on a belt that runs in the direction φ."""
    return asp.MassOnBelt(
        1.0, stiffness=1.0, law=LAW, normal_force=1.0, belt_velocity=speed * unit_vectors(phi)
    )


def _model_checks() -> list[Check]:
    directions = circle(24)
    systems = [belt(phi) for phi in directions]
    forces = LAW.force(-unit_vectors(directions))
    matrices = [asp.stability(system).matrix for system in systems]
    return [
        vanishes(
            "Fig. 14 (77) K q_eq − λ(−v)", [one.equilibrium for one in systems] - forces, 1e-12, "N"
        ),
        vanishes(
            "Fig. 14 (77) q_eq against the search for it",
            np.array([asp.equilibrium(one).q - one.equilibrium for one in systems]),
            1e-9,
            "m",
        ),
        vanishes(
            "Fig. 14 (86) B χ",
            np.einsum("nij,nj->ni", matrices, unit_vectors(directions)),
            1e-9,
            "N",
        ),
    ]


def draw() -> Redrawn:
    """Draw the mass on the belt (a) in space, (b) as a model of two degrees of freedom."""
    figure, (left, right) = panels(14, "mass on a moving belt", 2, figsize=(9.2, 3.9))
    belt_in_space(left)
    left.set_title("(a) mass, springs and grooved belt")
    belt_from_above(right)
    for ax in (left, right):
        ax.set_anchor("N")
    right.set_title("(b) the model from above")
    return Redrawn(figure, _model_checks())


# %%
if __name__ == "__main__":
    show(draw)
