"""Figs. 8 and 10 of [WL19]: the collinear law and the asperity model.

Fig. 10 has the paper's parameters μ = 1.2, β = 36°; those of Fig. 8 are own. Fig. 9, a sketch of
a spring on an inclined plane, is left out.
"""

from __future__ import annotations

import numpy as np

from asperity._base.arrays import Array, unit_vectors
from asperity.law import FrictionLaw
from asperity.paper.checks import Check
from asperity.paper.data import Curves
from asperity.paper.redrawn import Redrawn, circle, cross, draw_law, panels, shared_legend
from asperity.paper.sketches import wedges
from asperity.paper.statements import never_positive, truth, vanishes
from asperity.plot.look import style
from asperity.sets import Disk, Ellipse, StarSet, WedgeAsperity, star_shape

PAIR = (0.6, 0.3)
"""Friction coefficients μ₁, μ₂ of Fig. 8."""

MU, BETA = 1.2, np.deg2rad(36.0)
"""The paper's parameters of Fig. 10b."""

RADII = (7.643276410, 5.719896099, 3.471719339, 2.332058637, 1.796360109, 1.553757994, 1.483281573)
"""r_C at θ = 0°, 15°, …, 90° for these parameters."""

COLLINEAR = FrictionLaw.collinear(Ellipse(*PAIR))
"""The law of Fig. 8."""


def fig08() -> Redrawn:
    """Draw the collinear law (a) transformed to the unit disk, (b) with its elliptic reservoir."""
    figure, (left, right) = panels(8, "collinear friction law", 2, width_ratios=(1.0, 1.45))
    curves = Curves()
    phi = 2.0 * np.pi * np.arange(16) / 16
    force = -COLLINEAR.force(unit_vectors(phi))
    with style():
        transformed = np.arctan2(*(force / PAIR).T[::-1])
        draw_law(curves, "a", FrictionLaw.isotropic(1.0), left, prefix="T ", angles=transformed)
        left.set(
            title=r"(a) $T\gamma \in N_{TC}(-T\lambda)$",
            xlabel=r"$-\lambda_1/(\mu_1\lambda_N)$",
            ylabel=r"$-\lambda_2/(\mu_2\lambda_N)$",
        )
        draw_law(curves, "b", COLLINEAR, right, angles=phi)
        right.set_title(r"(b) $\mu_1 = 0.6$, $\mu_2 = 0.3$")
        for ax in (left, right):
            cross(ax)
        shared_legend(figure, [right])
    return Redrawn(figure, curves, _collinear_checks())


def _collinear_checks() -> list[Check]:
    slip = unit_vectors(circle(720))
    force = -COLLINEAR.force(slip)
    coefficient = 1.0 / np.hypot(*(slip / PAIR).T)
    ellipse = COLLINEAR.reservoir
    twice = slip / np.square(PAIR)
    return [
        vanishes(
            "Fig. 8 (42) friction coefficient",
            np.linalg.norm(force, axis=1) - coefficient,
            1e-12,
        ),
        vanishes(
            "Fig. 8 (43) Fenchel gap in T C", _gap(Disk(1.0), force / PAIR, slip / PAIR), 1e-12
        ),
        vanishes("Fig. 8 (44) Fenchel gap in C", _gap(ellipse, force, twice), 1e-12),
        vanishes("Fig. 8 deflection", np.rad2deg(COLLINEAR.deflection(circle(720))), 1e-9, "deg"),
        truth("Fig. 8 found collinear", COLLINEAR.is_collinear),
        truth("Fig. 8 found not associated", not COLLINEAR.is_associated),
    ]


def _gap(convex: StarSet, x: Array, y: Array) -> Array:
    """Ψ*_C(y) − xᵀy at boundary points x, 0 exactly for y ∈ N_C(x)."""
    gap: Array = convex.support(y) - np.sum(x * y, axis=-1)
    return gap


def fig10() -> Redrawn:
    """Draw (a) wedge asperities under springs, (b) the non-convex reservoir that they cause."""
    figure, (left, right) = panels(
        10,
        "asperity model",
        2,
        parameters="parameters of the paper",
        figsize=(10.8, 4.3),
        width_ratios=(1.0, 1.45),
    )
    law, curves = FrictionLaw.asperity(MU, beta=float(BETA)), Curves()
    with style():
        wedges(left, float(BETA))
        left.set_title("(a) springs on wedge asperities")
        draw_law(curves, "b", law, right, angles=32)
        right.set_title(r"(b) $\mu = 1.2$, $\beta = 36°$")
        cross(right)
        shared_legend(figure, [right])
    return Redrawn(figure, curves, [*_asperity_checks(law), *_convexity_checks(law)])


def _asperity_checks(law: FrictionLaw) -> list[Check]:
    reservoir = WedgeAsperity(MU, beta=float(BETA))
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


def _convexity_checks(law: FrictionLaw) -> list[Check]:
    # C is convex up to μ tan β = 1/√2.
    limit = float(np.arctan(np.sqrt(0.5) / MU))
    return [
        truth("Fig. 10b C is not convex", not law.reservoir.is_convex),
        truth("Fig. 10b C is star-shaped", star_shape(law.reservoir.boundary(720))),
        truth(
            "Fig. 10 convex just below μ tan β = 1/√2",
            WedgeAsperity(MU, beta=limit - 1e-6).is_convex,
        ),
        truth("Fig. 10 not convex just above", not WedgeAsperity(MU, beta=limit + 1e-6).is_convex),
        truth("Fig. 10b D ⊆ C", law.direction.margin_inside(law.reservoir) >= -1e-12),
        never_positive(
            "Fig. 10b trace criterion, largest −(l_t + dl_p/dφ)",
            -law.trace_criterion(circle(720)),
            1e-9,
        ),
    ]
