"""Geometry of the scenes: boxes, voussoirs and spheres with explicit contact points."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike, NDArray

from asperity._base import arrays
from asperity._base.arrays import Array
from asperity.problems.scene import GROUND, Scene

UPRIGHT = np.array([[0.0, 0.0, 1.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]])
"""Contact frame on a horizontal plane: normal z, tangents x and y."""
CORNERS = np.array([[-1.0, -1.0], [-1.0, 1.0], [1.0, -1.0], [1.0, 1.0]])


def stack(boxes: int, *, half_sizes: ArrayLike = (0.5, 0.5, 0.5), mass: float = 1.0) -> Scene:
    """Return boxes one upon the other, touching at the four corners of each face: 4 n contacts.

    Hyperstatic: 12 rows per interface, of which 6 are independent.

    Args:
        boxes: their number n.
        half_sizes: half the edges in m, shape ``(3,)``.
        mass: of each box in kg.

    >>> from asperity.problems import scenes
    >>> len(scenes.stack(20).point)
    80
    """
    count, half = arrays.count(boxes, "boxes"), _half_sizes(half_sizes)
    level = np.arange(count)
    center = np.zeros((count, 3))
    center[:, 2] = (2 * level + 1) * half[2]
    point = np.zeros((count, 4, 3))
    point[..., :2] = CORNERS * half[:2]
    point[..., 2] = 2 * half[2] * level[:, None]
    masses = np.full(count, arrays.positive(mass, "mass"))
    sides = np.broadcast_to(half, (count, 3))
    upper = level.repeat(4)
    return _upright(masses, _box_inertia(masses, sides), center, upper - 1, upper, point)


def wall(
    rows: int, *, columns: int, half_sizes: ArrayLike = (1.0, 0.5, 0.5), mass: float = 1.0
) -> Scene:
    """Return a wall in running bond, straight at both ends by half bricks in every other row.

    Bricks touch at the corners of every overlap, 8 contacts per brick length and 4 at the ground:
    4 columns (2 rows − 1) in all. Bricks of the same row do not touch. Hyperstatic.

    Args:
        rows: number of rows.
        columns: bricks in the rows 0, 2, …; the others have one more, two of them halves.
        half_sizes: half the edges of a brick in m, shape ``(3,)``, the length along x first.
        mass: of a whole brick in kg.

    >>> from asperity.problems import scenes
    >>> wall = scenes.wall(4, columns=3)
    >>> len(wall.mass), len(wall.point)
    (14, 84)
    """
    rows, columns = arrays.count(rows, "rows"), arrays.count(columns, "columns")
    half, mass = _half_sizes(half_sizes), arrays.positive(mass, "mass")
    # Joints of a row in units of half a brick.
    joints = (2 * np.arange(columns + 1), np.r_[0, 2 * np.arange(columns) + 1, 2 * columns])
    bricks = [np.column_stack([joints[r % 2][:-1], joints[r % 2][1:]]) for r in range(rows)]
    row = np.repeat(np.arange(rows), [len(spans) for spans in bricks])
    span = np.concatenate(bricks)
    length = np.diff(span, axis=1)[:, 0]
    center = np.zeros((len(span), 3))
    center[:, 0] = 0.5 * span.sum(axis=1) * half[0]
    center[:, 2] = (2 * row + 1) * half[2]
    sides = np.column_stack([0.5 * length * half[0], *np.tile(half[1:, None], len(span))])
    masses = 0.5 * length * mass
    lower, upper, overlap, level = _overlaps(rows, columns)
    point = np.zeros((len(overlap), 4, 3))
    point[..., 0] = overlap[:, [0, 0, 1, 1]] * half[0]
    point[..., 1] = CORNERS[:, 1] * half[1]
    point[..., 2] = 2 * half[2] * level[:, None]
    inertia = _box_inertia(masses, sides)
    return _upright(masses, inertia, center, lower.repeat(4), upper.repeat(4), point)


def _overlaps(rows: int, columns: int) -> tuple[NDArray[np.int64], ...]:
    """Return lower brick, upper brick, ends in half bricks and level of every overlap."""
    unit, brick = np.arange(2 * columns), np.arange(columns)
    inside = (unit // 2, (unit + 1) // 2)
    sizes = columns + np.arange(rows) % 2
    first = np.cumsum(sizes) - sizes
    lower, upper = [np.full(columns, GROUND)], [brick]
    ends, level = [np.column_stack([2 * brick, 2 * brick + 2])], [np.zeros(columns, dtype=np.int64)]
    for r in range(1, rows):
        lower.append(first[r - 1] + inside[(r - 1) % 2])
        upper.append(first[r] + inside[r % 2])
        ends.append(np.column_stack([unit, unit + 1]))
        level.append(np.full(2 * columns, r))
    return tuple(map(np.concatenate, (lower, upper, ends, level)))


def table(
    feet: int | ArrayLike, *, height: float = 1.0, radius: float = 1.0, mass: float = 1.0
) -> Scene:
    """Return one disk on feet of no mass: as many contacts as feet, a singular G beyond two.

    Args:
        feet: their number, on a circle of the disk's radius, or their places in m, ``(n, 2)``.
        height: of the disk's centre of mass above the ground in m.
        radius: of the disk in m.
        mass: of the disk in kg.

    >>> from asperity.problems import scenes
    >>> scenes.table([[-1, -1], [1, -1], [0, 1]]).point[:, 2].tolist()
    [0.0, 0.0, 0.0]
    """
    radius, mass = arrays.positive(radius, "radius"), arrays.positive(mass, "mass")
    if np.ndim(feet) == 0:
        count = arrays.count(feet, "feet")
        places = radius * arrays.unit_vectors(2.0 * np.pi * np.arange(count) / count)
    else:
        places = arrays.array(feet, "feet", (None, 2))
    point = np.column_stack([places, np.zeros(len(places))])
    center = np.array([[0.0, 0.0, arrays.positive(height, "height")]])
    inertia = 0.25 * mass * radius**2 * np.diag([1.0, 1.0, 2.0])[None]
    lower = np.full(len(point), GROUND)
    return _upright(np.array([mass]), inertia, center, lower, np.zeros(len(point)), point)


def arch(blocks: int, *, thickness: float = 0.15, depth: float = 0.3, mass: float = 1.0) -> Scene:
    """Return a semicircular arch of equal voussoirs, mean radius 1 m: 4 (n + 1) contacts.

    Without sliding it carries itself if it is at least 0.1075 m thick, in the limit of many
    voussoirs ([Milankovitch1907]); a thinner one has no equilibrium and starts to fall.
    Hyperstatic: the rank of G is 6 n.

    Args:
        blocks: number n of voussoirs; their joints are radial and touch at four corners.
        thickness: between extrados and intrados in m, below 2.
        depth: along y in m.
        mass: of each voussoir in kg.

    >>> from asperity.problems import scenes
    >>> scenes.arch(7).point.shape
    (32, 3)
    """
    count, mass = arrays.count(blocks, "blocks"), arrays.positive(mass, "mass")
    depth = arrays.positive(depth, "depth")
    # The inner radius 1 − t/2 must stay positive.
    thick = 2.0 * arrays.fraction(0.5 * arrays.positive(thickness, "thickness"), "thickness")
    inner, outer, half = 1.0 - 0.5 * thick, 1.0 + 0.5 * thick, 0.5 * np.pi / count
    centroid = 2.0 / 3.0 * (outer**3 - inner**3) / (outer**2 - inner**2) * np.sin(half) / half
    along, across, spread = _voussoir(inner, outer, half, centroid)
    flat = depth**2 / 12.0
    axes = _joint_frames(half * np.arange(1.0, 2 * count, 2.0))
    principal = mass * np.array([along + flat, across + flat, spread])
    inertia = np.einsum("kai,a,kaj->kij", axes, principal, axes)
    frame = _joint_frames(2.0 * half * np.arange(count + 1.0))
    radial = np.where(CORNERS[:, 0] > 0, outer, inner)
    point = radial[:, None] * frame[:, None, 1]
    point[..., 1] = 0.5 * depth * CORNERS[:, 1]
    upper = np.r_[np.arange(count), GROUND]
    lower = np.arange(count + 1) - 1
    return Scene(
        np.full(count, mass),
        inertia,
        centroid * axes[:, 1],
        lower.repeat(4),
        upper.repeat(4),
        point.reshape(-1, 3),
        frame.repeat(4, axis=0),
    )


def _joint_frames(angle: Array) -> Array:
    """Return the directions along the arch, outwards, and y at angles from the x axis."""
    c, s, zero = np.cos(angle), np.sin(angle), np.zeros_like(angle)
    rows = [[-s, zero, c], [c, zero, s], [zero, zero + 1.0, zero]]
    return np.moveaxis(np.array(rows), -1, 0)


def _voussoir(inner: float, outer: float, half: float, centroid: float) -> tuple[float, ...]:
    """Return mean squares about the centroid: radial, tangential, both."""
    mean = 0.5 * (inner**2 + outer**2)
    swing = np.sin(2.0 * half) / (4.0 * half)
    radial, tangential = mean * (0.5 + swing) - centroid**2, mean * (0.5 - swing)
    return radial, tangential, radial + tangential


def columns(
    n_columns: int,
    *,
    height: int,
    touching: bool = True,
    radius: float = 0.5,
    mass: float = 1.0,
) -> Scene:
    """Return columns of equal spheres on a square grid, filled row by row.

    One contact per sphere with what is below it. G is regular unless the columns touch: then every
    pair of neighbours has a contact more, and with more than 6 rows per sphere G is singular.

    Args:
        n_columns: number of columns.
        height: spheres in each.
        touching: whether neighbouring columns touch.
        radius: of the spheres in m.
        mass: of each sphere in kg.

    >>> from asperity.problems import scenes
    >>> (
    ...     len(scenes.columns(4, height=3).point),
    ...     len(scenes.columns(4, height=3, touching=False).point),
    ... )
    (24, 12)
    """
    count, tall = arrays.count(n_columns, "n_columns"), arrays.count(height, "height")
    radius = arrays.positive(radius, "radius")
    side = int(np.ceil(np.sqrt(count)))
    column, level = np.arange(count).repeat(tall), np.tile(np.arange(tall), count)
    place = np.column_stack([column % side, column // side, level]).astype(float)
    center = 2.0 * radius * place + [0.0, 0.0, radius]
    sphere = np.arange(count * tall)
    lower = [np.where(level > 0, sphere - 1, GROUND)]
    upper = [sphere]
    if touching:
        for step, fits in ((tall, column % side > 0), (side * tall, column >= side)):
            lower.append(sphere[fits] - step)
            upper.append(sphere[fits])
    return _spheres(center, radius, mass, np.concatenate(lower), np.concatenate(upper))


def pile(layers: int, *, radius: float = 0.5, mass: float = 1.0) -> Scene:
    """Return a square pyramid of equal spheres, each resting on four, neighbours touching.

    Layer k from the top has k² spheres. Hyperstatic, the rank of G is below its size.

    Args:
        layers: number of layers n.
        radius: of the spheres in m.
        mass: of each sphere in kg.

    >>> from asperity.problems import scenes
    >>> len(scenes.pile(2).point)  # four on the ground, four pairs, one sphere on four
    12
    """
    count, radius = arrays.count(layers, "layers"), arrays.positive(radius, "radius")
    sizes = list(range(count, 0, -1))
    first = [sum(size**2 for size in sizes[:level]) for level in range(count)]
    center, lower, upper = [], [np.full(count**2, GROUND)], [np.arange(count**2)]
    for level, (size, start) in enumerate(zip(sizes, first, strict=True)):
        i, j = (index.ravel() for index in np.indices((size, size)))
        center.append(
            np.column_stack([2 * i + level, 2 * j + level, 1 + np.sqrt(2.0) * level + 0 * i])
        )
        here = start + size * i + j
        for step, fits in ((size, i > 0), (1, j > 0)):
            lower.append(here[fits] - step)
            upper.append(here[fits])
        if level:
            below = first[level - 1] + (size + 1) * i + j
            for step in (0, 1, size + 1, size + 2):
                lower.append(below + step)
                upper.append(here)
    places = radius * np.concatenate(center)
    return _spheres(places, radius, mass, np.concatenate(lower), np.concatenate(upper))


def _spheres(
    center: Array, radius: float, mass: float, lower: NDArray[np.int64], upper: NDArray[np.int64]
) -> Scene:
    base = np.where((lower == GROUND)[:, None], center[upper] * [1, 1, 0], center[lower])
    normal = center[upper] - base
    normal /= np.linalg.norm(normal, axis=1)[:, None]
    # Any tangent will do: the axis that is farthest from the normal, made orthogonal to it.
    axis = np.eye(3)[np.abs(normal).argmin(axis=1)]
    first = np.cross(np.cross(normal, axis), normal)
    first /= np.linalg.norm(first, axis=1)[:, None]
    frame = np.stack([normal, first, np.cross(normal, first)], axis=1)
    masses = np.full(len(center), arrays.positive(mass, "mass"))
    inertia = 0.4 * masses[:, None, None] * radius**2 * np.eye(3)
    point = center[upper] - radius * normal
    return Scene(masses, inertia, center, lower, upper, point, frame)


def _upright(
    mass: Array, inertia: Array, center: Array, lower: ArrayLike, upper: ArrayLike, point: Array
) -> Scene:
    points = point.reshape(-1, 3)
    frame = np.broadcast_to(UPRIGHT, (len(points), 3, 3))
    return Scene(mass, inertia, center, lower, upper, points, frame)


def _box_inertia(mass: Array, half: Array) -> Array:
    squares = half**2
    principal = (squares.sum(axis=1)[:, None] - squares) * mass[:, None] / 3.0
    return principal[:, :, None] * np.eye(3)


def _half_sizes(value: ArrayLike) -> Array:
    half = arrays.extents(value, "half_sizes")
    return arrays.array(half, "half_sizes", (3,))
