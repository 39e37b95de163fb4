"""The models of C and D of a planar law, and what its parameters mean."""

from __future__ import annotations

import math
from typing import Any, NamedTuple

import numpy as np

from asperity._base.arrays import Array
from asperity.errors import ParameterError
from asperity.identify.models.coordinates import Coordinate, Roundness, Scale
from asperity.law import FrictionLaw


class Structure(NamedTuple):
    """The models of C and D, and with them what the parameters of a law mean."""

    reservoir: Any
    direction: Any

    @property
    def coordinates(self) -> tuple[tuple[str, Coordinate], ...]:
        """Names of the parameters, and the coordinates that the models have for them."""
        return tuple(
            (f"{part}.{one.name}", one)
            for part, model in (("reservoir", self.reservoir), ("direction", self.direction))
            for one in model.coordinates
        )

    @property
    def names(self) -> tuple[str, ...]:
        """Names of the parameters."""
        return tuple(name for name, _ in self.coordinates)

    @property
    def units(self) -> tuple[str, ...]:
        """Units of the parameters."""
        return tuple("rad" if one.scale is Scale.ANGLE else "-" for _, one in self.coordinates)

    @property
    def labels(self) -> tuple[str, ...]:
        """What the coordinates are, in which the covariance is."""
        words = {Scale.LOG: "ln({})", Scale.LOG_EXCESS: "ln({} - 1)"}
        return tuple(words.get(one.scale, "{}").format(name) for name, one in self.coordinates)

    def of_values(self, values: Array) -> Array:
        """Return the coordinates of parameters."""
        result = values.copy()
        for i, (name, one) in enumerate(self.coordinates):
            least = 1.0 if one.scale is Scale.LOG_EXCESS else 0.0
            if one.scale in (Scale.LOG, Scale.LOG_EXCESS):
                if values[i] <= least:
                    message = f"{name} must be above {least:g}, got {values[i]}"
                    raise ParameterError("values", message)
                result[i] = math.log(values[i] - least)
        return result

    def values(self, coordinates: Array) -> Array:
        """Return the parameters of coordinates ``(..., k)``."""
        columns = [
            one.scale.natural(coordinates[..., i]) for i, (_, one) in enumerate(self.coordinates)
        ]
        return np.stack(columns, axis=-1) if columns else coordinates.copy()

    def within_bounds(self, coordinates: Array) -> bool:
        """Return whether the models look for coordinates there."""
        pairs = zip(coordinates, self.coordinates, strict=True)
        return all(one.low <= x <= one.high for x, (_, one) in pairs)

    def law(self, coordinates: Array) -> FrictionLaw:
        """Return the law of coordinates."""
        split = len(self.reservoir.coordinates)
        return FrictionLaw(
            self.reservoir.reservoir(coordinates[:split]),
            self.direction.direction(coordinates[split:]),
        )

    def roundness(self) -> dict[str, tuple[slice, Roundness]]:
        """Return what vanishes where a set has no angle, by the names of the angles."""
        split = len(self.reservoir.coordinates)
        parts = (slice(0, split), slice(split, len(self.names)))
        return {
            self.names[part.stop - 1]: (part, roundness)
            for part, model in zip(parts, self, strict=True)
            if (roundness := model.roundness()) is not None
        }
