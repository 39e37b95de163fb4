"""Figure 3: Which reservoirs and sliding directions a law admits
=================================================================

What does dissipation demand of a friction law? The reservoir is star-shaped, and the sliding
direction lies in a half-plane that the force decides. The paper gives no numbers for these sets;
those here are our own.
"""

import asperity as asp
import numpy as np
from asperity.demo import Check
from asperity.plot import plot_set
from matplotlib.axes import Axes
from matplotlib.path import Path
from paper.curves import named
from paper.drawing import (
    GREY,
    INK,
    ORANGE,
    RESERVOIR,
    SLIDING,
    draw_arrows,
    draw_sector,
    unit_vectors,
)
from paper.frame import Redrawn, cross, drawn, note, panels, shared_legend, show
from paper.laws.fig01 import STAR, hidden, hooked
from paper.statements import proposition_1, truth, vanishes

FLAT = asp.CappedRectangle(0.3, 0.3, cap=0.25, angle=0.5)
"""A reservoir with two flats of length 0.6, their normals at 0.5 rad ± 90°."""

_NORMAL = unit_vectors(FLAT.angle + 0.5 * np.pi)
_ALONG = unit_vectors(FLAT.angle)

_FORCE = 1.1
"""Polar angle of the force in panel (c)."""


def _draw_hook(ax: Axes) -> list[Check]:
    outline = 0.6 * hooked()
    closed = np.vstack([outline, outline[:1]])
    ax.plot(*closed.T, color=RESERVOIR, label="reservoir $C$")
    ax.fill(*closed.T, color=RESERVOIR, alpha=0.08, linewidth=0.0)
    ends = np.outer([1.0, 0.6], hidden(outline))
    draw_arrows(ax, np.zeros((1, 2)), ends[:1], color=INK, gid="force A")
    ax.plot(*ends[1], "o", color=ORANGE, markersize=5.0, zorder=4.0, gid="force B")
    for name, point in zip("AB", ends, strict=True):
        note(ax, name, point, (5, -12))
    ax.set_title("(a) not star-shaped: not admissible")
    # A lies on the boundary: a little of slack counts it in.
    shape = Path(outline)
    inside = [shape.contains_point(ends[0], radius=1e-3), shape.contains_point(ends[1])]
    return [
        truth("Fig. 3a is not star-shaped", not asp.star_shape(outline)),
        truth("Fig. 3a A is admissible, B is not", inside == [True, False]),
    ]


def _draw_flat(ax: Axes) -> list[Check]:
    forces = FLAT.b * _NORMAL + np.linspace(-0.28, 0.28, 5)[:, None] * _ALONG
    level = np.stack([forces[0] - 0.35 * _ALONG, forces[-1] + 0.3 * _ALONG])
    named("bdry C", drawn(plot_set, FLAT, ax, label="reservoir $C$"))
    ax.plot(
        *level.T,
        color=GREY,
        linewidth=1.0,
        linestyle="--",
        label=r"$-\lambda^T\gamma$ constant",
        gid="constant dissipation",
    )
    draw_arrows(ax, np.zeros_like(forces), forces, color=INK, gid="force")
    draw_arrows(ax, forces, np.tile(0.2 * _NORMAL, (5, 1)), color=SLIDING, gid="sliding direction")
    ax.set_title("(b) one rate of dissipation, many forces")
    power = forces @ _NORMAL
    law = asp.FrictionLaw.associated(FLAT)
    return [
        vanishes("Fig. 3b gauge − 1 of the forces", FLAT.gauge(forces) - 1.0, 1e-9),
        vanishes(
            "Fig. 3b dissipation of the forces − D(γ)", power - law.dissipation(_NORMAL), 1e-9
        ),
        truth("Fig. 3b is convex", FLAT.is_convex),
        truth("Fig. 3b is not strictly convex", not FLAT.is_strictly_convex),
    ]


def _draw_admissible(ax: Axes) -> list[Check]:
    reservoir: asp.StarSet = STAR.scaled(0.6)
    force = reservoir.radius(_FORCE) * unit_vectors(_FORCE)
    slips = np.stack([law.slip_direction(-force) for law in _laws(reservoir)])
    named("bdry C", drawn(plot_set, reservoir, ax, label="reservoir $C$"))
    label = r"$\{\gamma : -\lambda^T\gamma \geq 0\}$"
    draw_sector(ax, force, _FORCE - 0.5 * np.pi, np.pi, 0.36, color=SLIDING, alpha=0.2, label=label)
    tails = np.tile(force, (len(slips), 1))
    draw_arrows(ax, tails, 0.36 * slips, color=SLIDING, width=0.011, gid="sliding direction")
    draw_arrows(ax, np.zeros((1, 2)), force[None], color=INK, gid="force")
    ax.plot([], [], color=INK, label=r"force $-\lambda$")
    ax.plot([], [], color=SLIDING, label=r"sliding direction $\gamma$")
    ax.set_title("(c) admissible sliding directions")
    return [
        truth("Fig. 3c sliding directions dissipate", (slips @ force).min() > 0.0),
        truth(
            "Fig. 3c laws found dissipative", all(law.is_dissipative for law in _laws(reservoir))
        ),
    ]


def _laws(reservoir: asp.StarSet) -> list[asp.FrictionLaw]:
    """Laws with one C whose sliding directions for one force spread over the half-plane."""
    shapes = [(ratio, turn) for ratio in (1.5, 3.0, 12.0) for turn in (-0.9, -0.3, 0.3, 0.9)]
    ellipses: list[asp.StarSet] = [
        asp.Ellipse(ratio, 1.0, angle=_FORCE + turn) for ratio, turn in shapes
    ]
    return [asp.FrictionLaw(reservoir, direction) for direction in ellipses]


def draw() -> Redrawn:
    """Draw an inadmissible reservoir, one rate of dissipation for many forces, and the γ for one λ.

    (a) Reducing the force from A to B would leave the reservoir. (b) All forces of a flat dissipate
    the same. (c) The half-plane of sliding directions that a dissipative law admits for one force,
    and the directions that twelve laws with the same C choose.
    """
    figure, axes = panels(3, "reservoirs, dissipation and sliding directions", 3)
    checks = [*_draw_hook(axes[0]), *_draw_flat(axes[1]), *_draw_admissible(axes[2])]
    for ax in axes:
        cross(ax)
        ax.set(xlabel=r"$-\lambda_1/\lambda_N$", ylabel=r"$-\lambda_2/\lambda_N$")
        ax.set_aspect("equal")
    shared_legend(figure, axes)
    return Redrawn(figure, [*checks, *proposition_1("Fig. 3b", asp.FrictionLaw.associated(FLAT))])


# %%
if __name__ == "__main__":
    show(draw)
