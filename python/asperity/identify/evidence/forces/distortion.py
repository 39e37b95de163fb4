"""What errors of calibration and zeros, which all turns share, can explain of a misfit."""

from __future__ import annotations

from typing import Any

import numpy as np

from asperity._base import arrays
from asperity._base.arrays import Array
from asperity.identify.estimator.descent import damped_step
from asperity.identify.estimator.loss import Loss, LossName
from asperity.identify.evidence.forces.bins import Bins, grouped
from asperity.identify.evidence.forces.normal_equations import Family
from asperity.identify.evidence.forces.outliers import without_outliers
from asperity.identify.evidence.forces.samples import Samples, by_axes, reads_normal_force
from asperity.identify.forces.strokes import Axes, on_axes

_WIDTH = 5


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
        channels = np.vstack([*on_axes(bins.force, along), np.ones_like(bins.phi)])
        unit = np.stack([along, across, -model * self._read])
        root = np.sqrt(bins.squares)
        readings = np.linalg.solve(self._transform, channels) * root
        entries = np.einsum("inc,jn->ijnc", unit, readings).reshape(9, -1)
        zeros = -np.einsum("inc,ij,n->jnc", unit, self._transform, bins.normal / root)
        return np.concatenate([entries, zeros.reshape(3, -1)])
