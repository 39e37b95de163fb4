"""Instability by the velocity feedback of the normal force: the oscillator of Fig. 13c."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import KW_ONLY
from typing import Annotated, Any, Self

import numpy as np

from asperity._base.arrays import Array
from asperity._base.value import Fraction, Positive, Record, Vector2, field, unchecked
from asperity.errors import ParameterError
from asperity.law import FrictionLaw
from asperity.mechanisms.line_law import line_law
from asperity.system import Contact, ContactLaw, LinearSystem, System
from asperity.system.contacts import relawed


class FrictionalImpactOscillator(Record, System):
    """A rigid rod with a mass at either end that leans against the motion of a belt.

    The upper mass m₁ moves vertically, at the height y, on a spring k_y and a damper d_y; the rod
    of length l turns about it by the angle φ against a rotational spring k_φ and a damper d_φ; the
    lower mass m₂ touches the belt, g_N = y − l cos φ ≥ 0, with restitution. With s = sin φ and
    c = cos φ, the belt running with v > 0 towards the foot of the upper mass,

        [m₁ + m₂, m₂ l s; m₂ l s, m₂ l²] u̇ + [m₂ l c φ̇²; 0] + ([k_y; k_φ] (q − q₀) + [d_y; d_φ] u)
            = [1; l s] λ_N + [0; −l c] λ,   γ = −l c φ̇ − v,   λ = μ λ_N in slip.

    The springs are stretched such that the rod slides steadily at the angle and the normal force
    given. The deviations from this state, with contact and a = s² − μ s c, obey

        (m₂ c² + m₁ a) l² φ̈ + (d_φ + d_y l² a) φ̇ + (k_φ + k_y l² a − λ_N l (c + μ s)) φ = 0.

    Beyond μ = tan φ (1 + d_φ/(d_y l² s²)) the part of the normal force that grows with the velocity
    feeds more power into the motion than the dampers take; at μ = tan φ + (m₂/m₁) cot φ Painlevé's
    paradox begins. There is no gravity. [WL19] gives no parameters; these were chosen here.

    Args:
        mu: friction coefficient μ, for which the springs are stretched.
        law: friction law of the contact, of dimension 1; default that of μ.
        angle: φ of the steady sliding in rad, above 0 and below π/2.
        normal_force: λ_N of the steady sliding in N.
        masses: m₁ and m₂ in kg.
        length: l in m.
        stiffness: k_y in N/m and k_φ in N m/rad.
        damping: d_y in N s/m and d_φ in N m s/rad.
        belt_velocity: v > 0 in m/s.
        normal_restitution: e_N in [0, 1].

    Reference: [WL19] §4.1, Fig. 13c, after [LeineBrogliatoNijmeijer2002].

    >>> from asperity import mechanisms, simulate
    >>> rod = mechanisms.FrictionalImpactOscillator(1.0)
    >>> start = rod.equilibrium + [0.0, 1e-3]
    >>> motion = simulate(rod, dt=5e-3, t_end=100.0, q0=start)
    >>> bool((motion.normal_force[1:] == 0.0).any())  # it grows until the rod lifts off
    True
    """

    dof = 2

    mu: Annotated[float, unchecked]
    _: KW_ONLY
    law: FrictionLaw | None = None
    angle: Positive = math.radians(30.0)
    normal_force: Positive = 1.0
    masses: Vector2 = field(default=(1.0, 1.0))
    length: Positive = 1.0
    stiffness: Vector2 = field(default=(1.0, 4.0))
    damping: Vector2 = field(default=(1.0, 0.1))
    belt_velocity: Positive = 1.0
    normal_restitution: Fraction = 0.0
    contacts: tuple[ContactLaw, ...] = field(init=False)
    _rest: Array = field(init=False)
    _stretch: Array = field(init=False)

    def _complete(self, given: dict[str, Any]) -> None:
        if given["angle"] >= 0.5 * math.pi:
            raise ParameterError("angle", f"must lie below π/2, got {given['angle']!r}")
        if given["masses"].min() <= 0.0:
            raise ParameterError("masses", f"must be positive, got {given['masses'].tolist()}")
        line_law(given["mu"], given["law"])
        given["mu"] = float(given["mu"])

    def _derive(self) -> None:
        friction = line_law(self.mu, self.law)
        contact = ContactLaw(friction, normal_restitution=self.normal_restitution)
        self._keep(contacts=(contact,), _rest=self.equilibrium)
        self._keep(_stretch=self._stretched())

    def with_law(
        self, law: FrictionLaw, *, contacts: int | str | Sequence[int | str] | None = None
    ) -> Self:
        """Return the same oscillator with another law of its contact, of dimension 1.

        Its springs stay as they are stretched, so that it slides steadily at another angle.
        """
        return self.replace(law=relawed(self.contacts, law, contacts, "contacts")[0].law)

    @property
    def equilibrium(self) -> Array:
        """Coordinates (y, φ) of the steady sliding under the law of μ."""
        return np.array([self.length * math.cos(self.angle), self.angle])

    @property
    def small_angles(self) -> LinearSystem:
        """The linear system of the deviations from the steady sliding, with contact and impacts.

        The turning of the constant contact forces is part of its stiffness.

        Raises:
            ParameterError: under another law than that of μ, which slides steadily elsewhere.
        """
        if self.contacts[0].law != line_law(self.mu, None):
            raise ParameterError("law", "must be that of mu, about whose steady sliding this is")
        q, lever = self.equilibrium, self.length * self.normal_force
        turning = lever * (math.cos(self.angle) + self.mu * math.sin(self.angle))
        contact = Contact(
            self.contacts[0].law,
            direction=self.direction(0.0, q, 0),
            normal=self.normal(0.0, q, 0),
            velocity=[-self.belt_velocity],
            normal_restitution=self.normal_restitution,
        )
        return LinearSystem(
            self.mass(q),
            stiffness=self.stiffness - [0.0, turning],
            damping=self.damping,
            force=self._stretch,
            contacts=[contact],
        )

    def mass(self, q: Array) -> Array:
        """Return M(φ)."""
        m1, m2 = self.masses.tolist()
        coupling = m2 * self.length * math.sin(q[1])
        return np.array([[m1 + m2, coupling], [coupling, m2 * self.length**2]])

    def forces(self, t: float, q: Array, u: Array) -> Array:
        """Return the forces of springs, dampers and inertia."""
        loads = self._stretch - self.stiffness * (q - self._rest) - self.damping * u
        loads[0] -= self.masses[1] * self.length * math.cos(q[1]) * u[1] ** 2
        return loads

    def direction(self, t: float, q: Array, contact: int) -> Array:
        """Return W, along the belt's motion."""
        return np.array([[0.0], [-self.length * math.cos(q[1])]])

    def velocity(self, t: float, q: Array, contact: int) -> Array:
        """Return χ in m/s."""
        return np.array([-self.belt_velocity])

    def normal(self, t: float, q: Array, contact: int) -> Array:
        """Return w_N."""
        return np.array([1.0, self.length * math.sin(q[1])])

    def gap(self, t: float, q: Array, contact: int) -> float:
        """Return g_N in m."""
        return float(q[0] - self.length * math.cos(q[1]))

    def _stretched(self) -> Array:
        """Return the forces of the springs in the steady sliding, opposite to the contact's."""
        pressed = self.normal(0.0, self._rest, 0)
        pulled = self.mu * self.direction(0.0, self._rest, 0)[:, 0]
        return -self.normal_force * (pressed + pulled)
