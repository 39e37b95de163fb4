"""Events of a motion."""

from __future__ import annotations

from dataclasses import KW_ONLY
from enum import StrEnum

from asperity._base.value import Record
from asperity.status import Phase


class EventKind(StrEnum):
    """What happens at an event."""

    STICK = "stick"
    """A contact begins to stick."""
    SLIP = "slip"
    """A contact begins to slip, or carries load again, or its slip passes through zero."""
    OPEN = "open"
    """A contact opens, or stays closed and carries no load any more."""
    IMPACT = "impact"
    """A contact closes; velocities may jump."""
    IMPACT_WITHOUT_COLLISION = "impact_without_collision"
    """Friction stops the slip by an impact without approach (Painlevé)."""
    SECTION = "section"
    """The motion crosses the section."""
    KINK = "kink"
    """A load or the velocity of a surface jumps, or its rate does, see `Signal`."""
    BORDER = "border"
    """A contact crosses a border at which friction jumps, see `FrictionRegions`."""

    def __repr__(self) -> str:
        return f"EventKind.{self.name}"


class Event(Record):
    """Something that happened in a motion.

    Attributes:
        time: in s.
        kind: what happened.
        contact: number of the contact; ``None`` of a section and of a kink.
        phase: what the contact does afterwards; ``None`` of a section and of a kink.
        ambiguous: whether the contacts might have done something else, see docs/selection.md.
    """

    time: float
    kind: EventKind
    contact: int | None = None
    phase: Phase | None = None
    _: KW_ONLY
    ambiguous: bool = False
