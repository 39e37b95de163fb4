"""Figs. 20–25 of [WL19]: the tribometer, what it measures and the sets that follow."""

from typing import Any

import numpy as np
from asperity.demo import Check
from asperity.identify import ProcessedData
from matplotlib.axes import Axes
from paper.drawing import BLUE, DIRECTION, GREY, INK, ORANGE, Array, unit_vectors
from paper.frame import Redrawn, panels, shared_legend
from paper.measurements.pairings import SYNTHETIC, Pairing, processed

_BINS = 360


def _resistance(data: ProcessedData) -> Array:
    """Return λ_t and λ_r in N in the directions of `data.sets`, at the mean normal force."""
    sets = data.sets
    e = unit_vectors(sets.phi)
    f = data.normal_force.mean() * sets.force
    return np.stack([np.sum(e * f, axis=1), e[:, 0] * f[:, 1] - e[:, 1] * f[:, 0]], axis=1)


def _forces_and_sets(number: int, pair: Pairing, checks: list[Check]) -> Redrawn:
    figure, axes = panels(number, pair.name, 2, figsize=(10.6, 5.0), parameters=SYNTHETIC)
    data = processed(pair)
    _draw_forces(data, pair, axes[0])
    _draw_sets(data, pair, axes[1])
    shared_legend(figure, axes, columns=6)
    return Redrawn(figure, checks)


def _draw_forces(data: ProcessedData, pair: Pairing, ax: Axes) -> None:
    phi = np.rad2deg(data.sets.phi)
    first = data.turn == 0
    e = unit_vectors(data.phi[first])
    f = data.force[first]
    raw = np.sum(e * f, axis=1), e[:, 0] * f[:, 1] - e[:, 1] * f[:, 0]
    turned = np.rad2deg(data.phi[first]) % 360.0
    for values, samples, name, text, color in zip(
        _resistance(data).T,
        raw,
        ("tangential force", "radial force"),
        (r"tangential $\lambda_t$", r"radial $\lambda_r$"),
        (BLUE, ORANGE),
        strict=True,
    ):
        look: dict[str, Any] = {
            "color": color,
            "alpha": 0.18,
            "markersize": 2.0,
            "markeredgewidth": 0.0,
        }
        ax.plot(turned[::8], samples[::8], ".", **look, gid=f"{name}, one turn")
        ax.plot(phi, values, color=color, label=text)
    ax.axhline(0.0, color=GREY, linewidth=0.7, zorder=0.9)
    ax.set_xlim(0.0, 360.0)
    ax.set(
        title=f"(a) forces at {pair.normal_force:g} N, {1e3 * pair.speed:g} mm/s",
        xlabel=r"sliding direction $\varphi$ in °, 0° across the grooves",
        ylabel="force in N, dots: one turn, unfiltered",
        xticks=np.arange(0.0, 361.0, 45.0),
    )


def _draw_sets(data: ProcessedData, pair: Pairing, ax: Axes) -> None:
    sets, scale = data.sets, pair.normal_force
    for points, name, text, color in (
        (sets.reservoir_points, "points of bdry C", "$C$ measured", BLUE),
        (sets.direction_by_support, "points of bdry D", "$D$ measured", DIRECTION),
    ):
        ax.plot(*(scale * points).T, ".", color=color, markersize=3.0, gid=name)
        ax.plot([], [], "o", color=color, markersize=4.0, label=text)
    corners = scale * sets.direction.polygon.vertices
    ax.plot(*np.vstack([corners, corners[:1]]).T, color=DIRECTION, linewidth=0.8, gid="convex D")
    truth_look: dict[str, Any] = {"color": INK, "linewidth": 0.8, "linestyle": "--"}
    for chosen, name in ((pair.law.reservoir, "true C"), (pair.law.direction, "true D")):
        outline = scale * chosen.boundary(_BINS)
        ax.plot(*np.vstack([outline, outline[:1]]).T, **truth_look, gid=name)
    ax.plot([], [], **truth_look, label="true sets")
    ax.set_aspect("equal")
    ax.set(
        title="(b) calculated sets",
        xlabel=r"$-\lambda_{T1}$ across the grooves in N",
        ylabel=r"$-\lambda_{T2}$ along the grooves in N",
    )


def _set_checks(number: int, data: ProcessedData, pair: Pairing) -> list[Check]:
    sets = data.sets
    off_c = np.abs(pair.law.reservoir.gauge(sets.reservoir_points) - 1.0).max()
    ratios = pair.law.direction.gauge(sets.direction_by_support)
    name = f"Fig. {number}"
    return [
        Check(f"{name} points off bdry C, share", 0.0, float(off_c), 0.05),
        Check(f"{name} shape of D off, share", 0.0, _variation(ratios), 0.03),
        # An error of the radial force counts 2π/μ-fold.
        Check(f"{name} closure of D", 1.0, sets.closure, 0.1),
        Check(f"{name} (125) and support form differ, share", 0.0, sets.difference, 5e-3),
    ]


def _variation(values: Array) -> float:
    """Return the largest difference from the mean relative to it."""
    mean = float(values.mean())
    return float(np.abs(values / mean - 1.0).max())


def _direction_variation(data: ProcessedData) -> float:
    return _variation(np.linalg.norm(data.sets.direction_by_support, axis=1))


def _alike(data: ProcessedData) -> bool:
    """Whether D is a scaled C within 5 %."""
    sets = data.sets
    return _variation(np.linalg.norm(sets.direction_by_support, axis=1) / sets.radius) < 0.05
