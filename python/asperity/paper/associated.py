"""Figs. 4–7 of [WL19]: associated Coulomb laws with various force reservoirs.

The paper gives no numbers for these sets; the ones here are own.
"""

from __future__ import annotations

import numpy as np
from matplotlib.axes import Axes
from matplotlib.patches import Circle

from asperity._base.arrays import unit_vectors
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
from asperity.paper.sketches import contact_plane, xy_table
from asperity.paper.statements import (
    never_positive,
    proposition_2,
    propositions_3_and_4,
    truth,
    vanishes,
)
from asperity.plot.look import (
    BLUE,
    GREEN,
    GREY,
    INK,
    ORANGE,
    PURPLE,
    SKY,
    SLIDING,
    draw_arrows,
    style,
)
from asperity.plot.sets import closed_outline
from asperity.runs.time_stepping import simulate
from asperity.runs.trajectory import Trajectory
from asperity.sets import CappedRectangle, Disk, Ellipse, Rectangle, Superellipse
from asperity.system import SlidingPoint

MU = 0.3
"""Friction coefficient of Fig. 4."""

PAIR = (0.6, 0.3)
"""Friction coefficients μ₁, μ₂ of Figs. 5–7."""

ROUNDNESS = (0.7, 1.0, 1.5, 2.0, 4.0, 30.0)
"""Roundness factors of Fig. 7a; only the first gives a set that is not convex."""

_COLORS = (GREY, SKY, GREEN, BLUE, ORANGE, INK)

RUNNER = CappedRectangle(0.35, 0.3, cap=0.25)
"""Rectangle of half-widths 0.35, 0.3 with half-ellipses of semi-axis 0.25 on both ends."""

_HALF = np.array([[1, -1], [1, 0], [1, 1], [0.5, 1], [0, 1], [-0.5, 1]], dtype=float)
_SIDES = np.vstack([_HALF, -_HALF])
"""Corners and points between them on the square |xᵢ| ≤ 1."""

ELLIPTIC = FrictionLaw.associated(Ellipse(*PAIR))
"""The law of Fig. 5."""


def fig04() -> Redrawn:
    """Draw (a) the contact plane and the forces on body 1, (b) isotropic friction."""
    figure, (left, right) = panels(4, "planar contact and isotropic friction", 2)
    law, curves = FrictionLaw.isotropic(MU), Curves()
    stick, slip = 0.55 * MU * unit_vectors(-0.6), np.array([0.3, 2.5, 4.4])
    with style():
        contact_plane(left)
        left.set_title("(a) contact forces on body 1")
        draw_law(curves, "b", law, right, angles=slip, forces="arrows")
        sticking = draw_arrows(right, np.zeros((1, 2)), stick[None], color=INK)
        record(curves, "b", "force in stick", [sticking])
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
    return Redrawn(figure, curves, checks)


def fig05() -> Redrawn:
    """Draw (a) a computed sliding path on grooved ground, (b) its associated elliptic law."""
    figure, (left, right) = panels(5, "associated Coulomb friction", 2, width_ratios=(1.0, 1.3))
    curves = Curves()
    path = simulate(
        SlidingPoint(1.0, law=ELLIPTIC),
        dt=1e-4,
        t_end=1.0,
        u0=1.5 * unit_vectors(np.deg2rad(35.0)),
        until_rest=True,
    )
    with style():
        _draw_path(left, path, curves)
        draw_law(curves, "b", ELLIPTIC, right, angles=12, forces="arrows")
        right.set_title(r"(b) $\mu_1 = 0.6$, $\mu_2 = 0.3$")
        cross(right)
        shared_legend(figure, [left, right], columns=3)
    return Redrawn(figure, curves, [*_path_checks(path), *_associated_checks()])


def _draw_path(ax: Axes, path: Trajectory, curves: Curves) -> None:
    reach = 1.3 * path.q[-1]
    grooves = np.arange(-0.075, reach[0], 0.006)
    ax.vlines(grooves, -0.03, reach[1], color="#E3E3E3", linewidth=0.8)
    line = ax.plot(*path.q.T, color=INK, linewidth=1.0, linestyle="--", label="path of the body")
    record(curves, "a", "path [m]", line)
    for share in (0.0, 0.3, 0.55, 1.0):
        k = round(share * (len(path.t) - 1))
        ax.add_patch(
            Circle(tuple(path.q[k]), 0.011, facecolor="#C9CED6", edgecolor=GREY, alpha=0.8)
        )
        if share < 1.0:
            direction = path.u[k] / np.linalg.norm(path.u[k])
            for name, vector, color in (
                ("sliding direction", 0.05 * direction, SLIDING),
                ("force on the body", 0.09 * ELLIPTIC.force(direction), PURPLE),
            ):
                arrow = draw_arrows(ax, path.q[[k]], vector[None], color=color)
                record(curves, "a", name, [arrow])
    ax.plot([], [], color=PURPLE, label=r"force $\lambda$ on the body")
    ax.grid(False)
    ax.set(xlim=(grooves[0], grooves[-1]), ylim=(-0.03, reach[1]), aspect="equal")
    ax.set(xlabel="$x$ across the grooves in m", ylabel="$y$ along the grooves in m")
    ax.set_title("(a) the force deflects a sliding body")


def _path_checks(path: Trajectory) -> list[Check]:
    # On elliptic D free sliding keeps |v₁/v₁₀| = |v₂/v₂₀|^((p₁/p₂)²).
    later = path.u[len(path.t) // 2]
    exponent = np.log(later[0] / path.u[0, 0]) / np.log(later[1] / path.u[0, 1])
    power = (PAIR[0] / PAIR[1]) ** 2
    return [Check("Fig. 5a exponent of the velocity components", power, float(exponent), 0.01)]


def _associated_checks() -> list[Check]:
    reservoir = ELLIPTIC.reservoir
    directions_ = (Disk(1.0), Ellipse(1.0, 3.0), Rectangle(2.0, 1.0, angle=0.4))
    others = [FrictionLaw(reservoir, direction) for direction in directions_]
    return [
        *proposition_2("Fig. 5b", ELLIPTIC, others),
        *propositions_3_and_4("Fig. 5b", ELLIPTIC, others[:2]),
    ]


def fig06() -> Redrawn:
    """Draw (a) an X–Y table, (b) its associated law with rectangular reservoir."""
    figure, (left, right) = panels(6, "X–Y table", 2, figsize=(9.6, 4.4))
    law, curves = FrictionLaw.associated(Rectangle(*PAIR)), Curves()
    x, y = PAIR[0] * _SIDES[:, 0], PAIR[1] * _SIDES[:, 1]
    with style():
        xy_table(left)
        left.set_title("(a) two slide bearings, from above")
        draw_law(curves, "b", law, right, angles=np.arctan2(y, x))
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
    return Redrawn(figure, curves, checks)


def fig07() -> Redrawn:
    """Draw (a) superelliptic reservoirs, (b) a rectangle with two half-ellipses."""
    figure, (left, right) = panels(7, "further force reservoirs", 2, figsize=(10.6, 4.0))
    curves = Curves()
    with style():
        for s, color in zip(ROUNDNESS, _COLORS, strict=True):
            star = Superellipse(*PAIR, s)
            dash = "-" if star.is_convex else "--"
            left.plot(*closed_outline(star).T, dash, color=color, label=f"$s = {s:g}$")
            curves.add("a", f"s = {s:g}", closed_outline(star))
        left.set(title="(a) superellipses with roundness factor $s$", aspect="equal")
        left.legend(loc="upper center", ncols=3, fontsize="small")
        draw_law(curves, "b", FrictionLaw.associated(RUNNER), right, angles=20)
        x, y = np.array([[-RUNNER.a], [RUNNER.a]]), np.array([-RUNNER.b, RUNNER.b])
        seams = [line for at in x for line in right.plot(np.tile(at, 2), y, ":", color=GREY)]
        record(curves, "b", "end of the rectangle", seams)
        right.set_title("(b) rectangle and two half-ellipses")
        for ax in (left, right):
            cross(ax)
            ax.set(xlabel=r"$-\lambda_1/\lambda_N$", ylabel=r"$-\lambda_2/\lambda_N$")
            ax.set(xlim=(-0.85, 0.85), ylim=(-0.55, 0.62))
        shared_legend(figure, [right])
    return Redrawn(figure, curves, [*_superellipse_checks(), *_runner_checks()])


def _superellipse_checks() -> list[Check]:
    diagonal = np.array([1.0, 1.0])
    sets = [Superellipse(*PAIR, s) for s in ROUNDNESS]
    expected = [float(np.sum(np.power(PAIR, -s)) ** (1.0 / s)) for s in ROUNDNESS]
    found = [float(star.gauge(diagonal)) for star in sets]
    return [
        vanishes("Fig. 7a (37) gauge at (1, 1)", np.subtract(found, expected), 1e-9),
        truth(
            "Fig. 7a convex exactly for s ≥ 1",
            all(bool(star.is_convex) == (star.exponent >= 1.0) for star in sets),
        ),
        truth("Fig. 7a s = 1 is not strictly convex", not sets[1].is_strictly_convex),
        truth("Fig. 7a s = 2 is the ellipse", Superellipse(*PAIR, 2.0).is_strictly_convex),
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
