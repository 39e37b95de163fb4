"""Names of bodies, coordinates and contacts, and the units of coordinates."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterable, Sequence
from typing import Annotated, Any, TypeAlias

from asperity._base import arrays
from asperity._base.value import Given, Record
from asperity.errors import DimensionError, ParameterError

UNKNOWN_UNIT = "SI"
"""The unit of a coordinate that may be a length or an angle."""


def texts(values: Sequence[str], argument: str) -> tuple[str, ...]:
    """Return texts that stand on one line each."""
    if isinstance(values, str):
        raise ParameterError(argument, f"must be a sequence of texts, got the text {values!r}")
    return tuple(_text(one, argument) for one in arrays.several(values, argument))


Names: TypeAlias = Annotated[Given[Sequence[str], tuple[str, ...]], texts]


class Labels(Record):
    """What the coordinates, velocities and contacts of a system are called, with their units.

    Args:
        coordinates: names, one per coordinate.
        coordinate_units: such as ``"m"``; ``"-"`` of numbers without one, ``"SI"`` if not known.
        velocities: names, one per velocity.
        velocity_units: such as ``"m/s"``.
        contacts: names, one per contact.

    >>> from asperity import Body, RigidBodies
    >>> RigidBodies([Body.ball(1.0, radius=0.1, name="pin")]).labels.coordinates[:3]
    ('pin x', 'pin y', 'pin z')
    """

    coordinates: Names
    coordinate_units: Names
    velocities: Names
    velocity_units: Names
    contacts: Names

    def _complete(self, given: dict[str, Any]) -> None:
        for names, units in (("coordinates", "coordinate_units"), ("velocities", "velocity_units")):
            if len(given[names]) != len(given[units]):
                raise DimensionError(units, f"must be {len(given[names])}, as many as {names}")
        for argument in ("coordinates", "velocities", "contacts"):
            unique(given[argument], argument)


def numbered(coordinates: int, velocities: int, contacts: int) -> Labels:
    """Return labels that are numbers only."""
    return Labels(
        [f"q{i}" for i in range(coordinates)],
        [UNKNOWN_UNIT] * coordinates,
        [f"u{i}" for i in range(velocities)],
        [UNKNOWN_UNIT] * velocities,
        contact_names([None] * contacts),
    )


def of_coordinates(
    coordinates: int,
    velocities: int,
    contacts: Sequence[str],
    names: Sequence[str] | None,
    units: Sequence[str] | None,
    *,
    are_rates: bool,
) -> Labels:
    """Return labels with the names and units that are given for the coordinates.

    Velocities are called after the coordinates where they are their rates.
    """
    plain = numbered(coordinates, velocities, len(contacts)).replace(contacts=contacts)
    if names is None and units is None:
        return plain
    names = plain.coordinates if names is None else names
    units = plain.coordinate_units if units is None else units
    if not are_rates:
        return plain.replace(coordinates=names, coordinate_units=units)
    rates = [f"{name}_dot" for name in names]
    return Labels(names, units, rates, list(map(per_second, units)), contacts)


def name(value: str | None, argument: str = "name") -> str | None:
    """Return a name that stands on one line, or None."""
    return None if value is None else _text(value, argument)


def _text(value: str, argument: str) -> str:
    # Names become titles of columns, where line breaks and blanks at the ends would be lost.
    if not isinstance(value, str) or not value or not value.isprintable() or value != value.strip():
        raise ParameterError(
            argument,
            "must be a text of one line without blanks at its ends or characters that cannot be "
            f"printed, got {value!r}",
        )
    return str(value)


def unique(names: Iterable[str], argument: str) -> None:
    """Refuse names that are given twice."""
    twice = [name for name, count in Counter(names).items() if count > 1]
    if twice:
        raise ParameterError(argument, f"must have different names, {twice[0]!r} is given twice")


def contact_names(names: Sequence[str | None], argument: str = "contacts") -> tuple[str, ...]:
    """Return the names of contacts; those without one are called by their numbers."""
    given = [name for name in names if name is not None]
    unique(given, argument)
    whole = tuple(
        f"contact {number}" if name is None else name for number, name in enumerate(names)
    )
    unique(whole, argument)
    return whole


def per_second(unit: str) -> str:
    """Return the unit of a rate."""
    if unit == UNKNOWN_UNIT:
        return unit
    return "1/s" if unit == "-" else f"{unit}/s"
