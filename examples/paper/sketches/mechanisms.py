"""Schematic drawings of the mechanisms of Fig. 13 and of the mass on a belt, Fig. 14."""

import numpy as np
from matplotlib.axes import Axes
from matplotlib.patches import Arc, Polygon, Rectangle
from numpy.typing import ArrayLike
from paper.drawing import BLUE, GREEN, GREY, INK, PURPLE, Array, unit_vectors
from paper.frame import bare
from paper.sketches import parts


def stribeck_block(ax: Axes) -> None:
    """Draw a block on a belt, held by a spring, and its friction characteristic."""
    bare(ax)
    parts.belt(ax, -1.5, 1.5, 0.0)
    parts.wall(ax, [-1.5, 0.75], [-1.5, 0.1])
    parts.spring(ax, [-1.5, 0.33], [-0.45, 0.33])
    parts.label(ax, "$k$", [-1.0, 0.58])
    parts.block(ax, [0.0, 0.3], (0.9, 0.6), "$m$")
    parts.arrow(ax, [0.0, 0.78], [0.5, 0.0], color=BLUE)
    parts.label(ax, "$x$", [0.62, 0.78], color=BLUE)
    parts.arrow(ax, [0.75, 1.05], [0.85, 0.0], color=INK)
    parts.arrow(ax, [0.75, 1.05], [0.0, 0.8], color=INK)
    slip = np.linspace(0.0, 0.75, 40)
    ax.plot(0.75 + slip, 1.05 + 0.62 / (1.0 + 3.0 * slip), color=PURPLE, linewidth=2.0)
    parts.label(ax, r"$|\lambda|$", [0.55, 1.75])
    parts.label(ax, r"$|\gamma|$", [1.62, 0.9])
    ax.set(xlim=(-1.8, 1.8), ylim=(-0.6, 1.95))


def mode_coupling(ax: Axes) -> None:
    """Draw a mass on two inclined springs, pressed on a belt on a vertical spring."""
    bare(ax)
    center = np.array([0.0, 0.28])
    for angle, text in ((150.0, "$k_1$"), (30.0, "$k_2$")):
        direction = unit_vectors(np.deg2rad(angle))
        end = center + 1.5 * direction
        across = 0.3 * np.array([-direction[1], direction[0]])
        parts.wall(ax, end - across, end + across)
        parts.spring(ax, center + 0.25 * direction, end)
        parts.label(ax, text, center + 0.85 * direction, offset=(0.0, 0.27))
    parts.block(ax, center, (0.56, 0.56), "$m$")
    parts.belt(ax, -1.1, 1.1, 0.0, forward=False)
    for x in (-0.55, 0.55):
        parts.spring(ax, [x, -0.34], [x, -0.95])
    parts.label(ax, r"$\frac{1}{2}k_3$", [0.0, -0.62])
    parts.wall(ax, [-0.95, -0.95], [0.95, -0.95])
    for tail, vector, text, place in (
        ([0.0, 0.62], [0.0, 0.45], "$y$", [0.12, 1.12]),
        ([0.35, 0.16], [0.45, 0.0], "$x$", [0.92, 0.16]),
        ([1.3, -0.17], [0.0, 0.45], "$z$", [1.44, 0.24]),
    ):
        parts.arrow(ax, tail, vector, color=BLUE)
        parts.label(ax, text, place, color=BLUE)
    ax.set(xlim=(-1.8, 1.8), ylim=(-1.15, 1.4))


def impact_oscillator(ax: Axes) -> None:
    """Draw a rod with a mass at either end, on springs and dampers, leaning against a belt."""
    bare(ax)
    top = np.array([0.45, 0.95])
    tip = top - 1.1 * np.array([np.sin(np.deg2rad(38.0)), np.cos(np.deg2rad(38.0))])
    parts.belt(ax, -1.5, 1.3, tip[1] - 0.13)
    parts.rod(ax, top, tip)
    parts.point_mass(ax, top, 0.16)
    parts.point_mass(ax, tip)
    parts.coil(ax, top, radius=0.34, start=0.0, sweep=0.0)
    parts.wall(ax, top - [-0.34, -0.13], top - [-0.34, 0.13])
    parts.label(ax, "$m_1$", top, offset=(-0.36, 0.22))
    parts.label(ax, "$m_2$", tip, offset=(-0.33, 0.08))
    parts.label(ax, r"$k_\varphi, d_\varphi$", top, offset=(0.78, -0.02))
    ceiling = 1.85
    parts.wall(ax, [1.1, ceiling], [-0.2, ceiling])
    ax.plot([0.15, 0.75], [1.25, 1.25], color=INK, linewidth=1.2)
    ax.plot([0.45, 0.45], [1.1, 1.25], color=INK, linewidth=1.2)
    parts.spring(ax, [0.2, 1.25], [0.2, ceiling])
    parts.damper(ax, [0.7, 1.25], [0.7, ceiling])
    parts.label(ax, "$k_y$", [-0.03, 1.55])
    parts.label(ax, "$d_y$", [0.95, 1.55])
    ax.plot([top[0]] * 2, [top[1], tip[1]], color=GREY, linewidth=0.8, linestyle=":")
    ax.add_patch(Arc(tuple(top), 1.3, 1.3, theta1=232.0, theta2=270.0, color=INK))
    parts.label(ax, r"$\varphi$", top, offset=(-0.21, -0.45))
    parts.arrow(ax, [-0.55, top[1]], [0.0, 0.45], color=BLUE)
    parts.label(ax, "$y$", [-0.68, 1.35], color=BLUE)
    ax.set(xlim=(-1.75, 1.75), ylim=(-0.5, 2.05))


def follower_pendulum(ax: Axes) -> None:
    """Draw a double pendulum whose tip carries a wheel on a belt, seen from above."""
    bare(ax)
    ax.add_patch(Rectangle((0.75, -0.8), 1.15, 1.75, facecolor=parts.PLATE, edgecolor=GREY))
    first, length = np.array([-1.45, -0.1]), 1.3
    angles = np.deg2rad([14.0, -12.0])
    second = first + length * unit_vectors(angles[0])
    tip = second + length * unit_vectors(angles[1])
    parts.wall(ax, first - [0.12, -0.4], first - [0.12, 0.4])
    ax.plot([first[0] - 0.12, first[0]], [first[1]] * 2, color=INK, linewidth=1.2)
    for start, end, angle in ((first, second, 0.0), (second, tip, angles[0])):
        parts.rod(ax, start, end)
        forward = unit_vectors(angle)
        ax.plot(*np.stack([start, start + 0.85 * forward]).T, color=GREY, linewidth=0.8, ls=":")
    parts.point_mass(ax, second, 0.15)
    parts.point_mass(ax, tip, 0.11)
    for center, beginning in ((first, 0.4), (second, -0.6)):
        parts.coil(ax, center, radius=0.27, start=beginning, sweep=0.5)
        parts.joint(ax, center)
    across = np.array([-np.sin(angles[1]), np.cos(angles[1])])
    along = unit_vectors(angles[1])
    wheel = tip + 0.25 * along
    ax.plot(*np.stack([tip, wheel + 0.1 * along]).T, color=INK, linewidth=1.2)
    corners = [
        wheel + 0.22 * a * across + 0.06 * b * along
        for a, b in ((1, 1), (-1, 1), (-1, -1), (1, -1))
    ]
    ax.add_patch(Polygon(np.array(corners), facecolor=INK, edgecolor=INK, zorder=4.0))
    parts.arrow(ax, wheel + 0.62 * along, -0.5 * along, color=PURPLE)
    parts.label(ax, r"$\lambda$", wheel + 0.5 * along + 0.18 * across, color=PURPLE)
    parts.arrow(ax, [1.65, -0.62], [-0.6, 0.0], color=GREEN)
    parts.label(ax, "$v$", [0.93, -0.62], color=GREEN)
    parts.label(ax, "$2m$", second, offset=(0.0, 0.33))
    parts.label(ax, "$m$", tip, offset=(-0.05, -0.25))
    parts.label(ax, r"$c, d$", first, offset=(0.3, -0.36))
    parts.label(ax, r"$\varphi_1$", first, offset=(0.72, 0.09))
    parts.label(ax, r"$\Delta$", second, offset=(0.72, 0.02))
    ax.set(xlim=(-1.85, 1.95), ylim=(-1.0, 1.15))


def belt_in_space(ax: Axes) -> None:
    """Draw a mass on a grooved belt, held by two springs, in oblique view."""
    bare(ax)
    ground = _oblique([[-1.5, -1.0], [1.5, -1.0], [1.5, 1.0], [-1.5, 1.0]])
    ax.add_patch(Polygon(ground, facecolor=parts.PLATE, edgecolor=INK, linewidth=1.2))
    for start in np.arange(-1.4, 1.45, 0.2):
        ax.plot(*_oblique([[start, -1.0], [start, 1.0]]).T, color="white", linewidth=1.0)
    for end, text in (([-1.45, 0.0], "$k$"), ([0.0, 1.8], "$k$")):
        foot, place = _oblique([[0.0, 0.0], end], height=0.18)
        parts.spring(ax, foot, place, width=0.08)
        parts.label(ax, text, 0.5 * (foot + place), offset=(-0.05, 0.2))
    left, back = _oblique([[-1.45, 0.0], [0.0, 1.8]], height=0.18)
    parts.wall(ax, left - [0.0, -0.22], left - [0.0, 0.22])
    parts.wall(ax, back - [-0.22, 0.0], back - [0.22, 0.0])
    _box(ax, 0.26, 0.36)
    direction = unit_vectors(np.deg2rad(40.0))
    tail, head = _oblique([0.55 * direction - [0.0, 0.75], 1.25 * direction - [0.0, 0.75]])
    parts.arrow(ax, tail, head - tail, color=GREEN)
    parts.label(ax, "$v$", head, offset=(0.1, 0.04), color=GREEN)
    ax.set(xlim=(-2.15, 2.15), ylim=(-0.85, 1.35))


def belt_from_above(ax: Axes) -> None:
    """Draw the model of two degrees of freedom from above."""
    bare(ax)
    ax.add_patch(Rectangle((-1.0, -1.0), 2.0, 2.0, facecolor=parts.PLATE, edgecolor=GREY))
    parts.wall(ax, [-1.5, 0.35], [-1.5, -0.35])
    parts.wall(ax, [-0.35, -1.5], [0.35, -1.5])
    parts.spring(ax, [-1.5, 0.0], [-0.12, 0.0])
    parts.spring(ax, [0.0, -1.5], [0.0, -0.12])
    parts.label(ax, "$k$", [-0.75, 0.22])
    parts.label(ax, "$k$", [0.22, -0.75])
    parts.point_mass(ax, [0.0, 0.0])
    parts.label(ax, "$m$", [-0.24, 0.26])
    phi = np.deg2rad(50.0)
    parts.arrow(ax, [0.0, 0.0], 0.85 * unit_vectors(phi), color=GREEN, zorder=2.8)
    parts.label(ax, "$v$", 0.97 * unit_vectors(phi), color=GREEN)
    ax.plot([0.0, 0.75], [0.0, 0.0], color=GREY, linewidth=0.9, linestyle=":")
    ax.add_patch(Arc((0.0, 0.0), 1.1, 1.1, theta2=np.rad2deg(phi), color=INK))
    parts.label(ax, r"$\varphi$", 0.68 * unit_vectors(0.5 * phi))
    for vector, text, place in (
        ([0.5, 0.0], r"$x,\ e_{T1}$", [1.95, -1.3]),
        ([0.0, 0.5], r"$y,\ e_{T2}$", [1.3, -0.66]),
    ):
        parts.arrow(ax, [1.2, -1.3], vector, color=BLUE)
        parts.label(ax, text, place, color=BLUE)
    ax.set(xlim=(-1.75, 2.3), ylim=(-1.75, 1.15))


def _oblique(points: ArrayLike, height: float = 0.0) -> Array:
    """Place points of a horizontal plane on the paper."""
    x, y = np.asarray(points, dtype=float).T
    return np.stack([x + 0.45 * y, 0.5 * y + height], axis=-1)


def _box(ax: Axes, half: float, height: float) -> None:
    """Draw a box that stands about the origin."""
    corners = [[-half, -half], [half, -half], [half, half], [-half, half]]
    base, top = _oblique(corners), _oblique(corners, height)
    for face, color in (
        ([base[0], base[1], top[1], top[0]], parts.METAL),
        ([base[1], base[2], top[2], top[1]], "#AEB5BF"),
        (list(top), "#DDE1E6"),
    ):
        ax.add_patch(Polygon(np.array(face), facecolor=color, edgecolor=INK, zorder=3.0))
