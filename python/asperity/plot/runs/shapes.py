"""Shapes of bodies, as far as their pairs tell: boxes, spheres, and hulls of points."""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np
from scipy.spatial import ConvexHull, QhullError

from asperity._base.arrays import Array, unit_vectors
from asperity.system.rigid import (
    BoxPlane,
    PointPlane,
    RigidBodies,
    SpherePlane,
    SphereSphere,
)

# Faces of a hull whose normals differ by less are one, and so are corners nearer than this share
# of the size.
_SAME = 1e-9
_CIRCLE = unit_vectors(np.linspace(0.0, 2.0 * np.pi, 73))


@dataclass(frozen=True)
class Shape:
    """What there is to draw of a body, in its own axes from its centre of mass, in m."""

    corners: tuple[Array, ...] = ()
    """Convex polyhedra or polygons, each by its corners."""
    spheres: tuple[tuple[Array, float], ...] = field(default=())
    """Centres and radii."""

    def extent(self) -> float:
        """Return the largest distance of a point from the centre of mass."""
        reaches = [np.linalg.norm(one, axis=1).max() for one in self.corners]
        reaches += [np.linalg.norm(center) + radius for center, radius in self.spheres]
        return float(max(reaches, default=0.0))


def shapes(system: RigidBodies) -> list[Shape]:
    """Return the shape of each body; a body that touches nothing has an empty one."""
    corners: list[list[Array]] = [[] for _ in system.bodies]
    points: list[list[Array]] = [[] for _ in system.bodies]
    spheres: list[dict[tuple[float, ...], tuple[Array, float]]] = [{} for _ in system.bodies]

    def add_sphere(body: int, center: Array, radius: float) -> None:
        spheres[body][*center.tolist(), radius] = (center, radius)

    for pair in system.pairs:
        if isinstance(pair, BoxPlane):
            signs = np.array(list(np.ndindex((2,) * len(pair.half_sizes)))) * 2.0 - 1.0
            box = signs * pair.half_sizes
            if not any(np.array_equal(box, one) for one in corners[pair.body]):
                corners[pair.body].append(box)
        elif isinstance(pair, SpherePlane):
            add_sphere(pair.body, pair.center, pair.radius)
        elif isinstance(pair, SphereSphere):
            add_sphere(pair.body, pair.center, pair.radius)
            add_sphere(pair.other, pair.other_center, pair.other_radius)
        elif isinstance(pair, PointPlane):
            points[pair.body].append(pair.point)
    return [
        Shape(
            corners=(*own, *([np.array(loose)] if loose else [])),
            spheres=tuple(round_ones.values()),
        )
        for own, loose, round_ones in zip(corners, points, spheres, strict=True)
    ]


def outline(points: Array) -> Array:
    """Return the convex hull of points of the plane, closed; of points on a line its ends."""
    try:
        around = ConvexHull(points).vertices
    except (QhullError, ValueError):
        along = points[:, np.argmax(np.ptp(points, axis=0))]
        return points[[int(along.argmin()), int(along.argmax())]]
    return points[[*around, around[0]]]


def edges(corners: Array) -> list[Array]:
    """Return the edges of the convex hull of points in space, each as its two ends."""
    middle = corners.mean(axis=0)
    _, sizes, axes = np.linalg.svd(corners - middle, full_matrices=True)
    flat = len(sizes) < 3 or sizes[2] <= _SAME * sizes[0]
    if flat:
        rim = outline((corners - middle) @ axes[:2].T) @ axes[:2] + middle
        return [rim[i : i + 2] for i in range(len(rim) - 1)]
    hull = ConvexHull(corners)
    faces: dict[tuple[int, ...], list[frozenset[int]]] = {}
    for equation, triangle in zip(hull.equations, hull.simplices, strict=True):
        plane = tuple(np.round(equation[:3] / _SAME * 1e-3).astype(int))
        sides = [frozenset((int(triangle[i]), int(triangle[i - 1]))) for i in range(3)]
        faces.setdefault(plane, []).extend(sides)
    # A side that two triangles of one face share lies inside the face.
    found = {side for sides in faces.values() for side in sides if sides.count(side) == 1}
    return [corners[sorted(side)] for side in found]


def circle(center: Array, radius: float) -> Array:
    """Return a closed circle in the plane."""
    return center + radius * _CIRCLE


def great_circles(center: Array, radius: float, turn: Array) -> list[Array]:
    """Return the three great circles of a sphere across its body's axes."""
    flat = np.column_stack([_CIRCLE, np.zeros(len(_CIRCLE))])
    return [center + radius * np.roll(flat, shift, axis=1) @ turn.T for shift in range(3)]
