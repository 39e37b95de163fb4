"""Figure 22: From forces to sets
=================================

How do C and D follow from measured forces? C by the forces themselves, D by integrating the angle
between force and sliding direction, (124).
"""

import numpy as np
from asperity.demo import Check
from asperity.plot import plot_set
from matplotlib.axes import Axes
from paper.curves import named
from paper.drawing import (
    BLUE,
    DIRECTION,
    GREEN,
    GREY,
    INK,
    ORANGE,
    circle,
    draw_arrows,
    unit_vectors,
)
from paper.frame import Redrawn, drawn, note, panels, show
from paper.measurements.pairings import PVC
from paper.sketches import experiments as setup_sketches


def _draw_construction(ax: Axes) -> None:
    law = PVC.law
    (outline, _), (inner, _) = (
        drawn(plot_set, chosen, ax, color=color, label=label)
        for chosen, color, label in (
            (law.reservoir, BLUE, "reservoir $C$"),
            (law.direction, DIRECTION, "direction set $D$"),
        )
    )
    named("bdry C", [outline])
    named("bdry D", [inner])
    phi = np.deg2rad(64.0)
    e = unit_vectors(phi)
    force = -law.force(e)
    theta = float(np.arctan2(force[1], force[0]))
    foot = law.direction.radius(theta) * unit_vectors(theta)
    for name, text, tail, vector, color, offset in (
        ("force", r"$-\lambda/\lambda_N$", np.zeros(2), force, INK, (6, -2)),
        ("sliding direction", r"$\gamma$", force, 0.2 * e, GREEN, (4, 4)),
        ("normal of D", r"$n_D$", foot, 0.2 * e, GREEN, (-16, 6)),
        ("r_D", "$r_D$", np.zeros(2), foot, ORANGE, (-10, -28)),
    ):
        draw_arrows(ax, tail[None], vector[None], color=color, zorder=5.0, gid=name)
        note(ax, text, tail + vector, offset, color=color)
    for angle, reach, text, color in ((phi, 0.13, r"$\varphi$", GREEN), (theta, 0.22, "θ", INK)):
        points = reach * unit_vectors(np.linspace(0.0, angle, 40))
        ax.plot(*points.T, color=color, linewidth=0.9, gid=f"angle {text}")
        note(ax, text, 1.12 * reach * unit_vectors(0.4 * angle), color=color)
    ray = np.stack([np.zeros(2), 0.26 * e])
    ax.plot(*ray.T, color=GREEN, linewidth=0.9, linestyle=":", gid="direction of sliding")
    ax.axhline(0.0, color=GREY, linewidth=0.7, zorder=0.9)
    ax.axvline(0.0, color=GREY, linewidth=0.7, zorder=0.9)
    ax.set(title="(b) force and sliding direction", xlabel="$x_1$", ylabel="$x_2$")
    ax.legend(loc="upper left", bbox_to_anchor=(0.0, -0.12), ncols=2)


def _construction_checks() -> list[Check]:
    phi = circle(720)
    e = unit_vectors(phi)
    force = -PVC.law.force(e)
    theta = np.arctan2(force[:, 1], force[:, 0])
    across = e[:, 0] * force[:, 1] - e[:, 1] * force[:, 0]
    tangent = across / np.sum(e * force, axis=1)
    step = 1e-6
    radius = PVC.law.direction.radius
    slope = (np.log(radius(theta + step)) - np.log(radius(theta - step))) / (2.0 * step)
    return [
        Check(
            "Fig. 22 tan(θ − φ) = λ_r/λ_t",
            0.0,
            float(np.abs(np.tan(theta - phi) - tangent).max()),
            1e-12,
        ),
        Check("Fig. 22 (124) d ln r_D/dθ", 0.0, float(np.abs(slope - tangent).max()), 1e-5),
    ]


def draw() -> Redrawn:
    """Draw (a) the frames of sensor and disk, (b) how C and D follow from the forces."""
    figure, axes = panels(
        22,
        "from forces to sets",
        2,
        figsize=(10.6, 5.2),
        parameters="synthetic: invented law of Fig. 24",
    )
    setup_sketches.disk_frames(axes[0])
    axes[0].set_title("(a) disk from above")
    _draw_construction(axes[1])
    return Redrawn(figure, _construction_checks())


# %%
if __name__ == "__main__":
    show(draw)
