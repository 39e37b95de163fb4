"""Systems that are alike but for some of their parts."""

from __future__ import annotations

import json
import math
from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

import asperity._core as _core
from asperity._base import arrays
from asperity._base.arrays import Array
from asperity._base.value import Value
from asperity.ensemble.places import Key, Place, part_at, places, replaced
from asperity.errors import DimensionError, ParameterError
from asperity.law import FrictionLaw
from asperity.law import file as law_file
from asperity.runs.model import Model
from asperity.sets import (
    Ball,
    Disk,
    Ellipse,
    Ellipsoid,
    Interval,
    Superellipse,
    Superellipsoid,
    WedgeAsperity,
)
from asperity.system import LinearSystem, MassOnBelt, SlidingPoint

_BY_NUMBERS = (
    Ball,
    Disk,
    Ellipse,
    Ellipsoid,
    Interval,
    Superellipse,
    Superellipsoid,
    WedgeAsperity,
)
"""Sets whose tables the core takes to the bit; others it keeps in forms that a table rounds."""
_CoreChange = tuple[tuple[str, int, int, list[str]], Array]
"""A place of the core's linear systems, with a number per variant."""


class Variants(Value):
    """A system and others that differ from it in some parts, or a sequence of systems.

    Args:
        systems: a system, or a sequence of systems with as many coordinates and contacts.
        replace: values by dotted names of what they replace. The values of a name are an array
            whose last axes are those of the part that it replaces, or a sequence of objects such
            as laws; the axes before are broadcast against each other.
    """

    systems: Any
    values: dict[str, NDArray[Any]]
    shape: tuple[int, ...]

    def __init__(
        self, systems: Model | Sequence[Model], replace: Mapping[str, Any] | None = None
    ) -> None:
        first: Any = systems
        shape: tuple[int, ...] = ()
        if not isinstance(systems, Model):
            systems = _listed(systems)
            first, shape = systems[0], (len(systems),)
        values: dict[str, NDArray[Any]] = {}
        changed: dict[str, list[Place]] = {}
        if replace:
            if shape:
                raise ParameterError("replace", "needs one system, not a sequence of them")
            if not isinstance(first, Value):
                raise ParameterError(
                    "replace", f"needs a system of values, which {type(first).__name__} is not"
                )
            for name, given in replace.items():
                changed[name] = places(first, name)
                values[name] = _values(given, name, part_at(first, changed[name][0]))
            _refuse_overlapping(changed)
            shape = _common_shape(
                {name: _lead(v, first, changed[name]) for name, v in values.items()}
            )
        self._set(systems=systems, replace=values)
        self._keep(first=first, values=values, shape=shape, _places=changed)

    first: Model
    _places: dict[str, list[Place]]

    @property
    def listed(self) -> tuple[Model, ...]:
        """The systems that are there: those of the sequence, or the one."""
        return self.systems if isinstance(self.systems, tuple) else (self.first,)

    @property
    def count(self) -> int:
        """Number of systems."""
        return math.prod(self.shape)

    def system(self, variant: int) -> Model:
        """Return one of them, by its number in the order of the axes.

        Raises:
            ParameterError: as the constructors of its parts do.
        """
        if isinstance(self.systems, tuple):
            system: Model = self.systems[variant]
            return system
        if not self._places:
            return self.first
        index = np.unravel_index(variant, self.shape)
        parts = {
            place: self._value(name, index)
            for name, found in self._places.items()
            for place in found
        }
        made: Model = replaced(self.first, parts)
        return made

    def _value(self, name: str, index: tuple[Any, ...]) -> Any:
        values = self.values[name]
        lead = _lead(values, self.first, self._places[name])
        wide = np.broadcast_to(values, (*self.shape, *values.shape[len(lead) :]))
        value = wide[index]
        return value.item() if isinstance(value, np.generic) else value

    def of_the_core(self) -> _core.LinearVariants | None:
        """Return what makes them without Python: of linear systems that differ in numbers."""
        if {"mass", "gravity"} <= self.values.keys() and isinstance(self.first, SlidingPoint):
            return None  # Each of them changes the normal force.
        linear = _linear(self.first)
        if linear is None or not self._places:
            return None
        changes: list[_CoreChange] = []
        replaced: list[tuple[int, list[_core.Law]]] = []
        for name, found in self._places.items():
            for place in found:
                if (contact := _contact_of_law(self.first, place)) is not None:
                    laws_here = np.broadcast_to(self.values[name], self.shape).reshape(-1).tolist()
                    p = linear.contacts[contact].law.dimension
                    if not all(isinstance(x, FrictionLaw) and x.dimension == p for x in laws_here):
                        return None
                    replaced.append((contact, [law._core for law in laws_here]))
                    continue
                values = self._columns(name)
                added = None if values is None else _core_changes(self.first, place, values)
                if added is None:
                    return None
                changes.extend(added)
        numbers = {place[1] for place, _ in changes if place[0] == "law"}
        laws = [
            json.dumps(law_file.table_of(contact.law, "law")) if i in numbers else None
            for i, contact in enumerate(linear.contacts)
        ]
        return _core.LinearVariants(
            linear.mass,
            linear.stiffness,
            linear.damping,
            linear.force,
            [contact._core_data() for contact in linear.contacts],
            laws,
            [place for place, _ in changes],
            np.array([column for _, column in changes]).reshape(-1, self.count).T,
            replaced,
        )

    def inner_axes(self, name: str) -> int:
        """Return how many axes of the values of a name are those of the part."""
        values = self.values[name]
        return values.ndim - len(_lead(values, self.first, self._places[name]))

    def _columns(self, name: str) -> Array | None:
        """Return the values as an array ``(variants, …)``; None of objects."""
        values = self.values[name]
        if values.dtype == object or values.dtype.kind in "iu":
            return None
        lead = _lead(values, self.first, self._places[name])
        inner = values.shape[len(lead) :]
        return np.broadcast_to(values, (*self.shape, *inner)).reshape(self.count, *inner)


def _listed(systems: Any) -> tuple[Model, ...]:
    listed = arrays.several(systems, "systems")
    if not listed:
        raise ParameterError("systems", "must not be empty")
    for system in listed:
        arrays.of_kind(system, "systems", Model, "systems such as SlidingPoint")
    return listed


def _values(given: Any, name: str, part: Any) -> NDArray[Any]:
    """Return the values of a name as an array of numbers, or of objects where the part is one."""
    listed = (given,) if isinstance(given, Value) else given
    if isinstance(listed, list | tuple) and any(isinstance(one, Value) for one in listed):
        values = np.empty(len(listed), dtype=object)
        values[:] = listed
        return values.reshape(() if isinstance(given, Value) else (-1,))
    if not isinstance(part, int | float | np.ndarray):
        raise ParameterError(
            "replace",
            f"of {name!r} needs a sequence of such objects as there are now, "
            f"{type(part).__name__}; numbers, arrays and values of the library can be replaced",
        )
    numbers = arrays.with_gaps(given, name)
    if not numbers.size:
        raise DimensionError("replace", f"of {name!r} must give a value at least")
    # What counts or numbers something stays whole.
    whole = type(part) is int and np.asarray(given).dtype.kind in "iu"
    return arrays.read_only(np.asarray(given) if whole else numbers)


def _lead(values: NDArray[Any], system: Any, found: list[Place]) -> tuple[int, ...]:
    """Return the axes of values that are not those of the part that they replace."""
    part = part_at(system, found[0])
    inner = part.shape if isinstance(part, np.ndarray) and values.dtype != object else ()
    if inner and values.shape[len(values.shape) - len(inner) :] != inner:
        name = _name(found[0])
        wanted = ", ".join(["...", *map(str, inner)])
        raise DimensionError(
            "replace", f"of {name!r} must have shape ({wanted}), has {values.shape}"
        )
    return values.shape[: values.ndim - len(inner)]


def _name(place: Place) -> str:
    text = ""
    for key in place:
        if isinstance(key, str):
            text += f".{key}"
        else:
            text += f"[{', '.join(map(str, key)) if isinstance(key, tuple) else key}]"
    return text.removeprefix(".")


def _common_shape(shapes: Mapping[str, tuple[int, ...]]) -> tuple[int, ...]:
    try:
        return np.broadcast_shapes(*shapes.values())
    except ValueError:
        listed = ", ".join(f"{name!r} {shape}" for name, shape in shapes.items())
        raise DimensionError("replace", f"must hold arrays that broadcast, got {listed}") from None


def _refuse_overlapping(changed: Mapping[str, list[Place]]) -> None:
    """Refuse two names for the same part, or for a part and one of its parts."""
    pairs = ((place, name) for name, found in changed.items() for place in found)
    seen: dict[Place, str] = {}
    # What holds others is shorter than they are.
    for place, name in sorted(pairs, key=lambda pair: len(pair[0])):
        whole = next((seen[place[:n]] for n in range(len(place) + 1) if place[:n] in seen), name)
        if whole != name:
            raise ParameterError("replace", f"has {whole!r} and a part of it, {name!r}")
        seen[place] = name


def _linear(system: Model) -> LinearSystem | None:
    """Return the linear system behind one."""
    if type(system) is SlidingPoint or type(system) is MassOnBelt:
        return system.linear
    return system if type(system) is LinearSystem and not system.constraints else None


def _contact_of_law(system: Model, place: Place) -> int | None:
    """Return the number of the contact whose law is at a place; None if there is something else."""
    match place:
        case ("law",) if isinstance(system, SlidingPoint | MassOnBelt):
            return 0
        case ("contacts", int(i), "law") if isinstance(system, LinearSystem):
            return i
    return None


def _core_changes(system: Model, place: Place, values: Array) -> list[_CoreChange] | None:
    """Return what the values at a place change in the core; None where Python has to make it."""
    if isinstance(system, SlidingPoint | MassOnBelt):
        if place[0] == "law":
            return _law_change(system.law, 0, place[1:], values)
        if isinstance(system, MassOnBelt) and (values > 0.0).all() and place == ("normal_force",):
            return [(("normal_force", 0, 0, []), values)]
        if isinstance(system, SlidingPoint) and place in (("mass",), ("gravity",)):
            return _of_the_point(system, place, values)
        if place[0] == "belt_velocity" and np.isfinite(values).all():
            return _entries("velocity", (0,), place[1:], -values)
        if place == ("mass",) and isinstance(system, MassOnBelt) and (values > 0.0).all():
            return [(("mass", i, i, []), values) for i in range(system.dof)]
        if place[0] == "stiffness" and np.isfinite(values).all():
            return _entries("stiffness", (), place[1:], values)
        return None
    if not isinstance(system, LinearSystem) or not np.isfinite(values).all():
        return None
    match place:
        case ("stiffness" | "damping" | "force" as kind, *entry):
            return _entries(str(kind), (), tuple(entry), values)
        case ("contacts", int(i), "law", *rest):
            return _law_change(system.contacts[i].law, i, tuple(rest), values)
        case ("contacts", int(i), "normal_force") if not system.contacts[i].unilateral:
            return [(("normal_force", i, 0, []), values)] if (values >= 0.0).all() else None
        case ("contacts", int(i), "gap") if system.contacts[i].unilateral:
            return [(("gap", i, 0, []), values)]
        case ("contacts", int(i), "velocity", *entry):
            return _entries("velocity", (i,), tuple(entry), values)
    return None


def _of_the_point(system: SlidingPoint, place: Place, values: Array) -> list[_CoreChange] | None:
    if not ((values > 0.0) & np.isfinite(values)).all():
        return None
    if place == ("gravity",):
        return [(("normal_force", 0, 0, []), system.mass * values)]
    mass: list[_CoreChange] = [(("mass", i, i, []), values) for i in range(system.dof)]
    return [*mass, (("normal_force", 0, 0, []), values * system.gravity)]


def _entries(kind: str, front: tuple[int, ...], entry: Place, values: Array) -> list[_CoreChange]:
    """Return the change of an array, or of one of its entries."""
    columns: dict[tuple[int, ...], Array] = {}
    if entry:
        (index,) = entry
        if not isinstance(index, str):
            columns[index if isinstance(index, tuple) else (index,)] = values
    else:
        columns = {index: values[:, *index] for index in np.ndindex(values.shape[1:])}
    changes: list[_CoreChange] = []
    for index, column in columns.items():
        i, j, *_ = (*front, *index, 0)
        changes.append(((kind, i, j, []), column))
    return changes


def _law_change(
    law: FrictionLaw, contact: int, keys: tuple[Key, ...], values: Array
) -> list[_CoreChange] | None:
    """Return the change of a number of a law; None where Python has to make the law."""
    # As it was given, which is what the table holds.
    direction = law._parameters["direction"]
    # The table of a turned one is rounded where D is scaled.
    if isinstance(direction, Superellipse) and (direction.angle or "angle" in keys):
        return None
    # What the constructor of a rate refuses the core may take.
    if keys[:1] == ("rate",):
        return None
    if not all(type(one) in _BY_NUMBERS for one in (law.reservoir, direction)):
        return None
    if not keys or not isinstance(part_at(law, keys), float):
        return None
    if not np.isfinite(values).all():
        return None
    # The table of such a law has the words of the constructors.
    words = [str(key[0] if isinstance(key, tuple) else key) for key in keys]
    return [(("law", contact, 0, words), values)]
