"""Which law a contact of two geoms has, and along which axes."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import KW_ONLY, dataclass, replace
from typing import TYPE_CHECKING, Annotated, Any, TypeAlias

import numpy as np
from numpy.typing import NDArray

import asperity._core as _core
from asperity._base import arrays
from asperity._base.arrays import Array
from asperity._base.value import Fraction, Positive, Record, Vector3, field
from asperity.contact import ContactStepper
from asperity.errors import DimensionError, ParameterError
from asperity.law import FrictionLaw
from asperity.mujoco.model import RowsModel
from asperity.sets import Disk, Ellipse, Ellipsoid
from asperity.system.rigid import friction_maps
from asperity.system.rigid.friction_maps import FrictionFactor

if TYPE_CHECKING:
    import mujoco


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
        normal_restitution: e_N in [0, 1], γ_N⁺ ≥ −e_N γ_N⁻ where the gap closes in the step;
            ``None``: that of the scene.
        friction_factor: where one of the two is a plane geom, `FrictionRegions`, a `FrictionRaster`
            or a function of the position (x₁, x₂) in m along the geom's x- and y-axis: the factor
            of the friction there. ``None``: 1 everywhere.

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
    normal_restitution: Fraction | None = None
    friction_factor: Annotated[FrictionFactor, friction_maps.checked_factor] = None

    def _complete(self, given: dict[str, Any]) -> None:
        dimension = given["law"].dimension
        if dimension not in (2, 3):
            raise DimensionError("law", f"must have dimension 2 or 3, has {dimension}")
        if (dimension == 3) != (given["patch_radius"] is not None):
            raise ParameterError("patch_radius", "goes with a law of dimension 3 and only with one")
        if not given["axis"].any():
            raise ParameterError("axis", "must not vanish")


Laws: TypeAlias = Mapping[Any, FrictionLaw | PairLaw]


Axes: TypeAlias = tuple[Sequence[float], int | None, bool, float]
"""The direction of e₁ in what carries it, which is a geom, a body, numbered behind them, or the
world; whether the slip is that of the first of the pair; the length that multiplies the drilling.
"""


@dataclass(frozen=True, slots=True)
class ContactLaw:
    """The law of a contact: its number, the kind of a row without friction, and its axes.

    Without axes they are MuJoCo's. `factor` is that of the friction over a plane, `flat` the law
    where nothing drills.
    """

    number: int
    dimension: int
    restitution: float
    axes: Axes | None = None
    factor: Callable[[float, float], float] | None = None
    flat: int | None = None


class PairLaws:
    """The laws of a scene: those of the user, by geoms, and those of MuJoCo's coefficients."""

    def __init__(self, rows: RowsModel, laws: Laws | None, restitution: float) -> None:
        self._rows, self._restitution = rows, restitution
        self.have_axes = self.have_factors = False
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
                if pair.friction_factor is not None:
                    raise ParameterError("laws", "name the pairs of a friction_factor, not default")
                self._default = self._made(pair, "world")
                rows.raise_condim(set(range(rows.user.ngeom)), 1 + pair.law.dimension)
                continue
            if not (isinstance(key, tuple) and len(key) == 2):
                raise ParameterError("laws", f"must have pairs of names as keys, got {key!r}")
            if key[0] != key[1] and key[::-1] in given:
                raise ParameterError("laws", f"have {key!r} and the reverse: give one of them")
            named.append((sum(name in rows.names for name in key), key, pair))
        # Pairs of geoms come before those of bodies and win.
        named_by: dict[tuple[int, int], tuple[int, tuple[str, str]]] = {}
        for rank, (first, second), pair in sorted(named, key=lambda entry: -entry[0]):
            made = self._made(pair, first)
            reverse = made
            if made.axes is not None:
                axis, carrier, _, radius = made.axes
                reverse = replace(made, axes=(axis, carrier, True, radius))
            ones, others = self._geoms(first), self._geoms(second)
            self._check(ones, others, (first, second), made)
            rows.raise_condim(ones | others, 1 + pair.law.dimension)
            for a in ones:
                for b in others:
                    by, key = named_by.get((a, b), (rank, (first, second)))
                    if by > rank:
                        continue
                    if key != (first, second):
                        names = f"{rows.names[a]!r} and {rows.names[b]!r}"
                        raise ParameterError(
                            "laws",
                            f"have {key!r} and {(first, second)!r}, both for {names}: give one of "
                            "them, or the pair of geoms",
                        )
                    named_by[a, b] = named_by[b, a] = rank, (first, second)
                    self._pairs[b, a] = reverse
                    self._pairs[a, b] = made

    def of_pair(self, pair: tuple[int, int], friction: Array) -> ContactLaw:
        """Return the law of two geoms, with these coefficients of MuJoCo."""
        law = self._pairs.get(pair)
        if law is None:
            law = self._pairs[pair] = self._default or self._mujoco(pair, friction)
        return law

    def dimension(self, pair: tuple[int, int]) -> int:
        """Return the dimension of the law of two geoms that have touched."""
        return self._pairs[pair].dimension

    def factors(
        self,
        data: mujoco.MjData,
        contacts: NDArray[np.int64],
        pairs: Sequence[tuple[int, int]],
    ) -> Array:
        """Return the factors of the friction of contacts, by their places on planes."""
        found, position = np.ones(len(pairs)), data.contact.pos
        for k, (contact, pair) in enumerate(zip(contacts, pairs, strict=True)):
            factor = self._pairs[pair].factor
            if factor is not None:
                plane = pair[0] if self._rows.is_plane[pair[0]] else pair[1]
                x1, x2, _ = (position[contact] - data.geom_xpos[plane]) @ data.geom_xmat[
                    plane
                ].reshape(3, 3)
                found[k] = arrays.positive(factor(float(x1), float(x2)), "friction_factor")
        return found

    def _check(
        self, ones: set[int], others: set[int], names: tuple[str, str], law: ContactLaw
    ) -> None:
        """Refuse laws of geoms that never touch, and places on what is not a plane."""
        if not any(self._rows.may_touch(a, b) for a in ones for b in others):
            raise ParameterError(
                "laws",
                f"name {names!r}, which MuJoCo never lets touch: by contype and conaffinity, an "
                "exclude, or as parts of one body or of neighbours",
            )
        planes = self._rows.is_plane
        if law.factor is not None and not all(planes[a] or planes[b] for a in ones for b in others):
            raise ParameterError("friction_factor", f"goes with a plane geom, not with {names!r}")

    def _mujoco(self, pair: tuple[int, int], friction: Array) -> ContactLaw:
        dimension = self._rows.condim(*pair) - 1
        if dimension == 0:
            return ContactLaw(ContactStepper.FRICTIONLESS, 0, self._restitution)
        flat = self._numbered(friction[:2]) if dimension == 3 else None
        number = self._numbered(friction[:dimension])
        return ContactLaw(number, dimension, self._restitution, flat=flat)

    def _numbered(self, friction: Array) -> int:
        """Return the number of the law with these coefficients."""
        axes = tuple(friction.tolist())
        number = self._own.get(axes)
        if number is None:
            number = self._own[axes] = len(self.laws)
            if len(axes) == 3:
                law = FrictionLaw.associated(Ellipsoid(axes))
            elif axes[0] == axes[1]:
                law = FrictionLaw.isotropic(axes[0])
            else:
                law = FrictionLaw.associated(Ellipse(*axes))
            self.laws.append(law)
        return number

    def _made(self, pair: PairLaw, first: str) -> ContactLaw:
        name = first if pair.carried_by is None else pair.carried_by
        self.laws.append(pair.law)
        number, radius = len(self.laws) - 1, pair.patch_radius or 1.0
        carrier = None
        if name != "world":
            kind, carrier = self._carrier(name)
            carrier += self._rows.user.ngeom if kind == "body" else 0
        given, factor = pair.normal_restitution, pair.friction_factor
        made = ContactLaw(number, pair.law.dimension, self._restitution if given is None else given)
        if factor is not None:
            self.have_factors = True
            if not callable(factor):
                factor = _core.FrictionFactor(friction_maps.core_data(factor)).at
        elif isinstance(pair.law.reservoir, Disk) and isinstance(pair.law.direction, Disk):
            return made
        self.have_axes = True
        axis = (pair.axis / np.linalg.norm(pair.axis)).tolist()
        return replace(made, axes=(axis, carrier, False, radius), factor=factor)

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
