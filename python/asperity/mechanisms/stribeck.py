"""Stick-slip by a friction coefficient that falls with the sliding speed, Fig. 13a."""

from __future__ import annotations

from asperity._base import arrays
from asperity.law import FrictionLaw
from asperity.law.rate import Stribeck
from asperity.system import Contact, LinearSystem

_DROP = Stribeck(1.0 / 3.0, shape="hyperbolic")


def stribeck_block(
    *,
    mass: float = 1.0,
    stiffness: float = 1.0,
    normal_force: float = 1.0,
    mu: float = 1.0,
    rate: Stribeck = _DROP,
    belt_velocity: float = 0.2,
) -> LinearSystem:
    """Return a block on a belt, held by a spring: m ẍ + k x = λ, γ = ẋ − v.

    In slip −λ = μ λ_N f(|γ|) sgn γ. Sliding at rest, x = μ λ_N f(v)/k, has the damping coefficient
    μ λ_N f′(v): it is unstable wherever f falls. The defaults give −λ = sgn γ/(1 + 3|γ|).

    Args:
        mass: m > 0 in kg.
        stiffness: k in N/m.
        normal_force: λ_N in N.
        mu: static friction coefficient μ.
        rate: f.
        belt_velocity: v > 0 in m/s.

    Reference: [WL19] §4.1, Fig. 13a.

    >>> from asperity import mechanisms, simulate
    >>> block = mechanisms.stribeck_block()
    >>> cycle = simulate(block, dt=1e-3, t_end=60.0).slice(40.0, 60.0)
    >>> round(float(cycle.q.max()), 2)
    1.13
    """
    law = FrictionLaw.isotropic(mu, dimension=1).replace(rate=rate)
    speed = arrays.positive(belt_velocity, "belt_velocity")
    belt = Contact(law, direction=[1.0], normal_force=normal_force, velocity=[-speed])
    return LinearSystem(mass, stiffness=stiffness, contacts=[belt])
