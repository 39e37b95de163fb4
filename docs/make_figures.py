"""Make the figures of the documentation that no other command writes.

Run: python docs/make_figures.py
"""

from pathlib import Path

import asperity as asp
import matplotlib.pyplot as plt
import numpy as np
from asperity.plot.look import BLUE, GREEN, INK, ORANGE
from matplotlib.axes import Axes
from numpy.typing import NDArray

Array = NDArray[np.float64]

IMAGES = Path(__file__).resolve().parent / "images"
STEPS = (0.4, 1.0, 1.6)
"""r λ_max(G) of the constant iteration, r̃ λ_max(G) of the adaptive one."""

LAW = asp.FrictionLaw(asp.Ellipse(0.6, 0.2, angle=np.deg2rad(30.0)), asp.Ellipse(3.0, 1.0))


def thin_load(law: asp.FrictionLaw, gauge: float) -> Array:
    """Return the load of this gauge in the direction where D is thinnest within C."""
    theta = np.linspace(0.0, np.pi, 100_001)
    directions = np.stack([np.cos(theta), np.sin(theta)], axis=-1)
    ratio = law.reservoir.gauge(directions) / law.direction.gauge(directions)
    direction = directions[np.argmin(ratio)]
    return gauge * direction / law.reservoir.gauge(direction)


def alpha(law: asp.FrictionLaw, x: Array) -> float:
    """Return α(x) = 1/(k_D(x) − k_C(x) + 1), [WL19] (56)."""
    return float(1.0 / (law.direction.gauge(x) - law.reservoir.gauge(x) + 1.0))


def errors(
    law: asp.FrictionLaw, load: Array, r: float, *, adaptive: bool, iterations: int
) -> Array:
    """Iterate [WL19] (69), (70) with G = I, P_N = 1 from P = 0; distances to the stick solution."""
    percussion, distances = np.zeros(2), []
    for _ in range(iterations + 1):
        distances.append(np.linalg.norm(percussion + load) / np.linalg.norm(load))
        a = alpha(law, -percussion)
        step = a * r if adaptive else r
        percussion = -law.direction.project(-a * percussion + step * (percussion + load)) / a
    return np.array(distances)


def draw_sets(ax: Axes, law: asp.FrictionLaw, load: Array) -> None:
    """Draw C, D and the load."""
    for label, convex, colour in (
        ("$C$", law.reservoir, BLUE),
        ("$D$, largest inside $C$", law.direction, ORANGE),
    ):
        closed = convex.boundary(400)[np.r_[0:400, 0]]
        ax.fill(*closed.T, color=colour, alpha=0.10, linewidth=0.0)
        ax.plot(*closed.T, color=colour, label=label)
    ax.annotate("", load, (0.0, 0.0), arrowprops={"arrowstyle": "->", "color": INK, "lw": 1.4})
    ax.plot(*load, "o", color=INK, markersize=5, label="load")
    ax.set_aspect("equal")
    ax.set(title="A load inside $C$", xlabel="$-P_1/P_N$", ylabel="$-P_2/P_N$")
    ax.set_ylim(top=0.72)
    ax.legend(loc="upper left", fontsize="small", ncols=3, columnspacing=1.0, handlelength=1.2)


def draw_errors(ax: Axes, law: asp.FrictionLaw, load: Array, *, adaptive: bool) -> None:
    """Draw the errors of one variant for all step lengths."""
    for r, colour, dash in zip(STEPS, (GREEN, BLUE, ORANGE), ("-", "--", "-."), strict=True):
        distances = errors(law, load, r, adaptive=adaptive, iterations=60)
        # Up to the first iterate that is exact to the last bits.
        last = int(np.argmax(np.append(distances, 0.0) < 1e-15))
        shown = np.maximum(distances[: last + 1], 1e-17)
        ax.semilogy(shown, dash, color=colour, label=f"{r:.1f}", linewidth=1.8)
    symbol = r"$\tilde r$" if adaptive else "$r$"
    ax.set(xlabel="iteration $k$", ylim=(1e-16, 1e1), xlim=(0, 60))
    ax.set_title(r"Adaptive, $r = \alpha_k\tilde r$" if adaptive else "Constant $r$")
    ax.legend(
        title=symbol + r" $\lambda_{\max}(G)$", loc="lower left" if not adaptive else "upper right"
    )


def prox_constant_r() -> None:
    """Draw the case of docs/prox.md."""
    load = thin_load(LAW, 0.95)
    with asp.plot.style():
        figure, axes = plt.subplots(
            1, 3, figsize=(11.0, 3.7), layout="constrained", width_ratios=(1.25, 1.0, 1.0)
        )
        draw_sets(axes[0], LAW, load)
        for ax, adaptive in zip(axes[1:], (False, True), strict=True):
            draw_errors(ax, LAW, load, adaptive=adaptive)
        axes[1].set_ylabel(r"$\|P^k - P^*\|\,/\,\|P^*\|$")
        axes[2].tick_params(labelleft=False)
    asp.plot.save_figure(figure, IMAGES / "prox_constant_r.png", dpi=130)


def selection() -> None:
    """Draw the loads with several solutions, and the three solutions of one of them."""
    direction = np.array([np.cos(np.deg2rad(60.0)), np.sin(np.deg2rad(60.0))])
    load = -LAW.force(direction) + 0.05 * direction
    problem = asp.ContactProblem(np.eye(2), load, LAW, normal_force=1.0)
    with asp.plot.style():
        figure, axes = plt.subplots(1, 2, figsize=(9.0, 3.9), layout="constrained")
        closed = LAW.reservoir.boundary(720)[np.r_[0:720, 0]]
        for ax in axes:
            ax.fill(*closed.T, color=BLUE, alpha=0.08, linewidth=0.0)
            ax.plot(*closed.T, color=BLUE, label="$C$")
            ax.set(xlabel="$-P_1/P_N$", ylabel="$-P_2/P_N$")
            ax.set_aspect("equal")
        draw_several(axes[0])
        axes[0].plot(*load, "o", color=INK, markersize=4, label="load on the right")
        axes[0].legend(loc="upper left", fontsize="small")
        axes[0].set(title="Loads with several solutions", xlim=(-0.64, 0.64), ylim=(-0.4, 0.64))
        for number, solution in enumerate(problem.solutions(0), start=1):
            draw_solution(axes[1], number, solution)
        axes[1].set(
            title="The three solutions of one load", xlim=(0.395, 0.505), ylim=(0.055, 0.145)
        )
    asp.plot.save_figure(figure, IMAGES / "selection.png", dpi=130)


def draw_solution(ax: Axes, number: int, solution: asp.LocalSolution) -> None:
    """Draw −P and the slip γ, an arrow from −P to the load, since G = I."""
    force, slips = -solution.percussion, solution.phase == asp.Phase.SLIP
    if slips:
        arrow = {"arrowstyle": "->", "color": ORANGE, "lw": 1.6, "shrinkA": 4, "shrinkB": 4}
        ax.annotate("", force + solution.velocity, force, arrowprops=arrow)
    ax.plot(*force, "o", color=ORANGE if slips else INK, markersize=6)
    text = f"{number}: {solution.phase.name.lower()}"
    offset, side = ((9, -5), "left") if slips else ((-9, 4), "right")
    ax.annotate(text, force, offset, textcoords="offset points", ha=side)


def draw_several(ax: Axes, n: int = 640) -> None:
    """Fill the loads for which one contact with G = I and P_N = 1 has several solutions."""
    angles = 2.0 * np.pi * (np.arange(n) + 0.37) / n
    rays = LAW.reservoir.radius(angles)[:, None] * np.stack([np.cos(angles), np.sin(angles)], -1)
    loads = np.linspace(0.94, 1.03, 160)[:, None, None] * rays
    several = np.zeros(loads.shape[:2])
    for index in np.ndindex(several.shape):
        problem = asp.ContactProblem(np.eye(2), loads[index], LAW, normal_force=1.0)
        several[index] = problem.solve().ambiguous
    ax.contourf(*np.moveaxis(loads, -1, 0), several, levels=[0.5, 1.5], colors=[ORANGE])
    ax.fill([], [], color=ORANGE, label="several solutions")


if __name__ == "__main__":
    prox_constant_r()
    selection()
