"""Is the flow associated? Whether the force across is the derivative of the force along sliding.

A law with force reservoir C and direction set D is associated if D = C: then −λ/λ_N = f(γ) is the
gradient of Ψ*_C(γ) = γᵀf(γ), and no admissible force dissipates more ([WL19] Prop. 2–4: it is
maximal monotone). In the plane, with f(φ) = l_t e(φ) + l_p e⊥(φ), it is so if l_p = dl_t/dφ. In R^p
the force integrates along any arc of directions e to the change of eᵀf,

    e₁ᵀf(e₁) − e₀ᵀf(e₀) = ∫ f(e)ᵀ de   over the arc from e₀ to e₁,

which asks for no derivative: forces that turn at once, as where D has flat sides, do no harm.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import NamedTuple, TypeAlias

import numpy as np

from asperity._base.arrays import Array
from asperity._base.value import Record
from asperity.identify.estimator.covariance import Covariance
from asperity.identify.models.coordinates import Estimate

Forces: TypeAlias = Callable[[Array, Array], Array]
"""Forces −λ/λ_N ``(n, p)`` while sliding along unit vectors ``(n, p)``, for coordinates."""

_ARC = math.radians(15.0)
_NODES = 12
# Directions about which arcs are taken.
_IN_THE_PLANE, _ON_THE_SPHERE = 360, 400
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
            f"the force across the sliding is {self.slope} times what D = C would make it; another "
            f"admissible force would dissipate up to {self.shortfall.value:.2%} more"
        )


def associativity_of(
    force: Forces,
    p: Array,
    covariance: Covariance | None,
    *,
    confidence: float | None,
    dimension: int = 2,
) -> Associativity:
    """Return how far the forces of a model are from associated ones, with bands.

    Args:
        force: of the model, for directions and coordinates.
        p: the coordinates that were fitted.
        covariance: of these.
        confidence: level of the bands.
        dimension: 2 for sliding, 3 for sliding and drilling.
    """
    arcs = _arcs(dimension)
    x, y, size = arcs.changes(force, p)
    middles = force(arcs.middles, p)
    powers = arcs.middles @ middles.T
    more: Array = np.max(powers / np.diag(powers)[:, None], axis=1)
    at = int(np.argmax(more))
    other = int(powers[at].argmax())
    pair = arcs.middles[[at, other]]

    def features(coordinates: Array) -> Array:
        """Return slope, shortfall and the differences, of other coordinates."""
        changes, across, _ = arcs.changes(force, coordinates)
        f = force(pair, coordinates)
        slope = changes @ across / max(float(changes @ changes), np.finfo(float).tiny)
        shortfall = f[1] @ pair[0] / (f[0] @ pair[0]) - 1.0
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


class _Arcs(NamedTuple):
    """Arcs of unit vectors.

    Attributes:
        middles: about which they are, ``(n, p)``.
        ends: of the arcs, ``(m, 2, p)``.
        nodes: of a quadrature on them, ``(m, q, p)``.
        tangents: there, ``(m, q, p)``.
        weights: of the quadrature, whose sum is 1, ``(q,)``.
    """

    middles: Array
    ends: Array
    nodes: Array
    tangents: Array
    weights: Array

    def changes(self, force: Forces, p: Array) -> tuple[Array, Array, float]:
        """Return the change of the force along and the mean of that across, per rad; the size."""
        at_ends = force(self.ends.reshape(-1, self.ends.shape[-1]), p).reshape(self.ends.shape)
        at_nodes = force(self.nodes.reshape(-1, self.nodes.shape[-1]), p)
        at_nodes = at_nodes.reshape(self.nodes.shape)
        along = (self.ends * at_ends).sum(axis=-1)
        across = (self.tangents * at_nodes).sum(axis=-1) @ self.weights
        size = math.sqrt(float((at_nodes**2).sum(axis=-1).mean()))
        return (along[:, 1] - along[:, 0]) / _ARC, across, size


def _arcs(dimension: int) -> _Arcs:
    """Return arcs of 15° about directions that are evenly spread."""
    middles, tangents = _frames(dimension)
    nodes, weights = np.polynomial.legendre.leggauss(_NODES)
    start = np.repeat(middles, tangents.shape[1], axis=0)[:, None]
    turn = tangents.reshape(-1, 1, dimension)

    def at(angle: Array) -> tuple[Array, Array]:
        c, s = np.cos(angle)[:, None], np.sin(angle)[:, None]
        return c * start + s * turn, c * turn - s * start

    ends, _ = at(np.array([-0.5, 0.5]) * _ARC)
    inner, along = at(0.5 * _ARC * nodes)
    return _Arcs(middles, ends, inner, along, 0.5 * weights)


def _frames(dimension: int) -> tuple[Array, Array]:
    """Return directions ``(n, p)`` with the tangents of arcs through them, ``(n, p − 1, p)``."""
    if dimension == 2:
        phi = np.arange(_IN_THE_PLANE) * (2.0 * np.pi / _IN_THE_PLANE)
        e = np.stack([np.cos(phi), np.sin(phi)], axis=-1)
        return e, np.stack([-e[:, 1], e[:, 0]], axis=-1)[:, None]
    # A spiral of equal areas on the sphere.
    number = np.arange(_ON_THE_SPHERE) + 0.5
    height = 1.0 - 2.0 * number / _ON_THE_SPHERE
    around = number * (np.pi * (3.0 - math.sqrt(5.0)))
    ring = np.sqrt(1.0 - height**2)
    e = np.stack([ring * np.cos(around), ring * np.sin(around), height], axis=-1)
    first = np.stack([-np.sin(around), np.cos(around), np.zeros_like(around)], axis=-1)
    return e, np.stack([first, np.cross(e, first)], axis=1)
