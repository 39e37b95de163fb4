"""Sections of the space of states."""

from __future__ import annotations

from numpy.typing import ArrayLike

from asperity._base import arrays
from asperity._base.arrays import Array
from asperity._base.value import Value
from asperity.errors import ParameterError


class Section(Value):
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

    normal: Array
    level: float
    after: float

    def __init__(self, normal: ArrayLike, level: float, *, after: float = 0.0) -> None:
        n = arrays.array(normal, "normal", (None,))
        if len(n) < 2 or not n.any():
            raise ParameterError(
                "normal", "must have an entry for every coordinate and velocity, not all zero"
            )
        self._set(
            normal=arrays.read_only(n),
            level=arrays.number(level, "level"),
            after=arrays.number(after, "after"),
        )
