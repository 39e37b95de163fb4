"""Classification of a friction law, and its shape over the sliding direction."""

from __future__ import annotations

from functools import cached_property

import numpy as np
from numpy.typing import ArrayLike

from asperity._base import arrays
from asperity._base.arrays import Array
from asperity.errors import DimensionError, ParameterError
from asperity.law.evaluation import Evaluation
from asperity.sets.gauge import directions
from asperity.sets.verdict import Verdict, verdict

_DIRECTIONS = 3600
_ROUNDING = 1e-9


class Questions(Evaluation):
    """The methods of `FrictionLaw` that classify it."""

    @cached_property
    def is_associated(self) -> Verdict:
        """Whether C = aD, so that sliding is normal to C.

        The witness is the sliding direction, shape ``(1, p)``, whose force differs most from the
        associated one.

        Reference: [WL19] Def. 12.

        >>> from asperity import Ellipse, FrictionLaw
        >>> bool(FrictionLaw(Ellipse(3.0, 1.0), Ellipse(0.3, 0.1)).is_associated)
        True
        """
        return verdict(self._core.associativity())

    @cached_property
    def is_collinear(self) -> Verdict:
        """Whether friction is opposite to sliding; the witness is a direction where it is not.

        Reference: [WL19] Def. 15.

        >>> from asperity import Ellipse, FrictionLaw
        >>> bool(FrictionLaw.collinear(Ellipse(3.0, 1.0)).is_collinear)
        True
        """
        return verdict(self._core.collinearity())

    @cached_property
    def is_dissipative(self) -> Verdict:
        """Whether −λᵀγ > 0 in sliding; the witness is a sliding direction where it is not.

        Reference: [WL19] Def. 11, Prop. 1, 5.

        >>> from asperity import Ellipse, FrictionLaw
        >>> bool(FrictionLaw(Ellipse(3.0, 1.0), Ellipse(1.0, 3.0)).is_dissipative)
        True
        """
        return verdict(self._core.dissipativity())

    @cached_property
    def is_maximal_monotone(self) -> Verdict:
        """Whether (γ − γ*)ᵀ(λ − λ*) ≤ 0 for all pairs, at any speed; only associated laws are.

        The witness, shape ``(4, p)``, has the rows γ, λ, γ*, λ* of two pairs that break it, per
        unit normal force.

        Reference: [WL19] Def. 13, Prop. 3, 4.

        >>> from asperity import Ellipse, FrictionLaw
        >>> law = FrictionLaw.collinear(Ellipse(3.0, 1.0))
        >>> bool(law.is_maximal_monotone)
        False
        >>> slip, force, other_slip, other_force = law.is_maximal_monotone.witness
        >>> bool((slip - other_slip) @ (force - other_force) > 0.0)
        True
        """
        return verdict(self._core.monotonicity())

    def dissipates_at_least(self, other: Evaluation) -> Verdict:
        """Return whether in every direction this law dissipates at least as much as another one.

        The associated law does, compared with every law of the same reservoir.

        Args:
            other: law with the same C and rate factor.

        Returns:
            The verdict; its defect is the largest shortfall relative to the other's dissipation,
            its witness the sliding direction where that is, shape ``(1, p)``.

        Raises:
            ParameterError: if the laws differ in more than D.

        Reference: [WL19] Prop. 2.

        >>> from asperity import Ellipse, FrictionLaw
        >>> ellipse = Ellipse(0.6, 0.2)
        >>> law, most = FrictionLaw.collinear(ellipse), FrictionLaw.associated(ellipse)
        >>> bool(most.dissipates_at_least(law)), bool(law.dissipates_at_least(most))
        (True, False)
        """
        arrays.of_kind(other, "other", Evaluation, "a FrictionLaw")
        if (other.reservoir, other.rate) != (self.reservoir, self.rate):
            raise ParameterError("other", "must have the same reservoir and rate as this law")
        if self._core.is_associated or self.direction == other.direction:
            return Verdict(True, exact=True, tolerance=0.0, defect=0.0, witness=None)
        slip = self._telling_directions(other)
        shortfall = 1.0 - self.dissipation(slip) / other.dissipation(slip)
        worst = int(shortfall.argmax())
        holds = bool(shortfall[worst] <= _ROUNDING)
        return Verdict(
            holds,
            exact=False,
            tolerance=_ROUNDING,
            defect=max(float(shortfall[worst]), 0.0),
            witness=None if holds else slip[[worst]],
        )

    def _telling_directions(self, other: Evaluation) -> Array:
        """Return directions all around and the normals of both D all around, close at thin ends."""
        around = directions(self.dimension, _DIRECTIONS)
        places = [around]
        if self.reservoir.is_convex:
            # Where C is thin all its points lie in a few directions.
            places.append(self.reservoir.support_point(around))
        sets = [law.direction for law in (self, other)]
        normals = [d.gauge_gradient(x) for d in sets for x in places]
        normals += [self.reservoir.gauge_gradient(x) for x in places]
        lengths = [np.linalg.norm(n, axis=-1)[:, None] for n in normals]
        return np.vstack([around, *(n / m for n, m in zip(normals, lengths, strict=True))])

    def resistance(self, phi: ArrayLike) -> tuple[Array, Array]:
        """Return the force against sliding and across it, −λ = λ_N (l_t e(φ) + l_p e⊥(φ)).

        Without the rate factor.

        Args:
            phi: angle of the sliding direction from e₁ in rad, any shape.

        Returns:
            l_t and l_p per unit normal force, shape of `phi`.

        Raises:
            DimensionError: if the law is not planar.

        Reference: [WL19] (119), with l_t = λ_t, l_p = λ_r.

        >>> from asperity import Ellipse, FrictionLaw
        >>> along, across = FrictionLaw.associated(Ellipse(0.6, 0.2)).resistance(0.0)
        >>> float(along), float(across)
        (0.6, 0.0)
        """
        slip = self._sliding(phi)
        force = -self._dry.force(slip)
        across = np.stack([-slip[..., 1], slip[..., 0]], axis=-1)
        return (force * slip).sum(-1), (force * across).sum(-1)

    def deflection(self, phi: ArrayLike) -> Array:
        """Return the angle θ − φ from the sliding direction to −λ.

        Args:
            phi: angle of the sliding direction from e₁ in rad, any shape.

        Returns:
            In rad, between −π/2 and π/2 as friction dissipates; shape of `phi`.

        Raises:
            DimensionError: if the law is not planar.

        Reference: [WL19] (71), (125).

        >>> from asperity import Disk, Ellipse, FrictionLaw
        >>> abs(float(FrictionLaw.collinear(Ellipse(0.6, 0.2)).deflection(1.0))) < 1e-12
        True
        """
        along, across = self.resistance(phi)
        return np.arctan2(across, along)

    def trace_criterion(self, phi: ArrayLike) -> Array:
        """Return l_t + dl_p/dφ = ‖γ‖ tr(−∂λ/∂γ) per unit normal force.

        Steady sliding along φ of a point with M ∝ I is unstable where it is negative. Without the
        rate factor.

        Args:
            phi: angle of the sliding direction from e₁ in rad, any shape.

        Returns:
            Dimensionless, shape of `phi`; infinite where D is flat.

        Raises:
            DimensionError: if the law is not planar.

        Reference: [WL19] Prop. 9–11, Thm. 2.

        >>> import math
        >>> from asperity import Ellipse, FrictionLaw
        >>> law = FrictionLaw(Ellipse(0.3, 0.1, angle=math.pi / 6), Ellipse(3.0, 1.0))
        >>> (law.trace_criterion([0.0, math.radians(60.0)]) < 0.0).tolist()
        [False, True]
        """
        jacobian = self._dry.jacobian(self._sliding(phi))
        return -np.trace(jacobian, axis1=-2, axis2=-1) + 0.0

    @cached_property
    def _dry(self) -> Evaluation:
        return self if self.rate is None else self.replace(rate=None)

    def _sliding(self, phi: ArrayLike) -> Array:
        if self.dimension != 2:
            raise DimensionError(
                "law", f"must be planar for this, this one has dimension {self.dimension}"
            )
        return arrays.unit_vectors(arrays.array(phi, "phi"))
