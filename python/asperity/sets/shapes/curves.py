"""Planar sets from points: polygon, curve through radii, curve through support values."""

from __future__ import annotations

from collections.abc import Callable
from typing import Self

from numpy.typing import ArrayLike

import asperity._core as _core
from asperity._base import arrays
from asperity._base.arrays import Array
from asperity._core import Set as CoreSet
from asperity.errors import ParameterError
from asperity.sets.shapes.turned import SizedSet
from asperity.sets.verdict import Verdict, verdict


class Polygon(SizedSet):
    """The polygon with the given vertices, star-shaped with respect to the origin.

    Args:
        vertices: in order, of either sense, the first not repeated; shape ``(n, 2)`` with n ≥ 3.

    Raises:
        ParameterError: with a witness point, if the outline crosses itself, is not star-shaped or
            does not have the origin inside.

    >>> from asperity import Polygon
    >>> triangle = Polygon([[2.0, -1.0], [0.0, 2.0], [-2.0, -1.0]])
    >>> triangle.support_point([0.1, 1.0]).tolist()
    [0.0, 2.0]
    """

    _lengths = ("vertices",)

    vertices: Array

    def __init__(self, vertices: ArrayLike) -> None:
        points = arrays.array(vertices, "vertices", (None, 2))
        self._set_core(_core.Set.polygon(points), vertices=points)

    def rotated(self, angle: float) -> Polygon:
        """Return the polygon turned counter-clockwise by `angle` in rad."""
        return Polygon(self.vertices @ arrays.rotation(arrays.number(angle, "angle")).T)


class CurveSet(SizedSet):
    """A planar set whose smooth boundary is given by values over angles."""

    angle: Array

    def _set_curve(
        self, make: Callable[[Array, Array], CoreSet], angle: ArrayLike, values: ArrayLike
    ) -> None:
        (name,) = self._lengths
        angles = arrays.array(angle, "angle", (None,))
        numbers = arrays.array(values, name, (angles.size,))
        if numbers.min(initial=1.0) <= 0.0:
            raise ParameterError(name, f"must be positive, got {numbers.min()}")
        self._set_core(make(angles, numbers), **{"angle": angles, name: numbers})

    def rotated(self, angle: float) -> Self:
        """Return the set turned counter-clockwise by `angle` in rad."""
        return self.replace(angle=self.angle + arrays.number(angle, "angle"))


class PolarCurve(CurveSet):
    """The set within the periodic C² curve through radii r_C(θᵢ) over polar angles.

    Between the samples w = 1/r_C has piecewise linear w + w″. The set is convex where w + w″ ≥ 0
    at the samples, and then so is the curve: convex data give a convex set. Where that is not to be
    had, or the curve would swing far beyond its samples, it has corners at them.

    Args:
        angle: θᵢ in rad, in any order, taken modulo a turn, without gap above 3 rad; shape ``(n,)``
            with n ≥ 4.
        radius: r_C(θᵢ) > 0, shape ``(n,)``.

    Raises:
        ParameterError: if angles coincide or leave a gap, or a radius is not positive.

    Reference: [WL19] §5.2.

    >>> import numpy as np
    >>> from asperity import PolarCurve
    >>> theta = np.arange(8) * np.pi / 4
    >>> circle = PolarCurve(theta, np.full(8, 0.3))
    >>> circle.radius([0.1, 0.2]).round(9).tolist()
    [0.3, 0.3]
    """

    _lengths = ("radius",)

    def __init__(self, angle: ArrayLike, radius: ArrayLike) -> None:
        self._set_curve(_core.Set.polar_curve, angle, radius)


class SupportCurve(CurveSet):
    """The convex set within the periodic C² curve with support values h(φᵢ) over normal angles.

    Between the samples the radius of curvature h + h″ is piecewise linear. It has to be ≥ 0.

    Args:
        angle: φᵢ in rad, in any order, taken modulo a turn, without gap above 3 rad; shape ``(n,)``
            with n ≥ 4.
        support: h(φᵢ) = Ψ*_C(cos φᵢ, sin φᵢ) > 0, shape ``(n,)``.

    Raises:
        ParameterError: if angles coincide or leave a gap, or the values are those of no convex set
            with the origin inside.

    Reference: [WL19] Def. 5.

    >>> import numpy as np
    >>> from asperity import Ellipse, SupportCurve
    >>> phi = np.arange(72) * np.pi / 36
    >>> normals = np.stack([np.cos(phi), np.sin(phi)], axis=-1)
    >>> curve = SupportCurve(phi, Ellipse(3.0, 2.0).support(normals))
    >>> curve.radius([0.0, np.pi / 2]).round(4).tolist()
    [3.0, 2.0]
    """

    _lengths = ("support",)

    def __init__(self, angle: ArrayLike, support: ArrayLike) -> None:
        self._set_curve(_core.Set.support_curve, angle, support)


def star_shape(vertices: ArrayLike) -> Verdict:
    """Return whether a closed outline bounds a set that is star-shaped with respect to the origin.

    Args:
        vertices: of the outline in order, of either sense, the first not repeated; shape
            ``(n, 2)`` with n ≥ 3.

    Returns:
        The verdict; its witness is a point ``(1, 2)`` of the outline that cannot be seen from the
        origin, or where the outline passes the origin or crosses itself. An edge along a ray is
        allowed here; `Polygon` refuses it, for its radius would jump.

    Raises:
        ParameterError: with fewer than three different points.

    Reference: [WL19] Def. 2, Fig. 1.

    >>> from asperity import star_shape
    >>> bool(star_shape([[1.0, -1.0], [1.0, 1.0], [-1.0, 1.0], [-1.0, -1.0]]))
    True
    >>> bool(star_shape([[2.0, 0.0], [1.0, 2.0], [3.0, 2.0], [3.0, 3.0], [-1.0, 0.0], [0.0, -1.0]]))
    False
    """
    return verdict(_core.star_shape(arrays.array(vertices, "vertices", (None, 2))))
