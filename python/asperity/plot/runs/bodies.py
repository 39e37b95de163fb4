"""Rigid bodies from above, from the front, from the side and in space."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any, Literal, NamedTuple

import numpy as np
from matplotlib.axes import Axes
from matplotlib.lines import Line2D
from matplotlib.ticker import MaxNLocator
from numpy.typing import ArrayLike

from asperity._base import arrays
from asperity._base.arrays import Array
from asperity.errors import DimensionError, ParameterError
from asperity.plot import look
from asperity.plot.runs import chosen
from asperity.plot.runs.chosen import Drawable
from asperity.plot.runs.shapes import Shape, circle, edges, great_circles, outline, shapes
from asperity.system.rigid import Plane, RigidBodies
from asperity.system.rigid.pairs import PlanePair

View = Literal["above", "front", "side", "space"]
"""From above x₁ and x₂ are seen, from the front x₁ and x₃, from the side x₂ and x₃."""

_SEEN: dict[str, tuple[int, ...]] = {
    "above": (0, 1),
    "front": (0, 2),
    "side": (1, 2),
    "space": (0, 1, 2),
}
# The longest arrow of a force relative to the size of what is drawn.
_LONGEST = 0.25
# A plane is seen edge on if its normal leaves the picture by less.
_EDGE_ON = 1e-9
# Strength of the first of several positions.
_FAINT = 0.25


class Stage(NamedTuple):
    """What stays the same in all pictures of a run."""

    system: RigidBodies
    seen: tuple[int, ...]
    shapes: list[Shape]
    bodies: list[int]
    contacts: list[int]
    positions: Array
    rotations: Array
    points: Array
    forces: Array

    @property
    def limits(self) -> Array:
        """Least and greatest seen coordinates over the whole run, shape ``(2, 2 or 3)``."""
        centers = self.positions[:, self.bodies][..., self.seen]
        reach = np.array([self.shapes[body].extent() for body in self.bodies])[:, None]
        lower = (centers - reach).min(axis=(0, 1))
        upper = (centers + reach).max(axis=(0, 1))
        return np.stack([lower, upper])

    @property
    def per_newton(self) -> float:
        """Length of the arrow of one newton in m."""
        largest = np.nanmax(np.linalg.norm(self.forces, axis=-1), initial=0.0)
        return _LONGEST * float(np.ptp(self.limits, axis=0).max()) / largest if largest else 0.0


def plot_bodies(
    run: Drawable | RigidBodies,
    *,
    system: RigidBodies | None = None,
    ax: Axes | None = None,
    at: int | ArrayLike = 5,
    view: View = "above",
    bodies: int | Sequence[int] | None = None,
    contacts: int | Sequence[int] | None = None,
    forces: bool = True,
    paths: bool = True,
) -> Axes:
    """Draw rigid bodies at some times, with the forces of their contacts.

    Boxes and spheres are drawn as such, bodies with points as the hull of these; what a body is
    like besides what its pairs need is not known. A cross marks a centre of mass. Earlier times are
    fainter. Bodies in a plane are drawn in it.

    Args:
        run: a `Trajectory`, a `Motion` or a `LimitCycle` of `RigidBodies`; or the system itself,
            which is drawn as it starts.
        system: the system of the run.
        ax: axes; in space those with ``projection="3d"``; default new ones.
        at: times in s, for which the nearest samples are drawn, or a number of times, which are
            then spread evenly over the run.
        view: ``"above"``, ``"front"``, ``"side"`` or ``"space"``; not of bodies in a plane.
        bodies: numbers of the bodies; default all.
        contacts: numbers of the contacts with forces; default all.
        forces: whether to draw the forces on the (first) bodies; the legend has their scale.
        paths: whether to draw the paths of the centres of mass.

    Returns:
        The axes.

    Raises:
        ParameterError, DimensionError: naming the argument.

    >>> import matplotlib
    >>> matplotlib.use("Agg")
    >>> from asperity import Body, BoxPlane, FrictionLaw, Plane, RigidBodies, simulate
    >>> from asperity.plot import plot_bodies
    >>> half = (0.1, 0.05, 0.05)
    >>> box = Body.box(1.0, half_sizes=half, position=(0.0, 0.0, 0.05), velocity=(1.0, 0.0, 0.0))
    >>> table = BoxPlane(0, half_sizes=half, plane=Plane(), law=FrictionLaw.isotropic(0.3))
    >>> system = RigidBodies([box], pairs=[table])
    >>> run = simulate(system, dt=1e-3, t_end=0.5)
    >>> ax = plot_bodies(run, system=system, at=[0.0, 0.5], view="front")
    """
    stage, times = staged(run, system, view, bodies, contacts)
    samples = _samples(times, at)
    space = len(stage.seen) == 3
    if isinstance(ax, Axes) and ax.name == "3d" and not space:
        raise ParameterError("ax", 'must have two dimensions, or view="space"')
    with look.drawing(ax, projection="3d" if space else None) as ax:
        if paths and len(times) > 1:
            draw_paths(ax, stage, len(times) - 1)
        for step, sample in enumerate(samples):
            strength = _FAINT + (1.0 - _FAINT) * (step + 1) / len(samples)
            draw_bodies(ax, stage, sample, alpha=strength, forces=forces)
        if forces and stage.per_newton:
            ax.legend(handles=[_scale(stage)], **look.BELOW)
        dress(ax, stage)
        return ax


def staged(
    run: Drawable | RigidBodies,
    system: RigidBodies | None,
    view: str,
    bodies: int | Sequence[int] | None,
    contacts: int | Sequence[int] | None,
) -> tuple[Stage, Array]:
    """Return what is drawn of a run, or of a system as it starts, and the times."""
    of: Any = system
    if of is None:
        of = run if isinstance(run, RigidBodies) else chosen.one_run(run).system
    if not isinstance(of, RigidBodies):
        why = "which the run does not know" if of is None else f"got {of!r}"
        raise ParameterError("system", f"must be the RigidBodies of the run, {why}")
    arrays.choice(view, "view", tuple(_SEEN))
    if of.planar and view != "above":
        raise ParameterError("view", f"must be left out for bodies in a plane, got {view!r}")
    shown = chosen.numbers(bodies, len(of.bodies), "bodies")
    touching = chosen.numbers(contacts, len(of.contacts), "contacts") if of.contacts else []
    size = len(of.gravity)
    if isinstance(run, RigidBodies):
        q = of._per_body(of.q0[None])
        positions, rotations = q[..., :size], of._rotations(q)
        points = forces = np.empty((1, 0, size))
        times = np.zeros(1)
    else:
        one = chosen.one_run(run)
        positions, rotations = of.positions(one), of.rotations(one)
        points = of.contact_points(one)[:, touching]
        forces = of.contact_forces(one, frame="world")[:, touching]
        times = one.t
    seen = (0, 1) if of.planar else _SEEN[view]
    return (
        Stage(of, seen, shapes(of), shown, touching, positions, rotations, points, forces),
        times,
    )


def draw_paths(ax: Axes, stage: Stage, last: int) -> None:
    """Draw the paths of the centres of mass up to a sample."""
    for body in stage.bodies:
        path = stage.positions[: last + 1, body][:, stage.seen]
        ax.plot(*path.T, color=look.GREY, linewidth=0.9, zorder=1.5)


def draw_bodies(ax: Axes, stage: Stage, sample: int, *, alpha: float, forces: bool) -> None:
    """Draw the bodies of one sample, and the forces on them."""
    for body in stage.bodies:
        color = look.color(body)
        place, turn = stage.positions[sample, body], stage.rotations[sample, body]
        shape = stage.shapes[body]
        for line in _lines(shape, place, turn, stage.seen):
            ax.plot(*line.T, color=color, alpha=alpha, linewidth=1.3)
        center = place[list(stage.seen)][None]
        ax.plot(*center.T, "+", color=color, alpha=alpha, markersize=6.0)
    if not forces:
        return
    known = np.isfinite(stage.forces[sample]).all(axis=-1)
    vectors = stage.per_newton * stage.forces[sample][known][:, stage.seen]
    tails = stage.points[sample][known][:, stage.seen]
    drawn = np.linalg.norm(vectors, axis=1) > 0.0
    if not drawn.any():
        return
    if len(stage.seen) == 3:
        space: Any = ax
        space.quiver(*tails[drawn].T, *vectors[drawn].T, color=look.INK, alpha=alpha, linewidth=1.0)
    else:
        look.draw_arrows(ax, tails[drawn], vectors[drawn], color=look.INK, alpha=alpha)


def dress(ax: Axes, stage: Stage, *, room: bool = True) -> None:
    """Label the axes, draw the ground and keep the scales equal, by more room or smaller axes."""
    names = [f"$x_{i + 1}$ in m" for i in stage.seen]
    ax.set(xlabel=names[0], ylabel=names[1])
    if len(stage.seen) == 3:
        space: Any = ax
        space.set_zlabel(names[2])
        space.set_aspect("equal", adjustable="datalim" if room else "box")
        for axis in (space.xaxis, space.yaxis, space.zaxis):
            axis.set_major_locator(MaxNLocator(4))
        return
    for ends in _ground(stage):
        ax.axline(*ends, color=look.GREY, linewidth=1.2, zorder=1.2)
    ax.set_aspect("equal", adjustable="datalim" if room else "box")


def _lines(shape: Shape, place: Array, turn: Array, seen: tuple[int, ...]) -> list[Array]:
    """Return the lines of a body as it is seen."""
    lines = []
    columns = list(seen)
    for corners in shape.corners:
        world = place + corners @ turn.T
        if len(seen) == 3:
            lines += edges(world)
        else:
            lines.append(outline(world[:, columns]))
    for center, radius in shape.spheres:
        world = place + turn @ center
        if len(seen) == 3:
            lines += great_circles(world, radius, turn)
            continue
        middle = world[columns]
        lines.append(circle(middle, radius))
        # A radius of the body shows how it turns.
        lines.append(np.stack([middle, middle + radius * turn[columns, 0]]))
    return lines


def _ground(stage: Stage) -> list[tuple[tuple[float, float], tuple[float, float]]]:
    """Return two points of each resting surface that is seen edge on, in the middle of the run."""
    middle, reach = stage.limits.mean(axis=0), 0.1 * float(np.ptp(stage.limits, axis=0).max())
    found: dict[tuple[float, float], tuple[float, float]] = {}
    for pair in stage.system.pairs:
        if not isinstance(pair, PlanePair) or pair.plane.body is not None or pair.plane.motion:
            continue
        normal = pair.plane.normal[list(stage.seen)]
        if isinstance(pair.plane, Plane) and abs(np.linalg.norm(normal) - 1.0) > _EDGE_ON:
            continue
        height = (middle - pair.plane.point[list(stage.seen)]) @ normal
        x, y = (middle - height * normal).round(12).tolist()
        found[x, y] = (x + reach * float(normal[1]), y - reach * float(normal[0]))
    return list(found.items())


def _samples(times: Array, at: int | ArrayLike) -> list[int]:
    """Return the numbers of the samples to draw, each once, in their order."""
    if np.ndim(at):
        wanted = arrays.array(at, "at", (None,))
        if not len(wanted):
            raise DimensionError("at", "must hold a time")
        if wanted.min() < times[0] or wanted.max() > times[-1]:
            raise ParameterError(
                "at", f"must lie within the run, {times[0]:.9g} to {times[-1]:.9g} s"
            )
    else:
        count = arrays.count(at, "at")
        wanted = np.linspace(times[0], times[-1], count) if count > 1 else times[-1:]
    return sorted({int(np.abs(times - one).argmin()) for one in wanted})


def _scale(stage: Stage) -> Line2D:
    largest = float(np.nanmax(np.linalg.norm(stage.forces, axis=-1)))
    label = f"contact forces, largest {largest:.3g} N"
    return Line2D([], [], color=look.INK, marker=">", markersize=5.0, label=label)
