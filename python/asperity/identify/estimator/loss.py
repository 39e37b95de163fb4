"""Losses of residuals: least squares, or less for outliers."""

from __future__ import annotations

import math
from dataclasses import KW_ONLY
from typing import Annotated, Literal, TypeAlias

import numpy as np

from asperity._base import arrays
from asperity._base.arrays import Array
from asperity._base.value import Positive, Record, field

LossName: TypeAlias = Literal["linear", "soft_l1", "huber", "cauchy"]

# Where a loss turns from squares, in standard deviations, for one component and for lengths of
# plane vectors: 95 % efficiency for Gaussian residuals, of soft_l1 for one component 93 %.
_TUNING: dict[LossName, tuple[float, float]] = {
    "linear": (math.inf, math.inf),
    "soft_l1": (1.0, 1.31),
    "huber": (1.345, 1.5),
    "cauchy": (2.385, 2.6),
}
# Median lengths of vectors of one and of two independent Gaussian components of deviation 1.
_MEDIANS = (0.6744897501960817, math.sqrt(2.0 * math.log(2.0)))
MEDIAN_LENGTH = _MEDIANS[1]


def _kind(given: LossName, _: str) -> LossName:
    return arrays.choice(given, "loss", tuple(_TUNING))


class Loss(Record):
    """Loss ρ(‖e‖²) of a residual e of two components, or of one.

    Args:
        kind: ``"linear"`` for least squares, ``"soft_l1"``, ``"huber"`` or ``"cauchy"``.
        scale: standard deviation of a component of residuals that are no outliers.
        components: of a residual.

    >>> from asperity.identify.estimator.loss import Loss
    >>> Loss("huber", 2.0).at(np.array([1.0, 36.0]))[1].tolist()
    [1.0, 0.5]
    """

    kind: Annotated[LossName, _kind] = "linear"
    scale: Positive = 1.0
    _: KW_ONLY
    components: int = 2
    is_linear: bool = field(init=False)
    bend: float = field(init=False)
    """Size of residuals where the loss turns from squares."""

    def _derive(self) -> None:
        bend = _TUNING[self.kind][self.components - 1] * self.scale
        self._keep(is_linear=self.kind == "linear", bend=bend)

    def at(self, squared: Array) -> tuple[Array, Array, Array]:
        """Return ρ, the weight ρ′ and the mean of (ρ′e)′ over all directions of e."""
        if self.is_linear:
            one = np.ones_like(squared)
            return squared, one, one
        part = squared / self.bend**2
        if self.kind == "cauchy":
            weight = 1.0 / (1.0 + part)
            value, turn = np.log1p(part), -weight * weight
        elif self.kind == "soft_l1":
            root = np.sqrt(1.0 + part)
            weight = 1.0 / root
            value, turn = 2.0 * (root - 1.0), -0.5 * weight**3
        else:
            length = np.sqrt(np.maximum(part, 1.0))
            weight = 1.0 / length
            value = np.where(part > 1.0, 2.0 * length - 1.0, part)
            turn = np.where(part > 1.0, -0.5 * weight**3, 0.0)
        bend = weight + (2.0 / self.components) * part * turn
        return self.bend**2 * value, weight, bend

    def scaled_by(self, lengths: Array) -> Loss:
        """Return the loss whose scale is that of residuals of given lengths, by their median."""
        median = float(np.median(lengths))
        if median == 0.0:
            return self
        return self.replace(scale=median / _MEDIANS[self.components - 1])
