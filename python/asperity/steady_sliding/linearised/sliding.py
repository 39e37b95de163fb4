"""One sliding contact and the derivatives of its force."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from asperity._base.arrays import Array
from asperity.law import FrictionLaw
from asperity.steady_sliding.critical.directions import margins
from asperity.steady_sliding.linearised.field import ContactState


@dataclass(frozen=True, eq=False)
class Sliding:
    """A contact in steady sliding: −∂λ/∂γ = λ_N/k_C(z) (I − L) H, z = ∇Ψ*_D(γ).

    Attributes:
        law: friction law.
        state: kinematics at the equilibrium, γ = χ.
        normal_force: λ_N in N.

    Reference: [WL19] (86)–(88), Prop. 7–9, Thm. 2.
    """

    law: FrictionLaw
    state: ContactState
    normal_force: float

    @property
    def slip(self) -> Array:
        """γ in m/s, shape ``(p,)``."""
        return self.state.chi

    @cached_property
    def unit_force(self) -> Array:
        """λ/λ_N, shape ``(p,)``."""
        return self.law.force(self.slip)

    @property
    def force(self) -> Array:
        """λ in N, shape ``(p,)``."""
        return self.normal_force * self.unit_force

    @cached_property
    def jacobian(self) -> Array:
        """∂λ/∂γ in N s/m, shape ``(p, p)``."""
        # Linear in λ_N, which may be negative on the way to an equilibrium.
        return self.normal_force * self.law.jacobian(self.slip)

    @cached_property
    def direction_jacobian(self) -> Array:
        """The part of ∂λ/∂γ at constant speed, shape ``(p, p)``."""
        if self.law.rate is None:
            return self.jacobian
        factor = self.law.rate(np.linalg.norm(self.slip))
        factor *= self.normal_force
        return factor * self.law.replace(rate=None).jacobian(self.slip)

    @property
    def rate_jacobian(self) -> Array:
        """The part of ∂λ/∂γ that comes from the dependence on the speed, shape ``(p, p)``."""
        return self.jacobian - self.direction_jacobian

    @cached_property
    def projector(self) -> Array:
        """L = z ∇k_C(z)ᵀ/k_C(z), the projector on the force along the boundary of C."""
        z = self.law.direction.support_point(self.slip)
        reservoir = self.law.reservoir
        return np.outer(z, reservoir.gauge_gradient(z)) / reservoir.gauge(z)

    @cached_property
    def hessian(self) -> Array:
        """H = ∇²Ψ*_D(γ), in s/m times the unit of D."""
        return self.law.direction.support_hessian(self.slip)

    @cached_property
    def margin(self) -> float:
        """Angle in rad by which γ is outside T_C(−λ), negative in its interior."""
        reservoir, direction = self.law.reservoir, self.law.direction
        if len(self.slip) == 2:
            return float(margins(reservoir, direction, self.slip[None])[0])
        normal = reservoir.gauge_gradient(direction.support_point(self.slip))
        sine = normal @ self.slip / (np.linalg.norm(normal) * np.linalg.norm(self.slip))
        return float(np.arcsin(np.clip(sine, -1.0, 1.0)))

    @property
    def is_smooth(self) -> bool:
        """Whether the force is differentiable."""
        return bool(np.isfinite(self.jacobian).all())

    @cached_property
    def error(self) -> float:
        """Relative error of ∂λ/∂γ, told by what it does along γ, where it should vanish."""
        along, J = np.linalg.norm(self.slip), self.direction_jacobian
        size = float(np.linalg.norm(J) * along)
        return float(np.linalg.norm(J @ self.slip) / size) if size else 0.0
