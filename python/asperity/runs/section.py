"""Sections of the space of states."""

from __future__ import annotations

from dataclasses import KW_ONLY
from typing import Any

from asperity._base.value import Number, Record, Vector
from asperity.errors import ParameterError


class Section(Record):
    """A hyperplane n·(q, u) = c of states, at which an integration ends when it is crossed upwards.

    Args:
        normal: n, an entry for every coordinate, then for every velocity; it points to where the
            motion goes.
        level: c.
        after: crossings up to this time in s do not count.

    >>> from asperity import Section
    >>> Section([1.0, 0.0], 0.5, after=1.0)
    Section([1.0, 0.0], 0.5, after=1.0)
    """

    normal: Vector
    level: Number
    _: KW_ONLY
    after: Number = 0.0

    def _complete(self, given: dict[str, Any]) -> None:
        if len(given["normal"]) < 2 or not given["normal"].any():
            raise ParameterError(
                "normal", "must have an entry for every coordinate and velocity, not all zero"
            )
