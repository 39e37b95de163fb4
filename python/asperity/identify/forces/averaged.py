"""Means over the turns in bins of the sliding direction."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike

from asperity._base import arrays
from asperity._base.arrays import Array
from asperity._base.value import Value
from asperity.errors import ParameterError


class Averaged(Value):
    """Mean readings and forces in bins of the sliding direction; made by `ProcessedData.averaged`.

    Args:
        phi: mean sliding direction of the samples in each bin in rad, shape ``(k,)``.
        readings: mean reading of the channels above the zero, times +1 or −1 where the disk turns
            forwards or backwards; shape ``(k, 3)``.
        normal_force: mean λ_N in N, shape ``(k,)``.
        count: number of samples, shape ``(k,)``.
        unsigned_readings: the same without that sign, shape ``(k, 3)``.
        sense: mean of that sign, shape ``(k,)``.
        matrix: T, shape ``(3, 3)``.
        zero: mean reading without load, shape ``(3,)``.
        is_load_given: whether λ_N is known apart from the readings.
        is_fixed: whether the sensor does not turn with the sliding, as that of a stage: `readings`
            are then those of a sensor that does, and their zero has no one value.

    Attributes:
        resistance: λ_t and λ_r in N, against the sliding and across it; shape ``(k, 2)``.
        force: −λ in N, shape ``(k, 2)``.

    Reference: [WL19] (119).
    """

    phi: Array
    readings: Array
    normal_force: Array
    count: Array
    unsigned_readings: Array
    sense: Array
    matrix: Array
    zero: Array
    is_load_given: bool
    is_fixed: bool
    resistance: Array
    force: Array

    def __init__(
        self,
        phi: ArrayLike,
        readings: ArrayLike,
        normal_force: ArrayLike,
        count: ArrayLike,
        *,
        unsigned_readings: ArrayLike,
        sense: ArrayLike,
        matrix: ArrayLike,
        zero: ArrayLike,
        is_load_given: bool = False,
        is_fixed: bool = False,
    ) -> None:
        angle = arrays.array(phi, "phi", (None,))
        k = angle.size
        self._set(
            phi=angle,
            readings=arrays.array(readings, "readings", (k, 3)),
            normal_force=arrays.array(normal_force, "normal_force", (k,)),
            count=arrays.array(count, "count", (k,)),
            unsigned_readings=arrays.array(unsigned_readings, "unsigned_readings", (k, 3)),
            sense=arrays.array(sense, "sense", (k,)),
            matrix=arrays.array(matrix, "matrix", (3, 3)),
            zero=arrays.array(zero, "zero", (3,)),
            is_load_given=bool(is_load_given),
            is_fixed=bool(is_fixed),
        )
        resistance = self.readings @ self.matrix[:2].T
        self._keep(
            resistance=resistance,
            force=turned(angle, resistance),
        )

    def __repr__(self) -> str:
        return f"<Averaged: {len(self.phi)} bins, {self.count.sum():.0f} samples>"

    def perturbed(
        self, *, matrix: ArrayLike | None = None, zero: ArrayLike | None = None
    ) -> tuple[Array, Array]:
        """Return −λ and λ_N in N that another calibration or zero would have given.

        Args:
            matrix: T, shape ``(3, 3)``.
            zero: mean reading without load, shape ``(3,)``.

        Returns:
            Forces ``(k, 2)`` and normal forces ``(k,)``.

        Raises:
            ParameterError: if the sensor does not turn with the sliding; `ProcessedData.perturbed`
                knows all samples.
        """
        if self.is_fixed:
            raise ParameterError(
                "self", "are means of a sensor that does not turn: use ProcessedData.perturbed"
            )
        t = self.matrix if matrix is None else arrays.array(matrix, "matrix", (3, 3))
        given = self.zero if zero is None else arrays.array(zero, "zero", (3,))
        shift = given - self.zero
        readings = self.readings - self.sense[:, None] * shift
        force = turned(self.phi, readings @ t[:2].T)
        if self.is_load_given:
            return force, self.normal_force
        # The mean normal force was filtered: only what changes is taken from the readings.
        pressing = self.unsigned_readings
        change = (pressing - shift) @ t[2] - pressing @ self.matrix[2]
        return force, self.normal_force + change


def turned(phi: Array, resistance: Array) -> Array:
    """Return −λ = R(φ)(λ_t, λ_r), shape ``(k, 2)``."""
    c, s = np.cos(phi), np.sin(phi)
    along, across = resistance[:, 0], resistance[:, 1]
    return np.stack([c * along - s * across, s * along + c * across], axis=-1)
