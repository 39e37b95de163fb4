"""Covariance of fitted coordinates, from what differs between turns and what they share; bands."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass, replace
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from asperity._base import arrays
from asperity._base.arrays import Array
from asperity._base.value import Record
from asperity.errors import FitError
from asperity.identify.fitting.data.bins import Bins
from asperity.identify.fitting.data.samples import reads_normal_force
from asperity.identify.fitting.least_squares.descent import damped_step
from asperity.identify.fitting.least_squares.loss import Loss
from asperity.identify.fitting.least_squares.normal_equations import Family, Sums
from asperity.identify.fitting.models.coordinates import Coordinate, Estimate, Roundness, Scale
from asperity.identify.fitting.uncertainty.leverage import Leverage, leverage_of
from asperity.identify.fitting.uncertainty.mountings import Mountings
from asperity.identify.forces import stated_errors
from asperity.identify.forces.strokes import Axes, on_axes
from asperity.identify.forces.zero import _BATCHES

# An angle is told from none at this level.
_LEVEL = 0.01
_MOST_DEGREES = 1e9
_ROUNDING = 1e-9


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

    def of(self, part: slice) -> Covariance:
        """Return the covariance of some of the coordinates."""
        parts = [None if one is None else one[part, part] for one in self.parts]
        scatter, degrees = self.scatter[part, part], self.degrees
        if self.leverage is not None:
            some = np.eye(len(self.scatter))[part]
            degrees = float(self.leverage.degrees(some).min()), *degrees[1:]
        runs = None if self.runs is None else self.runs[part, part]
        return Covariance(scatter, parts[1], parts[2], degrees, runs=runs)

    def at_least(self, other: Covariance, at: int) -> Covariance:
        """Return the covariance whose variance of one coordinate is not below that in another.

        The other one says nothing if its data leave combinations of coordinates open.
        """
        mine, others = self.leverage, other.leverage
        if mine is not None and others is not None and others.rank < mine.rank:
            return self

        def raised(part: Array, least: Array) -> Array:
            result = part.copy()
            result[at, at] = max(part[at, at], least[at, at])
            return result

        return self._each(raised, other)

    def between(self, found: Mountings) -> Covariance:
        """Return the covariance with what differs between two runs, apart where it matters."""
        if found.matters:
            return replace(self, runs=found.covariance)
        return replace(self, scatter=self.scatter + found.covariance)

    def merged(self) -> Covariance:
        """Return the covariance with two runs as what all scatter is between."""
        if self.runs is None:
            return self
        degrees = 1.0, *self.degrees[1:]
        return Covariance(self.scatter + self.runs, self.calibration, self.zero, degrees)

    def _each(self, change: Callable[[Array, Array], Array], other: Covariance) -> Covariance:
        def changed(mine: Array | None, others: Array | None) -> Array | None:
            return None if mine is None or others is None else change(mine, others)

        return Covariance(
            change(self.scatter, other.scatter),
            changed(self.calibration, other.calibration),
            changed(self.zero, other.zero),
            other.degrees,
            other.leverage,
        )

    def half_widths(self, directions: Array, confidence: float) -> Array:
        """Return the half widths of the bands of combinations ``(n, k)`` of coordinates.

        Each part has its own quantile of Student's t, and squares of half widths add up: such bands
        never hold less than they say (Banerjee 1960), not even where one of two turns repeats the
        other by chance.
        """
        from scipy.stats import t

        squares = np.zeros(len(directions))
        scatter = self.degrees[0] if self.leverage is None else self.leverage.degrees(directions)
        parts = zip((*self.parts, self.runs), (scatter, *self.degrees[1:], 1.0), strict=True)
        for part, degrees in parts:
            if part is not None:
                quantile = t.ppf(0.5 + 0.5 * confidence, np.minimum(degrees, _MOST_DEGREES))
                squares += quantile**2 * np.einsum("ni,ij,nj->n", directions, part, directions)
        return np.sqrt(np.maximum(squares, 0.0))


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

    Raises:
        FitError: with one turn.
    """
    if len(sums.cost) < 2:
        raise FitError(
            "data: one complete turn has no scatter between turns: record at least 2 turns (10 are "
            "better), or fit with confidence=None"
        )
    matrix = sums.matrix.sum(axis=0)
    count = int(clusters.max()) + 1
    gradients, matrices = np.zeros((count, len(matrix))), np.zeros((count, *matrix.shape))
    np.add.at(gradients, clusters, sums.gradient)
    np.add.at(matrices, clusters, sums.matrix)
    # Their sum is zero but for a coordinate at its bound, or an angle held by samples on an axis.
    gradients -= gradients.mean(axis=0)
    leverage = leverage_of(matrix, matrices)
    return leverage.covariance(gradients), leverage


class Shared(NamedTuple):
    """Covariances that errors cause which all turns share, and their degrees of freedom.

    A covariance is None where the error is not known.
    """

    calibration: Array | None
    zero: Array | None
    degrees: tuple[float, float]


def shared(family: Family, parts: list[tuple[Bins, Axes]], p: Array, data: Any) -> Shared:
    """Return the covariances that errors of the calibration matrix and of the zeros cause.

    `parts` are means of the runs in either sense of rotation, +1 or −1.
    """
    calibration = getattr(data, "calibration_covariance", None)
    zero = getattr(data, "zero_covariance", None)
    if calibration is None and zero is None:
        return Shared(None, None, (math.inf, math.inf))
    by = sensitivities(family, parts, p, data)
    raw = getattr(data, "raw", None)
    stated: tuple[Array | None, Array | None] = (None, None)
    load = np.zeros(len(p))
    if raw is not None:
        stated = stated_errors.of_gains(raw, data.matrix), stated_errors.of_zeros(raw, data.matrix)
        if raw.gain_error is not None and not reads_normal_force(data):
            # The scale of a given normal force, as if it were read.
            read = sensitivities(family, parts, p, data, read=True)
            load = read[:, 6:9] @ data.matrix[2] * raw.gain_error[2]

    def caused(covariance: Array | None, by: Array, name: str) -> Array | None:
        if covariance is None:
            return None
        known = arrays.array(covariance, f"data.{name}", 2 * (by.shape[1],))
        return by @ known @ by.T

    by_entries, by_zeros = by[:, :9], by[:, 9:]
    gains = caused(calibration, by_entries, "calibration_covariance")
    if gains is not None:
        gains += np.outer(load, load)
    zeros = caused(zero, by_zeros, "zero_covariance")
    estimated = _estimated_degrees(raw)
    exact = caused(stated[0], by_entries, "gain_error"), caused(stated[1], by_zeros, "zero_error")
    if exact[0] is not None:
        exact[0][...] += np.outer(load, load)
    degrees = (
        _joint_degrees(estimated[0], gains, exact[0]),
        _joint_degrees(estimated[1], zeros, exact[1]),
    )
    return Shared(gains, zeros, degrees)


def _estimated_degrees(raw: Any) -> tuple[float, float]:
    """Return the degrees of freedom behind the covariances of calibration and zeros."""
    if raw is None:
        return math.inf, math.inf
    known, weighed = math.inf, raw.calibration
    if weighed is not None and weighed.reading_error is None:
        known = max(len(weighed.loads) - 3.0 - weighed.fit_zero, 1.0)
    # A record's mean scatters like those of its batches.
    batches = min((min(len(record), _BATCHES) for record in raw.no_load), default=math.inf)
    return known, max(batches - 1.0, 1.0)


def _joint_degrees(estimated: float, total: Array | None, exact: Array | None) -> float:
    """Return the degrees of freedom of a variance of which a part is known exactly.

    They are Welch's and Satterthwaite's, of that coordinate for which they are fewest.
    """
    if total is None or exact is None:
        return estimated
    whole = np.diag(total)
    rest = np.maximum(whole - np.diag(exact), 0.0)
    # What is left of equal numbers is rounding.
    share = float((rest / np.where(whole > 0.0, whole, 1.0)).max(initial=0.0))
    return math.inf if share < _ROUNDING else estimated / share**2


def sensitivities(
    family: Family,
    parts: list[tuple[Bins, Axes]],
    p: Array,
    data: Any,
    *,
    read: bool | None = None,
) -> Array:
    """Return the derivatives of the estimates by the entries of T, row by row, and by the zeros.

    Channels keep their axes when the disk turns backwards, and those of a stage always: `parts` are
    means of samples with the same axes.

    Every entry of the matrix T, and every zero, moves the estimate by one Gauss–Newton step, which
    is linear in the means over directions: (−λ_T1, −λ_T2) = R(φ)(λ_t, λ_r), [WL19] (119). The
    curvature of a robust loss weighs gradient and matrix alike, and is left out of both.

    `read` says whether the normal force comes from its channel, as the data do by default.
    """
    transform = arrays.array(data.matrix, "data.matrix", (3, 3))
    # Row 3 of T has no effect where the normal force is given.
    read = reads_normal_force(data) if read is None else read
    pulls = np.sum(
        [_pulls(family, bins, axes, p, transform, read=read) for bins, axes in parts], axis=0
    )
    matrix = np.sum([family.sums(bins.samples, p, Loss()).matrix[0] for bins, _ in parts], axis=0)
    return np.stack([damped_step(matrix, column) for column in pulls.T], axis=-1)


class Stakes(NamedTuple):
    """How far coordinates move for a small error in any one channel, the farthest of the three.

    Attributes:
        zero: by a zero error of a part of the mean normal force, ``(k,)``.
        gain: by an error of a gain of the same part, ``(k,)``.
    """

    zero: Array
    gain: Array


def stakes(by: Array, transform: Array, normal: float, part: float) -> Stakes:
    """Return what is at stake where errors are not known, from the `sensitivities`."""
    # Readings that make a force of one unit in each channel, and rows of T that grow.
    zeros = by[:, 9:] @ np.linalg.inv(transform) * (part * normal)
    gains = np.einsum("kij,ij->ki", by[:, :9].reshape(-1, 3, 3), transform) * part
    return Stakes(np.abs(zeros).max(axis=1), np.abs(gains).max(axis=1))


def _pulls(
    family: Family, bins: Bins, axes: Axes, p: Array, transform: Array, *, read: bool = True
) -> Array:
    """Return the derivatives of the gradient by the entries of T, row by row, and by the zeros."""
    on_force, on_normal = family.responses(bins.phi, p)
    tangential = axes.tangential(bins.phi)
    along, across = on_axes(on_force, tangential)
    # What one unit in the tangential, radial and normal channel adds to the gradient, per bin.
    pull = np.stack([along, across, on_normal * read], axis=1)
    channels = np.vstack([*on_axes(bins.force, tangential), np.ones_like(bins.phi)])
    readings = np.linalg.solve(transform, channels)
    by_entry = np.einsum("kin,jn,n->kij", pull, readings, bins.squares).reshape(len(p), 9)
    by_zero = -np.einsum("kin,n,ij->kj", pull, bins.normal, transform)
    return np.hstack([by_entry, by_zero])


def has_angle(p: Array, roundness: Roundness, covariance: Covariance) -> bool:
    """Return whether the set differs from one without angle, by Wald's test with Hotelling's T²."""
    from scipy.stats import f

    off = roundness.matrix @ p - roundness.offset
    spread = roundness.matrix @ covariance.total @ roundness.matrix.T
    count, degrees = off.size, round(covariance.degrees[0])
    if degrees < count:
        # Too few turns for all at once: the first combination, the ratio of the axes, alone.
        off, spread, count = off[:1], spread[:1, :1], 1
    if not off @ off > 1e-18:
        return False
    statistic = off @ np.linalg.lstsq(spread, off, rcond=None)[0] if spread.any() else math.inf
    left = degrees - count + 1
    return bool(statistic * left / (count * degrees) > f.ppf(1.0 - _LEVEL, count, left))


def estimate(
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
