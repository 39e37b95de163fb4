"""The two systems of [WL19]: the sliding point and the mass on a moving belt."""

from __future__ import annotations

from dataclasses import KW_ONLY
from typing import Any, Self

import numpy as np

import asperity._core as _core
from asperity._base import arrays
from asperity._base.arrays import Array
from asperity._base.value import AnyArray, Positive, Record, field
from asperity.errors import ParameterError
from asperity.law import FrictionLaw
from asperity.system.contacts import Contact
from asperity.system.labels import Labels
from asperity.system.linear import LinearSystem


class OneContact(Record):
    """A linear system with one contact, whose law has the dimension of the motion."""

    law: FrictionLaw = field(init=False)
    linear: LinearSystem = field(init=False)

    def with_law(self, law: FrictionLaw) -> Self:
        """Return the same system with another friction law."""
        return self.replace(law=law)

    @property
    def dof(self) -> int:
        """Number of coordinates, the law's dimension."""
        return self.linear.dof

    @property
    def contacts(self) -> tuple[Contact, ...]:
        """The one contact, with W = I, and χ = −v on a belt that moves with v."""
        return self.linear.contacts

    @property
    def labels(self) -> Labels:
        """Names and units of coordinates and contacts."""
        return self.linear.labels

    @property
    def _core(self) -> _core.LinearSystem:
        return self.linear._core


class SlidingPoint(OneContact):
    """A point mass on a horizontal plane: m q̈ = λ, λ_N = m g.

    Args:
        mass: m > 0 in kg.
        law: friction law per unit normal force; its dimension p is that of the motion.
        gravity: g > 0 in m/s².

    Reference: [WL19] §5.3, Fig. 27.

    >>> from asperity import FrictionLaw, SlidingPoint, simulate
    >>> block = SlidingPoint(0.018, law=FrictionLaw.isotropic(0.5))
    >>> path = simulate(block, dt=1e-4, t_end=1.0, u0=[1.0, 0.0], until_rest=True)
    >>> round(float(path.q[-1, 0]), 6)  # v²/(2 μ g)
    0.101937
    """

    mass: Positive
    _: KW_ONLY
    law: FrictionLaw
    gravity: Positive = 9.81

    def _derive(self) -> None:
        law, load = self.law, self.mass * self.gravity
        contact = Contact(law, direction=np.eye(law.dimension), normal_force=load)
        self._keep(linear=LinearSystem(self.mass, contacts=[contact], **_lengths(law.dimension)))


class MassOnBelt(OneContact):
    """A mass held by springs on a belt moving with v: m q̈ + K q = λ, γ = q̇ − v.

    Args:
        mass: m > 0 in kg.
        stiffness: k or K in N/m, a number or shape ``(p, p)``.
        law: friction law of dimension p.
        normal_force: λ_N in N; 1 if the law's sets are in newtons.
        belt_velocity: v ≠ 0 in m/s, shape ``(p,)``.

    Reference: [WL19] §4.3, (76).

    >>> from asperity import FrictionLaw, MassOnBelt
    >>> belt = MassOnBelt(
    ...     1.0,
    ...     stiffness=2.0,
    ...     law=FrictionLaw.isotropic(0.5),
    ...     normal_force=10.0,
    ...     belt_velocity=[1.0, 0.0],
    ... )
    >>> belt.equilibrium.tolist()
    [2.5, 0.0]
    """

    mass: Positive
    _: KW_ONLY
    stiffness: AnyArray
    law: FrictionLaw
    normal_force: Positive
    belt_velocity: AnyArray

    def _complete(self, given: dict[str, Any]) -> None:
        p = given["law"].dimension
        given["belt_velocity"] = arrays.array(given["belt_velocity"], "belt_velocity", (p,))
        given["stiffness"] = arrays.square(given["stiffness"], "stiffness", p)

    def _derive(self) -> None:
        p, load = self.law.dimension, self.normal_force
        belt = -self.belt_velocity
        contact = Contact(self.law, direction=np.eye(p), normal_force=load, velocity=belt)
        made = LinearSystem(self.mass, stiffness=self.stiffness, contacts=[contact], **_lengths(p))
        self._keep(linear=made)

    @property
    def equilibrium(self) -> Array:
        """Sliding equilibrium q_eq = K⁻¹ λ(−v) in m, shape ``(p,)``; [WL19] (77)."""
        try:
            force = self.law.force(-self.belt_velocity, normal_force=self.normal_force)
            position = np.linalg.solve(self.stiffness, force)
        except np.linalg.LinAlgError:
            raise ParameterError("stiffness", "must be regular for an equilibrium") from None
        return arrays.array(position, "equilibrium")


def _lengths(p: int) -> dict[str, list[str]]:
    """Return names and units of p coordinates that are lengths along e₁, e₂, e₃."""
    return {
        "coordinate_names": [f"x{axis + 1}" for axis in range(p)],
        "coordinate_units": ["m"] * p,
    }
