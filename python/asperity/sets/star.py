"""What every set can do, and the image of a set under a linear map."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from asperity import _arrays
from asperity._arrays import Array
from asperity._core import Set as CoreSet
from asperity._value import Value
from asperity.errors import DimensionError, ParameterError

_GOLDEN_ANGLE = math.pi * (3.0 - math.sqrt(5.0))


class StarSet(Value):
    """A compact star-shaped set C with the origin in its interior.

    Methods take points of shape ``(..., p)`` and answer with arrays of the same leading shape.
    Support function, projection and normal cone need a convex set (`is_convex`) and raise
    `ParameterError` on others.

    Reference: [WL19] Def. 2, 3.
    """

    _core: CoreSet

    def _set_core(self, core: CoreSet, **parameters: Any) -> None:
        self._set(**parameters)
        self._keep(_core=core)

    @property
    def dimension(self) -> int:
        """Dimension p of the space, 1, 2 or 3."""
        return self._core.dimension

    @property
    def is_convex(self) -> bool:
        """Whether the set is convex."""
        return self._core.is_convex

    def gauge(self, x: ArrayLike) -> Array:
        """Return the gauge k_C(x) = inf{s > 0 : x ∈ sC}; C = {k_C ≤ 1}.

        Args:
            x: points, shape ``(..., p)``.

        Returns:
            Shape ``(...)``, dimensionless.

        Reference: [WL19] Def. 3.

        >>> from asperity import Ellipse
        >>> float(Ellipse(3.0, 1.0).gauge([6.0, 0.0]))
        2.0
        """
        flat, lead = _arrays.points(x, "x", self.dimension)
        return _arrays.unflatten(self._core.gauge(flat), lead)

    def gauge_gradient(self, x: ArrayLike) -> Array:
        """Return the gradient ∇k_C(x), an outward normal of the boundary.

        At a corner it is one element of the generalised gradient.

        Args:
            x: points other than the origin, shape ``(..., p)``.

        Returns:
            Shape ``(..., p)``, in the inverse unit of `x`.

        Raises:
            ParameterError: at the origin, where the gauge has no gradient.

        >>> from asperity import Disk
        >>> Disk(2.0).gauge_gradient([3.0, 4.0]).tolist()
        [0.3, 0.4]
        """
        flat, lead = _arrays.points(x, "x", self.dimension)
        return _arrays.unflatten(self._core.gauge_gradient(flat), lead)

    def radius(self, theta: ArrayLike) -> Array:
        """Return the radius r_C(θ) = 1/k_C(cos θ, sin θ) of a planar set.

        Args:
            theta: polar angles in rad, any shape.

        Returns:
            Distances from the origin to the boundary, shape of `theta`.

        >>> import math
        >>> from asperity import Rectangle
        >>> float(Rectangle(2.0, 1.0).radius(math.pi))
        2.0
        """
        self._require_plane("radius")
        angle = _arrays.array(theta, "theta")
        directions = np.stack([np.cos(angle), np.sin(angle)], axis=-1)
        return 1.0 / self.gauge(directions)

    def contains(self, x: ArrayLike, *, tolerance: float = 1e-12) -> NDArray[np.bool_]:
        """Return whether k_C(x) ≤ 1 + `tolerance`.

        Args:
            x: points, shape ``(..., p)``.
            tolerance: relative, dimensionless.

        Returns:
            Shape ``(...)``.

        >>> from asperity import Disk
        >>> Disk(1.0).contains([[0.5, 0.5], [1.0, 1.0]]).tolist()
        [True, False]
        """
        inside: NDArray[np.bool_] = self.gauge(x) <= 1.0 + _arrays.non_negative(
            tolerance, "tolerance"
        )
        return inside

    def boundary(self, n: int = 360) -> Array:
        """Return points of the boundary.

        Args:
            n: number of points; an interval has two whatever `n`.

        Returns:
            Shape ``(n, p)``. In the plane counter-clockwise at equidistant polar angles from 0 on,
            the first point not repeated; in space along a Fibonacci spiral.

        >>> from asperity import Disk
        >>> Disk(2.0).boundary(4).round(12).tolist()[:2]
        [[2.0, 0.0], [0.0, 2.0]]
        """
        directions = _directions(self.dimension, _arrays.count(n, "n"))
        return directions / self.gauge(directions)[:, None]

    def support(self, y: ArrayLike) -> Array:
        """Return the support function Ψ*_C(y) = sup{xᵀy : x ∈ C} of a convex set.

        Args:
            y: normals, shape ``(..., p)``, of any length.

        Returns:
            Shape ``(...)``.

        Raises:
            ParameterError: if the set is not convex.

        Reference: [WL19] Def. 5.

        >>> from asperity import Ellipse
        >>> float(Ellipse(3.0, 1.0).support([2.0, 0.0]))
        6.0
        """
        flat, lead = _arrays.points(y, "y", self.dimension)
        return _arrays.unflatten(self._convex("support").support(flat), lead)

    def support_point(self, y: ArrayLike) -> Array:
        """Return the point ∇Ψ*_C(y) of a convex set that is farthest in direction y.

        Where a whole face is farthest, it is the face's most symmetric point.

        Args:
            y: normals, shape ``(..., p)``.

        Returns:
            Shape ``(..., p)``; the origin for y = 0, where every point is farthest.

        Raises:
            ParameterError: if the set is not convex.

        >>> from asperity import Rectangle
        >>> Rectangle(2.0, 1.0).support_point([1.0, -1.0]).tolist()
        [2.0, -1.0]
        """
        flat, lead = _arrays.points(y, "y", self.dimension)
        return _arrays.unflatten(self._convex("support_point").support_point(flat), lead)

    def support_hessian(self, y: ArrayLike) -> Array:
        """Return the Hessian ∇²Ψ*_C(y) of a convex set; it holds ∇²Ψ*_C(y) y = 0.

        It is infinite where the boundary's curvature vanishes, zero where `y` points at a corner.

        Args:
            y: normals other than 0, shape ``(..., p)``.

        Returns:
            Shape ``(..., p, p)``.

        Raises:
            ParameterError: if the set is not convex or `y` vanishes.

        Reference: [WL19] (88).

        >>> from asperity import Disk
        >>> Disk(2.0).support_hessian([0.0, 4.0]).tolist()
        [[0.5, 0.0], [0.0, 0.0]]
        """
        flat, lead = _arrays.points(y, "y", self.dimension)
        return _arrays.unflatten(self._convex("support_hessian").support_hessian(flat), lead)

    def project(self, z: ArrayLike) -> Array:
        """Return the proximal point prox_C(z) = argmin{‖z − x‖ : x ∈ C} of a convex set.

        Args:
            z: points, shape ``(..., p)``.

        Returns:
            Shape ``(..., p)``.

        Raises:
            ParameterError: if the set is not convex.

        Reference: [WL19] (11).

        >>> from asperity import Rectangle
        >>> Rectangle(2.0, 1.0).project([5.0, 0.5]).tolist()
        [2.0, 0.5]
        """
        flat, lead = _arrays.points(z, "z", self.dimension)
        return _arrays.unflatten(self._convex("project").project(flat), lead)

    def normal_cone(self, x: ArrayLike, *, tolerance: float = 1e-9) -> Array | None:
        """Return the normal cone N_C(x) = {y : yᵀ(x* − x) ≤ 0 ∀x* ∈ C} of a convex set.

        Args:
            x: one point, shape ``(p,)``.
            tolerance: points with |k_C(x) − 1| ≤ `tolerance` count as boundary points.

        Returns:
            Unit generators, shape ``(m, p)``: m = 0 in the interior (the cone {0}), one normal on a
            smooth boundary, more at a corner. ``None`` outside, where the cone is empty.

        Raises:
            ParameterError: if the set is not convex.

        Reference: [WL19] Def. 6.

        >>> from asperity import Disk
        >>> Disk(1.0).normal_cone([0.0, 1.0]).tolist()
        [[0.0, 1.0]]
        >>> Disk(1.0).normal_cone([0.0, 2.0]) is None
        True
        """
        point = _arrays.array(x, "x", (self.dimension,))
        core = self._convex("normal_cone")
        return core.normal_cone(point, _arrays.non_negative(tolerance, "tolerance"))

    def rotated(self, angle: float) -> StarSet:
        """Return the set turned counter-clockwise about the origin of the plane.

        Args:
            angle: in rad.

        >>> from asperity import Ellipse
        >>> Ellipse(3.0, 1.0).rotated(0.5)
        Ellipse(3.0, 1.0, angle=0.5)
        """
        self._require_plane("rotated")
        return self.mapped(_arrays.rotation(_arrays.number(angle, "angle")))

    def scaled(self, factor: float) -> StarSet:
        """Return the set {s x : x ∈ C}.

        Args:
            factor: s > 0.

        >>> from asperity import Disk
        >>> Disk(1.5).scaled(2.0)
        Disk(3.0)
        """
        return self.mapped(np.eye(self.dimension) * _arrays.positive(factor, "factor"))

    def mapped(self, matrix: ArrayLike) -> Mapped:
        """Return the image {A x : x ∈ C}; for a preimage pass the inverse.

        Args:
            matrix: regular A, shape ``(p, p)``.

        >>> from asperity import Disk
        >>> float(Disk(1.0).mapped([[3.0, 0.0], [0.0, 1.0]]).radius(0.0))
        3.0
        """
        return Mapped(self, matrix)

    def _convex(self, operation: str) -> CoreSet:
        if not self.is_convex:
            raise ParameterError(
                "set", f"must be convex for {operation}, {self!r} is star-shaped only"
            )
        return self._core

    def _require_plane(self, operation: str) -> None:
        if self.dimension != 2:
            raise DimensionError(
                "set", f"must be planar for {operation}, this one has dimension {self.dimension}"
            )


class Mapped(StarSet):
    """The image {A x : x ∈ C} of a set under a regular linear map.

    Args:
        set: the set C.
        matrix: A, shape ``(p, p)``.

    Raises:
        ParameterError: if A is singular.

    Reference: [WL19] (9).

    >>> from asperity import Box, Mapped
    >>> shear = Mapped(Box([1.0, 1.0]), [[1.0, 0.5], [0.0, 1.0]])
    >>> bool(shear.contains([1.5, 1.0]))
    True
    """

    set: StarSet
    matrix: Array

    def __init__(self, set: StarSet, matrix: ArrayLike) -> None:
        if not isinstance(set, StarSet):
            raise ParameterError("set", f"must be a set, got {set!r}")
        converted = _arrays.array(matrix, "matrix", (set.dimension, set.dimension))
        self._set_core(set._core.mapped(converted), set=set, matrix=_arrays.read_only(converted))

    def mapped(self, matrix: ArrayLike) -> Mapped:
        """Return the image under a further map; the two matrices are multiplied."""
        outer = _arrays.array(matrix, "matrix", (self.dimension, self.dimension))
        return Mapped(self.set, outer @ self.matrix)


def _directions(dimension: int, n: int) -> Array:
    if dimension == 1:
        return np.array([[-1.0], [1.0]])
    k = np.arange(n)
    if dimension == 2:
        theta = 2.0 * np.pi * k / n
        return np.stack([np.cos(theta), np.sin(theta)], axis=-1)
    height = 1.0 - (2.0 * k + 1.0) / n
    ring = np.sqrt(1.0 - height**2)
    return np.stack(
        [ring * np.cos(_GOLDEN_ANGLE * k), ring * np.sin(_GOLDEN_ANGLE * k), height], -1
    )
