"""Figure 10: The asperity model
================================

What do wedge-shaped asperities do to friction? The reservoir ceases to be convex. The parameters μ
= 1.2, β = 36° are those of the paper.
"""

import asperity as asp
import numpy as np
from asperity.demo import Check
from paper.drawing import Array, circle, unit_vectors
from paper.frame import Redrawn, cross, draw_law, panels, shared_legend, show
from paper.sketches.laws import wedges
from paper.statements import never_positive, truth, vanishes

MU, BETA = 1.2, np.deg2rad(36.0)
"""The paper's parameters of Fig. 10b."""

RADII = (7.643276410, 5.719896099, 3.471719339, 2.332058637, 1.796360109, 1.553757994, 1.483281573)
"""r_C at θ = 0°, 15°, …, 90° for these parameters."""


def _asperity_checks(law: asp.FrictionLaw) -> list[Check]:
    reservoir = asp.WedgeAsperity(MU, beta=float(BETA))
    checks = [
        Check(f"Fig. 10b (50) r_C at {15 * k}°", expected, float(computed), 1e-9)
        for k, (expected, computed) in enumerate(
            zip(RADII, reservoir.radius(np.deg2rad(15.0 * np.arange(7))), strict=True)
        )
    ]
    phi = circle(720)
    mean = 0.5 * (_flank(phi, float(BETA)) + _flank(phi, -float(BETA)))
    across, along = law.direction.radius([0.0, 0.5 * np.pi])
    return [
        *checks,
        vanishes("Fig. 10b (49) against (50): gauge − 1", reservoir.gauge(mean) - 1.0, 1e-12),
        vanishes("Fig. 10b (49) against the law", -law.force(unit_vectors(phi)) - mean, 1e-9),
        Check("Fig. 10b (52) p₂/p₁", float(np.cos(BETA)), float(along / across), 1e-12),
    ]


def _flank(phi: Array, beta: float) -> Array:
    """(H_T1, H_T2), the forces per unit normal force on a flank of slope β, from (45)–(47)."""
    length = np.hypot(np.cos(phi), np.cos(beta) * np.sin(phi))
    c1, c2 = np.cos(phi) / length, np.cos(beta) * np.sin(phi) / length
    across = np.tan(beta + np.arctan(MU * c1))
    along = MU * c2 / (np.cos(beta) - MU * c1 * np.sin(beta))
    return np.stack([across, along], axis=-1)


def _convexity_checks(law: asp.FrictionLaw) -> list[Check]:
    # C is convex up to μ tan β = 1/√2.
    limit = float(np.arctan(np.sqrt(0.5) / MU))
    return [
        truth("Fig. 10b C is not convex", not law.reservoir.is_convex),
        truth("Fig. 10b C is star-shaped", asp.star_shape(law.reservoir.boundary(720))),
        truth(
            "Fig. 10 convex just below μ tan β = 1/√2",
            asp.WedgeAsperity(MU, beta=limit - 1e-6).is_convex,
        ),
        truth(
            "Fig. 10 not convex just above", not asp.WedgeAsperity(MU, beta=limit + 1e-6).is_convex
        ),
        truth("Fig. 10b D ⊆ C", law.direction.margin_inside(law.reservoir) >= -1e-12),
        never_positive(
            "Fig. 10b trace criterion, largest −(l_t + dl_p/dφ)",
            -law.trace_criterion(circle(720)),
            1e-9,
        ),
    ]


def draw() -> Redrawn:
    """Draw (a) wedge asperities under springs, (b) the non-convex reservoir that they cause."""
    figure, (left, right) = panels(
        10,
        "asperity model",
        2,
        parameters="parameters of the paper",
        figsize=(10.8, 4.3),
        width_ratios=(1.0, 1.45),
    )
    law = asp.FrictionLaw.asperity(MU, beta=float(BETA))
    wedges(left, float(BETA))
    left.set_title("(a) springs on wedge asperities")
    draw_law(law, right, angles=32)
    right.set_title(r"(b) $\mu = 1.2$, $\beta = 36°$")
    cross(right)
    shared_legend(figure, [right])
    return Redrawn(figure, [*_asperity_checks(law), *_convexity_checks(law)])


# %%
if __name__ == "__main__":
    show(draw)
