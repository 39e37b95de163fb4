"""Is the flow associated? Whether the force across is the derivative of the force along sliding.

A law with force reservoir C and direction set D is associated if D = C: then −λ/λ_N = f(γ) is the
gradient of Ψ*_C(γ) = γᵀf(γ), and no admissible force dissipates more ([WL19] Prop. 2–4: it is
maximal monotone). In the plane, with f(φ) = l_t e(φ) + l_p e⊥(φ), it is so if l_p = dl_t/dφ, or

    l_t(φ₁) − l_t(φ₀) = ∫ l_p dφ   over the arc from φ₀ to φ₁,

which asks for no derivative: forces that turn at once, as where D has flat sides, do no harm.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import TypeAlias

import numpy as np

from asperity._base import arrays
from asperity._base.arrays import Array
from asperity._base.value import Record
from asperity.identify.estimator.covariance import Covariance
from asperity.identify.models.coordinates import Estimate

Forces: TypeAlias = Callable[[Array, Array], Array]
"""Forces −λ/λ_N ``(n, 2)`` at sliding directions φ, for coordinates."""

# Arcs are taken about these directions.
_ARC = math.radians(15.0)
_MIDDLES: Array = np.arange(360, dtype=np.float64) * (2.0 * math.pi / 360)
_NODES, _WEIGHTS = np.polynomial.legendre.leggauss(12)
_STEP = 1e-5
# Forces along the sliding that vary less than this, relative to the forces, tell no slope.
_CONSTANT = 1e-9


class Associativity(Record):
    """How far forces are from those of an associated law, D = C.

    Args:
        slope: the factor between the force across the sliding and the derivative of the force along
            it, by least squares over the directions: 1 for an associated law, 0 for a collinear
            one. It is not identifiable where the force along is the same in all directions.
        defect: root mean square of the difference of the two, relative to the force.
        defect_error: root mean square of its standard errors, NaN without confidence intervals.
        shortfall: by which part of the power that is dissipated another admissible force would
            dissipate more, in the direction where this is most; 0 for a law that is maximal
            monotone, which an associated law is.

    >>> from asperity.identify import Associativity, Estimate
    >>> none = Estimate(0.0, 0.0, 0.001, 0.0005)
    >>> Associativity(Estimate(0.98, 0.95, 1.01, 0.015), 0.002, 0.003, none).may_be_associated
    True
    """

    slope: Estimate
    defect: float
    defect_error: float
    shortfall: Estimate

    @property
    def may_be_associated(self) -> bool:
        """Whether the confidence interval of the slope holds 1."""
        return not self.slope.identifiable or self.slope.covers(1.0)

    def __str__(self) -> str:
        if not self.slope.identifiable:
            return "the force along the sliding is the same in all directions"
        return (
            f"the transverse force is {self.slope} times the associated value; some admissible "
            f"force would dissipate up to {self.shortfall.value:.2%} more"
        )


def associativity_of(
    force: Forces,
    p: Array,
    covariance: Covariance | None,
    *,
    confidence: float | None,
) -> Associativity:
    """Return how far the forces of a model are from associated ones, with bands.

    Args:
        force: of the model, for sliding directions and coordinates.
        p: the coordinates that were fitted.
        covariance: of these.
        confidence: level of the bands.
    """
    x, y, size = _changes(force, p)
    e = arrays.unit_vectors(_MIDDLES)
    powers = e @ force(_MIDDLES, p).T
    more: Array = np.max(powers / np.diag(powers)[:, None], axis=1)
    at = int(np.argmax(more))
    other = int(powers[at].argmax())
    pair = [at, other]

    def features(coordinates: Array) -> Array:
        """Return slope, shortfall and the differences, of other coordinates."""
        changes, across, _ = _changes(force, coordinates)
        f = force(_MIDDLES[pair], coordinates)
        slope = changes @ across / max(float(changes @ changes), np.finfo(float).tiny)
        shortfall = f[1] @ e[at] / (f[0] @ e[at]) - 1.0
        return np.concatenate([[slope, shortfall], across - changes])

    found = features(p)
    told = math.sqrt(float(x @ x) / x.size) > _CONSTANT * size
    defect = math.sqrt(float(((y - x) ** 2).mean())) / size
    if covariance is None or confidence is None:
        slope, shortfall = (
            Estimate(value, math.nan, math.nan, math.nan) for value in found[:2].tolist()
        )
        return Associativity(slope if told else _OPEN, defect, math.nan, shortfall)
    by = np.stack(
        [
            (features(p + _STEP * unit) - features(p - _STEP * unit)) / (2.0 * _STEP)
            for unit in np.eye(p.size)
        ],
        axis=-1,
    )
    widths = covariance.half_widths(by[:2], confidence)
    errors = np.sqrt(np.maximum(np.einsum("ij,jk,ik->i", by, covariance.total, by), 0.0))
    slope = Estimate(found[0], found[0] - widths[0], found[0] + widths[0], errors[0])
    least = max(found[1] - widths[1], 0.0)
    shortfall = Estimate(found[1], least, found[1] + widths[1], errors[1])
    return Associativity(
        slope if told else _OPEN,
        defect,
        math.sqrt(float((errors[2:] ** 2).mean())) / size,
        shortfall,
    )


_OPEN = Estimate(math.nan, -math.inf, math.inf, math.inf, identifiable=False)


def _changes(force: Forces, p: Array) -> tuple[Array, Array, float]:
    """Return the change of the force along and the mean of that across, per rad; the size."""
    ends = (_MIDDLES[:, None] + np.array([-0.5, 0.5]) * _ARC).ravel()
    nodes = (_MIDDLES[:, None] + 0.5 * _ARC * _NODES).ravel()
    along, _ = arrays.along_and_across(force(ends, p), ends)
    inner = force(nodes, p)
    _, across = arrays.along_and_across(inner, nodes)
    size = math.sqrt(float((inner**2).sum(axis=-1).mean()))
    change = np.diff(along.reshape(-1, 2))[:, 0] / _ARC
    return change, across.reshape(-1, len(_NODES)) @ (0.5 * _WEIGHTS), size
