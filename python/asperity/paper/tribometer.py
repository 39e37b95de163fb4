"""Figs. 20–25 of [WL19]: the tribometer, what it measures and the sets that follow."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
from matplotlib.axes import Axes

from asperity._base.arrays import Array, unit_vectors
from asperity.identify import ProcessedData
from asperity.paper import setup_sketches
from asperity.paper.checks import Check
from asperity.paper.data import Curves
from asperity.paper.pairings import PVC, SANDBLASTED, STEEL, SYNTHETIC, Pairing, processed
from asperity.paper.redrawn import (
    Redrawn,
    circle,
    drawn,
    note,
    panels,
    record,
    record_texts,
    shared_legend,
)
from asperity.paper.statements import truth
from asperity.plot import plot_set
from asperity.plot.look import BLUE, DIRECTION, GREEN, GREY, INK, ORANGE, draw_arrows, style

_BINS = 360
_PIN_DIAMETER = 7.0


def fig20() -> Redrawn:
    """Draw the pin-on-disk tribometer."""
    figure, (ax,) = panels(20, "tribometer", 1, figsize=(8.0, 6.0), parameters="not to scale")
    with style():
        setup_sketches.tribometer_view(ax)
    curves = Curves()
    record_texts(curves, "a", ax)
    area = 0.25 * math.pi * _PIN_DIAMETER**2
    return Redrawn(figure, curves, [Check("Fig. 20 area of the pin", 38.0, area, 0.5, "mm²")])


def fig21() -> Redrawn:
    """Draw the tribometer from the side."""
    figure, (ax,) = panels(
        21, "experimental setup", 1, figsize=(8.0, 6.6), parameters="not to scale"
    )
    with style():
        setup_sketches.tribometer_section(ax)
    curves = Curves()
    record_texts(curves, "a", ax)
    speeds = (
        Check(
            f"Fig. 21 sliding speed, {pair.name}",
            pair.speed,
            float(processed(pair).speed.mean()),
            1e-6,
            "m/s",
        )
        for pair in (SANDBLASTED, PVC, STEEL)
    )
    return Redrawn(figure, curves, list(speeds))


def fig22() -> Redrawn:
    """Draw (a) the frames of sensor and disk, (b) how C and D follow from the forces."""
    figure, axes = panels(
        22,
        "from forces to sets",
        2,
        figsize=(10.6, 5.2),
        parameters="synthetic: invented law of Fig. 24",
    )
    curves = Curves()
    with style():
        setup_sketches.disk_frames(axes[0])
        axes[0].set_title("(a) disk from above")
        _draw_construction(curves, axes[1])
    return Redrawn(figure, curves, _construction_checks())


def _draw_construction(curves: Curves, ax: Axes) -> None:
    law = PVC.law
    (outline, _), (inner, _) = (
        drawn(plot_set, chosen, ax, color=color, label=label)
        for chosen, color, label in (
            (law.reservoir, BLUE, "reservoir $C$"),
            (law.direction, DIRECTION, "direction set $D$"),
        )
    )
    record(curves, "b", "bdry C", [outline])
    record(curves, "b", "bdry D", [inner])
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
        arrow = draw_arrows(ax, tail[None], vector[None], color=color, zorder=5.0)
        record(curves, "b", name, [arrow])
        note(ax, text, tail + vector, offset, color=color)
    for angle, reach, text, color in ((phi, 0.13, r"$\varphi$", GREEN), (theta, 0.22, "θ", INK)):
        points = reach * unit_vectors(np.linspace(0.0, angle, 40))
        (arc,) = ax.plot(*points.T, color=color, linewidth=0.9)
        record(curves, "b", f"angle {text}", [arc])
        note(ax, text, 1.12 * reach * unit_vectors(0.4 * angle), color=color)
    ray = np.stack([np.zeros(2), 0.26 * e])
    (ahead,) = ax.plot(*ray.T, color=GREEN, linewidth=0.9, linestyle=":")
    record(curves, "b", "direction of sliding", [ahead])
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


def fig23() -> Redrawn:
    """Draw forces and sets of a steel pin on sandblasted steel."""
    data = processed(SANDBLASTED)
    radius = data.sets.radius
    against, across = _resistance(data).T
    return _forces_and_sets(
        23,
        SANDBLASTED,
        [
            Check("Fig. 23 friction coefficient", 0.14, float(radius.mean()), 2e-3),
            Check("Fig. 23 radial force", 0.0, float(np.abs(across).max()), 0.06, "N"),
            Check("Fig. 23 tangential force varies", 0.0, _variation(against), 0.03),
            Check("Fig. 23 C is no circle by", 0.0, _variation(radius), 0.03),
            Check("Fig. 23 D is no circle by", 0.0, _direction_variation(data), 0.03),
        ],
    )


def fig24() -> Redrawn:
    """Draw forces and sets of a PVC pin on surface ground steel."""
    data = processed(PVC)
    across, along = data.sets.radii_on_axes
    return _forces_and_sets(
        24,
        PVC,
        [
            Check("Fig. 24 friction coefficient across", 0.54, across, 5e-3),
            Check("Fig. 24 friction coefficient along", 0.48, along, 5e-3),
            *_set_checks(24, data, PVC),
        ],
    )


def fig25() -> Redrawn:
    """Draw forces and sets of a steel pin on surface ground steel."""
    data = processed(STEEL)
    across, along = data.sets.radii_on_axes
    against = _resistance(data)[:, 0]
    highest = float(np.rad2deg(data.sets.phi[against.argmax()])) % 180.0
    return _forces_and_sets(
        25,
        STEEL,
        [
            truth("Fig. 25 more friction along the grooves", along > across),
            Check("Fig. 25 direction of most friction", 90.0, highest, 3.0, "deg"),
            truth("Fig. 25 C and D differ in shape", not _alike(data)),
            *_set_checks(25, data, STEEL),
        ],
    )


def _resistance(data: ProcessedData) -> Array:
    """Return λ_t and λ_r in N in the directions of `data.sets`, at the mean normal force."""
    sets = data.sets
    e = unit_vectors(sets.phi)
    f = data.normal_force.mean() * sets.force
    return np.stack([np.sum(e * f, axis=1), e[:, 0] * f[:, 1] - e[:, 1] * f[:, 0]], axis=1)


def _forces_and_sets(number: int, pair: Pairing, checks: list[Check]) -> Redrawn:
    figure, axes = panels(number, pair.name, 2, figsize=(10.6, 5.0), parameters=SYNTHETIC)
    curves, data = Curves(), processed(pair)
    with style():
        _draw_forces(curves, data, pair, axes[0])
        _draw_sets(curves, data, pair, axes[1])
        shared_legend(figure, axes, columns=6)
    return Redrawn(figure, curves, checks)


def _draw_forces(curves: Curves, data: ProcessedData, pair: Pairing, ax: Axes) -> None:
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
        (dots,) = ax.plot(turned[::8], samples[::8], ".", **look)
        record(curves, "a", f"{name}, one turn", [dots])
        (line,) = ax.plot(phi, values, color=color, label=text)
        record(curves, "a", name, [line])
    ax.axhline(0.0, color=GREY, linewidth=0.7, zorder=0.9)
    ax.set_xlim(0.0, 360.0)
    ax.set(
        title=f"(a) forces at {pair.normal_force:g} N, {1e3 * pair.speed:g} mm/s",
        xlabel=r"sliding direction $\varphi$ in °, 0° across the grooves",
        ylabel="force in N, dots: one turn, unfiltered",
        xticks=np.arange(0.0, 361.0, 45.0),
    )


def _draw_sets(curves: Curves, data: ProcessedData, pair: Pairing, ax: Axes) -> None:
    sets, scale = data.sets, pair.normal_force
    for points, name, text, color in (
        (sets.reservoir_points, "points of bdry C", "$C$ measured", BLUE),
        (sets.direction_by_support, "points of bdry D", "$D$ measured", DIRECTION),
    ):
        (dots,) = ax.plot(*(scale * points).T, ".", color=color, markersize=3.0)
        ax.plot([], [], "o", color=color, markersize=4.0, label=text)
        record(curves, "b", name, [dots])
    corners = scale * sets.direction.polygon.vertices
    (convex,) = ax.plot(*np.vstack([corners, corners[:1]]).T, color=DIRECTION, linewidth=0.8)
    record(curves, "b", "convex D", [convex])
    truth_look: dict[str, Any] = {"color": INK, "linewidth": 0.8, "linestyle": "--"}
    for chosen, name in ((pair.law.reservoir, "true C"), (pair.law.direction, "true D")):
        outline = scale * chosen.boundary(_BINS)
        (line,) = ax.plot(*np.vstack([outline, outline[:1]]).T, **truth_look)
        record(curves, "b", name, [line])
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
