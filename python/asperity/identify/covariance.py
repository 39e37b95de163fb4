"""Covariance of fitted coordinates: what differs between turns, and what all turns share."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Any

import numpy as np

from asperity import _arrays
from asperity._arrays import Array
from asperity.errors import FitError
from asperity.identify.bins import Bins
from asperity.identify.coordinates import Estimate, Roundness, Scale
from asperity.identify.descent import damped_step
from asperity.identify.loss import Loss
from asperity.identify.sums import Family, Sums

# An angle is told from none at this level.
_LEVEL = 0.01


@dataclass(frozen=True, eq=False)
class Covariance:
    """Covariance of coordinates: from the scatter of turns, calibration, records without load.

    `turns` is the number of turns behind the first one.
    """

    scatter: Array
    calibration: Array
    zero: Array
    turns: int

    @property
    def total(self) -> Array:
        """Sum of the parts."""
        return self.scatter + self.calibration + self.zero

    def shares(self) -> Array:
        """Return the parts of each variance from scatter, calibration and zeros, ``(k, 3)``."""
        parts = np.stack([np.diag(p) for p in (self.scatter, self.calibration, self.zero)], axis=-1)
        total = parts.sum(axis=1, keepdims=True)
        return parts / np.where(total > 0.0, total, 1.0)

    def of(self, part: slice) -> Covariance:
        """Return the covariance of some of the coordinates."""
        return Covariance(
            self.scatter[part, part],
            self.calibration[part, part],
            self.zero[part, part],
            self.turns,
        )

    def half_widths(self, directions: Array, confidence: float) -> Array:
        """Return the half widths of the bands of combinations ``(n, k)`` of coordinates.

        Scatter has one degree of freedom less than there are turns, the other parts are taken as
        known; a sum has an effective number (Welch and Satterthwaite).
        """
        from scipy.stats import t

        scattered = np.einsum("ni,ij,nj->n", directions, self.scatter, directions)
        total = np.einsum("ni,ij,nj->n", directions, self.total, directions)
        share = np.maximum(scattered, 1e-30 * np.abs(total).max(initial=1e-300))
        degrees = np.minimum((self.turns - 1) * (total / share) ** 2, 1e9)
        widths: Array = t.ppf(0.5 + 0.5 * confidence, degrees) * np.sqrt(np.maximum(total, 0.0))
        return widths


def scatter_of(sums: Sums) -> Array:
    """Return the covariance of an estimate whose gradients differ between turns (sandwich).

    A residual of one sample tells nothing about the next one: noise is coloured. Turns are nearly
    independent, and the t-distribution with one degree less than turns makes up for their number.
    """
    turns = len(sums.cost)
    if turns < 2:
        raise FitError(
            "data: one complete turn has no scatter between turns: record at least 2 turns (10 are "
            "better), or fit with confidence=None"
        )
    matrix = sums.matrix.sum(axis=0)
    steps = np.stack([damped_step(matrix, gradient) for gradient in sums.gradient])
    spread: Array = steps.T @ steps * (turns / (turns - 1.0))
    return spread


def shared(
    family: Family, parts: list[tuple[Bins, float]], p: Array, data: Any
) -> tuple[Array, Array]:
    """Return the covariances that errors of the calibration matrix and of the zeros cause.

    `parts` are means of the runs in either sense of rotation, +1 or −1: channels keep their axes
    when the disk turns backwards.

    Every entry of the matrix T, and every zero, moves the estimate by one Gauss–Newton step, which
    is linear in the means over directions: (−λ_T1, −λ_T2) = R(φ)(λ_t, λ_r), [WL19] (119). The
    curvature of a robust loss weighs gradient and matrix alike, and is left out of both.
    """
    calibration = getattr(data, "calibration_covariance", None)
    zero = getattr(data, "zero_covariance", None)
    none = np.zeros((family.size, family.size))
    if calibration is None and zero is None:
        return none, none
    transform = _arrays.array(data.matrix, "data.matrix", (3, 3))
    pulls = np.sum([_pulls(family, bins, sense, p, transform) for bins, sense in parts], axis=0)
    matrix = np.sum([family.sums(bins.samples, p, Loss()).matrix[0] for bins, _ in parts], axis=0)
    by = np.stack([damped_step(matrix, column) for column in pulls.T], axis=-1)

    def caused(covariance: Array | None, by: Array, name: str) -> Array:
        if covariance is None:
            return none
        known = _arrays.array(covariance, f"data.{name}", 2 * (by.shape[1],))
        spread: Array = by @ known @ by.T
        return spread

    return (
        caused(calibration, by[:, :9], "calibration_covariance"),
        caused(zero, by[:, 9:], "zero_covariance"),
    )


def _pulls(family: Family, bins: Bins, sense: float, p: Array, transform: Array) -> Array:
    """Return the derivatives of the gradient by the entries of T, row by row, and by the zeros."""
    on_force, on_normal = family.responses(bins.phi, p)
    cos, sin = np.cos(bins.phi), np.sin(bins.phi)
    # What one unit in the tangential, radial and normal channel adds to the gradient, per bin.
    pull = np.stack(
        [
            sense * (on_force[..., 0] * cos + on_force[..., 1] * sin),
            sense * (on_force[..., 1] * cos - on_force[..., 0] * sin),
            on_normal,
        ],
        axis=1,
    )
    x, y = bins.force.T
    channels = np.stack([sense * (x * cos + y * sin), sense * (y * cos - x * sin), np.ones_like(x)])
    readings = np.linalg.solve(transform, channels)
    by_entry = np.einsum("kin,jn,n->kij", pull, readings, bins.squares).reshape(len(p), 9)
    by_zero = -np.einsum("kin,n,ij->kj", pull, bins.normal, transform)
    return np.hstack([by_entry, by_zero])


def has_angle(p: Array, roundness: Roundness, covariance: Covariance) -> bool:
    """Return whether the set differs from one without angle, by Wald's test with Hotelling's T²."""
    from scipy.stats import f

    off = roundness.matrix @ p - roundness.offset
    spread = roundness.matrix @ covariance.total @ roundness.matrix.T
    count, degrees = off.size, covariance.turns - 1
    if degrees < count:
        # Too few turns for all at once: the first combination, the ratio of the axes, alone.
        off, spread, count = off[:1], spread[:1, :1], 1
    if not off @ off > 1e-18:
        return False
    statistic = off @ np.linalg.lstsq(spread, off, rcond=None)[0] if spread.any() else math.inf
    left = degrees - count + 1
    return bool(statistic * left / (count * degrees) > f.ppf(1.0 - _LEVEL, count, left))


def estimate(
    x: float, scale: Scale, half_width: float, standard_error: float, told: bool
) -> Estimate:
    """Return a parameter with its band from its coordinate."""
    value, low, high = scale.natural(np.array([x, x - half_width, x + half_width]))
    slope = float(scale.slope(np.array(x)))
    if not told:
        # All that is known of an angle that the data cannot tell.
        low, high = -0.25 * math.pi, 0.25 * math.pi
    return Estimate(value, low, high, slope * standard_error, identifiable=told)
