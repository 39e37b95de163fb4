"""Flow rules: the friction force over the sliding direction, from which C and D follow."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import KW_ONLY
from typing import Any, TypeAlias

import numpy as np
from numpy.typing import ArrayLike

from asperity import _core
from asperity._base import arrays
from asperity._base.arrays import Array
from asperity._base.value import Count, NonNegative, Number, Positive, Record
from asperity.errors import ParameterError
from asperity.sets import Ellipse, PolarCurve, SupportCurve

# Directions are inserted until the force turns by less than two of the first steps.
_ROUNDS, _MOST, _SMALLEST_STEP = 24, 20_000, 1e-6

FlowRule: TypeAlias = Callable[[Array], ArrayLike]
"""From angles φ of the sliding direction, ``(n,)``, to −λ/λ_N, ``(n, 2)``."""


class FlowReport(Record):
    """What was found, and repaired, when a law was built from forces over sliding directions.

    Args:
        closure: r_D(2π)/r_D(0); only where it is 1 is there a direction set.
        convexity_defect: largest decrease of the force's angle θ(φ) in rad, where D would not be
            convex; 0 if there is none.
        smallest_resistance: smallest l_t, the force against sliding per unit normal force.
        repair: bound of the relative change of r_D made to close D and to keep it convex.
        misfit: largest distance of the law's force from the given ones, between the directions
            that were used for a flow rule, at all samples for measured forces; relative to the
            largest force.
        samples: number of sliding directions.
        order: order of the trigonometric series that smoothed the samples; None if they were
            interpolated.
        noise: standard deviation of a force component from the series.

    Reference: [WL19] (71), (125).

    >>> from asperity import FrictionLaw
    >>> law = FrictionLaw.tensor_function(lambda phi: 0.3 * np.ones((len(phi), 1, 1)) * np.eye(2))
    >>> law.report.samples, round(law.report.smallest_resistance, 12)
    (1440, 0.3)
    """

    closure: Positive
    convexity_defect: NonNegative
    smallest_resistance: Number
    repair: NonNegative
    _: KW_ONLY
    misfit: NonNegative
    samples: Count
    order: Count | None = None
    noise: NonNegative = 0.0


Numbers: TypeAlias = tuple[float, float, float, float]
"""Closure, convexity defect, smallest resistance, repair."""


def sets_of(
    phi: Array,
    force: Array,
    closure_tolerance: float,
    convexity_tolerance: float,
    argument: str = "force",
) -> tuple[PolarCurve, SupportCurve, Numbers]:
    """Return C, D and the numbers of the report for forces −λ/λ_N at rising directions."""
    try:
        theta, radius, normal, support, numbers = _core.flow_law(
            phi, np.ascontiguousarray(force), closure_tolerance, convexity_tolerance
        )
        return PolarCurve(theta, radius), SupportCurve(normal, support), numbers
    except ParameterError as error:
        _, message = error.args
        raise ParameterError(argument, message) from None


def resolved(f: FlowRule, n: int, argument: str) -> tuple[Array, Array]:
    """Return directions and forces of a flow rule, denser where the force turns quickly."""
    phi = 2.0 * math.pi * np.arange(n) / n
    force = _values(f, phi, argument)
    for _ in range(_ROUNDS):
        theta = np.unwrap(np.arctan2(force[:, 1], force[:, 0]))
        turn = np.abs(np.diff(theta, append=theta[0] + 2.0 * math.pi))
        step = np.diff(phi, append=2.0 * math.pi)
        coarse = (turn > 4.0 * math.pi / n) & (step > _SMALLEST_STEP)
        if not coarse.any() or len(phi) > _MOST:
            break
        middle = phi[coarse] + 0.5 * step[coarse]
        phi, force = np.append(phi, middle), np.vstack([force, _values(f, middle, argument)])
        order = np.argsort(phi)
        phi, force = phi[order], force[order]
    return phi, force


def between(f: FlowRule, phi: Array, argument: str) -> tuple[Array, Array]:
    """Return the directions in the middle between others, and the forces there."""
    middle = phi + 0.5 * np.diff(phi, append=2.0 * math.pi)
    return middle, _values(f, middle, argument)


def _values(f: FlowRule, phi: Array, argument: str) -> Array:
    if not callable(f):
        raise ParameterError(argument, f"must be a function of the direction, got {f!r}")
    return arrays.array(f(phi), argument, (len(phi), 2))


def wedges(mu: float, beta: ArrayLike, weights: ArrayLike | None) -> FlowRule:
    """Return the mean force of springs on rising and falling flanks of unequal inclination."""
    slopes = arrays.array(beta, "beta", (2,))
    if slopes.min() <= 0.0:
        raise ParameterError("beta", f"must be positive, got {slopes.tolist()}")
    if mu * np.tan(slopes).max() >= 1.0 or slopes.max() >= 0.5 * math.pi:
        raise ParameterError("beta", f"must keep mu*tan(beta) below 1, got {slopes.tolist()}")
    # Each flank's share of the profile's length: a frictionless surface then carries no mean force.
    shares = 1.0 / np.tan(slopes) if weights is None else arrays.array(weights, "weights", (2,))
    if shares.min() < 0.0 or shares.sum() <= 0.0:
        raise ParameterError("weights", f"must not be negative nor all 0, got {shares.tolist()}")
    rising, falling = shares / shares.sum()

    def mean(phi: Array) -> Array:
        climb, descent = _flank(phi, mu, slopes[0]), _flank(phi, mu, -slopes[1])
        return rising * climb + falling * descent

    return mean


def _flank(phi: Array, mu: float, slope: float) -> Array:
    """Return −λ/λ_N of a spring on a flank that rises by the angle `slope` along e₁."""
    # Direction (c₁, c₂) of sliding within the flank.
    across, along = np.cos(phi), math.cos(slope) * np.sin(phi)
    length = np.hypot(across, along)
    c1, c2 = across / length, along / length
    ahead = np.tan(slope + np.arctan(mu * c1))
    aside = mu * c2 / (math.cos(slope) - mu * c1 * math.sin(slope))
    return np.stack([ahead, aside], axis=-1)


def tensor(second_order: Array, fourth_order: Array | None) -> FlowRule:
    """Return f = F n + K[n, n, n], n = (cos φ, sin φ)."""

    def force(phi: Array) -> Array:
        n = arrays.unit_vectors(phi)
        linear = n @ second_order.T
        if fourth_order is None:
            return linear
        cubic: Array = np.einsum("ijkl,nj,nk,nl->ni", fourth_order, n, n, n)
        return linear + cubic

    return force


def tensor_function(given: Any) -> FlowRule:
    """Return f = F(φ) n of a function F or of pairs (A_k, B_k), a trigonometric polynomial."""
    if callable(given):
        matrices = given
    else:
        pairs = arrays.array(given, "tensor", (None, 2, 2, 2))

        def matrices(phi: Array) -> Array:
            angles = np.multiply.outer(phi, np.arange(len(pairs)))
            waves = np.stack([np.cos(angles), np.sin(angles)], axis=-1)
            return np.einsum("nks,ksij->nij", waves, pairs)

    def force(phi: Array) -> Array:
        values = arrays.array(matrices(phi), "tensor", (len(phi), 2, 2))
        return np.einsum("nij,nj->ni", values, arrays.unit_vectors(phi))

    return force


def ellipses(tensor: Array) -> tuple[Ellipse, Ellipse]:
    """Return C and D of a symmetric friction tensor: x = F n on bdry C, z ∝ F n on bdry D."""
    difference = tensor[0, 0] - tensor[1, 1]
    angle = 0.5 * math.atan2(math.copysign(1.0, difference) * 2.0 * tensor[0, 1], abs(difference))
    axes = arrays.rotation(angle)
    mu = np.diag(axes.T @ tensor @ axes)
    if mu.min() <= 0.0:
        raise ParameterError(
            "second_order", f"must be positive definite, has the eigenvalue {mu.min()}"
        )
    (a, b), (p1, p2) = mu, np.sqrt(mu)
    return Ellipse(a, b, angle=angle), Ellipse(p1, p2, angle=angle)
