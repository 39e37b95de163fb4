"""The friction reservoir of sliding together with drilling."""

from __future__ import annotations

from typing import Literal

from asperity import _core
from asperity._base import arrays
from asperity.sets.shapes.turned import SizedSet

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
