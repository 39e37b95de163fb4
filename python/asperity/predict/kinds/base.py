"""What every kind of scenario provides."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from typing import Any, NamedTuple, TypeAlias

import numpy as np

from asperity._base import arrays
from asperity._base.arrays import Array
from asperity._base.storage.toml import NUMBER, NUMBERS, Schema, TomlFile
from asperity.errors import ParameterError
from asperity.law import FrictionLaw
from asperity.runs.model import Model
from asperity.runs.run import Run
from asperity.status import Phase

Laws: TypeAlias = Mapping[str, FrictionLaw]
"""Laws by the names that their files have in the scenario."""

START: Schema = {
    "position": NUMBERS,
    "velocity": NUMBERS,
    "speed": NUMBER,
    "direction_deg": NUMBER,
}
"""Where and how a point starts, or the centre of a disk."""


class Quantity(NamedTuple):
    """A number that a scenario is asked for."""

    name: str
    unit: str
    value: float


class Setup(NamedTuple):
    """A system and its initial state; None for what the system itself or zero says."""

    system: Model
    q0: Array | None = None
    u0: Array | None = None


@dataclass(frozen=True)
class Kind:
    """A kind of scenario.

    Attributes:
        name: in the key ``kind`` of the file.
        meaning: a sentence.
        schema: sections of the file besides those of every scenario.
        build: makes the system of the values of a file and of laws.
        paths: positions of what moves over the samples of a run, in m, by name: ``(n_t, 2 or 3)``.
        quantities: what a run is asked for; the first two are the end point if `has_end`.
        has_end: whether the motion is asked for the point of the plane in which it comes to rest.
        example: text of a file of this kind.
    """

    name: str
    meaning: str
    schema: Schema
    build: Callable[[TomlFile, Laws], Setup]
    paths: Callable[[Model, Run], dict[str, Array]]
    quantities: Callable[[Model, Run], Sequence[Quantity]]
    has_end: bool
    example: str


def section(file: TomlFile, name: str) -> dict[str, Any]:
    """Return a section of the file, empty if it is not there."""
    return dict(file.values.get(name, {}))


def needed(file: TomlFile, name: str, key: str) -> Any:
    """Return a value that has no default.

    Raises:
        ConfigurationError: if it is missing.
    """
    values = section(file, name)
    if key not in values:
        raise file.error(f"{name}.{key}", "is missing")
    return values[key]


def planar_law(file: TomlFile, laws: Laws) -> FrictionLaw:
    """Return the law of the scenario.

    Raises:
        ConfigurationError: if it is not planar.
    """
    law = laws[file.values["law"]]
    if law.dimension != 2:
        raise file.error("law", f"must be planar, its dimension is {law.dimension}")
    return law


def planar_vector(file: TomlFile, name: str, key: str) -> Array:
    """Return a vector of the plane, given by components, or by ``speed`` and ``direction_deg``."""
    values = section(file, name)
    if "speed" in values or "direction_deg" in values:
        if key in values:
            raise file.error(f"{name}.speed", f"is given beside {key}: leave one of the two out")
        angle = np.deg2rad(needed(file, name, "direction_deg"))
        return np.array([np.cos(angle), np.sin(angle)]) * float(needed(file, name, "speed"))
    return vector(file, f"{name}.{key}", values.get(key, [0.0, 0.0]), 2)


def vector(file: TomlFile, key: str, value: Any, size: int) -> Array:
    """Return a vector of so many components.

    Raises:
        ConfigurationError: if it is something else.
    """
    try:
        return arrays.array(value, key, (size,))
    except (ParameterError, ValueError):
        raise file.error(key, f"must be {size} numbers in brackets, got {value!r}") from None


def rest_time(run: Run) -> float | None:
    """Return since when no contact slides and one sticks, in s; None if one slides at the end."""
    resting = (run.phase == Phase.STICK).any(axis=1) & ~(run.phase == Phase.SLIP).any(axis=1)
    # The first sample of a run of time stepping has no phase.
    moving = np.flatnonzero(~resting)
    since = moving[-1] + 1 if moving.size else 0
    return float(run.t[since]) if since < len(run.t) else None


def end_point(path: Array, run: Run) -> list[Quantity]:
    """Return where a path of the plane ends, how far from its start, in which direction, when.

    The time of a path that does not come to rest is that of its end.
    """
    rest = rest_time(run)
    first, last = path[0, :2], path[-1, :2]
    way = last - first
    return [
        Quantity("end point e1", "m", float(last[0])),
        Quantity("end point e2", "m", float(last[1])),
        Quantity("distance of the end point from the start", "m", float(np.hypot(*way))),
        Quantity(
            "direction of the end point", "deg", float(np.rad2deg(np.arctan2(way[1], way[0])))
        ),
        Quantity("time until rest", "s", float(run.t[-1]) if rest is None else rest),
    ]
