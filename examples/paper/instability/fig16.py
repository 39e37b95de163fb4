"""Figure 16: The direction of the belt decides
===============================================

For which directions of the belt does the equilibrium lose its stability, and to which limit cycles?
The parameters are those of §4.3.
"""

from typing import Any

import asperity as asp
import numpy as np
from asperity.demo import Check
from asperity.demo.belt import LAW
from asperity.plot import plot_bifurcation, plot_growth_chart
from matplotlib.axes import Axes
from matplotlib.lines import Line2D
from paper.curves import named
from paper.drawing import INK, PURPLE, Array, draw_arrows, unit_vectors
from paper.frame import Redrawn, cross, draw_law, drawn, panels, shared_legend, show
from paper.instability.fig14 import belt
from paper.instability.fig15 import _PAPER, ZETA
from paper.statements import truth, vanishes

BORDERS = (44.106, 75.894)
"""Directions in degrees between which the belt's equilibrium is unstable at this rotation."""


def bifurcations(step: float = 1.0) -> asp.BifurcationDiagram:
    """Return equilibria and limit cycles for belt directions from 0 to 160° in steps."""
    return asp.bifurcation_diagram(
        belt, parameter="phi", values=np.deg2rad(np.arange(0.0, 160.0 + 0.5 * step, step))
    )


def _draw_diagram(ax: Axes, diagram: asp.BifurcationDiagram) -> None:
    artists = drawn(
        plot_bifurcation, diagram.replace(values=np.rad2deg(diagram.values)), ax, legend=False
    )
    for line in artists:
        if isinstance(line, Line2D):
            label = str(line.get_label())
            named("limit cycle" if label.startswith("_") else label, [line])
    ax.set(title="(a) bifurcation diagram", xlabel=r"belt direction $\varphi$ in degrees")
    ax.set(ylabel="$x$ in m", xticks=np.arange(0.0, 161.0, 40.0))


def _draw_critical(ax: Axes) -> None:
    draw_law(LAW, ax, angles=24)
    span = asp.critical_directions(LAW)[0]
    inside = np.linspace(*span, 61)
    forces = -LAW.force(unit_vectors(inside))
    arc: dict[str, Any] = {"color": PURPLE, "linewidth": 4.0, "alpha": 0.7, "zorder": 3.5}
    ax.plot(*forces.T, label=r"$\gamma \in$ int $T_C(-\lambda)$", gid="critical forces", **arc)
    draw_arrows(
        ax,
        forces[[0, -1]],
        13.0 * unit_vectors(np.array(span)),
        color=PURPLE,
        gid="sliding direction at the borders",
    )
    cross(ax)
    ax.set(title=r"(b) the law, $\zeta = 30°$", aspect="equal")
    ax.set(xlabel=r"$-\lambda_1$ in N", ylabel=r"$-\lambda_2$ in N")


def _draw_chart(ax: Axes) -> None:
    phi, zeta = np.linspace(0.0, np.pi, 181), np.linspace(0.0, 0.5 * np.pi, 91)
    unturned = belt(0.0).replace(
        law=asp.FrictionLaw(asp.Ellipse(30.0, 10.0), asp.Ellipse(3.0, 1.0))
    )
    growth = asp.growth_chart(unturned, phi=phi, zeta=zeta).growth
    plot_growth_chart(growth, x=np.rad2deg(phi), y=np.rad2deg(zeta), ax=ax, border=False)
    ax.plot(*np.rad2deg(_border()).T, color=INK, linewidth=1.2, gid="border of instability")
    ax.axhline(np.rad2deg(ZETA), color=INK, linewidth=0.8, linestyle=":")
    ax.set(title="(c) growth rate", xlabel=r"belt direction $\varphi$ in degrees")
    ax.set(ylabel=r"rotation $\zeta$ of $C$ in degrees")


def _border() -> Array:
    """Return the closed curve of (φ, ζ) on which γ is tangent to bdry C."""
    low, high = asp.critical_rotation(asp.Ellipse(3.0, 1.0), asp.Ellipse(3.0, 1.0))[0]
    middle, half = 0.5 * (low + high), 0.5 * (high - low)
    # Close to the ends, where the interval of directions shrinks to a point like a square root.
    turns = middle - half * np.cos(np.linspace(0.02, np.pi - 0.02, 61))
    laws = [
        asp.FrictionLaw(asp.Ellipse(3.0, 1.0, angle=turn), asp.Ellipse(3.0, 1.0)) for turn in turns
    ]
    spans = np.array([asp.critical_directions(law)[0] for law in laws])
    left, right = (np.column_stack([spans[:, side], turns]) for side in (0, 1))
    return np.vstack([left, right[::-1], left[:1]])


def _border_checks(diagram: asp.BifurcationDiagram) -> list[Check]:
    first, second = asp.critical_directions(LAW)
    low, high = np.rad2deg(first)
    degrees, kinds = np.rad2deg(diagram.values), np.array(diagram.kinds)
    inside = (degrees > low) & (degrees < high)
    cycles = np.isfinite(diagram.cycle_minima[:, 0])
    near = [asp.stability(belt(np.deg2rad(phi))).kind for phi in (44.1, 44.11, 75.89, 75.9)]
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


def draw() -> Redrawn:
    """Draw (a) the bifurcation diagram, (b) the law, (c) growth rates over φ and ζ."""
    figure, (left, middle, right) = panels(
        16,
        "the direction of the belt decides",
        3,
        figsize=(15.4, 4.9),
        width_ratios=(1.15, 1.25, 1.2),
        parameters=_PAPER,
    )
    diagram = bifurcations()
    _draw_diagram(left, diagram)
    _draw_critical(middle)
    _draw_chart(right)
    shared_legend(figure, [left, middle], columns=8)
    return Redrawn(figure, _border_checks(diagram))


# %%
if __name__ == "__main__":
    show(draw)
