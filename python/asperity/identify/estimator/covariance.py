"""Covariance of fitted coordinates: what differs between clusters, what they share; intervals."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from asperity._base import arrays
from asperity._base.arrays import Array
from asperity._base.quantiles import student
from asperity._base.value import Record
from asperity.errors import ParameterError
from asperity.identify.estimator.descent import Sums
from asperity.identify.estimator.leverage import Leverage, leverage_of
from asperity.identify.models.coordinates import Coordinate, Estimate, Scale
from asperity.identify.models.structure import PlanarStructure

# An angle is told from none at this level, and from rounding.
_LEVEL, _ROUNDING = 0.01, 1e-9
_MOST_DEGREES = 1e9


@dataclass(frozen=True, eq=False)
class Covariance:
    """Covariance of coordinates: from the scatter of turns, calibration, records without load.

    A part is None where the error that causes it is not known. `degrees` are the degrees of freedom
    of the parts, the fewest of all coordinates; infinite where errors are known. Those of the
    scatter follow from the `leverage` of the turns for every combination of coordinates. Where two
    runs differ by more than their turns, `runs` is what that adds, with one degree of freedom.
    """

    scatter: Array
    calibration: Array | None
    zero: Array | None
    degrees: tuple[float, float, float]
    leverage: Leverage | None = None
    runs: Array | None = None

    @property
    def parts(self) -> tuple[Array, Array | None, Array | None]:
        """The covariances by their causes."""
        return self.scatter, self.calibration, self.zero

    @property
    def total(self) -> Array:
        """Sum of the parts that are known."""
        return np.sum([part for part in (*self.parts, self.runs) if part is not None], axis=0)

    def shares(self) -> Array:
        """Return the parts of each variance from scatter, calibration and zeros, ``(k, 3)``.

        They are NaN where the error is not known.
        """
        total = np.diag(self.total)
        shares = [
            np.full_like(total, np.nan) if part is None else np.diag(part)
            for part in self.merged().parts
        ]
        return np.stack(shares, axis=-1) / np.where(total > 0.0, total, 1.0)[:, None]

    def at_least(self, other: Covariance, at: int) -> Covariance:
        """Return the covariance whose variance of one coordinate is not below that in another.

        The other one says nothing if its data leave combinations of coordinates open.
        """
        mine, others = self.leverage, other.leverage
        if mine is not None and others is not None and others.rank < mine.rank:
            return self

        def raised(part: Array | None, least: Array | None) -> Array | None:
            if part is None or least is None:
                return None
            result = part.copy()
            result[at, at] = max(part[at, at], least[at, at])
            return result

        scatter, calibration, zero = map(raised, self.parts, other.parts)
        assert scatter is not None
        return Covariance(scatter, calibration, zero, other.degrees, other.leverage)

    def between(self, runs: Array, *, apart: bool) -> Covariance:
        """Return the covariance with what differs between two runs, apart where it matters."""
        if apart:
            return replace(self, runs=runs)
        return replace(self, scatter=self.scatter + runs)

    def merged(self) -> Covariance:
        """Return the covariance with two runs as what all scatter is between."""
        if self.runs is None:
            return self
        degrees = 1.0, *self.degrees[1:]
        return Covariance(self.scatter + self.runs, self.calibration, self.zero, degrees)

    def variances(self, directions: Array) -> Array:
        """Return the variances of combinations ``(n, k)`` of coordinates."""
        found = np.einsum("ni,ij,nj->n", directions, self.total, directions)
        return np.asarray(np.maximum(found, 0.0))

    def half_widths(self, directions: Array, confidence: float) -> Array:
        """Return the half widths of the bands of combinations ``(n, k)`` of coordinates.

        Each part has its own quantile of Student's t, and squares of half widths add up: such bands
        never hold less than they say (Banerjee 1960), not even where one of two turns repeats the
        other by chance.
        """
        squares = np.zeros(len(directions))
        scatter = self.degrees[0] if self.leverage is None else self.leverage.degrees(directions)
        parts = zip((*self.parts, self.runs), (scatter, *self.degrees[1:], 1.0), strict=True)
        for part, degrees in parts:
            if part is not None:
                quantile = student(confidence, np.minimum(degrees, _MOST_DEGREES))
                squares += quantile**2 * np.einsum("ni,ij,nj->n", directions, part, directions)
        return np.sqrt(np.maximum(squares, 0.0))


def level_of(confidence: float | None, name: str = "confidence") -> float | None:
    """Return a level of confidence intervals, or None for none."""
    if confidence is None:
        return None
    confidence = arrays.fraction(confidence, name)
    if not 0.0 < confidence < 1.0:
        raise ParameterError(name, f"must lie between 0 and 1, got {confidence!r}")
    return confidence


class Bands(Record):
    """Model forces per unit normal force with confidence bands, pointwise.

    Args:
        phi: sliding directions in rad, ``(n,)``.
        force: −λ/λ_N, ``(n, 2)``.
        half_width: of the bands of its components.
        resistance: l_t and l_p, the parts against the sliding and across it, ``(n, 2)``.
        resistance_half_width: of their bands.
    """

    phi: Array
    force: Array
    half_width: Array
    resistance: Array
    resistance_half_width: Array


def scatter_of(sums: Sums, clusters: NDArray[np.intp]) -> tuple[Array, Leverage]:
    """Return the covariance of an estimate whose gradients differ between clusters (sandwich).

    A residual of one sample tells nothing about the next one: noise is coloured. Turns, strokes, or
    runs of several of these, are nearly independent.
    """
    matrix = sums.matrix.sum(axis=0)
    count = int(clusters.max()) + 1
    gradients, matrices = np.zeros((count, len(matrix))), np.zeros((count, *matrix.shape))
    np.add.at(gradients, clusters, sums.gradient)
    np.add.at(matrices, clusters, sums.matrix)
    # Their sum is zero but for a coordinate at its bound, or an angle held by samples on an axis.
    gradients -= gradients.mean(axis=0)
    leverage = leverage_of(matrix, matrices)
    return leverage.covariance(gradients), leverage


def known_angles(
    structure: PlanarStructure, p: Array, covariance: Covariance | None
) -> dict[str, bool]:
    """Return whether sets differ from those without an angle, by the names of the angles.

    One of the combinations of coordinates that vanish there must differ from zero, at a level that
    they share; without a covariance by more than rounding.
    """
    result = {}
    for name, (part, roundness) in structure.roundness().items():
        off = np.abs(roundness.matrix @ p[part] - roundness.offset)
        least = np.full(len(off), _ROUNDING)
        if covariance is not None:
            rows = np.zeros((len(off), len(p)))
            rows[:, part] = roundness.matrix
            widths = covariance.half_widths(rows, 1.0 - _LEVEL / len(off))
            least = np.fmax(least, widths)
        result[name] = bool((off > least).any())
    return result


def widths(
    covariance: Covariance | None, directions: Array, confidence: float | None
) -> tuple[Array, Array]:
    """Return half widths and standard errors of combinations ``(n, k)`` of coordinates, or NaN."""
    if covariance is None or confidence is None:
        return np.full(len(directions), np.nan), np.full(len(directions), np.nan)
    errors = np.sqrt(covariance.variances(directions))
    return covariance.half_widths(directions, confidence), errors


def estimates(
    structure: PlanarStructure,
    p: Array,
    told: NDArray[np.bool_],
    *,
    covariance: Covariance | None,
    confidence: float | None,
    fixed: NDArray[np.bool_] | None = None,
) -> Mapping[str, Estimate]:
    """Return the parameters of a planar law by name; the scale of D has no value.

    Args:
        structure: the models.
        p: the coordinates.
        told: whether the data determine them, apart from the angles of round sets.
        covariance: of the coordinates.
        confidence: level of the intervals.
        fixed: which were given, and not fitted.
    """
    angles = known_angles(structure, p, covariance)
    half, errors = widths(covariance, np.eye(p.size), confidence)
    found = {}
    for at, (name, one) in enumerate(structure.coordinates):
        given = fixed is not None and bool(fixed[at])
        width, error = (0.0, 0.0) if given else (float(half[at]), float(errors[at]))
        known = given or (bool(told[at]) and angles.get(name, True))
        found[name] = _estimate(float(p[at]), one, width, error, known)
    nothing = Estimate(math.nan, 0.0, math.inf, math.inf, identifiable=False)
    return {**found, "direction.scale": nothing}


def _estimate(
    x: float, coordinate: Coordinate, half_width: float, standard_error: float, told: bool
) -> Estimate:
    """Return a parameter with its confidence interval from its coordinate."""
    scale = coordinate.scale
    if told:
        ends = x - half_width, x + half_width
    else:
        # All that is known of what the data cannot tell.
        angle = scale is Scale.ANGLE
        ends = (-0.25 * math.pi, 0.25 * math.pi) if angle else (coordinate.low, coordinate.high)
    value, low, high = scale.natural(np.array([x, *ends]))
    slope = float(scale.slope(np.array(x)))
    return Estimate(value, low, high, slope * standard_error, identifiable=told)
