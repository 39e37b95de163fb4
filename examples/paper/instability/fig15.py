"""Figure 15: When sliding is unstable
======================================

Which sliding directions are unstable, and how far must C be turned for any to be? The direction
must lead into the tangent cone of C at the force. The parameters are those of §4.3.
"""

from typing import Any

import asperity as asp
import numpy as np
from asperity.demo import Check
from asperity.demo.belt import LAW
from asperity.plot import plot_cones, plot_set
from matplotlib.axes import Axes
from matplotlib.patches import Arc
from paper.curves import named
from paper.drawing import (
    BLUE,
    DIRECTION,
    INK,
    ORANGE,
    PURPLE,
    SLIDING,
    Array,
    circle,
    closed_outline,
    draw_arrows,
    unit_vectors,
)
from paper.frame import Redrawn, cross, drawn, note, panels, shared_legend, show
from paper.statements import truth, vanishes

ZETA = float(np.deg2rad(30.0))
"""Rotation of C."""

ROTATIONS = (17.1144, 72.8856)
"""Rotations in degrees between which there are such directions, sin 2ζ = 9/16."""

_PAPER = "parameters of §4.3"


def _deepest() -> float:
    """Return the direction φ that leads farthest into the tangent cone."""
    phi = np.linspace(*asp.critical_directions(LAW)[0], 401)
    slips = unit_vectors(phi)
    normals = LAW.reservoir.gauge_gradient(-LAW.force(slips))
    sines = np.sum(normals * slips, axis=-1) / np.linalg.norm(normals, axis=-1)
    return float(phi[np.argmin(sines)])


def _draw_tangent_cone(ax: Axes, phi: float) -> None:
    slip = unit_vectors(phi)
    force = -LAW.force(slip)
    named("bdry C", drawn(plot_set, LAW.reservoir, ax, label="reservoir $C$"))
    cone = drawn(plot_cones, LAW.reservoir, ax, x=force, normal=False, size=18.0)
    named("force", cone[:1])
    named("edges of the tangent cone", cone[1:])
    ax.plot([], [], color=PURPLE, label=r"tangent cone $T_C(-\lambda)$ at $-\lambda$")
    _, mode = _damping_mode(LAW, slip)
    # Towards the side on which C goes on anticlockwise.
    mode *= np.sign(mode @ [-force[1], force[0]])
    for name, tail, vector, color, text, place in (
        ("force from the origin", np.zeros(2), force, INK, r"$-\lambda$", (-4, 9)),
        ("sliding direction", force, 15.0 * slip, SLIDING, r"$\gamma$", (-3, 5)),
        ("eigenvector", force, 12.0 * mode, ORANGE, "$w$", (6, -6)),
    ):
        draw_arrows(ax, tail[None], vector[None], color=color, zorder=5.0, gid=name)
        share = 0.5 if tail is not force else 1.0
        note(ax, text, tail + share * vector, place, color=color)
    ax.set_title(r"(a) $\gamma \in$ int $T_C(-\lambda)$")
    ax.set(xlabel=r"$-\lambda_1$ in N", ylabel=r"$-\lambda_2$ in N")


def _draw_ellipses(ax: Axes) -> None:
    reservoir, direction = LAW.reservoir, asp.Ellipse(30.0, 10.0)
    named("bdry C", drawn(plot_set, reservoir, ax, label="reservoir $C$"))
    dashed: dict[str, Any] = {"color": DIRECTION, "linestyle": "--", "label": "direction set $D$"}
    named("bdry D", ax.plot(*closed_outline(direction).T, **dashed))
    axis = np.stack([np.zeros(2), 33.0 * unit_vectors(ZETA)])
    named("long axis of C", ax.plot(*axis.T, color=BLUE, linewidth=0.9))
    ax.add_patch(Arc((0.0, 0.0), 32.0, 32.0, theta2=np.rad2deg(ZETA), color=INK))
    note(ax, r"$\zeta$", 18.0 * unit_vectors(0.5 * ZETA), ha="center", va="center")
    for text, star, angle, place in (
        ("$n_1$", reservoir, 0.0, (4, -13)),
        ("$n_2$", reservoir, 0.5 * np.pi, (-17, 3)),
        ("$p_1$", direction, 0.0, (4, -13)),
        ("$p_2$", direction, 0.5 * np.pi, (6, -12)),
    ):
        point = star.radius(angle) * unit_vectors(angle)
        ax.plot(
            *point,
            "o",
            color=INK,
            markerfacecolor="white",
            markersize=4.5,
            zorder=4.0,
            gid=text.strip("$"),
        )
        note(ax, text, point, place)
    ax.set_title(r"(b) ellipses, $\zeta = 30°$")
    ax.set(xlabel=r"$-\lambda_1$ in N", ylabel=r"$-\lambda_2$ in N")


def _damping_mode(law: asp.FrictionLaw, slip: Array) -> tuple[float, Array]:
    """Return the eigenvalue of −∂λ/∂γ that is not zero along γ, and its eigenvector w."""
    values, vectors = np.linalg.eig(-law.jacobian(slip))
    k = int(np.abs(vectors.T @ [-slip[1], slip[0]] * values).argmax())
    return float(values[k].real), vectors[:, k].real


def _damping_checks() -> list[Check]:
    slips = unit_vectors(circle(360))
    forces = -LAW.force(slips)
    normals = LAW.reservoir.gauge_gradient(forces)
    modes = [_damping_mode(LAW, slip) for slip in slips]
    along = np.array([normal @ w for normal, (_, w) in zip(normals, modes, strict=True)])
    outside = np.sum(normals * slips, axis=-1) > 0.0
    jacobians = np.array([LAW.jacobian(slip) for slip in slips])
    return [
        vanishes("Fig. 15a (106) ∇k_C(−λ)·w", along, 1e-9),
        vanishes("Fig. 15a ∂λ/∂γ γ", np.einsum("nij,nj->ni", jacobians, slips), 1e-9, "N"),
        truth(
            "Fig. 15a Prop. 9: eigenvalue < 0 in the tangent cone, else > 0",
            all((value > 0.0) == out for (value, _), out in zip(modes, outside, strict=True)),
        ),
    ]


def _rotation_checks() -> list[Check]:
    low, high = np.rad2deg(asp.critical_rotation(asp.Ellipse(3.0, 1.0), asp.Ellipse(3.0, 1.0))[0])
    expected = np.rad2deg(0.5 * np.arcsin(9.0 / 16.0))
    intercepts = [_intercepts(np.deg2rad(zeta)) for zeta in (17.114, 17.115, 72.885, 72.886)]
    found = [asp.ellipses_can_be_unstable(*one, 3.0, 1.0) for one in intercepts]
    return [
        Check("Fig. 15b critical rotations begin", ROTATIONS[0], low, 1e-4, "deg"),
        Check("Fig. 15b critical rotations end", ROTATIONS[1], high, 1e-4, "deg"),
        Check("Fig. 15b sin 2ζ = 9/16", expected, low, 1e-9, "deg"),
        truth("Fig. 15b (118) agrees", found == [False, True, True, False]),
    ]


def _intercepts(zeta: float) -> tuple[float, float, float]:
    """Return n₁, n₂ and ν of (115) for semi-axes 3 and 1 turned by ζ."""
    ellipse = asp.Ellipse(3.0, 1.0, angle=zeta)
    n1, n2 = ellipse.radius([0.0, 0.5 * np.pi])
    # k_C² = (x₁/n₁)² + ν x₁ x₂ + (x₂/n₂)².
    rising, falling = np.square(ellipse.gauge([[1.0, 1.0], [1.0, -1.0]]))
    return float(n1), float(n2), float(0.5 * (rising - falling))


def draw() -> Redrawn:
    """Draw (a) sliding into the tangent cone, (b) ellipses C and D with C turned by ζ."""
    figure, (left, right) = panels(
        15, "when sliding is unstable", 2, figsize=(11.0, 4.9), parameters=_PAPER
    )
    _draw_tangent_cone(left, _deepest())
    _draw_ellipses(right)
    for ax in (left, right):
        cross(ax)
        ax.set(xlim=(-33.0, 35.0), ylim=(-21.0, 25.0), aspect="equal")
    shared_legend(figure, [left, right], columns=5)
    return Redrawn(figure, [*_damping_checks(), *_rotation_checks()])


# %%
if __name__ == "__main__":
    show(draw)
