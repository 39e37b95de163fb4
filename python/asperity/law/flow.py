"""Flow rules: the friction force over the sliding direction, from which C and D follow."""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import Any, TypeAlias

import numpy as np
from numpy.typing import ArrayLike

from asperity import _arrays, _core
from asperity._arrays import Array
from asperity._value import Value
from asperity.errors import ParameterError
from asperity.sets import PolarCurve, SupportCurve

FlowRule: TypeAlias = Callable[[Array], ArrayLike]
"""From angles φ of the sliding direction, ``(n,)``, to −λ/λ_N, ``(n, 2)``."""


class FlowReport(Value):
    """What was found, and repaired, when a law was built from forces over sliding directions.

    Args:
        closure: r_D(2π)/r_D(0); only where it is 1 is there a direction set.
        convexity_defect: largest decrease of the force's angle θ(φ) in rad, where D would not be
            convex; 0 if there is none.
        smallest_resistance: smallest l_t, the force against sliding per unit normal force.
        repair: largest relative change of r_D made to close D and to keep it convex.
        samples: number of sliding directions.

    Reference: [WL19] (71), (125).

    >>> from asperity import FrictionLaw
    >>> law = FrictionLaw.tensor_function(lambda phi: 0.3 * np.ones((len(phi), 1, 1)) * np.eye(2))
    >>> law.report.samples, round(law.report.smallest_resistance, 12)
    (1440, 0.3)
    """

    closure: float
    convexity_defect: float
    smallest_resistance: float
    repair: float
    samples: int

    def __init__(
        self,
        closure: float,
        convexity_defect: float,
        smallest_resistance: float,
        repair: float,
        samples: int,
    ) -> None:
        self._set(
            closure=_arrays.positive(closure, "closure"),
            convexity_defect=_arrays.non_negative(convexity_defect, "convexity_defect"),
            smallest_resistance=_arrays.number(smallest_resistance, "smallest_resistance"),
            repair=_arrays.non_negative(repair, "repair"),
            samples=_arrays.count(samples, "samples"),
        )


def sets_of(
    phi: Array, force: Array, closure_tolerance: float, convexity_tolerance: float
) -> tuple[PolarCurve, SupportCurve, FlowReport]:
    """Return C, D and the report of the law with these forces −λ/λ_N over sliding directions."""
    order = np.argsort(np.mod(phi, 2.0 * math.pi))
    theta, radius, normal, support, numbers = _core.flow_law(
        np.mod(phi, 2.0 * math.pi)[order],
        np.ascontiguousarray(force[order]),
        _arrays.non_negative(closure_tolerance, "closure_tolerance"),
        _arrays.non_negative(convexity_tolerance, "convexity_tolerance"),
    )
    report = FlowReport(*numbers, samples=len(phi))
    return PolarCurve(theta, radius), SupportCurve(normal, support), report


def wedges(mu: float, beta: ArrayLike, weights: ArrayLike | None) -> FlowRule:
    """Return the mean force of springs on rising and falling flanks of unequal inclination."""
    slopes = _arrays.array(beta, "beta", (2,))
    if slopes.min() <= 0.0:
        raise ParameterError("beta", f"must be positive, got {slopes.tolist()}")
    if mu * np.tan(slopes).max() >= 1.0 or slopes.max() >= 0.5 * math.pi:
        raise ParameterError("beta", f"must keep mu*tan(beta) below 1, got {slopes.tolist()}")
    # Each flank's share of the profile's length: a frictionless surface then carries no mean force.
    shares = 1.0 / np.tan(slopes) if weights is None else _arrays.array(weights, "weights", (2,))
    if shares.min() < 0.0 or shares.sum() <= 0.0:
        raise ParameterError("weights", f"must not be negative nor all 0, got {shares.tolist()}")
    rising, falling = shares / shares.sum()

    def mean(phi: Array) -> Array:
        climb, descent = _flank(phi, mu, slopes[0]), _flank(phi, mu, -slopes[1])
        force: Array = rising * climb + falling * descent
        return force

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
        n = _arrays.unit_vectors(phi)
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
        pairs = _arrays.array(given, "tensor", (None, 2, 2, 2))

        def matrices(phi: Array) -> Array:
            angles = np.multiply.outer(phi, np.arange(len(pairs)))
            waves = np.stack([np.cos(angles), np.sin(angles)], axis=-1)
            values: Array = np.einsum("nks,ksij->nij", waves, pairs)
            return values

    def force(phi: Array) -> Array:
        values = _arrays.array(matrices(phi), "tensor", (len(phi), 2, 2))
        product: Array = np.einsum("nij,nj->ni", values, _arrays.unit_vectors(phi))
        return product

    return force
