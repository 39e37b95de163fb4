"""Sets made of others: intersection, union, Minkowski sum, image under a linear map."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Sequence
from typing import Self

from numpy.typing import ArrayLike

import asperity._core as _core
from asperity._base import arrays
from asperity._base.arrays import Array
from asperity._core import Set as CoreSet
from asperity.errors import DimensionError
from asperity.sets.star import StarSet, checked_set, same_dimension


class CombinedSet(StarSet):
    """A set made of several others of one dimension."""

    sets: tuple[StarSet, ...]

    def _combine(
        self, combine: Callable[[Sequence[CoreSet]], CoreSet], sets: Iterable[StarSet]
    ) -> None:
        listed = same_dimension(arrays.several(sets, "sets"), "sets")
        if not listed:
            raise DimensionError("sets", "must hold at least one set")
        flat: list[StarSet] = []
        for one in listed:
            flat.extend(one.sets if isinstance(one, type(self)) else (one,))
        self._set_core(combine([one._core for one in flat]), sets=tuple(flat))

    def rotated(self, angle: float) -> Self:
        """Return the set turned counter-clockwise by `angle` in rad (p = 2)."""
        return self.replace(sets=[one.rotated(angle) for one in self.sets])

    def scaled(self, factor: float) -> Self:
        """Return the set {s x : x ∈ C}."""
        return self.replace(sets=[one.scaled(factor) for one in self.sets])


class Intersection(CombinedSet):
    """The intersection of sets, also written ``A & B``: its gauge is the largest of theirs.

    Args:
        sets: of one dimension; intersections among them are resolved into their parts.

    Reference: [WL19] Def. 3; [Rockafellar1970].

    >>> from asperity import Disk, Rectangle
    >>> cut = Disk(1.0) & Rectangle(0.8, 2.0)
    >>> cut
    Intersection((Disk(1.0), Rectangle(0.8, 2.0)))
    >>> cut.support_point([1.0, 0.1]).round(12).tolist()
    [0.8, 0.6]
    """

    def __init__(self, sets: Iterable[StarSet]) -> None:
        self._combine(_core.Set.intersection, sets)


class Union(CombinedSet):
    """The union of sets, also written ``A | B``: its gauge is the smallest of theirs.

    It is star-shaped, as each of them is. Support function, projection and normal cone are not
    available, even if the union happens to be convex.

    Args:
        sets: of one dimension; unions among them are resolved into their parts.

    Reference: [WL19] Def. 2, 3.

    >>> from asperity import Ellipse
    >>> cross = Ellipse(3.0, 1.0) | Ellipse(1.0, 3.0)
    >>> cross.gauge([[3.0, 0.0], [0.0, 3.0]]).tolist()
    [1.0, 1.0]
    >>> bool(cross.is_convex)
    False
    """

    def __init__(self, sets: Iterable[StarSet]) -> None:
        self._combine(_core.Set.union, sets)


class MinkowskiSum(CombinedSet):
    """The sum {x₁ + x₂ + … : xᵢ ∈ Cᵢ} of convex sets, also written ``A + B``.

    Its support function is the sum of theirs: the reservoir of several contacts that share one
    sliding velocity.

    Args:
        sets: convex and of one dimension; sums among them are resolved into their parts.

    Raises:
        ParameterError: if one of them is not convex.

    Reference: [Rockafellar1970] §13.

    >>> from asperity import Disk, Rectangle
    >>> rounded = Rectangle(2.0, 1.0) + Disk(0.5)
    >>> rounded.support([[1.0, 0.0], [0.6, 0.8]]).round(12).tolist()
    [2.5, 2.5]
    """

    def __init__(self, sets: Iterable[StarSet]) -> None:
        listed = same_dimension(arrays.several(sets, "sets"), "sets")
        for one in listed:
            one._convex("a Minkowski sum", "sets")
        self._combine(_core.Set.minkowski_sum, listed)


class Mapped(StarSet):
    """The image {A x : x ∈ C} of a set under a regular linear map.

    Args:
        set: the set C.
        matrix: A, shape ``(p, p)``.

    Raises:
        ParameterError: if A is singular.

    Reference: [WL19] (9).

    >>> from asperity.sets import Box, Mapped
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
