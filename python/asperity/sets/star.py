"""What every set can do."""

from __future__ import annotations

import os
from collections.abc import Iterable
from functools import cached_property
from typing import TYPE_CHECKING, Self

import numpy as np
from numpy.typing import ArrayLike

from asperity._base import arrays
from asperity._base.drawing import svg
from asperity.errors import DimensionError, ParameterError
from asperity.sets.cone import Cone
from asperity.sets.support import SupportMethods
from asperity.sets.verdict import Verdict, verdict

if TYPE_CHECKING:
    from asperity.sets.combined import Intersection, Mapped, MinkowskiSum, Union


class StarSet(SupportMethods):
    """A compact star-shaped set C with the origin in its interior.

    Methods take points of shape ``(..., p)`` and answer with arrays of the same leading shape.
    Support function, projection and normal cone need a set that is convex by construction and
    raise `ParameterError` on others. ``A & B`` is the intersection of two sets, ``A | B`` their
    union, ``A + B`` the Minkowski sum of two convex ones.

    Sets have sizes between 1e-60 and 1e60. Points may have any size, those to be projected up to
    1e80; an answer beyond the range of numbers is refused.

    Reference: [WL19] Def. 2, 3.
    """

    def _repr_svg_(self) -> str | None:
        """Return the picture of a planar set for a notebook; None of others."""
        return svg("plot_set", self) if self.dimension == 2 else None

    @cached_property
    def is_convex(self) -> Verdict:
        """Whether the set is convex; the witness is two of its points with the middle outside.

        Reference: [WL19] Def. 1.

        >>> from asperity import Disk, Superellipse
        >>> bool(Disk(1.0).is_convex), bool(Superellipse(1.0, 1.0, 0.9).is_convex)
        (True, False)
        """
        return verdict(self._core.convexity())

    @cached_property
    def is_strictly_convex(self) -> Verdict:
        """Whether no boundary segment is straight; the witness is the ends of one, or of a dent.

        Reference: [WL19] Def. 1.

        >>> from asperity import Disk, Rectangle
        >>> bool(Disk(1.0).is_strictly_convex), bool(Rectangle(1.0, 1.0).is_strictly_convex)
        (True, False)
        """
        return verdict(self._core.strict_convexity())

    @cached_property
    def is_star_shaped(self) -> Verdict:
        """Whether the set is star-shaped with respect to the origin, which every set here is.

        What is not star-shaped cannot be made into a set; `star_shape` tests an outline.

        Reference: [WL19] Def. 2.

        >>> from asperity import Disk
        >>> bool(Disk(1.0).is_star_shaped)
        True
        """
        return Verdict(True, exact=True, tolerance=0.0, defect=0.0, witness=None)

    @cached_property
    def is_symmetric(self) -> Verdict:
        """Whether C = −C; the witness is a boundary point x with k_C(−x) ≠ k_C(x).

        >>> from asperity import Interval
        >>> bool(Interval(-1.0, 1.0).is_symmetric), bool(Interval(-1.0, 2.0).is_symmetric)
        (True, False)
        """
        return verdict(self._core.symmetry())

    def tangent_cone(self, x: ArrayLike, *, tolerance: float = 1e-9) -> Cone:
        """Return the tangent cone T_C(x), of star-shaped sets too.

        Args:
            x: one point, shape ``(p,)``.
            tolerance: points with |k_C(x) − 1| ≤ `tolerance` count as boundary points.

        Returns:
            The cone: the whole space in the interior, a half-space {y : ∇k_C·y ≤ 0} on a smooth
            boundary, at a re-entrant corner a union of convex cones; empty outside. In space the
            half-space is also what edges and corners of star-shaped sets and of sums give.

        Reference: [WL19] Def. 7, (10).

        >>> from asperity import Rectangle
        >>> cone = Rectangle(2.0, 1.0).tangent_cone([2.0, 1.0])
        >>> cone.contains([[-1.0, 0.0], [-1.0, 0.1]]).tolist()
        [True, False]
        """
        point = arrays.array(x, "x", (self.dimension,))
        parts = self._core.tangent_cone(point, arrays.non_negative(tolerance, "tolerance"))
        return Cone(parts or (), dimension=self.dimension)

    def scale_inside(self, outer: StarSet) -> float:
        """Return the largest s for which s C lies inside another set.

        Args:
            outer: the other set, of the same dimension.

        >>> from asperity import Disk, Rectangle
        >>> Disk(0.5).scale_inside(Rectangle(2.0, 1.0))
        2.0
        """
        (other,) = same_dimension((outer,), "outer", self.dimension)
        return self._core.scale_inside(other._core)[0]

    def margin_inside(self, outer: StarSet) -> float:
        """Return the largest m with k_D ≥ (1 + m) k_C, D this set and C the other one.

        Args:
            outer: C, of the same dimension.

        Returns:
            The margin, dimensionless; not negative exactly where D ⊆ C.

        Reference: [WL19] (63).

        >>> from asperity import Disk, Rectangle
        >>> Disk(0.5).margin_inside(Rectangle(2.0, 1.0))
        1.0
        """
        return self.scale_inside(outer) - 1.0

    def rotated(self, angle: float) -> StarSet:
        """Return the set turned counter-clockwise about the origin of the plane.

        Args:
            angle: in rad.

        >>> from asperity import Ellipse
        >>> Ellipse(3.0, 1.0).rotated(0.5)
        Ellipse(3.0, 1.0, angle=0.5)
        """
        self._require_plane("rotated")
        return self.mapped(arrays.rotation(arrays.number(angle, "angle")))

    def scaled(self, factor: float) -> StarSet:
        """Return the set {s x : x ∈ C}.

        Args:
            factor: s > 0.

        >>> from asperity import Disk
        >>> Disk(1.5).scaled(2.0)
        Disk(3.0)
        """
        return self.mapped(np.eye(self.dimension) * arrays.positive(factor, "factor"))

    def mapped(self, matrix: ArrayLike) -> Mapped:
        """Return the image {A x : x ∈ C}; see `preimage` for {x : A x ∈ C}.

        Args:
            matrix: regular A, shape ``(p, p)``.

        >>> from asperity import Disk
        >>> float(Disk(1.0).mapped([[3.0, 0.0], [0.0, 1.0]]).radius(0.0))
        3.0
        """
        from asperity.sets.combined import Mapped

        return Mapped(self, matrix)

    def preimage(self, matrix: ArrayLike) -> Mapped:
        """Return the preimage A⁻¹C = {x : A x ∈ C}; y ∈ N_C(A x) exactly where Aᵀy is normal to it.

        Args:
            matrix: regular A, shape ``(p, p)``.

        Reference: [WL19] (9).

        >>> from asperity import Disk
        >>> Disk(1.0).preimage([[2.0, 0.0], [0.0, 1.0]]).radius([0.0]).tolist()
        [0.5]
        """
        return self.mapped(arrays.inverse(matrix, "matrix", self.dimension))

    def save(self, path: str | os.PathLike[str], *, note: str = "") -> None:
        """Write the set to a readable TOML file, from which `load` makes it again to the bit.

        Args:
            path: of the file; it is complete or not there.
            note: free text to keep with it.

        Raises:
            ParameterError: if the set is, or is made of, one of a class that is not asperity's.

        >>> import os, tempfile
        >>> from asperity import Ellipse, StarSet
        >>> path = os.path.join(tempfile.mkdtemp(), "set.toml")
        >>> Ellipse(0.6, 0.2).save(path)
        >>> StarSet.load(path)
        Ellipse(0.6, 0.2)
        """
        from asperity.sets import file

        file.save(self, path, note)

    @classmethod
    def load(cls, path: str | os.PathLike[str]) -> Self:
        """Read a set that `save` has written, or anybody else; nothing in the file is executed.

        Args:
            path: of the file.

        Raises:
            ConfigurationError: with file, line and key of what is wrong.
            ParameterError: if it is a set of another class than the one whose `load` is called;
                ``StarSet.load`` reads all.
        """
        from asperity.sets import file

        found = file.load(path)
        if not isinstance(found, cls):
            raise ParameterError(
                "path",
                f"must hold a set of the class {cls.__name__}, {os.fspath(path)} holds one of the "
                f"class {type(found).__name__}: StarSet.load reads it",
            )
        return found

    def __and__(self, other: StarSet) -> Intersection:
        from asperity.sets.combined import Intersection

        return Intersection((self, other)) if isinstance(other, StarSet) else NotImplemented

    def __or__(self, other: StarSet) -> Union:
        from asperity.sets.combined import Union

        return Union((self, other)) if isinstance(other, StarSet) else NotImplemented

    def __add__(self, other: StarSet) -> MinkowskiSum:
        from asperity.sets.combined import MinkowskiSum

        return MinkowskiSum((self, other)) if isinstance(other, StarSet) else NotImplemented


def checked_set(value: object, argument: str) -> StarSet:
    """Return `value` if it is a set."""
    return arrays.of_kind(value, argument, StarSet, "a set such as Disk or Ellipse")


def same_dimension(
    sets: Iterable[object], argument: str, dimension: int | None = None
) -> tuple[StarSet, ...]:
    """Return the sets, which must have one dimension, by default that of the first."""
    listed = tuple(checked_set(one, argument) for one in sets)
    for one in listed:
        dimension = dimension or one.dimension
        if one.dimension != dimension:
            raise DimensionError(
                argument,
                f"must have dimension {dimension} like the rest, {one!r} has {one.dimension}",
            )
    return listed
