"""Names of the models of C and D."""

from __future__ import annotations

from typing import Any, TypeAlias, TypeVar

from asperity._base.storage.data import Kinds
from asperity.errors import ParameterError
from asperity.identify.models.directions import (
    CircleDirection,
    DirectionModel,
    FourierDirection,
    SuperellipseDirection,
)
from asperity.identify.models.reservoirs import (
    CircleReservoir,
    FourierReservoir,
    ReservoirModel,
    SuperellipseReservoir,
)

Model = TypeVar("Model", ReservoirModel, DirectionModel)
ReservoirName: TypeAlias = str | ReservoirModel
"""``"circle"``, ``"ellipse"``, ``"superellipse"``, ``"fourier"``, ``"odd fourier"`` or a model."""
DirectionName: TypeAlias = str | DirectionModel
"""``"circle"``, ``"ellipse"``, ``"superellipse"``, ``"fourier"``, ``"odd fourier"`` or a model."""

RESERVOIRS: dict[str, ReservoirModel] = {
    "circle": CircleReservoir(),
    "ellipse": SuperellipseReservoir(2.0),
    "superellipse": SuperellipseReservoir(),
    "fourier": FourierReservoir(),
    "odd fourier": FourierReservoir(odd=True),
}
DIRECTIONS: dict[str, DirectionModel] = {
    "circle": CircleDirection(),
    "ellipse": SuperellipseDirection(2.0),
    "superellipse": SuperellipseDirection(),
    "fourier": FourierDirection(),
    "odd fourier": FourierDirection(odd=True),
}
# Models as data in files.
RESERVOIR_KINDS: Kinds = {type(one).__name__: type(one) for one in RESERVOIRS.values()}
DIRECTION_KINDS: Kinds = {type(one).__name__: type(one) for one in DIRECTIONS.values()}


def reservoir_model(name: ReservoirName) -> ReservoirModel:
    """Return the model of C that is meant."""
    return name if isinstance(name, ReservoirModel) else _named(name, RESERVOIRS, "reservoir")


def direction_model(name: DirectionName) -> DirectionModel:
    """Return the model of D that is meant."""
    return name if isinstance(name, DirectionModel) else _named(name, DIRECTIONS, "direction")


def _named(name: str, known: dict[str, Model], argument: str) -> Model:
    if name not in known:
        words = ", ".join(map(repr, known))
        raise ParameterError(argument, f"must be {words} or a model, got {name!r}")
    return known[name]


def name_of(model: ReservoirModel | DirectionModel) -> str:
    """Return the short name of a model, or its constructor call."""
    for names in (RESERVOIRS, DIRECTIONS):
        for name, known in names.items():
            if known == model:
                return name
    return repr(model)


def short(model: ReservoirModel | DirectionModel) -> Any:
    """Return the name of a model that has one, else the model."""
    name = name_of(model)
    return name if name in RESERVOIRS or name in DIRECTIONS else model
