"""Painlevé's rod: the contact forces of a rigid body that cease to exist."""

from __future__ import annotations

import math

from asperity._base import arrays
from asperity.law import FrictionLaw
from asperity.system import Line, PlanarBody, PointPlane, RigidBodies


def painleve_rod(
    *,
    mass: float = 1.0,
    half_length: float = 1.0,
    mu: float = 5.0 / 3.0,
    gravity: float = 10.0,
    angle: float = math.radians(31.0),
    speed: float = 30.0,
) -> RigidBodies:
    """Return a slender rod that slides over the ground, its tip ahead of its centre.

    With the inclination φ of the rod (the body's angle is −φ) and J = m s²/3, sliding forwards,

        λ_N (1 + 3 cos φ (cos φ − μ sin φ)) = m g − m s φ̇² sin φ.

    Where the factor of λ_N is negative no force keeps the tip from entering the ground (Painlevé's
    paradox); with μ = 5/3 for 45° < φ < 75.96°. At its edge a percussion stops the tip although it
    does not approach: an impact without collision.

    Args:
        mass: m > 0 in kg.
        half_length: s > 0 in m.
        mu: friction coefficient μ.
        gravity: g in m/s².
        angle: initial φ in rad.
        speed: initial velocity along the ground in m/s.

    Reference: [WL19] §4.1; [LeineNijmeijer2004].

    >>> from asperity import mechanisms, simulate
    >>> slide = simulate(mechanisms.painleve_rod(), dt=1e-5, t_end=0.82, sample_every=1e-3)
    >>> slide.u[[-7, -1], 0].round(1).tolist()  # before and after t = 0.8145 s
    [12.2, 6.2]
    """
    s = arrays.positive(half_length, "half_length")
    phi = arrays.number(angle, "angle")
    rod = PlanarBody(
        mass,
        inertia=arrays.positive(mass, "mass") * s**2 / 3.0,
        position=(0.0, s * math.sin(phi)),
        angle=-phi,
        velocity=(arrays.number(speed, "speed"), 0.0),
    )
    tip = PointPlane(0, point=(s, 0.0), plane=Line(), law=FrictionLaw.isotropic(mu, dimension=1))
    return RigidBodies([rod], pairs=[tip], gravity=(0.0, -arrays.number(gravity, "gravity")))
