"""Which law a contact of two geoms has, and along which axes."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import KW_ONLY, dataclass, replace
from typing import Any, TypeAlias

import numpy as np
from numpy.typing import NDArray

from asperity._base import arrays
from asperity._base.arrays import Array
from asperity._base.value import Positive, Record, Vector3, field
from asperity.contact import ContactStepper
from asperity.errors import DimensionError, ParameterError
from asperity.law import FrictionLaw
from asperity.mujoco.model import RowsModel
from asperity.sets import Disk, Ellipse, Ellipsoid


class PairLaw(Record):
    """The friction law of two geoms, with what carries its axes.

    The slip is that of the second of the pair relative to the first, n is the normal from the first
    to the second, e₁ the axis projected on the surface and e₂ = n × e₁.

    Args:
        law: of dimension p = 2, or 3 with drilling.
        axis: e₁ in the axes of what carries it, of any length, shape ``(3,)``; where it is parallel
            to the normal, the next axis takes its place.
        carried_by: name of the geom or body, or ``"world"``; default: the first of the pair, for
            ``"default"`` the world. The axes of a mesh's geom are MuJoCo's principal ones: name
            its body.
        patch_radius: R in m of the contact patch of a law with drilling, whose slip is
            (γ₁, γ₂, R ω_n).

    >>> import asperity as asp
    >>> from asperity.mujoco import PairLaw
    >>> grooved = asp.FrictionLaw.associated(asp.Ellipse(0.6, 0.2))
    >>> PairLaw(grooved, axis=(0.0, 1.0, 0.0), carried_by="plate").patch_radius is None
    True
    """

    law: FrictionLaw
    _: KW_ONLY
    axis: Vector3 = field(default=(1.0, 0.0, 0.0))
    carried_by: str | None = None
    patch_radius: Positive | None = None

    def _complete(self, given: dict[str, Any]) -> None:
        dimension = given["law"].dimension
        if dimension not in (2, 3):
            raise DimensionError("law", f"must have dimension 2 or 3, has {dimension}")
        if (dimension == 3) != (given["patch_radius"] is not None):
            raise ParameterError("patch_radius", "goes with a law of dimension 3 and only with one")
        if not given["axis"].any():
            raise ParameterError("axis", "must not vanish")


Laws: TypeAlias = Mapping[Any, FrictionLaw | PairLaw]


@dataclass(frozen=True, slots=True)
class Axes:
    """The direction of e₁ in what carries it: geoms, bodies numbered behind them, or the world."""

    axis: Sequence[float]
    carrier: int | None
    is_reversed: bool = False


@dataclass(frozen=True, slots=True)
class ContactLaw:
    """The law of a contact: its number, the kind of a row without friction, and its axes.

    Without axes they are MuJoCo's. The third slip is the radius times the drilling.
    """

    number: int
    dimension: int
    axes: Axes | None = None
    radius: float = 1.0


class PairLaws:
    """The laws of a scene: those of the user, by geoms, and those of MuJoCo's coefficients."""

    def __init__(self, rows: RowsModel, laws: Laws | None) -> None:
        self._rows = rows
        self.laws: list[FrictionLaw] = []
        self._default: ContactLaw | None = None
        self._pairs: dict[tuple[int, int], ContactLaw] = {}
        self._own: dict[tuple[float, ...], int] = {}
        given = {} if laws is None else dict(arrays.of_kind(laws, "laws", Mapping, "a mapping"))
        named: list[tuple[int, tuple[str, str], PairLaw]] = []
        for key, value in given.items():
            pair = value if isinstance(value, PairLaw) else None
            if pair is None:
                arrays.of_kind(value, f"laws[{key!r}]", FrictionLaw, "a FrictionLaw or a PairLaw")
                pair = PairLaw(value)
            if key == "default":
                self._default = self._made(pair, "world")
                rows.raise_condim(set(range(rows.user.ngeom)), 1 + pair.law.dimension)
                continue
            if not (isinstance(key, tuple) and len(key) == 2):
                raise ParameterError("laws", f"must have pairs of names as keys, got {key!r}")
            if key[0] != key[1] and key[::-1] in given:
                raise ParameterError("laws", f"have {key!r} and the reverse: give one of them")
            named.append((sum(name in rows.names for name in key), key, pair))
        # Pairs of geoms come after those of bodies and win.
        for _, (first, second), pair in sorted(named, key=lambda entry: entry[0]):
            made = self._made(pair, first)
            reverse = replace(made, axes=made.axes and replace(made.axes, is_reversed=True))
            ones, others = self._geoms(first), self._geoms(second)
            rows.raise_condim(ones | others, 1 + pair.law.dimension)
            for a in ones:
                for b in others:
                    self._pairs[b, a] = reverse
                    self._pairs[a, b] = made

    def of_contacts(
        self, pairs: list[list[int]], friction: Array, numbers: NDArray[np.int64]
    ) -> list[ContactLaw]:
        """Return the laws of contacts of two geoms, with MuJoCo's coefficients at these numbers."""
        found: list[ContactLaw] = []
        for (one, other), number in zip(pairs, numbers, strict=True):
            law = self._pairs.get((one, other))
            if law is None:
                law = self._default or self._mujoco((one, other), friction[number])
                self._pairs[one, other] = law
            found.append(law)
        return found

    def _mujoco(self, pair: tuple[int, int], friction: Array) -> ContactLaw:
        dimension = self._rows.condim(*pair) - 1
        if dimension == 0:
            return ContactLaw(ContactStepper.FRICTIONLESS, 0)
        axes = tuple(friction[:dimension].tolist())
        number = self._own.get(axes)
        if number is None:
            number = self._own[axes] = len(self.laws)
            if dimension == 3:
                law = FrictionLaw.associated(Ellipsoid(axes))
            elif axes[0] == axes[1]:
                law = FrictionLaw.isotropic(axes[0])
            else:
                law = FrictionLaw.associated(Ellipse(*axes))
            self.laws.append(law)
        return ContactLaw(number, dimension)

    def _made(self, pair: PairLaw, first: str) -> ContactLaw:
        name = first if pair.carried_by is None else pair.carried_by
        self.laws.append(pair.law)
        number, radius = len(self.laws) - 1, pair.patch_radius or 1.0
        carrier = None
        if name != "world":
            kind, carrier = self._carrier(name)
            carrier += self._rows.user.ngeom if kind == "body" else 0
        axes = Axes((pair.axis / np.linalg.norm(pair.axis)).tolist(), carrier)
        if isinstance(pair.law.reservoir, Disk) and isinstance(pair.law.direction, Disk):
            return ContactLaw(number, pair.law.dimension)
        return ContactLaw(number, pair.law.dimension, axes, radius)

    def _carrier(self, name: str) -> tuple[str, int]:
        if name in self._rows.names:
            return "geom", self._rows.names.index(name)
        mj, model = self._rows.mj, self._rows.user
        number = int(mj.mj_name2id(model, mj.mjtObj.mjOBJ_BODY, str(name)))
        if number < 0:
            raise ParameterError("laws", f"name {name!r}, which no geom or body of the model has")
        return "body", number

    def _geoms(self, name: str) -> set[int]:
        kind, number = self._carrier(name)
        if kind == "geom":
            return {number}
        geoms = set(np.flatnonzero(self._rows.user.geom_bodyid == number).tolist())
        if not geoms:
            raise ParameterError("laws", f"name body {name!r}, which has no geoms")
        return geoms
