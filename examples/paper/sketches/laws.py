"""Schematic drawings: contact plane, X–Y table, wedge asperities."""

import numpy as np
from matplotlib.axes import Axes
from matplotlib.patches import Arc, Circle, Polygon, Rectangle
from paper.drawing import BLUE, GREEN, GREY, INK, PURPLE, Array, draw_arrows, unit_vectors
from paper.frame import bare, note
from paper.sketches.parts import METAL, PLATE, spring


def contact_plane(ax: Axes) -> None:
    """Draw body 1, a ball, on the contact plane with the contact forces on it, in oblique view."""
    bare(ax)
    plane = _oblique([[-1.6, -1.3, 0.0], [1.7, -1.3, 0.0], [1.7, 1.3, 0.0], [-1.6, 1.3, 0.0]])
    ax.add_patch(Polygon(plane, facecolor=PLATE, edgecolor=GREY))
    note(ax, "contact plane", plane[1] + [-0.1, 0.07], color=INK, ha="right")
    ax.add_patch(Circle((0.0, 0.62), 0.62, facecolor=METAL, edgecolor=GREY, alpha=0.8))
    ax.annotate("body 1", (-0.31, 0.72), ha="center", va="center")
    forces = {
        r"$\lambda_N$": ([0.0, 0.0, 1.6], [0.17, -0.05], INK),
        r"$\lambda_{T1}$": ([-1.1, 0.0, 0.0], [0.0, -0.15], PURPLE),
        r"$\lambda_{T2}$": ([0.0, -0.95, 0.0], [-0.2, 0.02], PURPLE),
        r"$e_{T1}$": ([1.1, 0.0, 0.0], [0.0, -0.15], BLUE),
        r"$e_{T2}$": ([0.0, 1.0, 0.0], [0.42, 0.0], BLUE),
    }
    for label, (vector, offset, color) in forces.items():
        ends = _oblique([vector])
        draw_arrows(ax, np.zeros((1, 2)), ends, color=color, zorder=5.0)
        note(ax, label, ends[0] + offset, color=color, ha="center", va="center", zorder=6.0)
    ax.set(xlim=(-2.25, 2.3), ylim=(-0.6, 1.75))


def _oblique(points: Array | list[list[float]]) -> Array:
    x, y, z = np.asarray(points, dtype=float).T
    return np.stack([x + 0.42 * y, 0.36 * y + z], axis=-1)


def xy_table(ax: Axes) -> None:
    """Draw an X–Y table from above: two slide bearings at right angles, one on the other."""
    bare(ax)
    ax.add_patch(Rectangle((-1.7, -0.95), 3.4, 1.9, facecolor="#F1F3F5", edgecolor=GREY))
    for y in (-0.6, 0.6):
        ax.add_patch(Rectangle((-1.6, y - 0.07), 3.2, 0.14, facecolor=METAL, edgecolor=GREY))
    ax.add_patch(Rectangle((-0.75, -0.85), 1.5, 1.7, facecolor=PLATE, edgecolor=GREY))
    for x in (-0.45, 0.45):
        ax.add_patch(Rectangle((x - 0.07, -0.8), 0.14, 1.6, facecolor=METAL, edgecolor=GREY))
    ax.add_patch(Rectangle((-0.6, -0.32), 1.2, 0.64, facecolor="white", edgecolor=INK))
    draw_arrows(ax, np.zeros((1, 2)), np.array([[0.42, 0.0]]), color=BLUE, zorder=5.0)
    draw_arrows(ax, np.zeros((1, 2)), np.array([[0.0, 0.26]]), color=BLUE, zorder=5.0)
    ax.annotate("$e_{T1}$", (0.3, -0.17), color=BLUE, ha="center")
    ax.annotate("$e_{T2}$", (-0.2, 0.1), color=BLUE, ha="center")
    arrow = {"arrowstyle": "-", "color": GREY, "shrinkB": 0.0}
    for text, target, place in (
        ("slide bearing 1, $\\mu_1$", (1.3, 0.6), (1.0, 1.16)),
        ("slide bearing 2, $\\mu_2$", (-0.45, 0.6), (-1.0, 1.16)),
    ):
        ax.annotate(text, target, place, ha="center", arrowprops=arrow)
    ax.set(xlim=(-1.8, 1.8), ylim=(-1.05, 1.4))


def wedges(ax: Axes, beta: float) -> None:
    """Draw wedge-shaped asperities of inclination β under a moving plate with springs."""
    bare(ax)
    half, teeth, roof = 1.0, 2, 1.75
    height = half * np.tan(beta)
    x = half * np.arange(2 * teeth + 1)
    profile = np.stack([x, np.where(np.arange(len(x)) % 2, height, 0.0)], axis=-1)
    ground = np.vstack([[x[-1], -0.3], [0.0, -0.3], profile])
    ax.add_patch(Polygon(ground, facecolor=METAL, edgecolor=GREY))
    ax.add_patch(Rectangle((0.15, roof), x[-1] - 0.3, 0.22, facecolor=PLATE, edgecolor=GREY))
    for position in np.linspace(0.4, x[-1] - 0.4, 9):
        foot = float(np.interp(position, *profile.T))
        spring(ax, [position, foot], [position, roof], width=0.07)
        ax.plot(position, foot, "o", color=INK, markersize=3.0)
    moved = np.array([[x[-1] - 1.2, roof + 0.42]])
    draw_arrows(ax, moved, np.array([[0.9, 0.0]]), color=GREEN)
    note(ax, r"$\gamma_{T1}$", moved[0] - [0.08, 0.0], color=GREEN, ha="right", va="center")
    ax.plot([2.0, 2.75], [0.0, 0.0], color=INK, linewidth=0.9)
    ax.add_patch(Arc((2.0, 0.0), 1.0, 1.0, theta1=0.0, theta2=np.rad2deg(beta), color=INK))
    middle = np.array([2.0, 0.0]) + 0.64 * unit_vectors(0.5 * beta)
    note(ax, r"$\beta$", middle, ha="center", va="center")
    axis = np.array([[0.15, -0.62]])
    draw_arrows(ax, axis, np.array([[0.7, 0.0]]), color=BLUE)
    ax.annotate("$e_1$ across the asperities", (0.95, -0.62), color=BLUE, va="center")
    ax.set(xlim=(-0.1, x[-1] + 0.1), ylim=(-0.85, 2.4))
