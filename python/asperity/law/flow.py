"""Flow rules: the friction force over the sliding direction, from which C and D follow."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import KW_ONLY
from typing import Any, TypeAlias

import numpy as np
from numpy.typing import ArrayLike, NDArray

import asperity._core as _core
from asperity._base import arrays
from asperity._base.arrays import Array
from asperity._base.value import Count, NonNegative, Number, Positive, Record
from asperity.errors import ParameterError
from asperity.sets import Ellipse, PolarCurve, SupportCurve

# Directions are inserted until the force turns by less than two of the first steps, and no step is
# so many times as wide as the next one.
_MOST, _SMALLEST_STEP, _EVEN = 20_000, 1e-6, 4.0
# A step is at most this part of the angle by which the force is short of a right one from sliding.
_STEEP = 0.02
# Samples jump where the force turns by more than this in rad and by so many steps, as in the core.
_JUMP, _STEPS = 0.3, 10.0
# Directions along a flat side of D are so far apart in rad, a little more than the core joins, and
# forces there in asinh(tan ψ), for which the core's quadrature is right to seven digits.
_APART, _SHARE = 1.25e-7, 0.15

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
            largest force. Directions count to 1e-5 rad: where the force jumps, it is any between.
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
    least: float = _JUMP,
) -> tuple[PolarCurve, SupportCurve, Numbers]:
    """Return C, D and the numbers of the report for forces −λ/λ_N at rising directions.

    Where the force turns by more than `least` in rad at once, D has a flat side.
    """
    try:
        phi, force = _with_flat_sides(phi, force, least)
        theta, radius, normal, support, numbers = _core.flow_law(
            phi, np.ascontiguousarray(force), closure_tolerance, convexity_tolerance
        )
        if support.min() <= 0.0:
            raise ParameterError(argument, "must be given in smaller steps: D is thin")
        return PolarCurve(theta, radius), SupportCurve(normal, support), numbers
    except ParameterError as error:
        _, message = error.args
        raise ParameterError(argument, message) from None


def _with_flat_sides(phi: Array, force: Array, least: float) -> tuple[Array, Array]:
    """Return directions and forces to which those along the flat sides of D are added.

    The normal of a side lies anywhere between the two directions between which the force jumps, at
    the same fraction of all these intervals: the one at which D closes, or comes closest to it.
    """
    jumps, step = _jumps(phi, force, least)
    if not jumps.size:
        return phi, force
    sides = [_Side(phi[i], step[i], force[i], force[(i + 1) % len(phi)]) for i in jumps.tolist()]
    away = np.all([side.leaves(phi) for side in sides], axis=0)

    def filled(fraction: float) -> tuple[Array, Array]:
        parts = [(phi[away], force[away]), *(side.forces(fraction) for side in sides)]
        normals = np.mod(np.concatenate([part[0] for part in parts]), 2.0 * math.pi)
        order = np.argsort(normals)
        return normals[order], np.concatenate([part[1] for part in parts])[order]

    def defect(fraction: float) -> float:
        numbers = _core.flow_law(*filled(fraction), math.inf, math.inf)[-1]
        return math.log(numbers[0])

    first, last = defect(0.0), defect(1.0)
    if first * last >= 0.0:
        return filled(float(abs(last) < abs(first)))
    from scipy.optimize import brentq

    return filled(float(brentq(defect, 0.0, 1.0, xtol=1e-12)))


class _Side:
    """A flat side of D between two directions of sliding: forces on a chord of C."""

    def __init__(self, phi: float, step: float, force: Array, after: Array) -> None:
        self._ends = force, after
        middle = phi + 0.5 * step
        theta = np.arctan2(*np.stack(self._ends).T[::-1])
        # Forces at both ends are less than a right angle from the normal.
        self._theta = middle + np.remainder(theta - middle + math.pi, 2.0 * math.pi) - math.pi
        span = np.diff(np.arcsinh(np.tan(self._theta - middle)))
        self._count = max(3, math.ceil(span[0] / _SHARE))
        width = (self._count + 2) * _APART
        low = max(phi + width, self._theta[1] - 0.5 * math.pi + width)
        high = min(phi + step - width, self._theta[0] + 0.5 * math.pi - width)
        if low > high:
            low, high = middle - 0.5 * width, middle + 0.5 * width
        self._range, self._width = (low, high), width

    def leaves(self, phi: Array) -> NDArray[np.bool_]:
        """Whether directions are none of those that stand for the side."""
        low, high = self._range
        middle = 0.5 * (low + high)
        off = np.remainder(phi - middle + math.pi, 2.0 * math.pi) - math.pi
        return np.abs(off) > 0.5 * (high - low + self._width)

    def forces(self, fraction: float) -> tuple[Array, Array]:
        """Return directions that are nearly the normal, and the forces there, from end to end."""
        low, high = self._range
        normal = low + fraction * (high - low)
        ends = np.arcsinh(np.tan(self._theta - normal))
        psi = np.arctan(np.sinh(np.linspace(ends[0], ends[1], self._count)))
        ray, (force, after) = arrays.unit_vectors(normal + psi), self._ends
        radius = _cross(force, after) / (_cross(force, ray) + _cross(ray, after))
        places = np.arange(self._count) - 0.5 * (self._count - 1)
        return normal + _APART * places, radius[:, None] * ray


def _jumps(phi: Array, force: Array, least: float) -> tuple[NDArray[np.intp], Array]:
    """Return where the force jumps, and the steps between directions."""
    step = np.diff(phi, append=phi[0] + 2.0 * math.pi)
    after = np.roll(force, -1, axis=0)
    turn = np.arctan2(_cross(force, after), (force * after).sum(axis=-1))
    # Half a turn at once opposes sliding in no direction.
    at_once = (turn > np.maximum(least, _STEPS * step)) & (turn < math.pi)
    return np.flatnonzero(at_once), step


def _cross(a: Array, b: Array) -> Array:
    found: Array = a[..., 0] * b[..., 1] - a[..., 1] * b[..., 0]
    return found


def resolved(f: FlowRule, n: int, argument: str) -> tuple[Array, Array, float]:
    """Return directions and forces of a flow rule, denser where the force turns quickly.

    The force jumps where it turns by more than the third number in rad at once.
    """
    phi = 2.0 * math.pi * np.arange(n) / n
    force = _values(f, phi, argument)
    least = 4.0 * math.pi / n
    while True:
        theta = np.unwrap(np.arctan2(force[:, 1], force[:, 0]))
        turn = np.abs(np.diff(theta, append=theta[0] + 2.0 * math.pi))
        step = np.diff(phi, append=2.0 * math.pi)
        # Slopes are found from steps that differ little.
        uneven = step > _EVEN * np.minimum(np.roll(step, 1), np.roll(step, -1))
        # The force turns from sliding by up to a right angle, beside which quadrature is coarse.
        along, across = arrays.along_and_across(force, phi)
        steep = (along > 0.0) & (step * np.maximum(along, np.abs(across)) > _STEEP * along)
        coarse = ((turn > least) | uneven | steep) & (step > _SMALLEST_STEP)
        if not coarse.any() or len(phi) > _MOST:
            break
        middle = phi[coarse] + 0.5 * step[coarse]
        phi, force = np.append(phi, middle), np.vstack([force, _values(f, middle, argument)])
        order = np.argsort(phi)
        phi, force = phi[order], force[order]
    # Jumps in a row are one.
    jumps = (turn > least) & (step <= _SMALLEST_STEP)
    kept = ~(jumps & np.roll(jumps, 1))
    return phi[kept], force[kept], least


def between(f: FlowRule, phi: Array, argument: str) -> tuple[Array, Array]:
    """Return the directions in the middle between others, and the forces there."""
    middle = phi + 0.5 * np.diff(phi, append=phi[0] + 2.0 * math.pi)
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
