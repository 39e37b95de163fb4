"""What errors of the calibration matrix and of the zeros, which all turns share, do to a fit."""

from __future__ import annotations

import math
from typing import Any, NamedTuple

import numpy as np

from asperity._base import arrays
from asperity._base.arrays import Array
from asperity.identify.estimator.descent import damped_step
from asperity.identify.estimator.loss import Loss, LossName
from asperity.identify.evidence.forces.bins import Bins, grouped
from asperity.identify.evidence.forces.normal_equations import Family
from asperity.identify.evidence.forces.outliers import without_outliers
from asperity.identify.evidence.forces.samples import Samples, by_axes, reads_normal_force
from asperity.identify.forces import stated_errors
from asperity.identify.forces.strokes import Axes, on_axes
from asperity.identify.forces.zero import _BATCHES

_ROUNDING = 1e-9
# Comparisons of models take means over half a degree.
_WIDTH = 5


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
    along, across = on_axes(on_force, axes.tangential(bins.phi))
    # What one unit in the tangential, radial and normal channel adds to the gradient, per bin.
    pull = np.stack([along, across, on_normal * read], axis=1)
    return np.einsum("kcn,ecn->ke", pull, _of_channels(bins, axes, transform))


def _of_channels(bins: Bins, axes: Axes, transform: Array) -> Array:
    """Return what unit errors of the entries of T and of the zeros are in the channels.

    They are summed over the samples of each bin with the normal force, ``(12, 3, n)``.
    """
    channels = [*on_axes(bins.force, axes.tangential(bins.phi)), np.ones_like(bins.phi)]
    readings = np.linalg.solve(transform, np.vstack(channels)) * bins.squares
    entries = np.einsum("ic,jn->ijcn", np.eye(3), readings).reshape(9, 3, -1)
    return np.concatenate([entries, -np.einsum("cj,n->jcn", transform, bins.normal)])


class Distortion:
    """Errors of the entries of T and of the zeros with their covariance, of given data."""

    def __init__(self, samples: Samples, data: Any, *, loss: LossName = "linear") -> None:
        covariance = np.zeros((12, 12))
        for name, part in (
            ("calibration_covariance", slice(0, 9)),
            ("zero_covariance", slice(9, 12)),
        ):
            known = getattr(data, name, None)
            if known is not None:
                covariance[part, part] = known
        self._parts: list[tuple[Bins, Axes]] = []
        if covariance.any():
            self._read = reads_normal_force(data)
            self._transform = arrays.array(data.matrix, "data.matrix", (3, 3))
            for run, axes in by_axes(samples, data):
                near = run if Loss(loss).is_linear else without_outliers(run)
                self._parts.append((grouped(near, 1).bins(width=_WIDTH), axes))
        values, vectors = np.linalg.eigh(covariance)
        self._root = vectors * np.sqrt(np.maximum(values, 0.0))

    def explained(self, family: Family, p: Array, variance: float) -> float:
        """Return by how much the sum of squares falls if the errors may be what fits best.

        They are held by their own covariance, in proportion to the variance of uncorrelated
        residuals. The coordinates p, a minimum without errors, follow.
        """
        if not self._parts:
            return 0.0
        size = family.size
        normal, cross, inner, pull = (
            np.zeros((size, size)),
            np.zeros((12, size)),
            np.zeros((12, 12)),
            np.zeros(12),
        )
        for bins, axes in self._parts:
            force, derivative = family.forces(bins.phi, p)
            root = np.sqrt(bins.squares)
            errors = self._root.T @ self._columns(bins, axes, force)
            slopes = (derivative * root[:, None]).reshape(size, -1)
            left = ((bins.force - force) * root[:, None]).ravel()
            normal += slopes @ slopes.T
            cross += errors @ slopes.T
            inner += errors @ errors.T
            pull += errors @ left
        followed = np.stack([damped_step(normal, row) for row in cross])
        held = inner - cross @ followed.T + max(variance, np.finfo(float).tiny) * np.eye(12)
        return float(pull @ np.linalg.solve(held, pull))

    def _columns(self, bins: Bins, axes: Axes, model: Array) -> Array:
        """Return what unit errors add to the residuals of the bins, ``(12, 2n)``."""
        along = axes.tangential(bins.phi)
        across = np.stack([-along[:, 1], along[:, 0]], axis=-1)
        unit = np.stack([along, across, -model * self._read])
        parts = np.einsum("cnx,ecn->enx", unit, _of_channels(bins, axes, self._transform))
        return (parts / np.sqrt(bins.squares)[:, None]).reshape(12, -1)
