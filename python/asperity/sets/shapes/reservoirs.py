"""Reservoirs of wedge-shaped asperities, and of a contact area that drills while it slides."""

from __future__ import annotations

from typing import Literal

import asperity._core as _core
from asperity._base import arrays
from asperity.sets.shapes.turned import AngledSet, SizedSet

Pressure = Literal["hertz", "uniform"]


class CoulombContensou(SizedSet):
    """The reservoir in R³ of a circular contact area of radius R that slides and drills.

    Slip is (v₁, v₂, Rω), force (λ₁, λ₂, τ/R) per unit normal force. Each point of the area obeys
    Coulomb's isotropic law, so that the support function is
    Ψ*_C(v, Rω) = (μ/λ_N) ∫ p(r) ‖v + ω × r‖ dA, p the contact pressure.

    Args:
        mu: friction coefficient μ > 0.
        pressure: ``"hertz"`` (elastic sphere) or ``"uniform"`` (flat pad).

    Reference: [LeineGlocker2003].

    >>> from asperity import CoulombContensou
    >>> sliding, drilling = CoulombContensou(0.3).support([[1.0, 0.0, 0.0], [0.0, 0.0, 1.0]])
    >>> round(float(sliding), 9), round(float(drilling), 9)  # 0.3 and 0.3 · 3π/16
    (0.3, 0.176714587)
    """

    _lengths = ("mu",)

    mu: float
    pressure: Pressure

    def __init__(self, mu: float, *, pressure: Pressure = "hertz") -> None:
        mu = arrays.positive(mu, "mu")
        pressure = arrays.choice(pressure, "pressure", ("hertz", "uniform"))
        self._set_core(_core.Set.coulomb_contensou(mu, pressure), mu=mu, pressure=pressure)


class WedgeAsperity(AngledSet):
    """The reservoir of parallel wedges in contact with springs, with its closed-form gauge.

    k_C(x) = (cos β/μ) (x₂² + B x₁²)/√(cos²β x₁² + x₂²), B = 1 − (1 + μ²) sin²β. The first axis is
    across the wedges, the second along them. Convex for μ tan β ≤ 1/√2.

    Args:
        mu: friction coefficient μ > 0 of a single spring on a flank.
        beta: inclination 0 ≤ β < π/2 of the flanks in rad, with μ tan β < 1.
        angle: of the first axis from e₁, counter-clockwise, in rad.

    Raises:
        ParameterError: where μ tan β ≥ 1, as the springs then lock.

    Reference: [WL19] (50), Fig. 10.

    >>> import math
    >>> from asperity import WedgeAsperity
    >>> surface = WedgeAsperity(1.2, beta=math.radians(36.0))
    >>> surface.radius([0.0, math.pi / 2]).round(9).tolist()
    [7.64327641, 1.483281573]
    >>> bool(surface.is_convex)
    False
    """

    mu: float
    beta: float

    def __init__(self, mu: float, *, beta: float, angle: float = 0.0) -> None:
        mu, beta = arrays.positive(mu, "mu"), arrays.non_negative(beta, "beta")
        self._set_angled(_core.Set.wedge_asperity(mu, beta), angle, mu=mu, beta=beta)
