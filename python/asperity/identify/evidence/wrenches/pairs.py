"""Pairs of wrench and twist that a law of a patch is fitted to."""

from __future__ import annotations

from dataclasses import KW_ONLY
from typing import Annotated, Any

import numpy as np
from numpy.typing import ArrayLike

from asperity._base import arrays
from asperity._base.arrays import Array
from asperity._base.value import AnyArray, Given, OptionalArray, Record, field, shaped
from asperity.errors import FitError, ParameterError

MOST_AGAINST = 0.5
"""Share of the pairs whose power may be negative: more of them are of the other sign."""
# Sets of friction laws are larger than this, and smaller than its inverse.
_SMALLEST = 1e-50
# Signs that may be wrong, the likely ones first.
_SIGNS = {
    "all signs turned": (-1.0, -1.0, -1.0),
    "the sign of the torque turned": (1.0, 1.0, -1.0),
    "the signs of both forces turned": (-1.0, -1.0, 1.0),
    "the sign of the first force turned": (-1.0, 1.0, 1.0),
    "the sign of the second force turned": (1.0, -1.0, 1.0),
}


class Pairs(Record):
    """Wrenches that a body exerts on the ground, −λ, with its twists, in the body's axes.

    Args:
        wrench: (F₁, F₂, τ/ℓ), per unit normal force or in newtons, shape ``(n, 3)``.
        twist: (v₁, v₂, ω ℓ), of any scale, shape ``(n, 3)``.
        angle: of the body's axes from those of the ground in rad, shape ``(n,)``; None if it is
            not known, where laws of the body alone can be fitted.
        places: of known support points over ℓ, shape ``(n, K, 2)``; None if they are not known.
        loads: normal forces of these, shape ``(n, K)``; likewise.
    """

    wrench: Annotated[Given[ArrayLike, Array], shaped(None, 3)]
    twist: AnyArray
    _: KW_ONLY
    angle: OptionalArray = field(default=None)
    places: OptionalArray = field(default=None)
    loads: OptionalArray = field(default=None)
    along: Array = field(init=False)
    """The twists divided by their sizes."""

    def _complete(self, given: dict[str, Any]) -> None:
        shapes = {"twist": (3,), "angle": (), "places": (None, 2), "loads": (None,)}
        for name, rest in shapes.items():
            if given[name] is not None:
                given[name] = arrays.array(given[name], name, (len(given["wrench"]), *rest))
        sizes = arrays.lengths(given["twist"])
        if len(sizes) and not sizes.min() > 0.0:
            at = int(sizes.argmin())
            raise ParameterError("twist", f"must not vanish, does so in row {at}: leave it out")

    def _derive(self) -> None:
        # The force does not depend on the size of a twist: equal ones keep derivatives comparable.
        self._keep(along=self.twist / arrays.lengths(self.twist)[:, None])

    def __len__(self) -> int:
        return len(self.wrench)

    def __getitem__(self, rows: Array) -> Pairs:
        def some(values: Array | None) -> Array | None:
            return None if values is None else values[rows]

        return Pairs(
            self.wrench[rows],
            self.twist[rows],
            angle=some(self.angle),
            places=some(self.places),
            loads=some(self.loads),
        )

    @property
    def points(self) -> int:
        """Number of known support points."""
        return 0 if self.places is None else self.places.shape[1]

    def at(self, twist: Array) -> Pairs:
        """Return pairs of other twists, of any scale, without wrenches."""
        return self.replace(wrench=np.zeros_like(twist), twist=twist)

    def to_ground(self, vectors: Array) -> Array:
        """Return vectors ``(n, ..., p)`` in the ground's axes; as they are without angles."""
        return vectors if self.angle is None else in_ground(vectors, self.angle)

    def to_body(self, vectors: Array) -> Array:
        """Return vectors ``(n, ..., p)`` in the body's axes; as they are without angles."""
        return vectors if self.angle is None else in_ground(vectors, -self.angle)

    def check(self, parameters: int) -> None:
        """Refuse pairs that cannot tell a law of so many parameters, or are of the other sign."""
        if 3 * len(self) <= parameters:
            raise FitError(
                f"wrench: {len(self)} pairs do not tell {parameters} parameters, record more"
            )
        largest = float(np.abs(self.wrench).max())
        if not largest > 0.0:
            raise FitError("wrench: must not vanish in all pairs: no law follows from it")
        if not _SMALLEST < largest < 1.0 / _SMALLEST:
            raise FitError(
                f"wrench: must be between {_SMALLEST:.0e} and {1.0 / _SMALLEST:.0e} per normal "
                f"force, is up to {largest:.2g}"
            )
        against = self.against
        if against > MOST_AGAINST:
            meant = {
                words: self.replace(wrench=self.wrench * signs).against
                for words, signs in _SIGNS.items()
            }
            remedy = min(meant, key=lambda words: meant[words])
            raise FitError(
                f"wrench: the power of {against:.0%} of the pairs is negative, with {remedy} of "
                f"{meant[remedy]:.0%}: give the wrench that the body exerts on the ground, which "
                "is minus the friction on the body"
            )

    @property
    def against(self) -> float:
        """Share of the pairs whose power is negative."""
        return float(((self.wrench * self.twist).sum(axis=1) < 0.0).mean())


def in_ground(vectors: Array, angle: Array) -> Array:
    """Return plane parts of vectors ``(n, ..., p)`` turned from the body's axes by angles."""
    shape = (len(angle),) + (1,) * (vectors.ndim - 2)
    c, s = np.cos(angle).reshape(shape), np.sin(angle).reshape(shape)
    result = vectors.copy()
    result[..., 0] = c * vectors[..., 0] - s * vectors[..., 1]
    result[..., 1] = s * vectors[..., 0] + c * vectors[..., 1]
    return result
