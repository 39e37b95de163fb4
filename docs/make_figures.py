"""Make the figures of the documentation that no other command writes.

Run: PYTHONPATH=examples python docs/make_figures.py
"""

import contextlib
import re
import runpy
import shutil
import tempfile
from pathlib import Path
from typing import Any

import asperity as asp
import matplotlib.pyplot as plt
import numpy as np
from asperity.demo import round_trip
from matplotlib.axes import Axes
from matplotlib.lines import Line2D
from matplotlib.patches import Patch
from paper.__main__ import redraw
from paper.drawing import BLUE, GREEN, GREY, INK, ORANGE, PURPLE, Array

ROOT = Path(__file__).resolve().parents[1]

IMAGES = ROOT / "docs" / "images"
STEPS = (0.4, 1.0, 1.6)
"""r λ_max(G) of the constant iteration, r̃ λ_max(G) of the adaptive one."""

SIZES = {
    "amplitude_chart": 64,
    "basins_of_attraction": 60,
    "loads_with_several_solutions": 120,
    "uncertain_path": 1000,
}
"""Points along an axis of docs/charts.md; the scripts have fewer, to take less than 10 s."""

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
    problem = asp.ContactProblem(np.eye(2), free_velocity=load, laws=LAW, normal_force=1.0)
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


def draw_solution(ax: Axes, number: int, solution: asp.contact.LocalSolution) -> None:
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
        problem = asp.ContactProblem(
            np.eye(2), free_velocity=loads[index], laws=LAW, normal_force=1.0
        )
        several[index] = problem.solve().ambiguous
    ax.contourf(*np.moveaxis(loads, -1, 0), several, levels=[0.5, 1.5], colors=[ORANGE])
    ax.fill([], [], color=ORANGE, label="several solutions")


def sets() -> None:
    """Draw one set of each planar kind and of each combination."""
    theta = 2.0 * np.pi * np.arange(12) / 12
    gallery = {
        "Disk": asp.Disk(0.8),
        "Ellipse": asp.Ellipse(1.0, 0.5, angle=0.4),
        "Rectangle": asp.Rectangle(0.9, 0.5),
        "Superellipse, $s = 4$": asp.Superellipse(1.0, 0.6, 4.0),
        "Superellipse, $s = 0.6$": asp.Superellipse(1.0, 0.8, 0.6),
        "CappedRectangle": asp.CappedRectangle(0.5, 0.5, cap=0.45),
        "WedgeAsperity": asp.WedgeAsperity(1.2, beta=np.deg2rad(35.0)).scaled(0.16),
        "Polygon": asp.Polygon([[1.0, -0.5], [0.4, 0.2], [0.8, 0.9], [-0.9, 0.5], [-0.5, -0.8]]),
        "PolarCurve": asp.PolarCurve(theta, 0.75 + 0.2 * np.cos(3.0 * theta)),
        "Intersection  &": asp.Ellipse(1.0, 0.6) & asp.Rectangle(0.7, 0.9, angle=0.3),
        "Union  |": asp.Ellipse(1.0, 0.35) | asp.Ellipse(0.35, 0.8),
        "MinkowskiSum  +": asp.Rectangle(0.5, 0.3) + asp.Ellipse(0.4, 0.2, angle=0.7),
    }
    with asp.plot.style():
        figure, axes = plt.subplots(3, 4, figsize=(10.0, 7.0), layout="constrained")
        for ax, (name, star) in zip(axes.flat, gallery.items(), strict=True):
            asp.plot.plot_set(star, ax=ax, color=BLUE if star.is_convex else ORANGE)
            ax.plot(0.0, 0.0, "o", color=INK, markersize=3.0)
            ax.set(title=name, xlabel="", ylabel="", xlim=(-1.25, 1.25), ylim=(-1.0, 1.0))
            ax.tick_params(labelbottom=False, labelleft=False)
        figure.legend(
            [Line2D([], [], color=BLUE), Line2D([], [], color=ORANGE)],
            ["convex", "star-shaped only"],
            loc="outside lower center",
            ncols=2,
        )
    asp.plot.save_figure(figure, IMAGES / "sets.png", dpi=110)


def cones() -> None:
    """Draw the cones of docs/geometry.md."""
    lens = asp.Ellipse(1.0, 0.7) & asp.Rectangle(0.8, 1.0)
    cross = asp.Rectangle(1.0, 0.4) | asp.Rectangle(0.4, 1.0)
    with asp.plot.style():
        figure, (left, right) = plt.subplots(1, 2, figsize=(9.6, 4.6), layout="constrained")
        asp.plot.plot_set(lens, ax=left, label="$C$")
        smooth = lens.radius(2.0) * np.array([np.cos(2.0), np.sin(2.0)])
        for point in ([0.8, 0.42], smooth):
            asp.plot.plot_cones(lens, x=point, ax=left, size=0.35)
        asp.plot.plot_projection(lens, z=[[1.2, -0.75], [0.3, -1.1], [-1.25, 0.1]], ax=left)
        left.set_title("Convex: normal and tangent cones, projections")
        asp.plot.plot_set(cross, ax=right)
        for point in ([0.4, 0.4], [1.0, -0.4], [-0.4, 0.75]):
            asp.plot.plot_cones(cross, x=point, ax=right, normal=False, size=0.35)
        right.set_title("Star-shaped: tangent cones")
        handles, labels = left.get_legend_handles_labels()
        handles += [Patch(color=GREEN, alpha=0.4), Patch(color=PURPLE, alpha=0.4)]
        labels += ["normal cone", "tangent cone"]
        figure.legend(handles, labels, loc="outside lower center", ncols=5)
    asp.plot.save_figure(figure, IMAGES / "cones.png", dpi=110)


def made_laws() -> dict[str, asp.FrictionLaw]:
    """Return the laws of docs/laws.md by title."""
    fourth = np.zeros((2, 2, 2, 2))
    fourth[0, 0, 0, 0] = fourth[1, 1, 1, 1] = 0.1
    fourth[0, 0, 1, 1] = fourth[1, 1, 0, 0] = -0.1
    surface = asp.FrictionLaw(
        asp.Superellipse(0.537, 0.457, 2.94), asp.Superellipse(1.84, 1.19, 2.51)
    )
    phi = np.deg2rad(np.arange(0.0, 360.0, 10.0))
    slip = np.stack([np.cos(phi), np.sin(phi)], axis=-1)
    noise = 0.01 * np.random.default_rng(7).normal(size=slip.shape)
    return {
        "asperity(0.6, 30°)": asp.FrictionLaw.asperity(0.6, beta=np.deg2rad(30.0)),
        "asperity(0.5, (15°, 50°))": asp.FrictionLaw.asperity(0.5, beta=np.deg2rad([15.0, 50.0])),
        "tensor(F, K)": asp.FrictionLaw.tensor(0.2 * np.eye(2), fourth_order=fourth),
        "from_samples, 36 noisy ones": asp.FrictionLaw.from_samples(
            phi, noise - surface.force(slip)
        ),
    }


def laws() -> None:
    """Draw laws from asperities, tensors and samples."""
    with asp.plot.style():
        figure, axes = plt.subplots(2, 2, figsize=(9.6, 8.4), layout="constrained")
        for ax, (title, law) in zip(axes.flat, made_laws().items(), strict=True):
            asp.plot.plot_law(law, ax=ax, angles=24, legend=False)
            ax.set_title(title)
        figure.legend(*axes[0, 0].get_legend_handles_labels(), loc="outside lower center", ncols=4)
    asp.plot.save_figure(figure, IMAGES / "laws.png", dpi=110)


def directions() -> None:
    """Draw coefficients, deflection and trace criterion of three laws over the direction."""
    ellipse = asp.Ellipse(0.3, 0.1)
    chosen = {
        "associated ellipse": asp.FrictionLaw.associated(asp.Ellipse(0.3, 0.15)),
        "tensor diag(0.3, 0.1)": asp.FrictionLaw.tensor([[0.3, 0.0], [0.0, 0.1]]),
        "tilted ellipses": asp.FrictionLaw(ellipse.rotated(np.pi / 6), asp.Ellipse(3.0, 1.0)),
    }
    phi = np.linspace(0.0, 2.0 * np.pi, 721)
    with asp.plot.style():
        figure, axes = plt.subplots(1, 3, figsize=(12.6, 4.2), layout="constrained")
        for (name, law), color in zip(chosen.items(), (BLUE, GREEN, ORANGE), strict=True):
            asp.plot.plot_friction_coefficient(law, ax=axes[0], label=name, color=color)
            asp.plot.plot_deflection(law, ax=axes[1], color=color)
            axes[2].plot(np.rad2deg(phi), law.trace_criterion(phi), color=color)
        handles, labels = axes[0].get_legend_handles_labels()
        axes[0].get_legend().remove()
        axes[0].set_title("$l_t$ against sliding, $l_p$ across")
        axes[1].set_title("Deflection")
        axes[2].set(title="Trace criterion", ylabel=r"$l_t + dl_p/d\varphi$")
        axes[2].set(xticks=axes[1].get_xticks(), xlim=(0.0, 360.0), xlabel=axes[1].get_xlabel())
        axes[2].axhspan(axes[2].get_ylim()[0], 0.0, color=GREY, alpha=0.15, linewidth=0.0)
        axes[2].margins(y=0.0)
        figure.legend(handles, labels, loc="outside lower center", ncols=3)
    asp.plot.save_figure(figure, IMAGES / "directions.png", dpi=110)


def belt(phi: float) -> asp.MassOnBelt:
    """Return the mass on a belt of docs/stability.md; the belt moves at the angle φ."""
    law = asp.FrictionLaw(asp.Ellipse(30.0, 10.0, angle=np.pi / 6), asp.Ellipse(3.0, 1.0))
    return asp.MassOnBelt(
        1.0, stiffness=1.0, law=law, normal_force=1.0, belt_velocity=[np.cos(phi), np.sin(phi)]
    )


def growth() -> None:
    """Draw the chart of docs/stability.md; ζ = 30° is the belt of that page."""
    unturned = belt(0.0).replace(
        law=asp.FrictionLaw(asp.Ellipse(30.0, 10.0), asp.Ellipse(3.0, 1.0))
    )
    phi, zeta = np.linspace(20.0, 100.0, 401), np.linspace(0.0, 90.0, 361)
    rates = asp.growth_chart(unturned, phi=np.deg2rad(phi), zeta=np.deg2rad(zeta)).growth
    with asp.plot.style():
        figure, ax = plt.subplots(figsize=(6.4, 4.4), layout="constrained")
        asp.plot.plot_growth_chart(rates, x=phi, y=zeta, ax=ax, limit=12.0)
        ax.axhline(30.0, color=INK, linewidth=0.9, linestyle=":")
        ax.set(
            title="Growth rate of small motions",
            xlabel=r"belt direction $\varphi$ in degrees",
            ylabel=r"rotation $\zeta$ of $C$ in degrees",
        )
    asp.plot.save_figure(figure, IMAGES / "growth_chart.png", dpi=110)


def bifurcation() -> None:
    """Draw equilibria and limit cycles of docs/stability.md, and the periods of the cycles."""
    phi = np.linspace(30.0, 90.0, 241)
    diagram = asp.bifurcation_diagram(belt, parameter="phi", values=np.deg2rad(phi))
    found = [cycle is not None and cycle.is_stable for cycle in diagram.cycles]
    plain: dict[str, Any] = {"frameon": True, "framealpha": 1.0, "edgecolor": "none"}
    with asp.plot.style():
        figure, (left, right) = plt.subplots(1, 2, figsize=(11.0, 4.2), layout="constrained")
        asp.plot.plot_bifurcation(diagram.replace(values=phi), ax=left)
        for name, shown, marker in (("stable", found, "o"), ("unstable", np.invert(found), "x")):
            right.plot(
                phi[shown],
                diagram.periods[shown],
                marker,
                color=ORANGE if marker == "o" else INK,
                markersize=3.0,
                label=f"{name} limit cycle",
            )
        for ax in (left, right):
            for border in np.rad2deg(asp.critical_directions(belt(0.0).law)[0]):
                ax.axvline(border, color=GREY, linewidth=0.9)
            ax.set(xlabel=r"belt direction $\varphi$ in degrees", xlim=(30.0, 90.0))
        left.set(title="Equilibria and limit cycles", ylabel="$x$ in m", ylim=(5.0, 29.0))
        left.legend(loc="lower left", **plain)
        right.set(title="Periods", ylabel="period in s", ylim=(0.0, 140.0))
        right.legend(loc="lower right", **plain)
    asp.plot.save_figure(figure, IMAGES / "bifurcation.png", dpi=110)


def conveyor() -> None:
    """Run the example of the vibratory conveyor."""
    script = ROOT / "examples" / "bodies" / "vibratory_conveyor.py"
    runpy.run_path(str(script))
    asp.plot.save_figure(plt.gcf(), IMAGES / "conveyor.png")


def charts() -> None:
    """Run the examples of docs/charts.md with the numbers of points that are named there."""
    for script in sorted((ROOT / "examples" / "charts").glob("*.py")):
        size = SIZES[script.stem]
        text = re.sub(
            r"^(SIZE\b.*? = )\d+",
            rf"\g<1>{size}",
            script.read_text(encoding="utf-8"),
            flags=re.MULTILINE,
        )
        exec(compile(text, str(script), "exec"), {"__name__": "__main__"})
        asp.plot.save_figure(plt.gcf(), IMAGES / f"{script.stem}.png", dpi=110)


def tutorials() -> None:
    """Run the tutorials; the pictures that they save are those that they show."""
    run_page = runpy.run_path(str(ROOT / "tests" / "pages.py"))["run_page"]
    for page in sorted((ROOT / "docs" / "tutorials").glob("*.md")):
        with tempfile.TemporaryDirectory() as folder, contextlib.chdir(folder):
            run_page(page)
            for picture in sorted(Path(folder).glob("*.png")):
                shutil.copy(picture, IMAGES / f"{page.stem}_{picture.name}")


def paper() -> None:
    """Draw the figures of the paper that the documentation shows."""
    for number in (10, 12):
        figure = redraw(number).figure
        asp.plot.save_figure(figure, IMAGES / f"fig{number}.png", dpi=110)


def identified() -> None:
    """Draw the round trip of ``asperity demo``."""
    figure = round_trip.draw(round_trip.run())
    asp.plot.save_figure(figure, IMAGES / "roundtrip.png", dpi=110)


if __name__ == "__main__":
    for draw in (
        prox_constant_r,
        selection,
        sets,
        cones,
        laws,
        directions,
        growth,
        bifurcation,
        conveyor,
        charts,
        tutorials,
        paper,
        identified,
    ):
        draw()
