"""What the gauge of a set gives: membership, radius, boundary."""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from asperity._base import arrays
from asperity._base.arrays import Array
from asperity._base.value import Value
from asperity._core import Set as CoreSet
from asperity.errors import DimensionError

_GOLDEN_ANGLE = math.pi * (3.0 - math.sqrt(5.0))


class GaugeMethods(Value):
    """The methods of `StarSet` that need nothing but the gauge."""

    _core: CoreSet

    def _set_core(self, core: CoreSet, **parameters: Any) -> None:
        self._set(**parameters)
        self._keep(_core=core)

    def _each(self, function: Callable[[Array], Array], points: ArrayLike, argument: str) -> Array:
        """Return what a function of the core says of points of shape ``(..., p)``."""
        flat, lead = arrays.points(points, argument, self.dimension)
        return arrays.unflatten(function(flat), lead)

    @property
    def dimension(self) -> int:
        """Dimension p of the space, 1, 2 or 3."""
        return self._core.dimension

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
        return self._each(self._core.gauge, x, "x")

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
        return self._each(self._core.gauge_gradient, x, "x")

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
        return 1.0 / self.gauge(arrays.unit_vectors(arrays.array(theta, "theta")))

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
        return self.gauge(x) <= 1.0 + arrays.non_negative(tolerance, "tolerance")

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
        rays = directions(self.dimension, arrays.count(n, "n"))
        return rays / self.gauge(rays)[:, None]

    def indicator(self, x: ArrayLike, *, tolerance: float = 1e-12) -> Array:
        """Return the indicator function Ψ_C(x), 0 inside and ∞ outside.

        Args:
            x: points, shape ``(..., p)``.
            tolerance: as for `contains`.

        Returns:
            Shape ``(...)``.

        Reference: [WL19] Def. 4, (3).

        >>> from asperity import Disk
        >>> Disk(1.0).indicator([[0.5, 0.5], [1.0, 1.0]]).tolist()
        [0.0, inf]
        """
        return np.where(self.contains(x, tolerance=tolerance), 0.0, np.inf)[()]

    def _require_plane(self, operation: str) -> None:
        if self.dimension != 2:
            raise DimensionError(
                "set", f"must be planar for {operation}, this one has dimension {self.dimension}"
            )


def directions(dimension: int, n: int) -> Array:
    """Return unit vectors spread evenly over the line, the plane or the space."""
    if dimension == 1:
        return np.array([[-1.0], [1.0]])
    k = np.arange(n)
    if dimension == 2:
        return arrays.unit_vectors(2.0 * np.pi * k / n)
    height = 1.0 - (2.0 * k + 1.0) / n
    ring = np.sqrt(1.0 - height**2)
    return np.stack(
        [ring * np.cos(_GOLDEN_ANGLE * k), ring * np.sin(_GOLDEN_ANGLE * k), height], -1
    )
