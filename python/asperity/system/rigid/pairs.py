"""Pairs of a body and what it touches; each stands for one contact or, for a box, for several."""

from __future__ import annotations

from dataclasses import KW_ONLY
from typing import Annotated, Any, ClassVar, Self

import numpy as np
from numpy.typing import ArrayLike

from asperity._base import arrays
from asperity._base.arrays import Array
from asperity._base.value import (
    AnyArray,
    AnyArrayOrNone,
    Fraction,
    Given,
    Index,
    NonNegative,
    Positive,
    field,
    of_kind,
    unchecked,
)
from asperity.errors import DimensionError, ParameterError
from asperity.law import FrictionLaw
from asperity.system.contacts import AnyContact, Name
from asperity.system.rigid.bodies import positive_vector
from asperity.system.rigid.surfaces import BodyAxis, Frame, Line, Plane, checked_frame


class Pair(AnyContact):
    """Base of the pairs.

    Attributes:
        law: friction law: p = 1 in the plane; in space p = 2, or 3 with drilling.
        normal_force: prescribed λ_N in N of each contact; ``None``: unilateral.
        normal_restitution: e_N in [0, 1].
        tangential_restitution: e_T in [0, 1].
        patch_radius: R in m of the contact patch of a law with drilling, whose slip is
            (γ₁, γ₂, R ω_n) and whose third force is the torque divided by R.
        name: of the pair, from which those of its contacts follow; ``None``: from the bodies'.
    """

    _kind: ClassVar[str]

    body: Index
    _: KW_ONLY
    law: FrictionLaw
    normal_restitution: Fraction = 0.0
    tangential_restitution: Fraction = 0.0
    normal_force: NonNegative | None = None
    patch_radius: Positive | None = None
    name: Name = None

    def _complete(self, given: dict[str, Any]) -> None:
        if (given["law"].dimension == 3) != (given["patch_radius"] is not None):
            raise ParameterError("patch_radius", "goes with a law of dimension 3 and only with one")

    @property
    def planar(self) -> bool:
        """Whether the pair is one of planar bodies."""
        return self.law.dimension == 1

    @property
    def contacts(self) -> int:
        """Number of contacts."""
        return 1

    def _core_data(self) -> dict[str, Any]:
        return {**super()._core_data(), "kind": self._kind}


def _body_axis(value: BodyAxis | None, argument: str) -> BodyAxis:
    axis = BodyAxis((1.0, 0.0, 0.0)) if value is None else value
    return arrays.of_kind(axis, argument, BodyAxis, "a BodyAxis between spheres")


class PlanePair(Pair):
    """Base of the pairs of a body and a plane, or a line for planar bodies."""

    _: KW_ONLY
    plane: Annotated[Plane | Line, of_kind(Plane | Line, "a Plane or a Line")]
    frame: Annotated[Frame, unchecked] = "plane"

    def _complete(self, given: dict[str, Any]) -> None:
        law, plane = given["law"], given["plane"]
        allowed = (1,) if isinstance(plane, Line) else (2, 3)
        if law.dimension not in allowed:
            words, kind = " or ".join(map(str, allowed)), type(plane).__name__
            raise DimensionError(
                "law", f"must have dimension {words} on a {kind}, has {law.dimension}"
            )
        if plane.body == given["body"]:
            raise ParameterError(
                "plane", f"must not be fixed to the body {plane.body} that touches it"
            )
        given["frame"] = checked_frame(given["frame"], plane)
        super()._complete(given)

    def _core_data(self) -> dict[str, Any]:
        frame = self.frame.axis if isinstance(self.frame, BodyAxis) else self.frame
        return {**super()._core_data(), "plane": self.plane._core_data(), "frame": frame}


class PointPlane(PlanePair):
    """A point of a body that touches a plane.

    Args:
        body: number of the body.
        point: in the body's axes from its centre of mass in m, shape ``(3,)``, planar ``(2,)``.
        plane: `Plane`, or `Line` for planar bodies.
        law: friction law: p = 1 on a line; on a plane p = 2, or 3 with drilling.
        frame: what carries the law's axes e₁, e₂: ``"plane"``, ``"polar"``, a `BodyAxis`, or a
            function of the position (x₁, x₂) in the plane that returns the angle of e₁ in rad.
        normal_restitution: e_N in [0, 1].
        tangential_restitution: e_T in [0, 1].
        normal_force: prescribed λ_N ≥ 0 in N, which pushes the body away like any force: without
            a load against it the body moves off. ``None``: unilateral.
        patch_radius: R > 0 in m, with p = 3 and only then.
        name: of the pair; its contacts are named after it. Default: after the bodies.

    Raises:
        DimensionError, ParameterError: naming the argument.

    >>> from asperity import FrictionLaw, Plane, PointPlane
    >>> PointPlane(
    ...     0, point=(0.0, 0.0, -0.1), plane=Plane(), law=FrictionLaw.isotropic(0.3)
    ... ).contacts
    1
    """

    _kind = "point_plane"

    _: KW_ONLY
    point: AnyArray

    def _complete(self, given: dict[str, Any]) -> None:
        super()._complete(given)
        given["point"] = _vector(given["point"], "point", len(given["plane"].point))

    @classmethod
    def cylinder(
        cls,
        body: int,
        *,
        radius: float,
        height: float,
        plane: Plane,
        law: FrictionLaw,
        points: int = 12,
        normal_restitution: float = 0.0,
        tangential_restitution: float = 0.0,
    ) -> tuple[Self, ...]:
        """Return points on both edges of a cylinder: it stands, slides and tips on a plane.

        On its side it rests, but it does not roll there as a round one does.

        Args:
            body: number of the body, whose third axis is that of the cylinder.
            radius: R > 0 in m.
            height: h > 0 in m.
            plane: that it touches.
            law: as of `PointPlane`.
            points: number of points of each edge.
            normal_restitution: e_N in [0, 1].
            tangential_restitution: e_T in [0, 1].
        """
        count, half = arrays.count(points, "points", 3), 0.5 * arrays.positive(height, "height")
        edge = arrays.unit_vectors(2.0 * np.pi * np.arange(count) / count)
        edge *= arrays.positive(radius, "radius")
        return tuple(
            cls(
                body,
                point=(*place, z),
                plane=plane,
                law=law,
                normal_restitution=normal_restitution,
                tangential_restitution=tangential_restitution,
            )
            for z in (-half, half)
            for place in edge.tolist()
        )


class SpherePlane(PlanePair):
    """A sphere of a body, in a plane a disk, that touches a plane or a line.

    Args:
        body: number of the body.
        radius: of the sphere in m, > 0.
        plane: `Plane`, or `Line` for planar bodies.
        center: of the sphere, in the body's axes from its centre of mass in m. Default 0.
        law, frame, normal_restitution, tangential_restitution, normal_force, patch_radius, name: as
            of `PointPlane`, of each contact.

    Raises:
        DimensionError, ParameterError: naming the argument.

    >>> from asperity import FrictionLaw, Line, SpherePlane
    >>> SpherePlane(
    ...     0, radius=0.1, plane=Line(), law=FrictionLaw.isotropic(0.3, dimension=1)
    ... ).center.tolist()
    [0.0, 0.0]
    """

    _kind = "sphere_plane"

    _: KW_ONLY
    radius: Positive
    center: AnyArrayOrNone = field(default=None)

    def _complete(self, given: dict[str, Any]) -> None:
        super()._complete(given)
        given["center"] = _vector(given["center"], "center", len(given["plane"].point))


class BoxPlane(PlanePair):
    """A box of a body whose corners touch a plane: 8 contacts, in a plane 4.

    Args:
        body: number of the body, in whose axes the box is centred.
        half_sizes: half of its edges in m, shape ``(3,)``, planar ``(2,)``.
        plane: `Plane`, or `Line` for planar bodies.
        law, frame, normal_restitution, tangential_restitution, normal_force, patch_radius, name: as
            of `PointPlane`, of each contact.

    Raises:
        DimensionError, ParameterError: naming the argument.

    >>> from asperity import BoxPlane, FrictionLaw, Plane
    >>> BoxPlane(
    ...     0, half_sizes=(0.1, 0.2, 0.3), plane=Plane(), law=FrictionLaw.isotropic(0.3)
    ... ).contacts
    8
    """

    _kind = "box_plane"

    _: KW_ONLY
    half_sizes: AnyArray

    def _complete(self, given: dict[str, Any]) -> None:
        super()._complete(given)
        size = len(given["plane"].point)
        given["half_sizes"] = positive_vector(given["half_sizes"], "half_sizes", size)

    @property
    def contacts(self) -> int:
        """Number of corners."""
        return int(2 ** len(self.half_sizes))


class SphereSphere(Pair):
    """Two spheres of different bodies, in a plane disks; the normal points to the first.

    Args:
        body: number of the first body.
        radius: of its sphere in m, > 0.
        other: number of the second body.
        other_radius: of the second sphere in m, > 0.
        law: friction law: p = 1 for planar bodies; in space p = 2, or 3 with drilling.
        center: of the first sphere, in its body's axes from the centre of mass in m. Default 0.
        other_center: of the second sphere, likewise.
        frame: axis of the first body that carries the law's e₁. Default ``BodyAxis((1, 0, 0))``,
            which does not matter to isotropic laws.
        normal_restitution, tangential_restitution, normal_force, patch_radius, name: as of
            `PointPlane`.

    Raises:
        DimensionError, ParameterError: naming the argument.

    >>> from asperity import FrictionLaw, SphereSphere
    >>> SphereSphere(
    ...     0, radius=0.1, other=1, other_radius=0.2, law=FrictionLaw.isotropic(0.3)
    ... ).contacts
    1
    """

    _kind = "sphere_sphere"

    _: KW_ONLY
    radius: Positive
    other: Index
    other_radius: Positive
    center: AnyArrayOrNone = field(default=None)
    other_center: AnyArrayOrNone = field(default=None)
    frame: Annotated[Given[BodyAxis | None, BodyAxis], _body_axis] = field(default=None)

    def _complete(self, given: dict[str, Any]) -> None:
        super()._complete(given)
        if given["body"] == given["other"]:
            raise ParameterError("other", f"must be another body than {given['body']}")
        size = 2 if given["law"].dimension == 1 else 3
        for name in ("center", "other_center"):
            given[name] = _vector(given[name], name, size)

    def _core_data(self) -> dict[str, Any]:
        return {**super()._core_data(), "frame": self.frame.axis}


def _vector(value: ArrayLike | None, argument: str, size: int) -> Array:
    return arrays.array(np.zeros(size) if value is None else value, argument, (size,))
