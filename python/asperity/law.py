"""The friction law: a pair of force reservoir C and direction set D."""

from __future__ import annotations

from numpy.typing import ArrayLike

from asperity import _arrays, _core
from asperity._arrays import Array
from asperity._value import Value
from asperity.errors import DimensionError, ParameterError
from asperity.sets import Ball, Disk, Interval, StarSet


class FrictionLaw(Value):
    """The extended normal cone inclusion γ ∈ N_D(−αλ), α(x) = 1/(k_D(x) − k_C(x) + 1), x = −λ.

    The contact sticks where k_C(−λ) < 1 and slips where k_C(−λ) = 1, with γ normal to D at −αλ.
    Both sets hold −λ per unit normal force and are scaled by it. Only the shape of D matters: it is
    normalised to the largest scale inside C.

    Args:
        reservoir: force reservoir C, star-shaped.
        direction: direction set D, convex, of any scale.

    Raises:
        ParameterError: if D is not convex or C is degenerate.
        DimensionError: if the two sets differ in dimension.

    Reference: [WL19] Def. 16, (55)(56)(62).

    >>> from asperity import Ellipse, FrictionLaw
    >>> law = FrictionLaw(Ellipse(0.6, 0.2), Ellipse(3.0, 2.0))
    >>> round(law.direction.b, 9)
    0.2
    >>> law.force([4.0, 9.0], normal_force=10.0).round(3).tolist()
    [-1.897, -1.897]
    """

    reservoir: StarSet
    direction: StarSet
    _core: _core.Law

    def __init__(self, reservoir: StarSet, direction: StarSet) -> None:
        _check_set(reservoir, "reservoir")
        _check_set(direction, "direction")
        if direction.dimension != reservoir.dimension:
            raise DimensionError(
                "direction",
                f"must have the reservoir's dimension {reservoir.dimension}, "
                f"got {direction.dimension}",
            )
        if not direction.is_convex:
            raise ParameterError("direction", f"must be convex, {direction!r} is star-shaped only")
        core = _core.Law(reservoir._core, direction._core)
        if core.is_associated:
            direction = reservoir
        elif core.direction_scale != 1.0:
            direction = direction.scaled(core.direction_scale)
            core = _core.Law(reservoir._core, direction._core)
        self._set(reservoir=reservoir, direction=direction)
        self._keep(_core=core)

    @classmethod
    def isotropic(cls, mu: float, *, dimension: int = 2) -> FrictionLaw:
        """Make Coulomb's isotropic law: C = D = ball of radius μ.

        Args:
            mu: friction coefficient μ > 0.
            dimension: p = 1, 2 or 3.

        Reference: [WL19] Def. 14, (33).

        >>> from asperity import FrictionLaw
        >>> FrictionLaw.isotropic(0.3)
        FrictionLaw(Disk(0.3), Disk(0.3))
        """
        return cls.associated(_round(_arrays.positive(mu, "mu"), dimension))

    @classmethod
    def associated(cls, reservoir: StarSet) -> FrictionLaw:
        """Make the associated law D = C, of maximal dissipation: γ ∈ N_C(−λ).

        Args:
            reservoir: convex C.

        Reference: [WL19] Def. 12.

        >>> from asperity import FrictionLaw, Rectangle
        >>> FrictionLaw.associated(Rectangle(0.4, 0.2)).force([1.0, -2.0]).tolist()
        [-0.4, 0.2]
        """
        return cls(reservoir, reservoir)

    @classmethod
    def collinear(cls, reservoir: StarSet) -> FrictionLaw:
        """Make the collinear law: D a disk, so that friction is opposite to sliding.

        Args:
            reservoir: any star-shaped C.

        Reference: [WL19] Def. 15, (38)–(44).

        >>> from asperity import FrictionLaw, Superellipse
        >>> law = FrictionLaw.collinear(Superellipse(0.4, 0.2, 0.5))
        >>> law.slip_direction(law.force([3.0, 4.0])).round(12).tolist()
        [0.6, 0.8]
        """
        _check_set(reservoir, "reservoir")
        return cls(reservoir, _round(1.0, reservoir.dimension))

    @property
    def dimension(self) -> int:
        """Dimension p of slip and force."""
        return self._core.dimension

    @property
    def alpha_min(self) -> float:
        """Smallest α = min r_D/r_C; the prox iteration sticks only for r λ_max(G) < 2 α_min."""
        return self._core.alpha_min

    def force(self, slip: ArrayLike, normal_force: ArrayLike = 1.0) -> Array:
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
        return _arrays.unflatten(self._core.force(flat, normal), lead)

    def slip_direction(
        self, force: ArrayLike, normal_force: ArrayLike = 1.0, *, tolerance: float = 1e-9
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
            ParameterError: where −λ lies outside C.

        Reference: [WL19] (55).

        >>> from asperity import Ellipse, FrictionLaw
        >>> law = FrictionLaw.associated(Ellipse(0.6, 0.2))
        >>> law.slip_direction([[0.0, -2.0], [0.0, -1.0]], normal_force=10.0).tolist()
        [[0.0, 1.0], [0.0, 0.0]]
        """
        flat, normal, lead = self._loaded(force, "force", normal_force)
        tolerance = _arrays.non_negative(tolerance, "tolerance")
        return _arrays.unflatten(self._core.slip_direction(flat, normal, tolerance), lead)

    def jacobian(self, slip: ArrayLike, normal_force: ArrayLike = 1.0) -> Array:
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
        return _arrays.unflatten(self._core.jacobian(flat, normal) + 0.0, lead)

    def dissipation(self, slip: ArrayLike, normal_force: ArrayLike = 1.0) -> Array:
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
        return _arrays.unflatten(self._core.dissipation(flat, normal), lead)

    def rotated(self, angle: float) -> FrictionLaw:
        """Return the law of the surface turned counter-clockwise by `angle` in rad (p = 2).

        >>> from asperity import Ellipse, FrictionLaw
        >>> FrictionLaw.associated(Ellipse(0.6, 0.2)).rotated(0.5).reservoir
        Ellipse(0.6, 0.2, angle=0.5)
        """
        return FrictionLaw(self.reservoir.rotated(angle), self.direction.rotated(angle))

    def _loaded(
        self, vectors: ArrayLike, argument: str, normal_force: ArrayLike
    ) -> tuple[Array, Array, tuple[int, ...]]:
        flat, normal, lead = _arrays.points_with_scalars(
            vectors, argument, self.dimension, normal_force, "normal_force"
        )
        if normal.min(initial=0.0) < 0.0:
            raise ParameterError("normal_force", f"must not be negative, got {normal.min()}")
        return flat, normal, lead


def _check_set(value: object, argument: str) -> None:
    if not isinstance(value, StarSet):
        raise ParameterError(argument, f"must be a set such as Disk or Ellipse, got {value!r}")


def _round(radius: float, dimension: int) -> StarSet:
    match dimension:
        case 1:
            return Interval(-radius, radius)
        case 2:
            return Disk(radius)
        case _:
            return Ball(radius, dimension=dimension)
