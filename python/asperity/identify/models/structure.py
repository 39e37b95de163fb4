"""What the parameters of a law mean: of models of C and D in the plane, or of a patch."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Any

import numpy as np

from asperity._base.arrays import Array
from asperity.errors import ParameterError
from asperity.identify.models.coordinates import Coordinate, Roundness, Scale, at_bounds
from asperity.identify.models.directions import DirectionModel
from asperity.identify.models.patches import PatchModel
from asperity.identify.models.reservoirs import ReservoirModel
from asperity.law import FrictionLaw


class Structure:
    """The coordinates of a family of laws, and the parameters that follow from them."""

    @property
    def coordinates(self) -> tuple[tuple[str, Coordinate], ...]:
        """Names of the parameters, and the coordinates that the models have for them."""
        raise NotImplementedError

    def named(self) -> dict[str, Any]:
        """Return the models as `IdentifiedLaw` takes them."""
        raise NotImplementedError

    def law(self, coordinates: Array) -> FrictionLaw:
        """Return the law of coordinates."""
        raise NotImplementedError

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


@dataclass(frozen=True)
class PlanarStructure(Structure):
    """The models of C and D of a law in the plane."""

    reservoir: ReservoirModel
    direction: DirectionModel

    @property
    def models(self) -> tuple[tuple[str, Any, slice], ...]:
        """The sets by name, their models and the places of their coordinates."""
        split = len(self.reservoir.coordinates)
        whole = split + len(self.direction.coordinates)
        return (
            ("reservoir", self.reservoir, slice(0, split)),
            ("direction", self.direction, slice(split, whole)),
        )

    @property
    def coordinates(self) -> tuple[tuple[str, Coordinate], ...]:
        """Names of the parameters, and the coordinates that the models have for them."""
        return tuple(
            (f"{part}.{one.name}", one)
            for part, model, _ in self.models
            for one in model.coordinates
        )

    def named(self) -> dict[str, Any]:
        """Return the models as `IdentifiedLaw` takes them."""
        return {"reservoir_model": self.reservoir, "direction_model": self.direction}

    def law(self, coordinates: Array) -> FrictionLaw:
        """Return the law of coordinates."""
        (_, _, first), (_, _, second) = self.models
        return FrictionLaw(
            self.reservoir.reservoir(coordinates[first]),
            self.direction.direction(coordinates[second]),
        )

    def change(self, name: str, coordinate: float, step: float, *, signed: bool = False) -> str:
        """Return by how much a step of a coordinate changes its parameter, in words."""
        one, sign = dict(self.coordinates)[name], "+" if signed else ""
        size = step if signed else abs(step)
        if one.scale is Scale.ANGLE:
            text = f"{math.degrees(size):{sign}.2g}°"
        elif one.scale is Scale.PLAIN:
            text = f"{size:{sign}.2g}"
        else:
            x = np.asarray(coordinate)
            share = float(one.scale.slope(x)) / float(one.scale.natural(x))
            text = f"{100.0 * size * share:{sign}.2g} %"
        return f"{name} by {text}"

    def stuck(self, p: Array) -> dict[str, str]:
        """Return sentences on coordinates that ended at a bound of their model, by name."""
        listed = [one for _, one in self.coordinates]
        return {
            name: f"{name} is not identifiable: it ended at its bound {one.scale.natural(x):.4g}"
            for (name, one), x, ended in zip(self.coordinates, p, at_bounds(p, listed), strict=True)
            if ended
        }

    def roundness(self) -> dict[str, tuple[slice, Roundness]]:
        """Return what vanishes where a set has no angle, by the names of the angles."""
        return {
            self.names[part.stop - 1]: (part, roundness)
            for _, model, part in self.models
            if (roundness := model.roundness()) is not None
        }


@dataclass(frozen=True)
class PatchStructure(Structure):
    """The model of a patch, or of its support points in the plane."""

    model: PatchModel

    @property
    def coordinates(self) -> tuple[tuple[str, Coordinate], ...]:
        """Names of the parameters, and the coordinates that the model has for them."""
        return tuple((one.name, one) for one in self.model.coordinates)

    def named(self) -> dict[str, Any]:
        """Return the model as `IdentifiedLaw` takes it."""
        return {"reservoir_model": self.model}

    def law(self, coordinates: Array) -> FrictionLaw:
        """Return the law of coordinates."""
        return self.model.law(coordinates)
