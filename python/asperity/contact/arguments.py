"""Arguments of a contact problem that come contact by contact."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from asperity._base import arrays
from asperity._base.arrays import Array
from asperity.errors import DimensionError, ParameterError
from asperity.law import FrictionLaw

Laws = tuple[FrictionLaw | None, ...]
"""One per contact, ``None`` of those without friction."""


def dimension(law: FrictionLaw | None) -> int:
    """Return the number p of tangential rows."""
    return 0 if law is None else law.dimension


def sizes(laws: Laws, normal_force: Sequence[float | None]) -> list[int]:
    """Return the number of rows of each contact."""
    return [dimension(law) + (force is None) for law, force in zip(laws, normal_force, strict=True)]


def listed_laws(laws: Any, rows: int, normal_force: Any) -> Laws:
    """Return one law per contact."""
    if laws is None or isinstance(laws, FrictionLaw):
        return (laws,) * _contact_count(laws, rows, normal_force)
    listed = tuple(laws) if isinstance(laws, Sequence) else (laws,)
    for law in listed:
        arrays.of_kind(
            law,
            "laws",
            FrictionLaw | None,
            "a FrictionLaw, or None without friction, or a list of them",
        )
    if not listed:
        raise DimensionError("laws", "must hold at least one law")
    return listed


def _contact_count(law: FrictionLaw | None, rows: int, normal_force: Any) -> int:
    """Return the number of contacts that share one law."""
    if normal_force is not None and np.ndim(normal_force):
        return len(normal_force)
    rows_each = max(dimension(law) + (normal_force is None), 1)
    if rows == 0 or rows % rows_each:
        raise DimensionError(
            "free_velocity", f"must have a multiple of {rows_each} rows (one contact), got {rows}"
        )
    return rows // rows_each


def normal_forces(normal_force: Any, laws: Laws) -> tuple[float | None, ...]:
    """Return one prescribed percussion per contact, ``None`` where it is unilateral."""
    contacts = len(laws)
    if normal_force is None or np.ndim(normal_force) == 0:
        listed = [normal_force] * contacts
    else:
        listed = list(normal_force)
    if len(listed) != contacts:
        raise DimensionError(
            "normal_force", f"must have one entry per contact ({contacts}), got {len(listed)}"
        )
    if any(law is None and force is not None for law, force in zip(laws, listed, strict=True)):
        raise ParameterError(
            "normal_force",
            "must be None of a contact without friction, whose normal row is all it has",
        )
    return tuple(
        None if force is None else arrays.non_negative(force, "normal_force") for force in listed
    )


def fractions(value: ArrayLike, argument: str, contacts: int) -> Array:
    """Return one number between 0 and 1 per contact."""
    if type(value) is float:
        return np.full(contacts, arrays.fraction(value, argument))
    converted = arrays.array(value, argument)
    if converted.ndim == 0:
        converted = np.full(contacts, converted)
    arrays.check_shape(converted, argument, (contacts,))
    outside = (converted < 0.0) | (converted > 1.0)
    if outside.any():
        arrays.fraction(converted[outside.argmax()], argument)
    return converted
