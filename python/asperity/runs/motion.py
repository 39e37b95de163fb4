"""The outcome of an event-driven integration."""

from __future__ import annotations

from collections.abc import Sequence
from enum import StrEnum

from numpy.typing import ArrayLike

from asperity._base import arrays
from asperity._base.arrays import Array
from asperity._base.value import Value
from asperity.errors import ParameterError
from asperity.runs.run import Run
from asperity.status import Outcome, Phase


class EventKind(StrEnum):
    """What happens at an event."""

    STICK = "stick"
    """A contact begins to stick."""
    SLIP = "slip"
    """A contact begins to slip, or its slip passes through zero."""
    OPEN = "open"
    """A contact opens."""
    IMPACT = "impact"
    """A contact closes; velocities may jump."""
    IMPACT_WITHOUT_COLLISION = "impact_without_collision"
    """Friction stops the slip by an impact without approach (Painlevé)."""
    SECTION = "section"
    """The motion crosses the section."""
    KINK = "kink"
    """A load or the velocity of a surface jumps, or its rate does, see `Signal`."""

    def __repr__(self) -> str:
        return f"EventKind.{self.name}"


class Event(Value):
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
    contact: int | None
    phase: Phase | None
    ambiguous: bool

    def __init__(
        self,
        time: float,
        kind: EventKind | str,
        contact: int | None = None,
        phase: Phase | int | None = None,
        *,
        ambiguous: bool = False,
    ) -> None:
        self._set(
            time=float(time),
            kind=EventKind(kind),
            contact=contact,
            phase=None if phase is None else Phase(phase),
            ambiguous=bool(ambiguous),
        )


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


class Motion(Run):
    """States, forces and phases over time, with the events between; all arrays are read-only.

    Without a sampling step every step of the method is a sample, and events have two, before and
    after. Where contacts differ in dimension, missing components are NaN.

    Attributes:
        t: time in s, shape ``(n_t,)``.
        q: coordinates, shape ``(n_t, n_q)``; more than velocities where bodies turn in space.
        u: velocities, shape ``(n_t, n)``.
        slip: relative velocities γ in m/s, shape ``(n_t, n_contact, p)``.
        force: friction forces λ on the body in N, shape ``(n_t, n_contact, p)``.
        normal_force: λ_N in N, shape ``(n_t, n_contact)``.
        phase: `Phase` as integers, shape ``(n_t, n_contact)``.
        events: the events in their order.
        status: how the integration ended.
        steps: number of steps done.
        rejected_steps: number of steps that were tried and found too long.
    """

    events: tuple[Event, ...]
    rejected_steps: int

    def __init__(
        self,
        t: ArrayLike,
        q: ArrayLike,
        u: ArrayLike,
        slip: ArrayLike,
        force: ArrayLike,
        normal_force: ArrayLike,
        phase: ArrayLike,
        *,
        events: Sequence[Event],
        status: Outcome,
        steps: int,
        rejected_steps: int,
    ) -> None:
        self._set(
            **self._frozen(t, q, u, slip, force, normal_force, phase),
            events=tuple(events),
            status=Outcome(status),
            steps=int(steps),
            rejected_steps=int(rejected_steps),
        )

    def _extent(self) -> str:
        return f"{len(self)} samples and {len(self.events)} events"

    @property
    def at_section(self) -> bool:
        """Whether the motion ends on the section."""
        return self.status is Outcome.SECTION

    @property
    def ambiguous_events(self) -> int:
        """Number of events at which the contacts might have done something else."""
        return sum(event.ambiguous for event in self.events)

    def slice(self, t0: float, t1: float) -> Motion:
        """Return the samples and events with t0 ≤ t ≤ t1; counts and status remain those of all."""
        series = self._between(t0, t1)
        events = tuple(event for event in self.events if t0 <= event.time <= t1)
        return self.replace(**series, events=events)
