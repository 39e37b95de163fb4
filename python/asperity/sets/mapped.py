"""The image of a set under a linear map."""

from __future__ import annotations

from numpy.typing import ArrayLike

from asperity._base import arrays
from asperity._base.arrays import Array
from asperity.sets.star import StarSet, checked_set


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
        set = checked_set(set, "set")
        converted = arrays.array(matrix, "matrix", (set.dimension, set.dimension))
        self._set_core(set._core.mapped(converted), set=set, matrix=converted)

    def mapped(self, matrix: ArrayLike) -> Mapped:
        """Return the image under a further map; the two matrices are multiplied."""
        outer = arrays.array(matrix, "matrix", (self.dimension, self.dimension))
        return Mapped(self.set, outer @ self.matrix)
