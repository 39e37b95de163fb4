"""Sets with round boundary: ball, disk, ellipse, ellipsoid, superellipse, superellipsoid."""

from __future__ import annotations

from typing import Any, Self

import numpy as np
from numpy.typing import ArrayLike

import asperity._core as _core
from asperity._base import arrays
from asperity._base.arrays import Array
from asperity.errors import DimensionError
from asperity.sets.shapes.turned import SizedSet, TurnedSet
from asperity.sets.star import StarSet


class Radius(float):
    """The radius of a ball or a disk: a number, and `radius` of every planar set when called."""

    _of: StarSet

    def __call__(self, theta: ArrayLike) -> Array:
        """Return the radius r_C(θ) at polar angles in rad."""
        return StarSet.radius(self._of, theta)

    def __reduce__(self) -> tuple[Any, ...]:
        return float, (float(self),)


class RoundSet(SizedSet):
    """A ball, which looks the same from all sides."""

    _lengths = ("radius",)

    @property
    def radius(self) -> Radius:
        """The radius, a number; ``radius(theta)`` is that of every planar set over the direction.

        >>> from asperity import Disk
        >>> Disk(0.3).radius, float(Disk(0.3).radius(1.0))
        (0.3, 0.3)
        """
        found = Radius(self._parameters["radius"])
        found._of = self
        return found

    def rotated(self, angle: float) -> Self:
        """Return the set itself."""
        arrays.number(angle, "angle")
        return self


class Ball(RoundSet):
    """The ball {x : ‖x‖ ≤ radius} of R¹, R² or R³.

    It is a set of friction forces; a rigid body of this shape is made by `Body.ball`.

    Args:
        radius: > 0.
        dimension: p = 1, 2 or 3.

    >>> from asperity import Ball
    >>> float(Ball(2.0).gauge([0.0, 3.0, 4.0]))
    2.5
    """

    def __init__(self, radius: float, *, dimension: int = 3) -> None:
        radius = arrays.positive(radius, "radius")
        dimension = arrays.count(dimension, "dimension")
        if dimension > 3:
            raise DimensionError("dimension", f"must be 1, 2 or 3, got {dimension}")
        self._set_core(_core.Set.ball(dimension, radius), radius=radius, dimension=dimension)


class Disk(RoundSet):
    """The disk {x : ‖x‖ ≤ radius}, the force reservoir of isotropic Coulomb friction.

    It is a set of friction forces; a rigid body of this shape is made by `PlanarBody.disk`.

    Args:
        radius: > 0; the friction coefficient μ for sets per unit normal force.

    Reference: [WL19] (33).

    >>> from asperity import Disk
    >>> float(Disk(0.3).support([0.0, 2.0]))
    0.6
    """

    def __init__(self, radius: float) -> None:
        radius = arrays.positive(radius, "radius")
        self._set_core(_core.Set.ball(2, radius), radius=radius)


class Ellipse(TurnedSet):
    """The ellipse {x : (x₁/a)² + (x₂/b)² ≤ 1}, turned by an angle.

    Args:
        a: semi-axis along the first axis.
        b: semi-axis along the second axis.
        angle: of the first axis from e₁, counter-clockwise, in rad.

    Reference: [WL19] (34).

    >>> from asperity import Ellipse
    >>> Ellipse(3.0, 1.0).support_point([0.0, 2.0]).tolist()
    [0.0, 1.0]
    """

    def __init__(self, a: float, b: float, *, angle: float = 0.0) -> None:
        a, b = arrays.size(a, "a"), arrays.size(b, "b")
        upright = _core.Set.ellipsoid(np.array([a, b]))
        self._set_angled(upright, angle, a=a, b=b)

    @classmethod
    def from_intercepts(cls, n1: float, n2: float, nu: float) -> Ellipse:
        """Make the ellipse k² = (x₁/n₁)² + (x₂/n₂)² + ν x₁x₂ ≤ 1 from its axis intercepts.

        Args:
            n1: intercept n₁ > 0 with the first axis.
            n2: intercept n₂ > 0 with the second axis.
            nu: |ν| < 2/(n₁n₂); 0 for an upright ellipse.

        Raises:
            ParameterError: if ν is too large for an ellipse.

        Reference: [WL19] (115).

        >>> from asperity import Ellipse
        >>> ellipse = Ellipse.from_intercepts(2.0, 1.0, 0.5)
        >>> ellipse.gauge([[2.0, 0.0], [0.0, 1.0]]).round(12).tolist()
        [1.0, 1.0]
        """
        a, b, angle = _core.Set.ellipse_from_intercepts(
            arrays.positive(n1, "n1"), arrays.positive(n2, "n2"), arrays.number(nu, "nu")
        )
        return cls(a, b, angle=angle)


class Ellipsoid(SizedSet):
    """The ellipsoid {x : Σ (eᵢ·x/aᵢ)² ≤ 1} of R¹, R² or R³.

    Args:
        semi_axes: aᵢ > 0, shape ``(p,)`` with p ≤ 3.
        axes: unit vectors eᵢ along them, orthonormal to 1e-12, as the columns of a matrix of shape
            ``(p, p)``; default those of the coordinates.

    Reference: [WL19] (34).

    >>> from asperity import Ellipsoid
    >>> Ellipsoid([3.0, 1.0, 2.0]).support_point([0.0, 0.0, 5.0]).tolist()
    [0.0, 0.0, 2.0]
    >>> turned = Ellipsoid([3.0, 1.0, 2.0], axes=[[0, -1, 0], [1, 0, 0], [0, 0, 1]])
    >>> float(turned.support([0.0, 1.0, 0.0]))
    3.0
    """

    _lengths = ("semi_axes",)

    semi_axes: Array
    axes: Array | None

    def __init__(self, semi_axes: ArrayLike, *, axes: ArrayLike | None = None) -> None:
        lengths = arrays.extents(semi_axes, "semi_axes")
        size = len(lengths)
        directions = None if axes is None else arrays.array(axes, "axes", (size, size))
        self._set_core(_core.Set.ellipsoid(lengths, directions), semi_axes=lengths, axes=directions)


class Superellipse(TurnedSet):
    """The superellipse {x : |x₁/a|^s + |x₂/b|^s ≤ 1}, turned by an angle.

    A rhombus for s = 1, an ellipse for s = 2, nearly a rectangle for large s; for s < 1 it is
    star-shaped only and has no support function, projection or normal cone.

    Args:
        a: semi-axis along the first axis.
        b: semi-axis along the second axis.
        exponent: s ≥ 0.01.
        angle: of the first axis from e₁, counter-clockwise, in rad.

    Reference: [WL19] (37).

    >>> from asperity import Superellipse
    >>> bool(Superellipse(3.0, 1.0, 0.5).is_convex)
    False
    >>> float(Superellipse(3.0, 1.0, 1.0).gauge([3.0, 1.0]))
    2.0
    """

    exponent: float

    def __init__(self, a: float, b: float, exponent: float, *, angle: float = 0.0) -> None:
        a, b = arrays.size(a, "a"), arrays.size(b, "b")
        exponent = arrays.positive(exponent, "exponent")
        upright = _core.Set.superellipsoid(np.array([a, b]), exponent)
        self._set_angled(upright, angle, a=a, b=b, exponent=exponent)


class Superellipsoid(SizedSet):
    """The superellipsoid {x : Σ |xᵢ/aᵢ|^s ≤ 1} of R¹, R² or R³ with its axes along the coordinates.

    An octahedron for s = 1, an ellipsoid for s = 2, nearly a box for large s; for s < 1 it is
    star-shaped only and has no support function, projection or normal cone. `mapped` turns it.

    Args:
        semi_axes: aᵢ > 0, shape ``(p,)`` with p ≤ 3.
        exponent: s ≥ 0.01.

    Reference: [WL19] (37).

    >>> from asperity import Superellipsoid
    >>> octahedron = Superellipsoid([1.0, 2.0, 0.5], exponent=1.0)
    >>> float(octahedron.gauge([1.0, 2.0, 0.5]))
    3.0
    >>> bool(octahedron.replace(exponent=0.5).is_convex)
    False
    """

    _lengths = ("semi_axes",)

    semi_axes: Array
    exponent: float

    def __init__(self, semi_axes: ArrayLike, *, exponent: float) -> None:
        lengths = arrays.extents(semi_axes, "semi_axes")
        exponent = arrays.positive(exponent, "exponent")
        core = _core.Set.superellipsoid(lengths, exponent)
        self._set_core(core, semi_axes=lengths, exponent=exponent)
