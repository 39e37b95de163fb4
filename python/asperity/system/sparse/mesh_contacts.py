"""Contacts of the nodes of a mesh with a moving surface."""

from __future__ import annotations

from dataclasses import KW_ONLY
from typing import Annotated, Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from asperity._base import arrays
from asperity._base.arrays import Array
from asperity._base.value import AnyArray, AnyArrayOrNone, Given, Record, field, unchecked
from asperity.errors import DimensionError, ParameterError
from asperity.law import FrictionLaw
from asperity.system.contacts import scaled_law


class MeshContacts(Record):
    """Unilateral contacts of m nodes with a rigid moving surface: g_N = n·q + g₀, γ = T(q̇ − v).

    The law's axes e₁, e₂ are the rows of T: `tangents` projected on the surface, and n × e₁.

    Args:
        law: friction law of dimension 2.
        coordinates: numbers of the displacements x, y, z of each node among the coordinates of the
            system, shape ``(m, 3)``.
        velocity: v of the surface in m/s at each node, shape ``(3,)`` or ``(m, 3)``; its part along
            n is left out, as the surface stays in its place.
        normals: n, from the surface into the body, shape ``(3,)`` or ``(m, 3)``, of any length.
        tangents: directions of e₁, shape ``(3,)`` or ``(m, 3)``, of any length.
        gap: g₀ in m, a number or shape ``(m,)``.

    Raises:
        DimensionError, ParameterError: naming the argument.

    Reference: [WL19] (23).

    >>> import numpy as np
    >>> from asperity import FrictionLaw, MeshContacts
    >>> nodes = np.array([4, 7])
    >>> MeshContacts(
    ...     FrictionLaw.isotropic(0.4),
    ...     coordinates=3 * nodes[:, None] + np.arange(3),
    ...     velocity=[5.0, 0.0, 0.0],
    ... ).count
    2
    """

    law: FrictionLaw
    _: KW_ONLY
    coordinates: Annotated[Given[ArrayLike, NDArray[np.intp]], unchecked]
    velocity: AnyArray
    normals: AnyArrayOrNone = field(default=(0.0, 0.0, 1.0))
    tangents: AnyArrayOrNone = field(default=(1.0, 0.0, 0.0))
    gap: AnyArrayOrNone = field(default=0.0)
    axes: Array = field(init=False)
    """Unit vectors e₁, e₂ and n of each node, shape ``(m, 3, 3)``."""

    @classmethod
    def on_disc(
        cls,
        law: FrictionLaw,
        *,
        coordinates: ArrayLike,
        positions: ArrayLike,
        rate: ArrayLike,
        centre: ArrayLike = (0.0, 0.0, 0.0),
        circumferential: bool = False,
        **others: Any,
    ) -> MeshContacts:
        """Make contacts with a rotating disc, v = Ω × (x − c).

        Args:
            law: friction law of dimension 2.
            coordinates: as of the class.
            positions: x of the nodes in m, shape ``(m, 3)``.
            rate: Ω in rad/s, shape ``(3,)``.
            centre: c in m, a point of the axis of rotation.
            circumferential: whether e₁ is along v at each node, as of a disc with marks of
                grinding along circles; otherwise it is `tangents`.
            others: further arguments of the class.

        >>> import numpy as np
        >>> from asperity import FrictionLaw, MeshContacts
        >>> MeshContacts.on_disc(
        ...     FrictionLaw.isotropic(0.4),
        ...     coordinates=[[0, 1, 2]],
        ...     positions=[[0.1, 0.0, 0.0]],
        ...     rate=[0.0, 0.0, 50.0],
        ... ).velocity.tolist()
        [[0.0, 5.0, 0.0]]
        """
        places = arrays.array(positions, "positions", (None, 3))
        arms = places - arrays.array(centre, "centre", (3,))
        velocity = np.cross(arrays.array(rate, "rate", (3,)), arms)
        if circumferential:
            if "tangents" in others:
                raise ParameterError("tangents", "are those of circles if circumferential")
            others["tangents"] = velocity
        return cls(law, coordinates=coordinates, velocity=velocity, **others)

    @property
    def count(self) -> int:
        """Number m of contacts."""
        return len(self.coordinates)

    @property
    def slip(self) -> Array:
        """γ = −Tv of the node at rest in m/s, shape ``(m, 2)``."""
        return -np.einsum("mij,mj->mi", self.axes[:, :2], self.velocity)

    def _turned(self, friction: float, phi: float, speed: float) -> MeshContacts:
        """Return contacts with C times a factor and the velocity turned about n and scaled."""
        n = self.axes[:, 2]
        along = np.sum(n * self.velocity, axis=1)[:, None] * n
        v, across = self.velocity - along, np.cross(n, self.velocity)
        velocity = speed * (np.cos(phi) * v + np.sin(phi) * across)
        return self.replace(law=scaled_law(self.law, friction), velocity=velocity + along)

    def _complete(self, given: dict[str, Any]) -> None:
        if given["law"].dimension != 2:
            raise DimensionError("law", f"must have dimension 2, has {given['law'].dimension}")
        numbers = arrays.array(given["coordinates"], "coordinates", (None, 3))
        wrong = (
            (numbers != np.floor(numbers)) | (numbers < 0) | (numbers > np.iinfo(np.intp).max / 2)
        )
        if wrong.any():
            raise ParameterError("coordinates", "must be whole numbers from 0 on")
        whole = numbers.astype(np.intp)
        if len(np.unique(whole)) < whole.size:
            raise ParameterError("coordinates", "must name every coordinate once")
        given["coordinates"] = whole
        m = len(whole)
        for name in ("velocity", "normals", "tangents"):
            given[name] = _each(given[name], name, (m, 3))
        given["gap"] = _each(given["gap"], "gap", (m,))

    def _derive(self) -> None:
        lengths = np.linalg.norm(self.normals, axis=1)
        if not (lengths > 0.0).all():
            raise ParameterError("normals", "must not vanish")
        normals = self.normals / lengths[:, None]
        along = self.tangents - np.sum(self.tangents * normals, axis=1)[:, None] * normals
        sizes = np.linalg.norm(along, axis=1)
        if not (sizes > 1e-6 * np.linalg.norm(self.tangents, axis=1)).all():
            raise ParameterError("tangents", "must not be along the normals")
        first = along / sizes[:, None]
        self._keep(axes=np.stack([first, np.cross(normals, first), normals], axis=1))


def _each(value: ArrayLike, argument: str, shape: tuple[int, ...]) -> Array:
    """Return one value per node."""
    given = arrays.constant(value, argument, [None] * np.ndim(value))
    if given.shape not in (shape, shape[1:]):
        raise DimensionError(argument, f"must have shape {shape[1:]} or {shape}, got {given.shape}")
    return np.array(np.broadcast_to(given, shape))
