"""What is kept of every run of an ensemble."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from typing import Any, Literal, TypeAlias

from asperity._base import arrays
from asperity._base.arrays import Array
from asperity.errors import DimensionError, ParameterError
from asperity.runs.section import Section

Reduction: TypeAlias = Literal["extent", "stick_share", "rest_time"] | Section
"""A quantity that is found while a run goes on, so that nothing of the way has to be kept."""
REDUCTIONS = ("extent", "stick_share", "rest_time")


@dataclass(frozen=True)
class Kept:
    """What is kept besides the ends.

    Attributes:
        every: steps, or seconds, from one sample to the next; None keeps none.
        names: of quantities that are found on the way.
        section: whose crossings are counted.
        after: time in s before which nothing is looked at.
    """

    every: float | None
    names: frozenset[str]
    section: Section | None
    after: float

    def arguments(self, steps: int | None) -> tuple[Any, ...]:
        """Return it as the core takes it."""
        wanted = [name in self.names for name in REDUCTIONS]
        return steps, self.after, wanted, section_arguments(self.section)


def section_arguments(section: Section | None) -> tuple[Array, float, float] | None:
    """Return a section as the core takes it."""
    return None if section is None else (section.normal, section.level, section.after)


def kept(keep: Any, after: float, sizes: Mapping[str, int]) -> Kept:
    """Return what a user has asked for.

    Args:
        keep: ``"end"``, a number, a quantity or several of them.
        after: time in s before which quantities do not look.
        sizes: numbers of coordinates and velocities.
    """
    after = arrays.non_negative(after, "after")
    states = sizes["coordinate"] + sizes["velocity"]
    if isinstance(keep, str | Section):
        keep = (keep,)
    elif not isinstance(keep, Iterable) or getattr(keep, "ndim", 1) == 0:
        if isinstance(keep, bool):
            raise ParameterError("keep", _ALLOWED.format(keep))
        return Kept(arrays.positive(keep, "keep"), frozenset(), None, after)
    names, sections = set(), []
    for part in keep:
        if isinstance(part, Section):
            sections.append(part)
        elif isinstance(part, str) and part in (*REDUCTIONS, "end"):
            names.add(part)
        else:
            raise ParameterError("keep", _ALLOWED.format(part))
    if len(sections) > 1:
        raise ParameterError("keep", "must not hold more than one Section")
    if sections and len(sections[0].normal) != states:
        raise DimensionError(
            "keep",
            f"must have a Section whose normal has {states} entries, one per coordinate and "
            f"velocity, has {len(sections[0].normal)}",
        )
    section = sections[0] if sections else None
    return Kept(None, frozenset(names - {"end"}), section, after)


_ALLOWED = (
    "must be 'end', the distance of samples, 'extent', 'stick_share', 'rest_time', a Section or "
    "several of these, got {!r}"
)
