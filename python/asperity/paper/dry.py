"""Fig. 3 of [WL19]: which reservoirs and sliding directions a dry friction law admits.

The paper gives no numbers for these sets; the ones here are own.
"""

from __future__ import annotations

import numpy as np
from matplotlib.axes import Axes
from matplotlib.path import Path

from asperity._base.arrays import Array, unit_vectors
from asperity.law import FrictionLaw
from asperity.paper.checks import Check
from asperity.paper.convexity import STAR, hidden, hooked
from asperity.paper.data import Curves
from asperity.paper.redrawn import Redrawn, cross, note, panels, record, shared_legend
from asperity.paper.statements import proposition_1, truth, vanishes
from asperity.plot import plot_set
from asperity.plot.look import (
    GREY,
    INK,
    ORANGE,
    RESERVOIR,
    SLIDING,
    draw_arrows,
    draw_sector,
    style,
)
from asperity.plot.sets import closed_outline
from asperity.sets import CappedRectangle, Ellipse, StarSet, star_shape

FLAT = CappedRectangle(0.3, 0.3, cap=0.25, angle=0.5)
"""A reservoir with two flats of length 0.6, their normals at 0.5 rad ± 90°."""

_NORMAL = unit_vectors(FLAT.angle + 0.5 * np.pi)
_ALONG = unit_vectors(FLAT.angle)
_FORCE = 1.1
"""Polar angle of the force in panel (c)."""


def fig03() -> Redrawn:
    """Draw an inadmissible reservoir, one rate of dissipation for many forces, and the γ for one λ.

    (a) Reducing the force from A to B would leave the reservoir. (b) All forces of a flat dissipate
    the same. (c) The half-plane of sliding directions that a dissipative law admits for one force,
    and the directions that twelve laws with the same C choose.
    """
    figure, axes = panels(3, "reservoirs, dissipation and sliding directions", 3)
    curves = Curves()
    with style():
        checks = [
            *_draw_hook(axes[0], curves),
            *_draw_flat(axes[1], curves),
            *_draw_admissible(axes[2], curves),
        ]
        for ax in axes:
            cross(ax)
            ax.set(xlabel=r"$-\lambda_1/\lambda_N$", ylabel=r"$-\lambda_2/\lambda_N$")
            ax.set_aspect("equal")
        shared_legend(figure, axes)
    return Redrawn(
        figure, curves, [*checks, *proposition_1("Fig. 3b", FrictionLaw.associated(FLAT))]
    )


def _draw_hook(ax: Axes, curves: Curves) -> list[Check]:
    outline = 0.6 * hooked()
    closed = np.vstack([outline, outline[:1]])
    ax.plot(*closed.T, color=RESERVOIR, label="reservoir $C$")
    ax.fill(*closed.T, color=RESERVOIR, alpha=0.08, linewidth=0.0)
    ends = np.outer([1.0, 0.6], hidden(outline))
    force = draw_arrows(ax, np.zeros((1, 2)), ends[:1], color=INK)
    dot = ax.plot(*ends[1], "o", color=ORANGE, markersize=5.0, zorder=4.0)
    for name, point in zip("AB", ends, strict=True):
        note(ax, name, point, (5, -12))
    ax.set_title("(a) not star-shaped: not admissible")
    curves.add("a", "bdry C", closed)
    record(curves, "a", "force A", [force])
    record(curves, "a", "force B", dot)
    # A lies on the boundary: a little of slack counts it in.
    shape = Path(outline)
    inside = [shape.contains_point(ends[0], radius=1e-3), shape.contains_point(ends[1])]
    return [
        truth("Fig. 3a is not star-shaped", not star_shape(outline)),
        truth("Fig. 3a A is admissible, B is not", inside == [True, False]),
    ]


def _draw_flat(ax: Axes, curves: Curves) -> list[Check]:
    forces = FLAT.b * _NORMAL + np.linspace(-0.28, 0.28, 5)[:, None] * _ALONG
    level = np.stack([forces[0] - 0.35 * _ALONG, forces[-1] + 0.3 * _ALONG])
    plot_set(FLAT, ax=ax, label="reservoir $C$")
    constant = ax.plot(
        *level.T, color=GREY, linewidth=1.0, linestyle="--", label=r"$-\lambda^T\gamma$ constant"
    )
    arrows = draw_arrows(ax, np.zeros_like(forces), forces, color=INK)
    slips = draw_arrows(ax, forces, np.tile(0.2 * _NORMAL, (5, 1)), color=SLIDING)
    ax.set_title("(b) one rate of dissipation, many forces")
    curves.add("b", "bdry C", closed_outline(FLAT))
    record(curves, "b", "constant dissipation", constant)
    record(curves, "b", "force", [arrows])
    record(curves, "b", "sliding direction", [slips])
    power = forces @ _NORMAL
    law = FrictionLaw.associated(FLAT)
    return [
        vanishes("Fig. 3b gauge − 1 of the forces", FLAT.gauge(forces) - 1.0, 1e-9),
        vanishes(
            "Fig. 3b dissipation of the forces − D(γ)", power - law.dissipation(_NORMAL), 1e-9
        ),
        truth("Fig. 3b is convex", FLAT.is_convex),
        truth("Fig. 3b is not strictly convex", not FLAT.is_strictly_convex),
    ]


def _draw_admissible(ax: Axes, curves: Curves) -> list[Check]:
    reservoir: StarSet = STAR.scaled(0.6)
    force = reservoir.radius(_FORCE) * unit_vectors(_FORCE)
    slips = np.stack([law.slip_direction(-force) for law in _laws(reservoir)])
    plot_set(reservoir, ax=ax, label="reservoir $C$")
    label = r"$\{\gamma : -\lambda^T\gamma \geq 0\}$"
    draw_sector(ax, force, _FORCE - 0.5 * np.pi, np.pi, 0.36, color=SLIDING, alpha=0.2, label=label)
    tails = np.tile(force, (len(slips), 1))
    chosen = draw_arrows(ax, tails, 0.36 * slips, color=SLIDING, width=0.011)
    arrow = draw_arrows(ax, np.zeros((1, 2)), force[None], color=INK)
    ax.plot([], [], color=INK, label=r"force $-\lambda$")
    ax.plot([], [], color=SLIDING, label=r"sliding direction $\gamma$")
    ax.set_title("(c) admissible sliding directions")
    curves.add("c", "bdry C", closed_outline(reservoir))
    curves.add("c", "edge of the half-plane", force + 0.36 * _sides(_FORCE))
    record(curves, "c", "force", [arrow])
    record(curves, "c", "sliding direction", [chosen])
    return [
        truth("Fig. 3c sliding directions dissipate", (slips @ force).min() > 0.0),
        truth(
            "Fig. 3c laws found dissipative", all(law.is_dissipative for law in _laws(reservoir))
        ),
    ]


def _sides(angle: float) -> Array:
    """Return the two unit vectors at right angles to a direction."""
    return unit_vectors(angle + np.array([-0.5, 0.5]) * np.pi)


def _laws(reservoir: StarSet) -> list[FrictionLaw]:
    """Laws with one C whose sliding directions for one force spread over the half-plane."""
    shapes = [(ratio, turn) for ratio in (1.5, 3.0, 12.0) for turn in (-0.9, -0.3, 0.3, 0.9)]
    ellipses: list[StarSet] = [Ellipse(ratio, 1.0, angle=_FORCE + turn) for ratio, turn in shapes]
    return [FrictionLaw(reservoir, direction) for direction in ellipses]
