"""Losses of the residuals' length: least squares, or less for outliers."""

from __future__ import annotations

import math

import numpy as np

from asperity._base import arrays
from asperity._base.arrays import Array
from asperity._base.value import Value

# Where a loss turns from squares, in standard deviations: 95 % efficiency for Gaussian residuals.
_TUNING = {"linear": math.inf, "huber": 1.5, "cauchy": 2.6}
# Median length of a plane vector of independent Gaussian components of deviation 1.
MEDIAN_LENGTH = math.sqrt(2.0 * math.log(2.0))


class Loss(Value):
    """Loss ρ(‖e‖²) of a residual e of two components.

    Args:
        kind: ``"linear"`` for least squares, ``"huber"`` or ``"cauchy"``.
        scale: standard deviation of a component of residuals that are no outliers.

    >>> from asperity.identify.estimator.loss import Loss
    >>> Loss("huber", 2.0).at(np.array([1.0, 36.0]))[1].tolist()
    [1.0, 0.5]
    """

    kind: str
    scale: float

    def __init__(self, kind: str = "linear", scale: float = 1.0) -> None:
        kind = arrays.choice(kind, "loss", tuple(_TUNING))
        self._set(kind=kind, scale=arrays.positive(scale, "scale"))
        self._keep(is_linear=kind == "linear", _bend=_TUNING[kind] * self.scale)

    is_linear: bool
    _bend: float

    def at(self, squared: Array) -> tuple[Array, Array, Array]:
        """Return ρ, the weight ρ′ and the mean of (ρ′e)′ over all directions of e."""
        if self.kind == "cauchy":
            part = squared / self._bend**2
            weight = 1.0 / (1.0 + part)
            return self._bend**2 * np.log1p(part), weight, weight * weight
        # Huber's loss; without a bend, squares.
        far = squared > self._bend**2
        length = np.sqrt(squared, out=np.ones_like(squared), where=far)
        bend = self._bend if far.any() else 1.0
        weight = np.where(far, bend / length, 1.0)
        value = np.where(far, bend * (2.0 * length - bend), squared)
        return value, weight, np.where(far, 0.5 * weight, 1.0)

    def scaled_by(self, lengths: Array) -> Loss:
        """Return the loss whose scale is that of residuals of given lengths, by their median."""
        median = float(np.median(lengths))
        return self if median == 0.0 else Loss(self.kind, median / MEDIAN_LENGTH)
