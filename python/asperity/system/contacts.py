"""Contacts of a system: what they obey, and where constant, how they move."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import KW_ONLY
from typing import Annotated, Any, Protocol, Self, TypeAlias, TypeVar

import numpy as np

from asperity._base import arrays
from asperity._base.value import (
    AnyArray,
    AnyArrayOrNone,
    Fraction,
    NonNegative,
    Number,
    OptionalArray,
    Record,
    field,
)
from asperity.errors import DimensionError, ParameterError
from asperity.law import FrictionLaw
from asperity.system import labels


class _Obeying(Protocol):
    """A contact or a pair."""

    @property
    def law(self) -> FrictionLaw: ...

    def replace(self, **changes: Any) -> Self: ...


_Part = TypeVar("_Part", bound=_Obeying)


Name: TypeAlias = Annotated[str | None, labels.name]


class AnyContact(Record):
    """What a contact obeys."""

    law: FrictionLaw = field(init=False)
    normal_force: float | None = field(init=False)

    @property
    def unilateral(self) -> bool:
        """Whether the contact can open."""
        return self.normal_force is None

    def _core_data(self) -> dict[str, Any]:
        return {**self._parameters, "law": self.law._core}


class ContactLaw(AnyContact):
    """The laws of one contact of a `System`; its kinematics are the system's methods.

    Args:
        law: friction law.
        normal_force: prescribed λ_N ≥ 0 in N; ``None``: unilateral, with ``normal`` and ``gap``.
        normal_restitution: e_N in [0, 1].
        tangential_restitution: e_T in [0, 1].
        name: of the contact, in tables and messages; by default its number.

    >>> from asperity import ContactLaw, FrictionLaw
    >>> ContactLaw(FrictionLaw.isotropic(0.3), normal_force=9.81)
    ContactLaw(FrictionLaw(Disk(0.3), Disk(0.3)), normal_force=9.81)
    """

    law: FrictionLaw
    _: KW_ONLY
    normal_force: NonNegative | None = None
    normal_restitution: Fraction = 0.0
    tangential_restitution: Fraction = 0.0
    name: Name = None


class Contact(AnyContact):
    """A contact with constant directions: γ = Wᵀu + χ, g_N = w_Nᵀq + g₀.

    Exactly one of `normal_force` (prescribed) and `normal` (unilateral) has to be given.

    Args:
        law: friction law of dimension p.
        direction: W, shape ``(n, p)``; ``(n,)`` will do for p = 1. May be a sparse array of SciPy,
            as may `normal`; both are held in full.
        normal_force: prescribed λ_N ≥ 0 in N.
        normal: w_N of a unilateral contact, shape ``(n,)``.
        gap: g₀, the gap of a unilateral contact at q = 0 in m.
        velocity: χ in m/s, shape ``(p,)``; a belt moving with v has χ = −v. Default 0.
        normal_restitution: e_N in [0, 1].
        tangential_restitution: e_T in [0, 1].
        name: of the contact, in tables and messages; by default its number.

    Reference: [WL19] (23), with +χ.

    >>> from asperity import Contact, FrictionLaw
    >>> Contact(
    ...     FrictionLaw.isotropic(0.3, dimension=1), direction=[1.0, 0.0], normal_force=2.0
    ... ).direction
    array([[1.],
           [0.]])
    """

    law: FrictionLaw
    _: KW_ONLY
    direction: AnyArray
    normal_force: NonNegative | None = None
    normal: OptionalArray = field(default=None)
    gap: Number = 0.0
    velocity: AnyArrayOrNone = field(default=None)
    normal_restitution: Fraction = 0.0
    tangential_restitution: Fraction = 0.0
    name: Name = None

    def _complete(self, given: dict[str, Any]) -> None:
        law, normal, velocity = given["law"], given["normal"], given["velocity"]
        if hasattr(normal, "toarray"):
            normal = normal.toarray().ravel()
        if (given["normal_force"] is None) == (normal is None):
            raise ParameterError(
                "normal_force", "give either normal_force (prescribed) or normal (unilateral)"
            )
        if normal is None and given["gap"]:
            raise ParameterError("gap", "needs a unilateral contact: give normal")
        columns = given["direction"]
        columns = columns.toarray() if hasattr(columns, "toarray") else columns
        columns = arrays.array(columns, "direction")
        if columns.ndim == 1 and law.dimension == 1:
            columns = columns[:, None]
        given["direction"] = arrays.array(columns, "direction", (None, law.dimension))
        if normal is not None:
            given["normal"] = arrays.array(normal, "normal", (len(columns),))
        belt = np.zeros(law.dimension) if velocity is None else velocity
        given["velocity"] = arrays.constant(belt, "velocity", (law.dimension,))

    def _turned(self, friction: float, phi: float, speed: float) -> Contact:
        """Return a contact with C times a factor and its surface's velocity turned and scaled."""
        velocity, p = speed * self.velocity, self.law.dimension
        if phi and p != 2:
            raise DimensionError("phi", f"turns planar sliding, a contact has {p} directions")
        velocity = arrays.rotation(phi) @ velocity if phi else velocity
        return self.replace(law=scaled_law(self.law, friction), velocity=velocity)


def scaled_law(law: FrictionLaw, factor: float) -> FrictionLaw:
    """Return a law whose forces are those of another times a factor."""
    if factor == 1.0:
        return law
    sets = {name: law._parameters[name].scaled(factor) for name in ("reservoir", "direction")}
    return law.replace(**sets)


def relawed(
    parts: Sequence[_Part],
    law: FrictionLaw,
    chosen: int | str | Sequence[int | str] | None,
    argument: str,
) -> tuple[_Part, ...]:
    """Return contacts or pairs with another law at those chosen by number or name."""
    names = [getattr(part, "name", None) for part in parts]
    wanted = set(range(len(parts)))
    if chosen is not None:
        one = isinstance(chosen, int | str | np.integer)
        given: Sequence[Any] = [chosen] if one else arrays.several(chosen, argument)
        wanted = {_number(each, names, argument) for each in given}
    if not wanted:
        raise ParameterError(argument, "must name one whose law is to change, there is none")
    for number in wanted:
        known = parts[number].law
        if isinstance(law, FrictionLaw) and law.dimension != known.dimension:
            raise DimensionError(
                "law",
                f"must have {known.dimension} as its dimension, as the law before, has "
                f"{law.dimension}",
            )
    return tuple(
        part.replace(law=law) if number in wanted else part for number, part in enumerate(parts)
    )


def _number(chosen: Any, names: list[str | None], argument: str) -> int:
    if isinstance(chosen, str):
        if chosen not in names:
            known = ", ".join(repr(name) for name in names if name) or "none has a name"
            raise ParameterError(argument, f"must be among the names ({known}), got {chosen!r}")
        return names.index(chosen)
    number = arrays.count(chosen, argument, 0)
    if number >= len(names):
        raise ParameterError(argument, f"must be below {len(names)}, got {number}")
    return number
