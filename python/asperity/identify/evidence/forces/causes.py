"""Where errors of a fit come from: turns that differ, calibration, zeros; and which none tells."""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import cached_property
from typing import Any

import numpy as np
from numpy.typing import NDArray

from asperity._base.arrays import Array
from asperity.errors import FitError
from asperity.identify.estimator.covariance import Covariance, scatter_of
from asperity.identify.estimator.descent import Descent, Sums
from asperity.identify.estimator.leverage import leverage_of
from asperity.identify.estimator.loss import Loss
from asperity.identify.evidence.forces.bins import Bins, grouped
from asperity.identify.evidence.forces.coverage import coverage
from asperity.identify.evidence.forces.errors import sensitivities, shared, stakes
from asperity.identify.evidence.forces.flat_sides import away_from_axes, means_away_from_axes
from asperity.identify.evidence.forces.mountings import Mountings, mountings_of
from asperity.identify.evidence.forces.normal_equations import Family
from asperity.identify.evidence.forces.outliers import without_outliers
from asperity.identify.evidence.forces.samples import (
    WRAPPED,
    Samples,
    by_axes,
    clusters_of,
    is_wrapped,
    runs_of,
)
from asperity.identify.forces.strokes import Axes
from asperity.identify.models.coordinates import Scale

_PERCENT = 0.01
# Angles that the data allow, in half widths of their interval.
_ALLOWED, _MOST_ANGLES = 2.0, 20
# Eigenvalues of JᵀJ, with a diagonal of ones, below which it is singular: directions are rounded.
_SINGULAR = 1e-5
# A coordinate has a part in a combination that is left open.
_PART_IN = 0.1


@dataclass(frozen=True, eq=False)
class Causes:
    """What is known of the causes of errors of a fit.

    Attributes:
        family: the models.
        descent: where their coordinates ended.
        loss: of the residuals.
        data: as for `fit_law`.
        samples: of the data.
        bins: means of the samples, without outliers if the loss is robust.
    """

    family: Family
    descent: Descent
    loss: Loss
    data: Any
    samples: Samples
    bins: Bins

    def covariance(self, *, held: bool) -> Covariance:
        """Return the covariance of the coordinates.

        Where samples on the axes of D hold its angle, the angle's variance is at least that of the
        samples away from them.
        """
        p = self.descent.p
        covariance = self._covariance(self.descent.sums, away=False)
        if held:
            sums = self.family.sums(away_from_axes(self.samples, p[-1]), p, self.loss)
            covariance = covariance.at_least(self._covariance(sums, away=True), -1)
        found = self.mountings
        if found is None:
            return covariance
        return covariance.between(found.covariance, apart=found.matters)

    @cached_property
    def mountings(self) -> Mountings | None:
        """How two runs differ, between which the pin was set down anew; None for others."""
        run = runs_of(self.samples, self.data)
        if run.size == 0 or np.ptp(run) == 0:
            return None
        p, means = self.descent.p, self.bins.samples
        model = means.normal[:, None] * self.family.forces(means.phi, p)[0]
        # Twice the forces of the model leave these as residuals.
        level = self.family.sums(replace(means, force=2.0 * model), p, Loss()).gradient[0]
        parts = self._means(away=False)
        common = shared(self.family, parts, p, self.data)
        # Two runs may have zeros of their own; where axes differ, errors move them apart.
        errors = [(common.zero, 2.0 if len(parts) == 1 else 4.0)]
        errors += [(common.calibration, 4.0)] * (len(parts) > 1)
        sums = self.descent.sums
        inverse = leverage_of(sums.matrix.sum(axis=0), sums.matrix).inverse
        return mountings_of(
            sums,
            run,
            inverse=inverse,
            level=level,
            shared=sum(
                (factor * one for one, factor in errors if one is not None),
                np.zeros((p.size, p.size)),
            ),
        )

    def undetermined(self, half_widths: Array) -> NDArray[np.bool_]:
        """Return which coordinates strokes in few directions leave open.

        Where an axis of D is one of the directions, or midway between two, those on either side of
        it tell the same, and combinations of coordinates may be left open that an estimated angle,
        which is never quite there, pretends to know. The angles that the data allow are therefore
        tried where directions are symmetric about the axes.

        Args:
            half_widths: of the intervals of the coordinates.
        """
        family, size = self.family, self.family.size
        found = np.zeros(size, dtype=np.bool_)
        if family.split == size or family.coordinates[-1].scale is not Scale.ANGLE:
            return _open_coordinates(self.descent.sums.matrix.sum(axis=0))
        phi = coverage(self.bins.phi, is_symmetric=family.is_symmetric).phi
        middle = 0.5 * (phi[:, None] + phi[None, :]).ravel()
        known, quarter = float(self.descent.p[-1]), 0.5 * np.pi
        off = (middle - known + 0.5 * quarter) % quarter - 0.5 * quarter
        near = off[np.abs(off) <= _ALLOWED * half_widths[-1]]
        for angle in (known, *np.unique(np.round(known + near, 9)).tolist()[:_MOST_ANGLES]):
            p = self.descent.p.copy()
            p[-1] = angle
            found |= _open_coordinates(family.sums(self.bins.samples, p, Loss()).matrix[0])
        return found

    def missing(self) -> dict[str, tuple[str, Array]]:
        """Return causes that no record tells, with what is missing and what is at stake."""
        raw = getattr(self.data, "raw", None)
        if raw is None:
            return {}
        by = sensitivities(self.family, self._means(away=False), self.descent.p, self.data)
        normal = float(np.mean(self.data.normal_force))
        moved = stakes(by, self.data.matrix, normal, _PERCENT)
        causes = {}
        if self.data.calibration_covariance is None:
            what = "no calibration" if raw.calibration is None else "a calibration without an error"
            causes["calibration"] = what, moved.gain
        if self.data.zero_covariance is None:
            causes["zeros"] = "no records without load", moved.zero
        return causes

    def _covariance(self, sums: Sums, *, away: bool) -> Covariance:
        common = shared(self.family, self._means(away=away), self.descent.p, self.data)
        if self.samples.turns == 1 and is_wrapped(self.samples):
            raise FitError(f"data: {WRAPPED}")
        if self.samples.turns < 2:
            raise FitError(
                "data: one complete turn has no scatter between turns: record at least 2 turns (10 "
                "are better), or fit with confidence=None"
            )
        scatter, leverage = scatter_of(sums, clusters_of(self.samples, self.data))
        for name, known in zip(self.family.coordinates, leverage.single, strict=True):
            # Derivatives by angles are as large as they are cut off where samples are on axes.
            if known and name.scale is not Scale.ANGLE:
                raise FitError(
                    f"data: {name.name} is known from a single stroke or turn, so that nothing is "
                    "known of its scatter: repeat strokes, choose models with fewer parameters, or "
                    "fit with confidence=None"
                )
        fewest = float(leverage.degrees(np.eye(self.family.size)).min())
        degrees = fewest, *common.degrees
        return Covariance(scatter, common.calibration, common.zero, degrees, leverage)

    def _means(self, *, away: bool) -> list[tuple[Bins, Axes]]:
        """Return means of samples with the same axes of the sensor, with these."""
        if not away:
            return self._parts
        return [(means_away_from_axes(one, self.descent.p[-1]), axes) for one, axes in self._parts]

    @cached_property
    def _parts(self) -> list[tuple[Bins, Axes]]:
        parts = by_axes(self.samples, self.data)
        if len(parts) == 1:
            return [(self.bins, parts[0][1])]
        return [(means_of(one, self.loss), axes) for one, axes in parts]


def _open_coordinates(matrix: Array) -> NDArray[np.bool_]:
    """Return which coordinates have a part in combinations that JᵀJ does not see."""
    scale = np.sqrt(np.maximum(np.diag(matrix), 0.0))
    scale[scale == 0.0] = 1.0
    sizes, vectors = np.linalg.eigh(matrix / np.outer(scale, scale))
    return np.asarray((np.abs(vectors[:, sizes < _SINGULAR]) > _PART_IN).any(axis=1))


def means_of(samples: Samples, loss: Loss) -> Bins:
    """Return means over fine bins, without outliers if the loss is robust."""
    return grouped(weighty(samples, loss), 1).bins()


def weighty(samples: Samples, loss: Loss) -> Samples:
    """Return the samples whose means mean something: without outliers if the loss is robust."""
    return samples if loss.is_linear else without_outliers(samples)
