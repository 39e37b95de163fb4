"""Schematic drawings of the experiments of [WL19] §5: sliding disk, pin-on-disk tribometer."""

from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.patches import Arc, Circle, Ellipse, FancyArrowPatch, Polygon, Rectangle
from matplotlib.path import Path
from numpy.typing import ArrayLike
from paper.drawing import BLUE, GREEN, GREY, INK, ORANGE, PURPLE, Array, unit_vectors
from paper.frame import bare
from paper.sketches import parts

# A horizontal circle in oblique view: heights are shortened, depths more so.
_FLAT = 0.36
_RED, _DARK = "#C8372D", "#A9B2BD"


def sliding_experiment(ax: Axes) -> None:
    """Draw the disk on the ground plate, the accelerator and the camera above, in oblique view."""
    bare(ax)
    _cylinder(ax, [0.0, 0.0], 2.0, 0.22, parts.PLATE, zorder=3.0)
    for line in _chords(2.0, 24, np.pi / 2 - 0.55):
        ax.plot(line[:, 0], _FLAT * line[:, 1], color=GREY, linewidth=0.5, zorder=3.2)
    track = np.linspace(0.0, 1.0, 40)[:, None]
    path = (1 - track) ** 2 * [-1.1, -0.25] + 2 * track * (1 - track) * [0.0, 0.02]
    path = path + track**2 * [0.75, 0.5]
    ax.plot(*path.T, color=ORANGE, linewidth=1.6, linestyle=(0, (1, 1.6)), zorder=3.5)
    solenoid = np.array([[-2.35, -0.75], [-1.7, -0.5], [-1.7, -0.12], [-2.35, -0.37]])
    ax.add_patch(Polygon(solenoid, facecolor=parts.METAL, edgecolor=INK, zorder=4.0))
    ax.plot([-1.7, -1.42], [-0.33, -0.24], color=INK, linewidth=3.0, zorder=4.0)
    _puck(ax, path[0])
    _puck(ax, path[-1])
    parts.arrow(ax, path[0] + [0.28, 0.2], [0.5, 0.13], color=GREEN)
    parts.label(ax, r"$v_0$", path[0] + [0.62, 0.52], color=GREEN)
    _camera(ax, np.array([0.1, 2.15]))
    for foot in ([-1.95, 0.1], [1.95, 0.1]):
        ax.plot([0.1, foot[0]], [1.72, foot[1]], color=GREY, linewidth=0.8, linestyle=":")
    for text, place, target in (
        ("solenoid and\ncentring device", [-2.55, 0.62], [-2.0, -0.25]),
        ("disk ⌀28 mm on\nthree PVC pads,\nred mark", [2.35, 1.0], [0.95, 0.68]),
        ("surface ground\nsteel plate", [2.35, -0.6], [1.55, -0.3]),
        ("camera, 500 frames/s", [1.75, 2.15], [0.45, 2.15]),
    ):
        _call_out(ax, text, place, target)
    ax.set(xlim=(-3.1, 3.1), ylim=(-1.05, 2.6))


def tribometer_view(ax: Axes) -> None:
    """Draw the pin-on-disk tribometer in oblique view."""
    bare(ax)
    _cylinder(ax, [0.0, -0.75], 0.5, 0.7, parts.METAL)
    _cylinder(ax, [0.0, 0.0], 1.9, 0.2, parts.PLATE, zorder=3.0)
    for line in _chords(1.9, 22, np.pi / 2):
        ax.plot(line[:, 0], _FLAT * line[:, 1], color=GREY, linewidth=0.5, zorder=3.2)
    x = 1.25
    ax.add_patch(Ellipse((x, -0.02), 0.16, 0.07, facecolor=INK, zorder=4.0))
    _cylinder(ax, [x, 0.42], 0.11, 0.42, _DARK, zorder=5.0)
    _cylinder(ax, [x, 0.75], 0.3, 0.32, "#D8C7A3", zorder=6.0)
    _cylinder(ax, [x, 1.95], 0.08, 1.2, parts.METAL, zorder=7.0)
    _cylinder(ax, [x, 1.4], 0.22, 0.34, parts.PLATE, zorder=8.0)
    _cylinder(ax, [x, 2.05], 0.42, 0.2, _DARK, zorder=9.0)
    _cylinder(ax, [x, 2.27], 0.42, 0.2, _DARK, zorder=10.0)
    turn = FancyArrowPatch(
        (-1.45, -0.05),
        (-0.5, 0.42),
        connectionstyle="arc3,rad=-0.35",
        arrowstyle="-|>",
        mutation_scale=14.0,
        color=GREEN,
        zorder=6.0,
    )
    ax.add_patch(turn)
    parts.label(ax, r"$\varphi$", [-1.05, 0.5], color=GREEN)
    for text, place, target in (
        ("weights", [2.55, 2.15], [1.65, 2.1]),
        ("linear ball spline", [2.75, 1.25], [1.45, 1.25]),
        ("3D force sensor", [2.75, 0.6], [1.55, 0.6]),
        ("pin", [0.35, 0.75], [1.18, 0.1]),
        ("ground disk ⌀30 cm", [-1.9, 1.0], [-1.1, 0.25]),
        ("servomotor, harmonic\ndrive and resolver", [-1.75, -1.2], [-0.45, -1.1]),
    ):
        _call_out(ax, text, place, target)
    ax.set(xlim=(-3.0, 3.4), ylim=(-1.75, 2.65))


def tribometer_section(ax: Axes) -> None:
    """Draw the tribometer from the side, with what is measured."""
    bare(ax)
    parts.block(ax, [0.0, -1.29], (1.1, 0.9), "motor")
    parts.block(ax, [0.0, -0.67], (0.8, 0.34), "gear")
    ax.add_patch(Rectangle((-0.12, -0.5), 0.24, 0.4, facecolor=parts.METAL, edgecolor=INK))
    ax.add_patch(Rectangle((-2.0, -0.1), 4.0, 0.22, facecolor=parts.PLATE, edgecolor=INK))
    x = 1.3
    pin = np.array(
        [[x - 0.12, 0.57], [x - 0.12, 0.2], [x, 0.12], [x + 0.12, 0.2], [x + 0.12, 0.57]]
    )
    ax.add_patch(Polygon(pin, facecolor=_DARK, edgecolor=INK, zorder=4.0))
    parts.block(ax, [x, 0.78], (0.95, 0.42), "sensor")
    ax.add_patch(Rectangle((x - 0.08, 0.99), 0.16, 0.95, facecolor=parts.METAL, edgecolor=INK))
    for side in (-1.0, 1.0):
        ax.add_patch(
            Rectangle((x + side * 0.2 - 0.1, 1.2), 0.2, 0.5, facecolor=parts.PLATE, edgecolor=INK)
        )
    parts.wall(ax, [x + 0.3, 1.2], [x + 0.3, 1.7])
    parts.wall(ax, [x - 0.3, 1.7], [x - 0.3, 1.2])
    parts.block(ax, [x, 2.08], (1.0, 0.3), "weights")
    ax.plot([0.0, 0.0], [0.2, 1.02], color=GREY, linewidth=0.8, linestyle="-.")
    parts.arrow(ax, [0.12, -0.33], [x - 0.12, 0.0], color=INK)
    parts.label(ax, "$r_P$", [0.68, -0.5])
    parts.arrow(ax, [x, -0.75], [0.0, 0.63], color=PURPLE)
    parts.label(ax, r"$\lambda_N$", [x + 0.28, -0.72], color=PURPLE)
    parts.arrow(ax, [x + 0.16, 0.26], [0.62, 0.0], color=PURPLE)
    parts.label(ax, r"$\lambda_r$", [x + 0.92, 0.34], color=PURPLE)
    ax.plot(x - 0.3, 0.3, "o", color=PURPLE, markersize=7.0, markerfacecolor="white")
    ax.plot(x - 0.3, 0.3, ".", color=PURPLE, markersize=4.0)
    parts.label(ax, r"$\lambda_t$", [x - 0.55, 0.34], color=PURPLE)
    turn = [0.0, 0.62] + [0.35, 0.12] * unit_vectors(np.linspace(2.6, 6.9, 60))
    look: dict[str, Any] = {"arrowstyle": "->", "mutation_scale": 12.0, "fill": False}
    ax.add_patch(FancyArrowPatch(path=Path(turn), color=GREEN, linewidth=1.4, **look))
    parts.label(ax, r"$\varphi$", [-0.52, 0.62], color=GREEN)
    ax.set(xlim=(-2.5, 2.7), ylim=(-1.95, 2.5))


def disk_frames(ax: Axes, turned: float = np.deg2rad(32.0)) -> None:
    """Draw the disk from above with the frames I of the sensor and K of the disk.

    The disk turns clockwise below the pin, so that γ, its velocity at the pin, turns by +φ in K.
    """
    bare(ax)
    ax.add_patch(Circle((0.0, 0.0), 2.0, facecolor=parts.PLATE, edgecolor=INK))
    for line in _chords(2.0, 26, np.pi / 2 - turned):
        ax.plot(*line.T, color=GREY, linewidth=0.5, alpha=0.7)
    pin = np.array([0.0, 1.45])
    ax.add_patch(Circle(tuple(pin), 0.13, facecolor=_DARK, edgecolor=INK, zorder=5.0))
    for vector, text, offset, color in (
        ([1.0, 0.0], r"$e_t^I,\ \gamma$", [0.36, 0.0], GREEN),
        ([0.0, 0.95], "$e_r^I$", [0.25, 0.0], INK),
    ):
        parts.arrow(ax, pin, vector, color=color)
        parts.label(ax, text, np.add(pin, vector), offset=offset, color=color, bbox=_PAPER)
    across, along = unit_vectors(-turned), unit_vectors(np.pi / 2 - turned)
    for axis, text in ((across, "$e_1^K$"), (along, "$e_2^K$")):
        parts.arrow(ax, [0.0, 0.0], 1.1 * axis, color=BLUE)
        parts.label(ax, text, 1.32 * axis, color=BLUE, bbox=_PAPER)
    ax.plot([0.0, 1.15], [0.0, 0.0], color=GREY, linewidth=0.8, linestyle=":")
    angle = np.rad2deg(turned)
    ax.add_patch(Arc((0.0, 0.0), 1.5, 1.5, theta1=-angle, theta2=0.0, color=GREEN))
    parts.label(ax, r"$\varphi$", 0.9 * unit_vectors(-0.5 * turned), color=GREEN, bbox=_PAPER)
    force = 0.9 * unit_vectors(0.25)
    parts.arrow(ax, pin, force, color=PURPLE)
    parts.label(ax, r"$-\lambda$", pin + force, offset=[0.1, 0.22], color=PURPLE, bbox=_PAPER)
    rim = FancyArrowPatch(
        tuple(2.15 * unit_vectors(2.5)),
        tuple(2.15 * unit_vectors(1.95)),
        connectionstyle="arc3,rad=-0.15",
        arrowstyle="-|>",
        mutation_scale=14.0,
        color=GREEN,
    )
    ax.add_patch(rim)
    parts.label(ax, "grooves along $e_2^K$", [-0.65, -1.45], bbox=_PAPER)
    ax.set(xlim=(-2.5, 2.5), ylim=(-2.3, 2.7))


_PAPER = {"facecolor": "white", "edgecolor": "none", "alpha": 0.75, "pad": 1.0}


def _chords(radius: float, count: int, angle: float) -> list[Array]:
    """Return parallel chords of a circle."""
    along, across = unit_vectors(angle), unit_vectors(angle + np.pi / 2)
    lines = []
    for height in radius * np.linspace(-1.0, 1.0, count + 2)[1:-1]:
        half = np.sqrt(radius**2 - height**2) * along
        lines.append(np.stack([height * across - half, height * across + half]))
    return lines


def _cylinder(
    ax: Axes, top: ArrayLike, radius: float, height: float, color: str, zorder: float = 2.0
) -> None:
    """Draw an upright cylinder in oblique view, `top` being the centre of its upper face."""
    x, y = np.asarray(top, dtype=float)
    flat = 2.0 * _FLAT * radius
    half = np.linspace(-np.pi, 0.0, 60)
    rim = np.stack([x + radius * np.cos(half), y - height + 0.5 * flat * np.sin(half)], axis=-1)
    side = np.vstack([[x - radius, y], rim, [x + radius, y]])
    look: dict[str, Any] = {"facecolor": color, "edgecolor": INK, "linewidth": 0.9}
    ax.add_patch(Polygon(side, zorder=zorder, **look))
    ax.add_patch(Ellipse((x, y), 2.0 * radius, flat, zorder=zorder + 0.1, **look))


def _puck(ax: Axes, center: Array) -> None:
    x, y = center
    _cylinder(ax, [x, y + 0.17], 0.2, 0.17, "white", zorder=4.5)
    ax.add_patch(Ellipse((x, y + 0.17), 0.22, 0.22 * _FLAT, facecolor=_RED, zorder=4.8))


def _camera(ax: Axes, center: Array) -> None:
    x, y = center
    look: dict[str, Any] = {"facecolor": INK, "edgecolor": INK}
    ax.add_patch(Rectangle((x - 0.32, y - 0.2), 0.64, 0.42, **look))
    lens = [[x - 0.13, y - 0.2], [x + 0.13, y - 0.2], [x + 0.2, y - 0.43], [x - 0.2, y - 0.43]]
    ax.add_patch(Polygon(np.array(lens), **look))


def _call_out(ax: Axes, text: str, place: ArrayLike, target: ArrayLike) -> None:
    (x, y), end = np.asarray(place, dtype=float), np.asarray(target, dtype=float)
    line = {"arrowstyle": "-", "color": GREY, "linewidth": 0.8, "shrinkB": 0.0}
    ax.annotate(
        text,
        (float(end[0]), float(end[1])),
        (float(x), float(y)),
        ha="center",
        va="center",
        color=INK,
        fontsize="small",
        arrowprops=line,
        zorder=12.0,
    )
