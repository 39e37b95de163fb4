"""Mode coupling by a normal force that depends on displacements, Fig. 13b."""

from __future__ import annotations

import math

import numpy as np

from asperity._base import arrays
from asperity.law import FrictionLaw
from asperity.system import Contact, LinearSystem


def mode_coupling(
    mu: float,
    *,
    mass: float = 1.0,
    belt_mass: float = 1e-3,
    stiffness: tuple[float, float] = (2.0 / 3.0 * (2.0 - 3**0.5), 2.0 / 3.0 * (2.0 + 3**0.5)),
    angles: tuple[float, float] = (math.radians(150.0), math.radians(30.0)),
    belt_stiffness: float = 4.0 / 3.0,
    damping: float = 0.0,
    normal_force: float = 1.0,
    belt_velocity: float = 1.0,
) -> LinearSystem:
    """Return a mass (x, y) held by two springs on a belt (z) that can move up and down.

    The contact is unilateral, g_N = y − z. The belt runs along −x, so that λ = −μ λ_N while the
    mass slides. With closed contact and K₁ = k₁ e₁e₁ᵀ + k₂ e₂e₂ᵀ, eᵢ along the springs,

        [m, −μ m_b; 0, m + m_b] q̈ + d q̇ + (K₁ + [0, −μ k₃; 0, k₃]) q = 0.

    The springs are stretched such that q = 0 is the steady sliding. With the defaults
    the stiffness is [2, 1 − 4μ/3; 1, 2]: as m_b → 0 both frequencies meet at μ = 3/4, and flutter
    begins.

    Args:
        mu: friction coefficient μ.
        mass: m > 0 in kg.
        belt_mass: m_b > 0 in kg; small, it shifts the limit by the factor 1 + 3 m_b/(2 m).
        stiffness: k₁ and k₂ in N/m.
        angles: of these springs against x in rad.
        belt_stiffness: k₃ in N/m, of the spring under the belt.
        damping: d in N s/m, of the mass.
        normal_force: λ_N of the steady sliding in N.
        belt_velocity: speed v > 0 of the belt in m/s.

    Reference: [WL19] §4.1, Fig. 13b.

    >>> from asperity import mechanisms
    >>> mechanisms.mode_coupling(0.9).stiffness.round(9).tolist()
    [[2.0, 1.0, 0.0], [1.0, 0.666666667, 0.0], [0.0, 0.0, 1.333333333]]
    """
    axes = arrays.unit_vectors(arrays.array(angles, "angles", (2,)))
    springs = np.zeros((3, 3))
    springs[:2, :2] = axes.T @ np.diag(arrays.array(stiffness, "stiffness", (2,))) @ axes
    springs[2, 2] = arrays.number(belt_stiffness, "belt_stiffness")
    normal_force = arrays.positive(normal_force, "normal_force")
    contact = Contact(
        FrictionLaw.isotropic(mu, dimension=1),
        direction=[1.0, 0.0, 0.0],
        normal=[0.0, 1.0, -1.0],
        velocity=[arrays.positive(belt_velocity, "belt_velocity")],
    )
    return LinearSystem(
        [mass, mass, arrays.positive(belt_mass, "belt_mass")],
        stiffness=springs,
        damping=[damping, damping, 0.0],
        force=[mu * normal_force, -normal_force, normal_force],
        contacts=[contact],
    )
