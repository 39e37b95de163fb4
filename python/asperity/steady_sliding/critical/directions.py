"""The sliding directions that are critical."""

from __future__ import annotations

import numpy as np

from asperity._base import arrays
from asperity._base.arrays import Array, unit_vectors
from asperity.errors import DimensionError, ParameterError
from asperity.law import FrictionLaw
from asperity.sets import StarSet
from asperity.steady_sliding.critical.intervals import CriticalIntervals
from asperity.steady_sliding.critical.scan import negative, refined

# Angle by which normals are taken on both sides of a point, to see corners.
_SIDE = 1e-12


def margins(C: StarSet, D: StarSet, slip: Array, rotation: Array | float = 0.0) -> Array:
    """Return the angles by which γ is outside T_C(−λ), negative in its interior.

    At a corner of C the normals on both sides count: the tangent cone is the intersection of the
    half-planes at a convex corner, their union at a re-entrant one.

    Args:
        C: planar force reservoir.
        D: planar direction set.
        slip: γ, shape ``(n, 2)``.
        rotation: angles by which C is turned first, a number or shape ``(n,)``.
    """
    z, gamma = _turned(D.support_point(slip), rotation), _turned(slip, rotation)
    z /= np.linalg.norm(z, axis=-1)[:, None]
    aside = _SIDE * np.stack([-z[:, 1], z[:, 0]], axis=-1)
    before, after = C.gauge_gradient(z - aside), C.gauge_gradient(z + aside)
    sines = [_sine(normal, gamma) for normal in (before, after)]
    turn = before[:, 0] * after[:, 1] - before[:, 1] * after[:, 0]
    sine = np.where(turn >= 0.0, np.maximum(*sines), np.minimum(*sines))
    return np.arcsin(np.clip(sine, -1.0, 1.0))


def destabilising(C: StarSet, D: StarSet, slip: Array, rotation: Array | float = 0.0) -> Array:
    """Return the `margins` of directions in which the force turns with γ, π/2 of the others.

    At a corner of D, H = ∇²Ψ*_D(γ) vanishes, and ∂λ/∂γ with it: the force is the same for all
    normals of the corner, and a mass swings about its equilibrium as without friction.
    """
    turns = D.support_hessian(slip).any(axis=(-2, -1))
    return np.where(turns, margins(C, D, slip, rotation), 0.5 * np.pi)


def critical_directions(law: FrictionLaw) -> CriticalIntervals:
    """Return the intervals of sliding direction in which γ ∈ int T_C(−λ) and the force turns.

    There a body with M ∝ I slides unsteadily on a belt. φ is the direction of γ, of the body's slip
    over the ground: on a belt that moves along φ_b a resting body slips along φ_b + π, which is
    not the same unless C and D are symmetric; `growth_chart` uses φ_b. Where D is flat the
    force is set-valued for one direction, which is no interval and is not reported. Where D has a
    corner, the force does not turn with γ, ∂λ/∂γ = 0, and no direction is critical.

    Args:
        law: planar friction law; its rate factor does not matter.

    Returns:
        (φ₀, φ₁) in rad with 0 ≤ φ₀ < 2π and φ₀ < φ₁, ends to 1e-10; φ₁ > 2π if the interval holds
        the direction 0. (0, 2π) if all directions are critical. They are a sequence of pairs with
        `summary` and `to_pandas`.

    Raises:
        DimensionError: if the law is not planar.

    Reference: [WL19] Thm. 2, (114).

    >>> import math
    >>> from asperity import Ellipse, FrictionLaw, critical_directions
    >>> law = FrictionLaw(Ellipse(3.0, 1.0, angle=math.pi / 6), Ellipse(3.0, 1.0))
    >>> [round(math.degrees(phi), 3) for phi in critical_directions(law)[0]]
    [44.106, 75.894]
    """
    arrays.of_kind(law, "law", FrictionLaw, "a FrictionLaw")
    if law.dimension != 2:
        raise DimensionError(
            "law", f"must be planar for this, this one is not: p = {law.dimension}"
        )
    C, D = law.reservoir, law.direction

    def margin(phi: Array) -> Array:
        return destabilising(C, D, unit_vectors(phi))

    def shape(phi: Array) -> Array:
        z = D.support_point(unit_vectors(phi))
        return np.stack([angle_of(z), angle_of(C.gauge_gradient(z))], axis=-1)

    return CriticalIntervals(negative(margin, refined(shape)), angle="sliding direction")


def ellipses_can_be_unstable(n1: float, n2: float, nu: float, p1: float, p2: float) -> bool:
    """Return whether |ν| > 4 p₁p₂/(n₁n₂ (p₁² + p₂²)): some sliding directions are critical.

    Args:
        n1: intercept n₁ > 0 of C = `Ellipse.from_intercepts(n1, n2, nu)`.
        n2: intercept n₂ > 0 of C.
        nu: ν, with |ν| < 2/(n₁n₂).
        p1: semi-axis p₁ > 0 of D along e₁.
        p2: semi-axis p₂ > 0 of D along e₂.

    Reference: [WL19] (118).

    >>> from asperity import Ellipse
    >>> from asperity.steady_sliding import ellipses_can_be_unstable
    >>> ellipses_can_be_unstable(1.5, 1.5, 0.6, 3.0, 1.0)
    True
    >>> ellipses_can_be_unstable(1.5, 1.5, 0.5, 3.0, 1.0)
    False
    """
    n1, n2, p1, p2 = (
        arrays.positive(value, name)
        for value, name in ((n1, "n1"), (n2, "n2"), (p1, "p1"), (p2, "p2"))
    )
    nu = abs(arrays.number(nu, "nu"))
    if nu * n1 * n2 >= 2.0:
        raise ParameterError("nu", f"must be below 2/(n1 n2) = {2.0 / (n1 * n2)}, got {nu}")
    return bool(nu * n1 * n2 * (p1**2 + p2**2) > 4.0 * p1 * p2)


def _turned(x: Array, angle: Array | float) -> Array:
    """Return vectors turned clockwise."""
    c, s = np.cos(angle), np.sin(angle)
    return np.stack([c * x[:, 0] + s * x[:, 1], c * x[:, 1] - s * x[:, 0]], axis=-1)


def _sine(normal: Array, gamma: Array) -> Array:
    along: Array = (normal * gamma).sum(axis=-1)
    return along / (np.linalg.norm(normal, axis=-1) * np.linalg.norm(gamma, axis=-1))


def angle_of(x: Array) -> Array:
    """Return the angles of plane vectors, shape ``(..., 2)``."""
    return np.arctan2(x[..., 1], x[..., 0])
