"""Figure 11: Extended normal cone inclusions
=============================================

How does a second set D give the sliding direction, where C holds the forces? The paper gives no
numbers for these laws; those here are our own.
"""

from collections.abc import Sequence

import asperity as asp
import numpy as np
from asperity.demo import Check
from matplotlib.artist import Artist
from matplotlib.axes import Axes
from paper.curves import named
from paper.drawing import INK, SLIDING, circle, draw_arrows, unit_vectors
from paper.frame import Redrawn, cross, draw_law, note, panels, shared_legend, show
from paper.statements import never_positive, proposition_5, truth, vanishes

ELLIPSES = asp.FrictionLaw(asp.Ellipse(0.6, 0.3), asp.Ellipse(1.0, 0.85))
"""The law of Fig. 11a."""

DENTED = asp.FrictionLaw(
    asp.Ellipse(0.6, 0.22) | asp.Ellipse(0.3, 0.5), asp.Superellipse(1.3, 1.0, 2.5)
)
"""The law of Fig. 11b; its C is the union of two ellipses."""


def _draw_scaling(
    ax: Axes, law: asp.FrictionLaw, theta: float, labels: Sequence[tuple[int, int]]
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


def draw() -> Redrawn:
    """Draw non-associated laws (a) with elliptic sets, (b) with a reservoir that is not convex."""
    figure, axes = panels(11, "non-associated friction laws", 2)
    titles = ("(a) elliptic $C$ and $D$", "(b) non-convex $C$")
    chosen = np.deg2rad([12.0, 68.0])
    places = (((-4, 9), (-66, 10)), ((9, -7), (-63, -25)))
    for ax, law, title, theta, labels in zip(
        axes, (ELLIPSES, DENTED), titles, chosen, places, strict=True
    ):
        draw_law(law, ax, angles=[theta, theta + np.pi, np.pi - theta, -theta])
        scaling = _draw_scaling(ax, law, theta, labels)
        for name, artist in scaling.items():
            named(name, [artist])
        ax.set_title(title)
        cross(ax)
    shared_legend(figure, axes)
    return Redrawn(figure, [*_ellipse_checks(), *_dented_checks()])


# %%
if __name__ == "__main__":
    show(draw)
