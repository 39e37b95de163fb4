"""What the support function of a convex set gives: support points, projection, normal cone."""

from __future__ import annotations

from numpy.typing import ArrayLike

from asperity._base import arrays
from asperity._base.arrays import Array
from asperity._core import Set as CoreSet
from asperity.errors import ParameterError
from asperity.sets.cone import Cone
from asperity.sets.gauge import GaugeMethods


class SupportMethods(GaugeMethods):
    """The methods of `StarSet` that need a convex set."""

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
        return self._each(self._convex("support").support, y, "y")

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
        return self._each(self._convex("support_point").support_point, y, "y")

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
        return self._each(self._convex("support_hessian").support_hessian, y, "y")

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
        return self._each(self._convex("project").project, z, "z")

    def normal_cone(self, x: ArrayLike, *, tolerance: float = 1e-9) -> Cone:
        """Return the normal cone N_C(x) = {y : yᵀ(x* − x) ≤ 0 ∀x* ∈ C} of a convex set.

        Args:
            x: one point, shape ``(p,)``.
            tolerance: points with |k_C(x) − 1| ≤ `tolerance` count as boundary points.

        Returns:
            The cone: {0} in the interior, a ray on a smooth boundary, more at a corner, empty
            outside.

        Raises:
            ParameterError: if the set is not convex.

        Reference: [WL19] Def. 6, (7).

        >>> from asperity import Rectangle
        >>> Rectangle(2.0, 1.0).normal_cone([2.0, 0.5]).generators.tolist()
        [[1.0, 0.0]]
        >>> Rectangle(2.0, 1.0).normal_cone([2.0, 1.5]).is_empty
        True
        """
        point = arrays.array(x, "x", (self.dimension,))
        tolerance = arrays.non_negative(tolerance, "tolerance")
        generators = self._convex("normal_cone").normal_cone(point, tolerance)
        return Cone(() if generators is None else (generators,), dimension=self.dimension)

    def fenchel_gap(self, x: ArrayLike, y: ArrayLike, *, tolerance: float = 1e-12) -> Array:
        """Return Ψ_C(x) + Ψ*_C(y) − xᵀy ≥ 0; it vanishes exactly where y ∈ N_C(x).

        Args:
            x: points, shape ``(..., p)``.
            y: normals, shape ``(..., p)``; they broadcast with `x`.
            tolerance: as for `contains`.

        Returns:
            Shape ``(...)``; infinite outside the set.

        Raises:
            ParameterError: if the set is not convex.

        Reference: [WL19] (5).

        >>> from asperity import Rectangle
        >>> Rectangle(2.0, 1.0).fenchel_gap([2.0, 0.5], [[3.0, 0.0], [0.0, 3.0]]).tolist()
        [0.0, 1.5]
        """
        x, y = arrays.point_pairs(x, "x", y, "y", self.dimension)
        return self.indicator(x, tolerance=tolerance) + self.support(y) - (x * y).sum(-1)

    def _convex(self, operation: str, argument: str = "set") -> CoreSet:
        if self._core.is_convex:
            return self._core
        why = "is star-shaped only"
        if self._core.convexity()[0]:
            why = "is convex by sampling only; make it a Polygon, PolarCurve or SupportCurve"
        raise ParameterError(argument, f"must be convex for {operation}, {self!r} {why}")
