"""What made a run, so that it can be repeated."""

from __future__ import annotations

import json
from collections.abc import Mapping
from functools import cached_property
from typing import Any

from numpy.typing import NDArray

from asperity import _core, law, sets, solvers, system
from asperity._base import arrays
from asperity._base.storage import data
from asperity._base.value import Value
from asperity.errors import ParameterError
from asperity.runs.model import Model
from asperity.runs.section import Section
from asperity.runs.state import State
from asperity.solvers import Solver, chosen
from asperity.system.labels import Labels


def _interval(sample_every: float | None) -> float | None:
    return None if sample_every is None else arrays.positive(sample_every, "sample_every")


def _checked(start: State) -> State:
    if not isinstance(start, State):
        raise ParameterError("start", f"must be a State, got {start!r}")
    return start


class TimeStepping(Value):
    """Options of `simulate`, with the state that the run starts from.

    Args:
        dt: step in s.
        t_end: end time in s.
        start: the state at the start.
        solver: contact solver.
        tolerance: of each step's contact problem.
        sample_every: time between samples in s, or None: every step is kept.
        until_rest: whether the run ends at rest.
        on_failure: ``"raise"`` or ``"record"``.

    >>> from asperity import FrictionLaw, SlidingPoint, simulate
    >>> block = SlidingPoint(1.0, law=FrictionLaw.isotropic(0.5))
    >>> simulate(block, dt=0.01, t_end=0.2, u0=[2.0, 0.0]).options.dt
    0.01
    """

    dt: float
    t_end: float
    start: State
    solver: Solver
    tolerance: float
    sample_every: float | None
    until_rest: bool
    on_failure: str

    def __init__(
        self,
        *,
        dt: float,
        t_end: float,
        start: State,
        solver: Solver,
        tolerance: float,
        sample_every: float | None,
        until_rest: bool,
        on_failure: str,
    ) -> None:
        self._set(
            dt=arrays.positive(dt, "dt"),
            t_end=arrays.number(t_end, "t_end"),
            start=_checked(start),
            solver=chosen(solver),
            tolerance=arrays.positive(tolerance, "tolerance"),
            sample_every=_interval(sample_every),
            until_rest=bool(until_rest),
            on_failure=arrays.choice(on_failure, "on_failure", ["raise", "record"]),
        )


class EventDriven(Value):
    """Options of `integrate`, with the state that the run starts from.

    Args:
        t_end: end time in s.
        start: the state at the start.
        tolerance: error that is aimed at.
        sample_every: time between samples in s, or None: every step is kept.
        max_step: longest step in s, or None.
        section: where to stop, or None.
        max_events: number of events after which the integration gives up.

    >>> from asperity import FrictionLaw, SlidingPoint, integrate
    >>> block = SlidingPoint(1.0, law=FrictionLaw.isotropic(0.5))
    >>> integrate(block, t_end=1.0, u0=[2.0, 0.0]).options.tolerance
    1e-10
    """

    t_end: float
    start: State
    tolerance: float
    sample_every: float | None
    max_step: float | None
    section: Section | None
    max_events: int

    def __init__(
        self,
        *,
        t_end: float,
        start: State,
        tolerance: float,
        sample_every: float | None,
        max_step: float | None,
        section: Section | None,
        max_events: int,
    ) -> None:
        if section is not None and not isinstance(section, Section):
            raise ParameterError("section", f"must be a Section or None, got {section!r}")
        self._set(
            t_end=arrays.positive(t_end, "t_end"),
            start=_checked(start),
            tolerance=arrays.positive(tolerance, "tolerance"),
            sample_every=_interval(sample_every),
            max_step=None if max_step is None else arrays.positive(max_step, "max_step"),
            section=section,
            max_events=arrays.count(max_events, "max_events"),
        )


class Origin(Value):
    """The system and the options that made a run.

    Args:
        system: the system with its laws; ``None`` where a file could not hold it.
        options: of `simulate` or `integrate`.
        version: of asperity.
        note: why there is no system.
    """

    system: Model | None
    options: TimeStepping | EventDriven
    version: str
    note: str

    def __init__(
        self,
        system: Model | None,
        options: TimeStepping | EventDriven,
        *,
        version: str = _core.__version__,
        note: str = "",
    ) -> None:
        if not isinstance(options, TimeStepping | EventDriven):
            raise ParameterError("options", f"must be of simulate or integrate, got {options!r}")
        # Asking for the whole protocol takes longer than some runs.
        if system is not None and not hasattr(system, "dof"):
            raise ParameterError("system", f"must be a system or None, got {system!r}")
        self._set(system=system, options=options, version=str(version), note=str(note))

    def __reduce__(self) -> tuple[Any, ...]:
        # As in a file: what a function of the user is in cannot be copied to another process.
        beside: data.Arrays = {}
        return read, (self.written(beside), beside)

    def written(self, beside: data.Arrays) -> str:
        """Return the origin as text, with large arrays beside it; without a system that is no data.

        Args:
            beside: where large arrays are put, by their places.
        """
        return json.dumps(data.typed(self, "origin", KNOWN, beside), ensure_ascii=False)

    def _stored(self) -> Origin:
        return self if self.unsaved is None else self.replace(system=None, note=self.unsaved)

    @cached_property
    def unsaved(self) -> str | None:
        """Why no file can hold the system; ``None`` if one can."""
        if self.system is None:
            return None
        try:
            data.typed(self.system, "origin.system", KNOWN, {})
        except ParameterError as error:
            return f"{error.argument.removeprefix('origin.')} {error.message}"
        return None


KNOWN: data.Kinds = {
    **data.classes(sets, law, system, solvers),
    **{one.__name__: one for one in (Origin, TimeStepping, EventDriven, State, Section)},
}
"""Classes that the origin of a run is made of."""


def read(text: str, beside: Mapping[str, NDArray[Any]]) -> Origin:
    """Return the origin of a text, given the arrays beside it.

    Raises:
        ParameterError: naming the place of what is wrong.
    """
    found = _decoded(text, "origin", beside)
    if not isinstance(found, Origin):
        raise ParameterError("origin", f"must be of the type Origin, got {found!r:.60}")
    return found


def labels_written(labels: Labels) -> str:
    """Return labels as text."""
    return json.dumps(data.typed(labels, "labels", KNOWN), ensure_ascii=False)


def read_labels(text: str) -> Labels:
    """Return the labels of a text.

    Raises:
        ParameterError: naming the place of what is wrong.
    """
    found = _decoded(text, "labels", {})
    if not isinstance(found, Labels):
        raise ParameterError("labels", f"must be of the type Labels, got {found!r:.60}")
    return found


def _decoded(text: str, key: str, beside: Mapping[str, NDArray[Any]]) -> Any:
    try:
        return data.built_as_typed(json.loads(text), key, KNOWN, beside)
    except ParameterError:
        raise
    except (ValueError, RecursionError) as error:
        raise ParameterError(key, f"must be the text that asperity writes: {error}") from None
