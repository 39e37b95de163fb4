"""Dependence of the friction force on the sliding speed."""

from __future__ import annotations

from dataclasses import KW_ONLY
from typing import Literal

import numpy as np
from numpy.typing import ArrayLike

from asperity._base import arrays
from asperity._base.arrays import Array
from asperity._base.value import Fraction, NonNegative, Positive, Record
from asperity.errors import ParameterError

Shape = Literal["exponential", "hyperbolic"]


class Stribeck(Record):
    """The rate factor f(v) = ρ + (1 − ρ) s((v/v₀)^δ) + κv of the force in slip, v = ‖γ‖.

    s(x) = exp(−x) (``"exponential"``) or 1/(1 + x) (``"hyperbolic"``). In slip
    −λ = f(‖γ‖) λ_N z/k_C(z); in stick the force takes any value in λ_N C, as f(0) = 1.
    `simulate` takes the falling part of f at the speed before the step, and κv at its end: viscous
    friction is damped however long the step. It is then found by several solves in a step; if
    these do not end, as with laws that have several solutions in so long a step, the step counts
    as not converged.

    Args:
        speed: v₀ > 0 in m/s, at which the drop of the force is well on its way.
        ratio: ρ, kinetic over static friction, between 0 and 1.
        shape: of the drop s.
        exponent: δ > 0.
        viscous: κ ≥ 0 in s/m, per unit static friction.

    Reference: [WL19] §4.1; [AcaryBrogliato2008].

    >>> from asperity import FrictionLaw, Stribeck
    >>> law = FrictionLaw.isotropic(0.5).replace(rate=Stribeck(0.1, shape="hyperbolic"))
    >>> law.force([[0.1, 0.0], [0.0, 0.3]]).round(12).tolist()
    [[-0.25, -0.0], [-0.0, -0.125]]
    """

    speed: Positive
    _: KW_ONLY
    ratio: Fraction = 0.0
    shape: Shape = "exponential"
    exponent: Positive = 1.0
    viscous: NonNegative = 0.0

    def __call__(self, speed: ArrayLike) -> Array:
        """Return f(v).

        Args:
            speed: v ≥ 0 in m/s, any shape.

        Returns:
            Dimensionless, shape of `speed`.

        >>> from asperity import Stribeck
        >>> Stribeck(0.1, ratio=0.4, shape="hyperbolic")([0.0, 0.1]).round(12).tolist()
        [1.0, 0.7]
        """
        v = arrays.array(speed, "speed")
        if v.min(initial=0.0) < 0.0:
            raise ParameterError("speed", f"must not be negative, got {v.min()}")
        x = (v / self.speed) ** self.exponent
        drop = np.exp(-x) if self.shape == "exponential" else 1.0 / (1.0 + x)
        return self.ratio + (1.0 - self.ratio) * drop + self.viscous * v

    @property
    def _core(self) -> tuple[str, float, float, float, float]:
        return self.shape, self.speed, self.ratio, self.exponent, self.viscous
