"""Figs. 11 and 12 of [WL19]: extended normal cone inclusions and tensor laws.

The paper's parameters of Fig. 12 are not public; those here and those of Fig. 11 are own.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from matplotlib.artist import Artist
from matplotlib.axes import Axes
from matplotlib.patches import Arc
from scipy.integrate import cumulative_simpson

from asperity._base.arrays import Array, unit_vectors
from asperity.errors import ParameterError
from asperity.law import FrictionLaw
from asperity.paper.checks import Check
from asperity.paper.data import Curves
from asperity.paper.redrawn import (
    Redrawn,
    circle,
    cross,
    draw_law,
    note,
    panels,
    record,
    shared_legend,
)
from asperity.paper.statements import never_positive, proposition_5, truth, vanishes
from asperity.plot.look import INK, SLIDING, draw_arrows, style
from asperity.sets import Ellipse, Superellipse

ELLIPSES = FrictionLaw(Ellipse(0.6, 0.3), Ellipse(1.0, 0.85))
"""The law of Fig. 11a."""

DENTED = FrictionLaw(Ellipse(0.6, 0.22) | Ellipse(0.3, 0.5), Superellipse(1.3, 1.0, 2.5))
"""The law of Fig. 11b; its C is the union of two ellipses."""

SECOND_ORDER = np.diag([0.3, 0.1])
"""Tensor of Fig. 12a."""


def fourth_order() -> Array:
    """Return the tensor of Fig. 12c: k₁₁₁₁ = k₂₂₂₂ = 0.1, k₁₁₂₂ = k₂₂₁₁ = −0.1."""
    tensor = np.zeros((2, 2, 2, 2))
    tensor[0, 0, 0, 0] = tensor[1, 1, 1, 1] = 0.1
    tensor[0, 0, 1, 1] = tensor[1, 1, 0, 0] = -0.1
    return tensor


def coefficient(phi: Array) -> Array:
    """Return the friction tensor of Fig. 12b, (0.2 + 0.05 cos 4φ) times the unit tensor."""
    return (0.2 + 0.05 * np.cos(4.0 * phi))[:, None, None] * np.eye(2)


def tensor_laws() -> dict[str, FrictionLaw]:
    """Return the three laws of Fig. 12 by panel."""
    return {
        "a": FrictionLaw.tensor(SECOND_ORDER),
        "b": FrictionLaw.tensor_function(coefficient),
        "c": FrictionLaw.tensor(0.2 * np.eye(2), fourth_order=fourth_order()),
    }


def fig11() -> Redrawn:
    """Draw non-associated laws (a) with elliptic sets, (b) with a reservoir that is not convex."""
    figure, axes = panels(11, "non-associated friction laws", 2)
    curves = Curves()
    titles = ("(a) elliptic $C$ and $D$", "(b) non-convex $C$")
    chosen = np.deg2rad([12.0, 68.0])
    places = (((-4, 9), (-66, 10)), ((9, -7), (-63, -25)))
    with style():
        for ax, panel, law, title, theta, labels in zip(
            axes, "ab", (ELLIPSES, DENTED), titles, chosen, places, strict=True
        ):
            draw_law(curves, panel, law, ax, angles=[theta, theta + np.pi, np.pi - theta, -theta])
            scaling = _draw_scaling(ax, law, theta, labels)
            for name, artist in scaling.items():
                record(curves, panel, name, [artist])
            ax.set_title(title)
            cross(ax)
        shared_legend(figure, axes)
    return Redrawn(figure, curves, [*_ellipse_checks(), *_dented_checks()])


def _draw_scaling(
    ax: Axes, law: FrictionLaw, theta: float, labels: Sequence[tuple[int, int]]
) -> dict[str, Artist]:
    """Draw one force and its point z on bdry D, where the sliding direction is normal."""
    ray = unit_vectors(theta)
    force, z = law.reservoir.radius(theta) * ray, law.direction.radius(theta) * ray
    arrow = draw_arrows(ax, np.zeros((1, 2)), force[None], color=INK)
    slip = law.slip_direction(-force)
    normal = draw_arrows(ax, z[None], 0.15 * slip[None], color=SLIDING)
    (dot,) = ax.plot(*z, "o", color=INK, markerfacecolor="white", markersize=5.0, zorder=5.0)
    texts = (r"$-\lambda$", r"$z = -\alpha\lambda$")
    for text, point, place in zip(texts, (force, z), labels, strict=True):
        note(ax, text, point, place)
    return {"force from the origin": arrow, "z": dot, "sliding direction at z": normal}


def _ellipse_checks() -> list[Check]:
    slip = unit_vectors(circle(720))
    force = -ELLIPSES.force(slip)
    reservoir, direction = np.array([0.6, 0.3]), np.array([1.0, 0.85])
    turned = np.square(direction / reservoir) * slip
    gap = ELLIPSES.reservoir.support(turned) - np.sum(force * turned, axis=-1)
    return [
        vanishes("Fig. 11a (54) Fenchel gap of T²γ", gap, 1e-12),
        *proposition_5("Fig. 11a", ELLIPSES),
    ]


def _dented_checks() -> list[Check]:
    points = np.random.default_rng(5).normal(size=(2000, 2)) * 0.4
    gauge_c, gauge_d = DENTED.reservoir.gauge(points), DENTED.direction.gauge(points)
    alpha = 1.0 / (gauge_d - gauge_c + 1.0)
    z = alpha[:, None] * points
    inverse = DENTED.reservoir.gauge(z) - DENTED.direction.gauge(z) + 1.0
    return [
        truth("Fig. 11b C is not convex", not DENTED.reservoir.is_convex),
        truth("Fig. 11b D is convex", DENTED.direction.is_convex),
        never_positive("Fig. 11b (63) k_C − k_D", gauge_c - gauge_d, 1e-12),
        vanishes("Fig. 11b (67) α(z) − α(−λ)", inverse - alpha, 1e-12),
        *proposition_5("Fig. 11b", DENTED),
    ]


def fig12() -> Redrawn:
    """Draw three tensor laws: orthotropic, with non-constant tensor, of fourth order."""
    figure, axes = panels(
        12, "tensor laws", 3, parameters="own parameters: those of the paper are not public"
    )
    curves, laws = Curves(), tensor_laws()
    titles = {
        "a": r"(a) $F = \mathrm{diag}(0.3, 0.1)$",
        "b": r"(b) $F = (0.2 + 0.05\cos 4\varphi)\,I$",
        "c": "(c) fourth order",
    }
    with style():
        for ax, (panel, law) in zip(axes, laws.items(), strict=True):
            draw_law(curves, panel, law, ax, angles=8 if panel == "c" else 20)
            ax.set_title(titles[panel])
            cross(ax)
        _draw_angles(axes[2], laws["c"], np.deg2rad(60.0), curves)
        shared_legend(figure, axes)
    return Redrawn(figure, curves, _tensor_checks(laws))


def _draw_angles(ax: Axes, law: FrictionLaw, phi: float, curves: Curves) -> None:
    """Mark θ, the angle of a force −λ, and φ, that of its sliding direction γ."""
    slip = unit_vectors(phi)
    force = -law.force(slip)
    theta = float(np.arctan2(force[1], force[0]))
    arrow = draw_arrows(ax, np.zeros((1, 2)), force[None], color=INK)
    record(curves, "c", "force from the origin", [arrow])
    along = draw_arrows(ax, force[None], 0.09 * slip[None], color=SLIDING)
    record(curves, "c", "sliding direction of this force", [along])
    for apex, angle, radius, name in (
        (np.zeros(2), theta, 0.11, "theta"),
        (force, phi, 0.05, "varphi"),
    ):
        ax.add_patch(Arc(tuple(apex), 2 * radius, 2 * radius, theta2=np.rad2deg(angle), color=INK))
        level = apex + np.array([[0.0, 0.0], [1.3 * radius, 0.0]])
        record(curves, "c", f"{name} is counted from", ax.plot(*level.T, color=INK, linewidth=0.8))
        middle = apex + 1.35 * radius * unit_vectors(0.45 * angle)
        note(ax, rf"$\{name}$", middle, ha="center", va="center")


def _tensor_checks(laws: dict[str, FrictionLaw]) -> list[Check]:
    a, b, c = laws.values()
    quarter = np.array([0.0, 0.5 * np.pi])
    radii = b.direction.radius(circle(720))
    rebuilt = FrictionLaw.from_flow_rule(lambda phi: unit_vectors(phi) @ SECOND_ORDER.T).direction
    checks = [
        Check("Fig. 12a p₁/p₂ = √3", 3.0**0.5, _ratio(a.direction.radius(quarter)), 1e-8),
        Check("Fig. 12a p₁/p₂ from forces alone", 3.0**0.5, _ratio(rebuilt.radius(quarter)), 1e-8),
        Check("Fig. 12a n₁/n₂", 3.0, _ratio(a.reservoir.radius(quarter)), 1e-8),
        vanishes(
            "Fig. 12a C − ellipse",
            a.reservoir.radius(circle(720)) - Ellipse(0.3, 0.1).radius(circle(720)),
            1e-6,
        ),
        truth("Fig. 12b found collinear", b.is_collinear),
        Check("Fig. 12b largest / smallest r_D", 1.0, float(radii.max() / radii.min()), 1e-8),
        truth("Fig. 12b C is not convex", not b.reservoir.is_convex),
        truth("Fig. 12c C is not convex", not c.reservoir.is_convex),
        truth("Fig. 12c D is convex", c.direction.is_convex),
        Check("Fig. 12 closure of a skew tensor", 6.13, _closure(SECOND_ORDER + _SKEW), 5e-3),
        truth("Fig. 12 the skew tensor is refused", _refused(SECOND_ORDER + _SKEW)),
    ]
    for panel, law in laws.items():
        checks += [
            vanishes(f"Fig. 12{panel} (71) against D, relative", _quadrature(law), 1e-5),
            *proposition_5(f"Fig. 12{panel}", law),
        ]
    return checks


_SKEW = np.array([[0.0, -0.05], [0.05, 0.0]])


def _ratio(pair: Array) -> float:
    return float(pair[0] / pair[1])


def _closure(tensor: Array) -> float:
    """Return r_D(2π)/r_D(0) = exp ∮ l_p/l_t dφ by the rectangle rule, which is exact here."""
    phi = circle(720)
    force = unit_vectors(phi) @ tensor.T
    along = np.sum(force * unit_vectors(phi), axis=-1)
    across = np.sum(force * unit_vectors(phi + 0.5 * np.pi), axis=-1)
    return float(np.exp(2.0 * np.pi * np.mean(across / along)))


def _refused(tensor: Array) -> bool:
    try:
        FrictionLaw.tensor(tensor)
    except ParameterError:
        return True
    return False


def _quadrature(law: FrictionLaw) -> Array:
    """r_D from (71) by Simpson's rule over θ, relative to r_D of the law."""
    phi = np.linspace(0.0, 2.0 * np.pi, 5761)
    force = -law.force(unit_vectors(phi))
    theta = np.unwrap(np.arctan2(force[:, 1], force[:, 0]))
    grown = np.exp(cumulative_simpson(np.tan(theta - phi), x=theta, initial=0.0))
    radius = law.direction.radius(theta)
    difference: Array = grown * radius[0] / radius - 1.0
    return difference
