"""Figs. 14–16 of [WL19]: anisotropic friction alone makes a mass on a belt unstable."""

from __future__ import annotations

from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.lines import Line2D
from matplotlib.patches import Arc

from asperity._base.arrays import Array, rotation, unit_vectors
from asperity.cycles import BifurcationDiagram, bifurcation_diagram
from asperity.law import FrictionLaw
from asperity.paper.checks import Check
from asperity.paper.data import Curves
from asperity.paper.fig17 import LAW
from asperity.paper.mechanism_sketches import belt_from_above, belt_in_space
from asperity.paper.redrawn import (
    Redrawn,
    circle,
    cross,
    draw_law,
    drawn,
    note,
    panels,
    record,
    shared_legend,
)
from asperity.paper.statements import truth, vanishes
from asperity.plot import plot_bifurcation, plot_cones, plot_growth_chart, plot_set
from asperity.plot.look import BLUE, DIRECTION, INK, ORANGE, PURPLE, SLIDING, draw_arrows, style
from asperity.plot.sets import closed_outline
from asperity.sets import Ellipse
from asperity.steady_sliding import (
    critical_directions,
    critical_rotation,
    ellipses_can_be_unstable,
    equilibrium,
    growth_chart,
    stability,
)
from asperity.system import MassOnBelt

ZETA = float(np.deg2rad(30.0))
"""Rotation of C."""

BORDERS = (44.106, 75.894)
"""Directions in degrees between which the belt's equilibrium is unstable at this rotation."""

ROTATIONS = (17.1144, 72.8856)
"""Rotations in degrees between which there are such directions, sin 2ζ = 9/16."""

_PAPER = "parameters of §4.3"


def belt(phi: float, speed: float = 1.0) -> MassOnBelt:
    """Return the paper's mass on a belt that runs in the direction φ."""
    return MassOnBelt(
        1.0, stiffness=1.0, law=LAW, normal_force=1.0, belt_velocity=speed * unit_vectors(phi)
    )


def fig14() -> Redrawn:
    """Draw the mass on the belt (a) in space, (b) as a model of two degrees of freedom."""
    figure, (left, right) = panels(14, "mass on a moving belt", 2, figsize=(9.2, 3.9))
    with style():
        belt_in_space(left)
        left.set_title("(a) mass, springs and grooved belt")
        belt_from_above(right)
        for ax in (left, right):
            ax.set_anchor("N")
        right.set_title("(b) the model from above")
    return Redrawn(figure, Curves(), _model_checks())


def _model_checks() -> list[Check]:
    directions = circle(24)
    systems = [belt(phi) for phi in directions]
    forces = LAW.force(-unit_vectors(directions))
    matrices = [stability(system).matrix for system in systems]
    return [
        vanishes(
            "Fig. 14 (77) K q_eq − λ(−v)", [one.equilibrium for one in systems] - forces, 1e-12, "N"
        ),
        vanishes(
            "Fig. 14 (77) q_eq against the search for it",
            np.array([equilibrium(one).q - one.equilibrium for one in systems]),
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


def fig15() -> Redrawn:
    """Draw (a) sliding into the tangent cone, (b) ellipses C and D with C turned by ζ."""
    figure, (left, right) = panels(
        15, "when sliding is unstable", 2, figsize=(11.0, 4.9), parameters=_PAPER
    )
    curves = Curves()
    with style():
        _draw_tangent_cone(left, _deepest(), curves)
        _draw_ellipses(right, curves)
        for ax in (left, right):
            cross(ax)
            ax.set(xlim=(-33.0, 35.0), ylim=(-21.0, 25.0), aspect="equal")
        shared_legend(figure, [left, right], columns=5)
    return Redrawn(figure, curves, [*_damping_checks(), *_rotation_checks()])


def _deepest() -> float:
    """Return the direction φ that leads farthest into the tangent cone."""
    phi = np.linspace(*critical_directions(LAW)[0], 401)
    slips = unit_vectors(phi)
    normals = LAW.reservoir.gauge_gradient(-LAW.force(slips))
    sines = np.sum(normals * slips, axis=-1) / np.linalg.norm(normals, axis=-1)
    return float(phi[np.argmin(sines)])


def _draw_tangent_cone(ax: Axes, phi: float, curves: Curves) -> None:
    slip = unit_vectors(phi)
    force = -LAW.force(slip)
    record(curves, "a", "bdry C", drawn(plot_set, LAW.reservoir, ax, label="reservoir $C$"))
    cone = drawn(plot_cones, LAW.reservoir, ax, x=force, normal=False, size=18.0)
    record(curves, "a", "force", cone[:1])
    record(curves, "a", "edges of the tangent cone", cone[1:])
    ax.plot([], [], color=PURPLE, label=r"tangent cone $T_C(-\lambda)$ at $-\lambda$")
    _, mode = _damping_mode(LAW, slip)
    # Towards the side on which C goes on anticlockwise.
    mode *= np.sign(mode @ [-force[1], force[0]])
    for name, tail, vector, color, text, place in (
        ("force from the origin", np.zeros(2), force, INK, r"$-\lambda$", (-4, 9)),
        ("sliding direction", force, 15.0 * slip, SLIDING, r"$\gamma$", (-3, 5)),
        ("eigenvector", force, 12.0 * mode, ORANGE, "$w$", (6, -6)),
    ):
        arrows = draw_arrows(ax, tail[None], vector[None], color=color, zorder=5.0)
        record(curves, "a", name, [arrows])
        share = 0.5 if tail is not force else 1.0
        note(ax, text, tail + share * vector, place, color=color)
    ax.set_title(r"(a) $\gamma \in$ int $T_C(-\lambda)$")
    ax.set(xlabel=r"$-\lambda_1$ in N", ylabel=r"$-\lambda_2$ in N")


def _draw_ellipses(ax: Axes, curves: Curves) -> None:
    reservoir, direction = LAW.reservoir, Ellipse(30.0, 10.0)
    record(curves, "b", "bdry C", drawn(plot_set, reservoir, ax, label="reservoir $C$"))
    dashed: dict[str, Any] = {"color": DIRECTION, "linestyle": "--", "label": "direction set $D$"}
    record(curves, "b", "bdry D", ax.plot(*closed_outline(direction).T, **dashed))
    axis = np.stack([np.zeros(2), 33.0 * unit_vectors(ZETA)])
    record(curves, "b", "long axis of C", ax.plot(*axis.T, color=BLUE, linewidth=0.9))
    ax.add_patch(Arc((0.0, 0.0), 32.0, 32.0, theta2=np.rad2deg(ZETA), color=INK))
    note(ax, r"$\zeta$", 18.0 * unit_vectors(0.5 * ZETA), ha="center", va="center")
    for text, star, angle, place in (
        ("$n_1$", reservoir, 0.0, (4, -13)),
        ("$n_2$", reservoir, 0.5 * np.pi, (-17, 3)),
        ("$p_1$", direction, 0.0, (4, -13)),
        ("$p_2$", direction, 0.5 * np.pi, (6, -12)),
    ):
        point = star.radius(angle) * unit_vectors(angle)
        dot = ax.plot(*point, "o", color=INK, markerfacecolor="white", markersize=4.5, zorder=4.0)
        record(curves, "b", text.strip("$"), dot)
        note(ax, text, point, place)
    ax.set_title(r"(b) ellipses, $\zeta = 30°$")
    ax.set(xlabel=r"$-\lambda_1$ in N", ylabel=r"$-\lambda_2$ in N")


def _damping_mode(law: FrictionLaw, slip: Array) -> tuple[float, Array]:
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
    low, high = np.rad2deg(critical_rotation(Ellipse(3.0, 1.0), Ellipse(3.0, 1.0))[0])
    expected = np.rad2deg(0.5 * np.arcsin(9.0 / 16.0))
    intercepts = [_intercepts(np.deg2rad(zeta)) for zeta in (17.114, 17.115, 72.885, 72.886)]
    found = [ellipses_can_be_unstable(*one, 3.0, 1.0) for one in intercepts]
    return [
        Check("Fig. 15b critical rotations begin", ROTATIONS[0], low, 1e-4, "deg"),
        Check("Fig. 15b critical rotations end", ROTATIONS[1], high, 1e-4, "deg"),
        Check("Fig. 15b sin 2ζ = 9/16", expected, low, 1e-9, "deg"),
        truth("Fig. 15b (118) agrees", found == [False, True, True, False]),
    ]


def _intercepts(zeta: float) -> tuple[float, float, float]:
    """Return n₁, n₂ and ν of (115) for semi-axes 3 and 1 turned by ζ."""
    R = rotation(zeta)
    A = R @ np.diag([1.0 / 9.0, 1.0]) @ R.T
    return float(A[0, 0] ** -0.5), float(A[1, 1] ** -0.5), float(2.0 * A[0, 1])


def fig16() -> Redrawn:
    """Draw (a) the bifurcation diagram, (b) the law, (c) growth rates over φ and ζ."""
    figure, (left, middle, right) = panels(
        16,
        "the direction of the belt decides",
        3,
        figsize=(15.4, 4.9),
        width_ratios=(1.15, 1.25, 1.2),
        parameters=_PAPER,
    )
    curves, diagram = Curves(), bifurcations()
    with style():
        _draw_diagram(left, diagram, curves)
        _draw_critical(middle, curves)
        _draw_chart(right, curves)
        shared_legend(figure, [left, middle], columns=8)
    return Redrawn(figure, curves, _border_checks(diagram))


def bifurcations(step: float = 1.0) -> BifurcationDiagram:
    """Return equilibria and limit cycles for belt directions from 0 to 160° in steps."""
    return bifurcation_diagram(
        belt, parameter="phi", values=np.deg2rad(np.arange(0.0, 160.0 + 0.5 * step, step))
    )


def _draw_diagram(ax: Axes, diagram: BifurcationDiagram, curves: Curves) -> None:
    in_degrees = diagram.replace(values=np.rad2deg(diagram.values))
    for line in drawn(plot_bifurcation, in_degrees, ax, legend=False):
        if isinstance(line, Line2D):
            label = str(line.get_label())
            record(curves, "a", "limit cycle" if label.startswith("_") else label, [line])
    ax.set(title="(a) bifurcation diagram", xlabel=r"belt direction $\varphi$ in degrees")
    ax.set(ylabel="$x$ in m", xticks=np.arange(0.0, 161.0, 40.0))


def _draw_critical(ax: Axes, curves: Curves) -> None:
    draw_law(curves, "b", LAW, ax, angles=24)
    span = critical_directions(LAW)[0]
    inside = np.linspace(*span, 61)
    forces = -LAW.force(unit_vectors(inside))
    arc: dict[str, Any] = {"color": PURPLE, "linewidth": 4.0, "alpha": 0.7, "zorder": 3.5}
    line = ax.plot(*forces.T, label=r"$\gamma \in$ int $T_C(-\lambda)$", **arc)
    record(curves, "b", "forces of critical directions", line)
    ends = draw_arrows(ax, forces[[0, -1]], 13.0 * unit_vectors(np.array(span)), color=PURPLE)
    record(curves, "b", "sliding direction at the borders", [ends])
    cross(ax)
    ax.set(title=r"(b) the law, $\zeta = 30°$", aspect="equal")
    ax.set(xlabel=r"$-\lambda_1$ in N", ylabel=r"$-\lambda_2$ in N")


def _draw_chart(ax: Axes, curves: Curves) -> None:
    phi, zeta = np.linspace(0.0, np.pi, 181), np.linspace(0.0, 0.5 * np.pi, 91)
    unturned = belt(0.0).replace(law=FrictionLaw(Ellipse(30.0, 10.0), Ellipse(3.0, 1.0)))
    growth = growth_chart(unturned, phi=phi, zeta=zeta).growth
    plot_growth_chart(growth, x=np.rad2deg(phi), y=np.rad2deg(zeta), ax=ax, border=False)
    line = ax.plot(*np.rad2deg(_border()).T, color=INK, linewidth=1.2)
    record(curves, "c", "border of instability", line)
    ax.axhline(np.rad2deg(ZETA), color=INK, linewidth=0.8, linestyle=":")
    ax.set(title="(c) growth rate", xlabel=r"belt direction $\varphi$ in degrees")
    ax.set(ylabel=r"rotation $\zeta$ of $C$ in degrees")


def _border() -> Array:
    """Return the closed curve of (φ, ζ) on which γ is tangent to bdry C."""
    low, high = critical_rotation(Ellipse(3.0, 1.0), Ellipse(3.0, 1.0))[0]
    middle, half = 0.5 * (low + high), 0.5 * (high - low)
    # Close to the ends, where the interval of directions shrinks to a point like a square root.
    turns = middle - half * np.cos(np.linspace(0.02, np.pi - 0.02, 61))
    laws = [FrictionLaw(Ellipse(3.0, 1.0, angle=turn), Ellipse(3.0, 1.0)) for turn in turns]
    spans = np.array([critical_directions(law)[0] for law in laws])
    left, right = (np.column_stack([spans[:, side], turns]) for side in (0, 1))
    return np.vstack([left, right[::-1], left[:1]])


def _border_checks(diagram: BifurcationDiagram) -> list[Check]:
    first, second = critical_directions(LAW)
    low, high = np.rad2deg(first)
    degrees, kinds = np.rad2deg(diagram.values), np.array(diagram.kinds)
    inside = (degrees > low) & (degrees < high)
    cycles = np.isfinite(diagram.cycle_minima[:, 0])
    near = [stability(belt(np.deg2rad(phi))).kind for phi in (44.1, 44.11, 75.89, 75.9)]
    tangent = [
        LAW.reservoir.gauge_gradient(-LAW.force(unit_vectors(phi))) @ unit_vectors(phi)
        for phi in first
    ]
    return [
        Check("Fig. 16 critical directions begin", BORDERS[0], low, 1e-3, "deg"),
        Check("Fig. 16 critical directions end", BORDERS[1], high, 1e-3, "deg"),
        vanishes(
            "Fig. 16 the other interval is opposite", np.subtract(second, first) - np.pi, 1e-9
        ),
        vanishes("Fig. 16b γ is tangent to bdry C at the borders", np.array(tangent), 1e-9),
        truth("Fig. 16a unstable between them", (kinds[inside] == "unstable").all()),
        truth("Fig. 16a neutral outside", (kinds[~inside] == "neutral").all()),
        truth(
            "Fig. 16a eigenvalues change there",
            near == ["neutral", "unstable", "unstable", "neutral"],
        ),
        # Towards the upper border the cycle turns several times before it sticks: it loses its
        # stability to others of twice the period, and is not followed to the end.
        truth(
            "Fig. 16a a limit cycle for 45° ≤ φ ≤ 72°",
            cycles[(degrees > 44.5) & (degrees < 72.5)].all(),
        ),
        truth(
            "Fig. 16a it coexists with the neutral equilibrium just below the lower border",
            diagram.coexistence[(degrees > 42.5) & (degrees < low)].all(),
        ),
    ]
