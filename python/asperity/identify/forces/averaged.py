"""Means over the turns in bins of the sliding direction."""

from __future__ import annotations

from typing import Any

import numpy as np

from asperity._base import arrays
from asperity._base.arrays import Array
from asperity._base.value import AnyArray, Record, Vector, field


class Averaged(Record):
    """Mean forces in bins of the sliding direction; made by `ProcessedData.averaged`.

    Args:
        phi: mean sliding direction of the samples in each bin in rad, shape ``(k,)``.
        resistance: means of λ_t and λ_r in N, against the sliding and across it; shape ``(k, 2)``.
        normal_force: mean λ_N in N, shape ``(k,)``.
        count: number of samples, shape ``(k,)``.

    Attributes:
        force: −λ in N, shape ``(k, 2)``.

    Reference: [WL19] (119).
    """

    phi: Vector
    resistance: AnyArray
    normal_force: AnyArray
    count: AnyArray
    force: Array = field(init=False)

    def _complete(self, given: dict[str, Any]) -> None:
        for name, columns in (("resistance", (2,)), ("normal_force", ()), ("count", ())):
            given[name] = arrays.array(given[name], name, (len(given["phi"]), *columns))

    def _derive(self) -> None:
        c, s = np.cos(self.phi), np.sin(self.phi)
        along, across = self.resistance.T
        # −λ = R(φ)(λ_t, λ_r)
        force = np.stack([c * along - s * across, s * along + c * across], axis=-1)
        self._keep(force=force)

    def __repr__(self) -> str:
        return f"<Averaged: {len(self.phi)} bins, {self.count.sum():.0f} samples>"
