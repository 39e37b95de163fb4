"""Flutter by a friction force that follows the body it acts on, Fig. 13d."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import KW_ONLY
from typing import Annotated, Any, Self

import numpy as np

from asperity._base.arrays import Array
from asperity._base.value import NonNegative, Number, Positive, Record, field, unchecked
from asperity.law import FrictionLaw
from asperity.mechanisms.line_law import line_law
from asperity.system import ContactLaw, System
from asperity.system.contacts import relawed


class FollowerPendulum(Record, System):
    """A double pendulum whose tip is pushed by friction along its second rod.

    Joints with equal rotational springs c and dampers d carry massless rods of length l with
    masses 2m at the second joint and m at the tip. A free wheel at the tip, its axle along the
    second rod, rolls on a belt that runs with v towards the first joint: only the velocity along
    the axle e₂ is a slip. With the angles φᵢ against the rods' straight position, Δ = φ₂ − φ₁,

        m l² [3, cos Δ; cos Δ, 1] φ̈ + m l² sin Δ [−φ̇₂²; φ̇₁²] + d D φ̇ + c D φ = W λ,

    D = [2, −1; −1, 1], W = [l sin Δ; 0], γ = l φ̇₁ sin Δ + v cos φ₂. With the force P = μ λ_N > 0
    and p = P l/c the straight position has m l² ω²/c = (7/2 − p ± √((7/2 − p)² − 2))/2: undamped,
    it flutters for 7/2 − √2 < p < 7/2 + √2 and diverges beyond.

    In the straight position W vanishes, which `simulate` does not accept as a start: begin beside
    it, with `q0=[1e-6, 0.0]` say. `equilibrium` and `stability` take the straight position itself.

    Args:
        mu: friction coefficient μ.
        law: friction law of the contact, of dimension 1; default that of μ.
        normal_force: λ_N in N.
        tip_mass: m > 0 in kg.
        length: l > 0 in m.
        stiffness: c in N m/rad.
        damping: d in N m s/rad.
        belt_velocity: v > 0 in m/s.

    Reference: [WL19] §4.1, Fig. 13d.

    >>> from asperity import mechanisms, simulate
    >>> stable, flutter = mechanisms.FollowerPendulum(0.19), mechanisms.FollowerPendulum(0.23)
    >>> for pendulum in (stable, flutter):
    ...     motion = simulate(pendulum, dt=0.01, t_end=100.0, q0=[1e-3, 0.0])
    ...     print(bool(abs(motion.q).max() > 0.1))
    False
    True
    """

    dof = 2

    mu: Annotated[float, unchecked]
    _: KW_ONLY
    law: FrictionLaw | None = None
    normal_force: NonNegative = 10.0
    tip_mass: Positive = 1.0
    length: Positive = 1.0
    stiffness: Number = 1.0
    damping: Number = 0.0
    belt_velocity: Positive = 1.0
    contacts: tuple[ContactLaw, ...] = field(init=False)

    def _complete(self, given: dict[str, Any]) -> None:
        line_law(given["mu"], given["law"])
        given["mu"] = float(given["mu"])

    def _derive(self) -> None:
        friction = line_law(self.mu, self.law)
        self._keep(contacts=(ContactLaw(friction, normal_force=self.normal_force),))

    def with_law(
        self, law: FrictionLaw, *, contacts: int | str | Sequence[int | str] | None = None
    ) -> Self:
        """Return the same pendulum with another law of its contact, of dimension 1."""
        return self.replace(law=relawed(self.contacts, law, contacts, "contacts")[0].law)

    def mass(self, q: Array) -> Array:
        """Return M(φ) in kg m²."""
        c = math.cos(q[1] - q[0])
        return self.tip_mass * self.length**2 * np.array([[3.0, c], [c, 1.0]])

    def forces(self, t: float, q: Array, u: Array) -> Array:
        """Return the torques of springs, dampers and inertia in N m."""
        turning = self.tip_mass * self.length**2 * math.sin(q[1] - q[0])
        inertia = turning * np.array([u[1] ** 2, -(u[0] ** 2)])
        return inertia - _JOINTS @ (self.stiffness * q + self.damping * u)

    def direction(self, t: float, q: Array, contact: int) -> Array:
        """Return W in m; it vanishes where the rods are in line."""
        return np.array([[self.length * math.sin(q[1] - q[0])], [0.0]])

    def velocity(self, t: float, q: Array, contact: int) -> Array:
        """Return χ in m/s, the belt's velocity against the axle."""
        return np.array([self.belt_velocity * math.cos(q[1])])


_JOINTS = np.array([[2.0, -1.0], [-1.0, 1.0]])
