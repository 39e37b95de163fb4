"""The sets C and D from forces over the sliding direction."""

from __future__ import annotations

import math
from dataclasses import KW_ONLY
from functools import cached_property
from typing import Any

import numpy as np

from asperity._base import arrays
from asperity._base.arrays import Array
from asperity._base.value import AnyArray, NonNegative, Record, Vector, field
from asperity.errors import ParameterError
from asperity.law import FrictionLaw
from asperity.sets import Polygon

_TURN = 2.0 * math.pi
_FEWEST = 8
_NEAR = np.deg2rad(np.linspace(-3.0, 3.0, 13))
# Rounds of isotonic regression and closure; the second leaves changes near rounding.
_ROUNDS = 4


class MeasuredSets(Record):
    """Points of bdry C and of D from forces over one turn of the sliding direction.

    C is the curve of the forces −λ/λ_N themselves. D follows up to its scale from the deflection
    θ − φ of the force: r_D(θ) = r_D(0) exp∫tan(θ − φ) dθ, and without differentiating from its
    support function h_D(φ) = h_D(0) exp∫tan(θ − φ) dφ. Both are given, scaled by the largest number
    that keeps D in C. They are pictures, starting values and diagnostics: their errors add up along
    the integral.

    Args:
        phi: rising directions φ of sliding within one turn in rad, shape ``(k,)``.
        force: −λ/λ_N, shape ``(k, 2)``.

    Attributes:
        theta: angle θ of the force in rad, without jumps; shape ``(k,)``.
        radius: r_C(θ), shape ``(k,)``.
        reservoir_points: −λ/λ_N again, the points of bdry C, shape ``(k, 2)``.
        closure: r_D(2π)/r_D(0); only where it is 1 is there a direction set.
        convexity_defect: largest decrease of θ while φ grows in rad; where it is 0, D is convex.
        asymmetry: largest |f(φ + π) + f(φ)| relative to the largest force; 0 for a law that does
            not tell forwards from backwards.
        direction_by_integration: points of D by (125), shape ``(k, 2)``.
        direction_by_support: points of D by its support function, shape ``(k, 2)``.
        difference: largest |ln r_D| between the two.

    Raises:
        ParameterError: if the force does not oppose sliding in some direction.

    Reference: [WL19] §5.2, (121)–(125).

    >>> import numpy as np
    >>> from asperity import Ellipse, FrictionLaw
    >>> from asperity.identify import MeasuredSets
    >>> phi = 2.0 * np.pi * np.arange(720) / 720
    >>> law = FrictionLaw(Ellipse(0.5, 0.4), Ellipse(3.0, 2.0))
    >>> sets = MeasuredSets(phi, -law.force(np.stack([np.cos(phi), np.sin(phi)], axis=-1)))
    >>> abs(sets.closure - 1.0) < 1e-12, sets.convexity_defect, sets.difference < 1e-4
    (True, 0.0, True)
    """

    phi: Vector
    force: AnyArray
    theta: Array = field(init=False)
    radius: Array = field(init=False)
    reservoir_points: Array = field(init=False)
    closure: float = field(init=False)
    convexity_defect: float = field(init=False)
    asymmetry: float = field(init=False)
    direction_by_integration: Array = field(init=False)
    direction_by_support: Array = field(init=False)
    difference: float = field(init=False)
    _slope: Array = field(init=False)

    def _complete(self, given: dict[str, Any]) -> None:
        given["force"] = arrays.array(given["force"], "force", (len(given["phi"]), 2))
        _check_directions(given["phi"])

    def _derive(self) -> None:
        angle, f = self.phi, self.force
        along, across = _parts(angle, f)
        slope = across / along
        theta = angle + np.arctan(slope)
        radius = np.hypot(*f.T)
        logarithm = float(_steps(angle) @ slope)
        even = slope - logarithm / _TURN
        support = _integral(angle, even)
        # r = h/cos(θ − φ): the tangent at the support point is across φ.
        by_support = support + 0.5 * np.log1p(slope**2)
        by_integration = _integral(theta, slope - logarithm / _TURN)
        self._keep(
            theta=theta,
            radius=radius,
            reservoir_points=self.force,
            closure=math.exp(logarithm),
            convexity_defect=_largest_fall(theta),
            asymmetry=_asymmetry(angle, f),
            direction_by_integration=_inside(by_integration, radius, theta),
            direction_by_support=_inside(by_support, radius, theta),
            difference=_distance(by_integration, by_support),
            _slope=even,
        )

    def __repr__(self) -> str:
        return (
            f"<MeasuredSets: {len(self.phi)} directions, closure {self.closure:.6g}, "
            f"convexity defect {self.convexity_defect:.3g} rad>"
        )

    @cached_property
    def direction(self) -> ConvexDirection:
        """The convex set D nearest to the data, and how much it differs from them."""
        return _corrected(self.phi, self.force, self._slope)

    @property
    def radii_on_axes(self) -> tuple[float, float]:
        """Radius of C on e₁ and on e₂, each a mean over ±3° on both sides."""
        axes = np.pi * np.arange(4) / 2.0
        near = (axes[:, None] + _NEAR).ravel()
        radii = np.interp(near, self.theta, self.radius, period=_TURN).reshape(2, 2, -1)
        first, second = radii.mean(axis=(0, 2)).tolist()
        return first, second

    def law(self, **options: Any) -> FrictionLaw:
        """Return the law of the measured forces, by `FrictionLaw.from_samples` with its options."""
        return FrictionLaw.from_samples(self.phi, self.force, **options)


class ConvexDirection(Record):
    """A convex D from measured forces: isotonic regression of θ over φ, then half-planes.

    Args:
        polygon: D, the intersection of the half-planes x·(cos φ, sin φ) ≤ h_D(φ), inside C.
        angle_change: largest change of θ in rad.
        support_change: largest relative change of h_D, closure apart.
    """

    polygon: Polygon
    _: KW_ONLY
    angle_change: NonNegative
    support_change: NonNegative


def _check_directions(phi: Array) -> None:
    if len(phi) < _FEWEST:
        raise ParameterError("phi", f"must hold {_FEWEST} directions or more, got {len(phi)}")
    steps = np.diff(phi, append=phi[0] + _TURN)
    if steps.min() <= 0.0 or steps.max() > 0.25 * _TURN:
        raise ParameterError("phi", "must rise within one turn, without a gap above π/2")


def _parts(phi: Array, force: Array) -> tuple[Array, Array]:
    """Return l_t and l_p."""
    along, across = arrays.along_and_across(force, phi)
    if along.min() <= 0.0:
        at = phi[along.argmin()]
        raise ParameterError(
            "force", f"must oppose sliding, does not in the direction {at:.6g} rad"
        )
    return along, across


def _steps(angle: Array) -> Array:
    """Return the weights of the trapezoidal rule over a turn."""
    step = np.diff(angle, append=angle[0] + _TURN)
    return 0.5 * (step + np.roll(step, 1))


def _integral(angle: Array, values: Array) -> Array:
    """Return the integral from the first angle on, by the trapezoidal rule."""
    from scipy.integrate import cumulative_trapezoid

    return np.asarray(cumulative_trapezoid(values, angle, initial=0), dtype=np.float64)


def _largest_fall(theta: Array) -> float:
    """Return by how much θ falls below an earlier value, over two turns."""
    twice = np.concatenate([theta, theta + _TURN])
    return float((np.maximum.accumulate(twice) - twice).max())


def _asymmetry(phi: Array, force: Array) -> float:
    opposite = np.stack(
        [np.interp(phi + math.pi, phi, column, period=_TURN) for column in force.T], axis=-1
    )
    return float(np.hypot(*(force + opposite).T).max() / np.hypot(*force.T).max())


def _inside(log_radius: Array, reservoir: Array, theta: Array) -> Array:
    """Return points of D at the angles of the forces, at the largest scale inside C."""
    scale = (np.log(reservoir) - log_radius).min()
    return np.exp(log_radius + scale)[:, None] * arrays.unit_vectors(theta)


def _distance(a: Array, b: Array) -> float:
    """Return the largest difference of two logarithms of free scale."""
    apart = a - b
    return 0.5 * float(apart.max() - apart.min())


def _corrected(phi: Array, force: Array, slope: Array) -> ConvexDirection:
    raw = _integral(phi, slope)
    theta, weights = phi + np.arctan(slope), _steps(phi)
    level = slope
    for _ in range(_ROUNDS):
        # The slopes stay finite: means of angles within π/2 of rising directions.
        level = np.tan(_isotonic(phi + np.arctan(level)) - phi)
        level = level - float(weights @ level) / _TURN
    support = _integral(phi, level)
    vertices = _intersection(phi, np.exp(support))
    factor = float(Polygon(vertices).gauge(force).min())
    return ConvexDirection(
        Polygon(factor * vertices),
        angle_change=float(np.abs(phi + np.arctan(level) - theta).max()),
        support_change=_distance(support, raw),
    )


def _isotonic(theta: Array) -> Array:
    """Return the nearest angles that never fall, going round."""
    from scipy.optimize import isotonic_regression

    n = len(theta)
    thrice = np.concatenate([theta - _TURN, theta, theta + _TURN])
    return np.asarray(isotonic_regression(thrice).x[n : 2 * n], dtype=np.float64)


def _intersection(phi: Array, support: Array) -> Array:
    """Return the vertices of the intersection of half-planes x·(cos φ, sin φ) ≤ h.

    The half-planes that count are the vertices of the convex hull of the poles (cos φ, sin φ)/h.
    """
    from scipy.spatial import ConvexHull

    poles = arrays.unit_vectors(phi) / support[:, None]
    here = poles[ConvexHull(poles).vertices]
    # The vertex where x·a = 1 and x·b = 1 for neighbouring poles a, b.
    edge = np.roll(here, -1, axis=0) - here
    area = here[:, 0] * edge[:, 1] - here[:, 1] * edge[:, 0]
    return np.stack([edge[:, 1], -edge[:, 0]], axis=-1) / area[:, None]
