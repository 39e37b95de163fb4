"""Cones: normal and tangent cones, and what one asks them."""

from __future__ import annotations

from collections.abc import Iterable

import numpy as np
from numpy.typing import ArrayLike, NDArray

import asperity._core as _core
from asperity._base import arrays
from asperity._base.arrays import Array
from asperity._base.value import Value
from asperity.errors import DimensionError, ParameterError


class Cone(Value):
    """A union of convex cones, each given by generators: {Σ sᵢ gᵢ : sᵢ ≥ 0}.

    Normal cones have one part. So have tangent cones, except where the boundary has a re-entrant
    corner. A part without generators is the cone {0}; without any part the cone is empty, as
    normal and tangent cones are outside their set.

    Args:
        parts: generators of each part, shapes ``(m, p)``.
        dimension: p; by default that of the first part.

    Reference: [WL19] Def. 6, 7; [Rockafellar1970].

    >>> from asperity.sets import Cone
    >>> quadrant = Cone([[[1.0, 0.0], [0.0, 1.0]]])
    >>> quadrant.distance([3.0, -4.0]).tolist()
    4.0
    """

    parts: tuple[Array, ...]
    dimension: int

    def __init__(self, parts: Iterable[ArrayLike], *, dimension: int | None = None) -> None:
        listed = [arrays.array(part, "parts") for part in arrays.several(parts, "parts")]
        if dimension is None:
            if not listed or listed[0].ndim != 2:
                raise DimensionError(
                    "dimension", "must be given unless it follows from the first part"
                )
            dimension = listed[0].shape[1]
        dimension = arrays.count(dimension, "dimension")
        if dimension > 3:
            raise DimensionError("dimension", f"must be 1, 2 or 3, got {dimension}")
        # An empty list has lost the width of its rows.
        shaped = [part.reshape(-1, dimension) if part.size == 0 else part for part in listed]
        self._set(
            parts=tuple(
                arrays.read_only(arrays.array(part, "parts", (None, dimension))) for part in shaped
            ),
            dimension=dimension,
        )

    @property
    def is_empty(self) -> bool:
        """Whether there is no element, not even 0."""
        return not self.parts

    @property
    def is_convex(self) -> bool:
        """Whether the cone is given as one convex part."""
        return len(self.parts) == 1

    @property
    def generators(self) -> Array:
        """Generators of all parts, shape ``(m, p)``."""
        return np.concatenate([np.empty((0, self.dimension)), *self.parts])

    def contains(self, y: ArrayLike, *, tolerance: float = 1e-9) -> NDArray[np.bool_]:
        """Return whether the distance of y is at most `tolerance` times ‖y‖.

        Args:
            y: vectors, shape ``(..., p)``.
            tolerance: sine of the angle by which y may be outside.

        Returns:
            Shape ``(...)``.

        >>> from asperity import Disk
        >>> Disk(1.0).normal_cone([1.0, 0.0]).contains([[5.0, 0.0], [5.0, 0.1]]).tolist()
        [True, False]
        """
        distance = self.distance(y)
        length = arrays.lengths(arrays.array(y, "y"))
        return distance <= length * arrays.non_negative(tolerance, "tolerance")

    def distance(self, y: ArrayLike) -> Array:
        """Return the distance from y to the nearest element, infinite if there is none.

        Args:
            y: vectors, shape ``(..., p)``.

        Returns:
            Shape ``(...)``, in the unit of y.

        >>> from asperity import Disk
        >>> float(Disk(1.0).tangent_cone([1.0, 0.0]).distance([0.5, 7.0]))
        0.5
        """
        flat, lead = arrays.points(y, "y", self.dimension)
        return arrays.unflatten(self._nearest(flat)[0], lead)

    def project(self, y: ArrayLike) -> Array:
        """Return the element nearest to y, one of them if the cone is not convex.

        Args:
            y: vectors, shape ``(..., p)``.

        Returns:
            Shape ``(..., p)``.

        Raises:
            ParameterError: if the cone is empty.

        >>> from asperity import Disk
        >>> Disk(1.0).tangent_cone([1.0, 0.0]).project([0.5, 7.0]).tolist()
        [0.0, 7.0]
        """
        flat, lead = arrays.points(y, "y", self.dimension)
        if self.is_empty:
            raise ParameterError("cone", "must not be empty to project onto it")
        return arrays.unflatten(self._nearest(flat)[1], lead)

    def polar(self) -> Cone:
        """Return the polar cone {y : yᵀx ≤ 0 ∀x in the cone} of a convex one.

        The polar of the normal cone is the tangent cone, and the other way round.

        Raises:
            ParameterError: if the cone is not convex.

        Reference: [Rockafellar1970] §14.

        >>> from asperity import Rectangle
        >>> corner = Rectangle(2.0, 1.0).normal_cone([2.0, 1.0])
        >>> corner.polar().contains([[-1.0, 0.0], [-1.0, 0.5]]).tolist()
        [True, False]
        """
        if not self.is_convex:
            raise ParameterError("cone", f"must be one convex part, has {len(self.parts)}")
        return Cone((_core.cone_polar(self.parts[0]),), dimension=self.dimension)

    def _nearest(self, y: Array) -> tuple[Array, Array]:
        distance, nearest = np.full(len(y), np.inf), np.zeros_like(y)
        for part in self.parts:
            found = _core.cone_projection(part, y)
            away = arrays.lengths(y - found)
            closer = away < distance
            distance[closer], nearest[closer] = away[closer], found[closer]
        return distance, nearest
