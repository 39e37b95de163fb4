"""Figure 5: Associated Coulomb friction
========================================

Where does a body go on grooved ground if the sliding direction is normal to an elliptic reservoir?
The paper gives no numbers for these sets; those here are our own.
"""

import asperity as asp
import numpy as np
from asperity.demo import Check
from matplotlib.axes import Axes
from matplotlib.patches import Circle
from paper.drawing import GREY, INK, PURPLE, SLIDING, draw_arrows, unit_vectors
from paper.frame import Redrawn, cross, draw_law, panels, shared_legend, show
from paper.statements import proposition_2, propositions_3_and_4

PAIR = (0.6, 0.3)
"""Friction coefficients μ₁, μ₂ of Figs. 5–7."""

ELLIPTIC = asp.FrictionLaw.associated(asp.Ellipse(*PAIR))
"""The law of Fig. 5."""


def _draw_path(ax: Axes, path: asp.Trajectory) -> None:
    reach = 1.3 * path.q[-1]
    grooves = np.arange(-0.075, reach[0], 0.006)
    ax.vlines(grooves, -0.03, reach[1], color="#E3E3E3", linewidth=0.8)
    ax.plot(*path.q.T, color=INK, linewidth=1.0, linestyle="--", label="path of the body")
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
                draw_arrows(ax, path.q[[k]], vector[None], color=color, gid=name)
    ax.plot([], [], color=PURPLE, label=r"force $\lambda$ on the body")
    ax.grid(False)
    ax.set(xlim=(grooves[0], grooves[-1]), ylim=(-0.03, reach[1]), aspect="equal")
    ax.set(xlabel="$x$ across the grooves in m", ylabel="$y$ along the grooves in m")
    ax.set_title("(a) the force deflects a sliding body")


def _path_checks(path: asp.Trajectory) -> list[Check]:
    # On elliptic D free sliding keeps |v₁/v₁₀| = |v₂/v₂₀|^((p₁/p₂)²).
    later = path.u[len(path.t) // 2]
    exponent = np.log(later[0] / path.u[0, 0]) / np.log(later[1] / path.u[0, 1])
    power = (PAIR[0] / PAIR[1]) ** 2
    return [Check("Fig. 5a exponent of the velocity components", power, float(exponent), 0.01)]


def _associated_checks() -> list[Check]:
    reservoir = ELLIPTIC.reservoir
    directions_ = (asp.Disk(1.0), asp.Ellipse(1.0, 3.0), asp.Rectangle(2.0, 1.0, angle=0.4))
    others = [asp.FrictionLaw(reservoir, direction) for direction in directions_]
    return [
        *proposition_2("Fig. 5b", ELLIPTIC, others),
        *propositions_3_and_4("Fig. 5b", ELLIPTIC, others[:2]),
    ]


def draw() -> Redrawn:
    """Draw (a) a computed sliding path on grooved ground, (b) its associated elliptic law."""
    figure, (left, right) = panels(5, "associated Coulomb friction", 2, width_ratios=(1.0, 1.3))
    path = asp.simulate(
        asp.SlidingPoint(1.0, law=ELLIPTIC),
        dt=1e-4,
        t_end=1.0,
        u0=1.5 * unit_vectors(np.deg2rad(35.0)),
        until_rest=True,
    )
    _draw_path(left, path)
    draw_law(ELLIPTIC, right, angles=12, forces="arrows")
    right.set_title(r"(b) $\mu_1 = 0.6$, $\mu_2 = 0.3$")
    cross(right)
    shared_legend(figure, [left, right], columns=3)
    return Redrawn(figure, [*_path_checks(path), *_associated_checks()])


# %%
if __name__ == "__main__":
    show(draw)
