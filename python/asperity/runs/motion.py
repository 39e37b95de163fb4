"""The outcome of an event-driven integration."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import KW_ONLY
from typing import Annotated

import numpy as np

from asperity._base.arrays import Array
from asperity._base.result import counted
from asperity._base.value import AnyArray, Given, a_tuple, field, unchecked
from asperity.runs.event import Event, EventKind
from asperity.runs.model import Model
from asperity.runs.origin import Origin
from asperity.runs.run import AnyLabels, AnyPhases, Run
from asperity.runs.state import State
from asperity.status import Outcome, Phase

_COUNTED = (Phase.OPEN, Phase.STICK, Phase.SLIP)
# Most events in a summary.
_TOLD = 8


_WITH_CONTACT = {
    EventKind.STICK: "sticks",
    EventKind.SLIP: "slips",
    EventKind.OPEN: "opens",
    EventKind.IMPACT: "closes with an impact",
    EventKind.IMPACT_WITHOUT_COLLISION: "stops slipping by an impact without collision",
    EventKind.SECTION: "crosses the section",
    EventKind.KINK: "has a kink",
    EventKind.BORDER: "crosses a border of friction",
}
_WITHOUT_CONTACT = {
    **dict.fromkeys(EventKind, "something happens"),
    EventKind.SECTION: "The motion crosses the section",
    EventKind.KINK: "A load or a surface velocity has a kink",
}


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
        labels: `Labels`, the names and units of coordinates, velocities and contacts.
        origin: `Origin`, the system and the options of the run; ``None`` if they are not known.

    >>> from asperity import FrictionLaw, SlidingPoint, integrate
    >>> block = SlidingPoint(1.0, law=FrictionLaw.isotropic(0.5), gravity=10.0)
    >>> print(integrate(block, t_end=1.0, u0=[2.0, 0.0]).summary())
    The run went on to its end. It has 26 samples and 1 event, up to t = 1 s.
    contact 0 stuck 60.0% and slipped 40.0% of the time.
    contact 0 sticks at t = 0.4 s.
    """

    t: AnyArray
    q: AnyArray
    u: AnyArray
    slip: AnyArray
    force: AnyArray
    normal_force: AnyArray
    phase: AnyPhases
    _: KW_ONLY
    events: Annotated[Given[Sequence[Event], tuple[Event, ...]], a_tuple]
    status: Outcome
    steps: int
    rejected_steps: int
    labels: AnyLabels = field(default=None)
    origin: Annotated[Origin | None, unchecked] = None

    def _extent(self) -> str:
        return f"{super()._extent()} and {counted(len(self.events), 'event')}"

    def _shares(self) -> Array:
        """Return the shares of the time; between two samples the phase of the later one holds."""
        lengths = np.diff(self.t, prepend=self.t[:1])
        whole = max(float(lengths.sum()), np.finfo(float).tiny)
        shares: Array = np.stack(
            [(lengths[:, None] * (self.phase == kind)).sum(axis=0) for kind in _COUNTED], axis=-1
        )
        return shares / whole

    def _sentences(self) -> Iterator[str]:
        yield from super()._sentences()
        for event in self.events[:_TOLD]:
            yield f"{self._told(event)} at t = {event.time:.9g} s."
        if len(self.events) > _TOLD:
            yield f"There are {counted(len(self.events) - _TOLD, 'more event')}."
        if self.ambiguous_events:
            yield (
                f"At {counted(self.ambiguous_events, 'event')} the contacts might have done "
                "something else; what continues their state was taken."
            )

    def _told(self, event: Event) -> str:
        if event.contact is None:
            return _WITHOUT_CONTACT[event.kind]
        return f"{self.contact_names[event.contact]} {_WITH_CONTACT[event.kind]}"

    def _facts(self) -> dict[str, str | int | float]:
        return {**super()._facts(), "rejected_steps": self.rejected_steps}

    def repeat(self, *, system: Model | None = None) -> Motion:
        """Make the run again, the whole of it if this is a slice.

        The same version of asperity gives the same bits.

        Args:
            system: what to integrate with the same options, as with another law; default the
                run's own. It has to be given for a run from a file that could not hold it.

        Raises:
            ParameterError: if the run has no options or no system.
        """
        from asperity.runs.event_driven import integrate

        own, options = self._again(system)
        return integrate(own, **options)

    @property
    def end(self) -> State | None:
        """The `State` at the last sample, from which runs go on with ``start=``; None without one.

        Contacts then decide afresh what they do; where they have a choice, what they did before the
        end does not count.
        """
        if not len(self):
            return None
        return State(self.q[-1], self.u[-1], t0=self.t[-1])

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
