"""Evaluation of a friction law: force, sliding direction, Jacobian, dissipation."""

from __future__ import annotations

from numpy.typing import ArrayLike

import asperity._core as _core
from asperity._base import arrays
from asperity._base.arrays import Array
from asperity._base.value import Value
from asperity.errors import ParameterError
from asperity.law.rate import Stribeck
from asperity.sets import StarSet


class Evaluation(Value):
    """The methods of `FrictionLaw` that evaluate it."""

    reservoir: StarSet
    direction: StarSet
    rate: Stribeck | None
    _core: _core.Law

    @property
    def dimension(self) -> int:
        """Dimension p of slip and force."""
        return self._core.dimension

    @property
    def alpha_min(self) -> float:
        """Smallest α = min r_D/r_C; the prox iteration sticks only for r λ_max(G) < 2 α_min."""
        return self._core.alpha_min

    def force(self, slip: ArrayLike, *, normal_force: ArrayLike = 1.0) -> Array:
        """Return the friction force λ on a sliding body: −λ = λ_N z/k_C(z), z = ∇Ψ*_D(γ).

        Where a whole face of D is farthest along γ the force is set-valued and this is the force of
        the face's most symmetric point.

        Args:
            slip: relative velocities γ ≠ 0 in m/s, shape ``(..., p)``.
            normal_force: λ_N ≥ 0 in N, shape ``(...)``.

        Returns:
            λ in N, shape ``(..., p)``, with λ·γ ≤ 0.

        Raises:
            ParameterError: at rest, where the force is set-valued.

        Reference: [WL19] (84).

        >>> from asperity import FrictionLaw
        >>> FrictionLaw.isotropic(0.5).force([3.0, 4.0], normal_force=10.0).round(12).tolist()
        [-3.0, -4.0]
        """
        flat, normal, lead = self._loaded(slip, "slip", normal_force)
        return arrays.unflatten(self._core.force(flat, normal), lead)

    def slip_direction(
        self, force: ArrayLike, *, normal_force: ArrayLike = 1.0, tolerance: float = 1e-9
    ) -> Array:
        """Return the direction γ/‖γ‖ in which a contact slips under the friction force λ.

        Args:
            force: λ in N, shape ``(..., p)``.
            normal_force: λ_N > 0 in N, shape ``(...)``.
            tolerance: forces with |k_C(−λ/λ_N) − 1| ≤ `tolerance` count as slip.

        Returns:
            Unit vectors, shape ``(..., p)``; zeros where −λ lies inside C (stick). At a corner of D
            it is one element of the normal cone.

        Raises:
            ParameterError: where −λ lies outside C, and for laws with a rate factor, whose force
                in slip may lie anywhere in C.

        Reference: [WL19] (55).

        >>> from asperity import Ellipse, FrictionLaw
        >>> law = FrictionLaw.associated(Ellipse(0.6, 0.2))
        >>> law.slip_direction([[0.0, -2.0], [0.0, -1.0]], normal_force=10.0).tolist()
        [[0.0, 1.0], [0.0, 0.0]]
        """
        flat, normal, lead = self._loaded(force, "force", normal_force)
        tolerance = arrays.non_negative(tolerance, "tolerance")
        return arrays.unflatten(self._core.slip_direction(flat, normal, tolerance), lead)

    def jacobian(self, slip: ArrayLike, *, normal_force: ArrayLike = 1.0) -> Array:
        """Return ∂λ/∂γ of the sliding contact: −∂λ/∂γ = λ_N/k_C(z) (I − L) H.

        L = z ∇k_C(z)ᵀ/k_C(z), H = ∇²Ψ*_D(γ), z = ∇Ψ*_D(γ).

        Args:
            slip: relative velocities γ ≠ 0 in m/s, shape ``(..., p)``.
            normal_force: λ_N ≥ 0 in N, shape ``(...)``.

        Returns:
            Shape ``(..., p, p)``, in N s/m; infinite where D is flat.

        Raises:
            ParameterError: at rest.

        Reference: [WL19] (87)(88).

        >>> from asperity import FrictionLaw
        >>> FrictionLaw.isotropic(0.5).jacobian([2.0, 0.0], normal_force=4.0).tolist()
        [[0.0, 0.0], [0.0, -1.0]]
        """
        flat, normal, lead = self._loaded(slip, "slip", normal_force)
        # Adding zero clears the sign of negative zeros.
        return arrays.unflatten(self._core.jacobian(flat, normal) + 0.0, lead)

    def dissipation(self, slip: ArrayLike, *, normal_force: ArrayLike = 1.0) -> Array:
        """Return the dissipated power D = −λᵀγ; it is unique even where the force is not.

        Args:
            slip: relative velocities γ in m/s, shape ``(..., p)``; 0 dissipates nothing.
            normal_force: λ_N ≥ 0 in N, shape ``(...)``.

        Returns:
            Shape ``(...)``, in W.

        Reference: [WL19] Def. 11, Prop. 5.

        >>> from asperity import FrictionLaw
        >>> float(FrictionLaw.isotropic(0.5).dissipation([3.0, 4.0], normal_force=10.0))
        25.0
        """
        flat, normal, lead = self._loaded(slip, "slip", normal_force)
        return arrays.unflatten(self._core.dissipation(flat, normal), lead)

    def _loaded(
        self, vectors: ArrayLike, argument: str, normal_force: ArrayLike
    ) -> tuple[Array, Array, tuple[int, ...]]:
        flat, normal, lead = arrays.points_with_scalars(
            vectors, argument, self.dimension, normal_force, "normal_force"
        )
        if normal.min(initial=0.0) < 0.0:
            raise ParameterError("normal_force", f"must not be negative, got {normal.min()}")
        return flat, normal, lead
