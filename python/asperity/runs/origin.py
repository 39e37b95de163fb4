"""What made a run, so that it can be repeated."""

from __future__ import annotations

from dataclasses import KW_ONLY
from functools import cached_property
from typing import Annotated, Any

import asperity._core as _core
from asperity import law, sets, solvers, system
from asperity._base import arrays
from asperity._base.storage import data
from asperity._base.value import Count, Number, Positive, Record, Text, of_kind
from asperity.errors import ParameterError
from asperity.runs.model import Model
from asperity.runs.section import Section
from asperity.runs.state import State
from asperity.solvers import Solver, chosen


def _solver(value: Solver | None, _: str) -> Solver:
    return chosen(value)


def _on_failure(value: str, argument: str) -> str:
    return arrays.choice(value, argument, ["raise", "record"])


def _theta(value: float | None, argument: str) -> float | None:
    if value is None:
        return None
    theta = arrays.number(value, argument)
    if not 0.5 <= theta <= 1.0:
        raise ParameterError(argument, f"must be None or from 0.5 to 1, got {value!r}")
    return theta


class TimeStepping(Record):
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
        implicit: θ of implicit stiffness and damping, or None: explicit.

    >>> from asperity import FrictionLaw, SlidingPoint, simulate
    >>> block = SlidingPoint(1.0, law=FrictionLaw.isotropic(0.5))
    >>> simulate(block, dt=0.01, t_end=0.2, u0=[2.0, 0.0]).options.dt
    0.01
    """

    _: KW_ONLY
    dt: Positive
    t_end: Number
    start: State
    solver: Annotated[Solver, _solver]
    tolerance: Positive
    sample_every: Positive | None
    until_rest: bool
    on_failure: Annotated[str, _on_failure]
    implicit: Annotated[float | None, _theta] = None


class EventDriven(Record):
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

    _: KW_ONLY
    t_end: Positive
    start: State
    tolerance: Positive
    sample_every: Positive | None
    max_step: Positive | None
    section: Section | None
    max_events: Count


def _system(value: Any, argument: str) -> Any:
    # Asking for the whole protocol takes longer than some runs.
    if value is not None and not hasattr(value, "dof"):
        raise ParameterError(argument, f"must be a system or None, got {value!r}")
    return value


class Origin(Record):
    """The system and the options that made a run.

    Args:
        system: the system with its laws; ``None`` where a file could not hold it.
        options: of `simulate` or `integrate`.
        version: of asperity.
        note: why there is no system.
    """

    system: Annotated[Model | None, _system]
    options: Annotated[
        TimeStepping | EventDriven, of_kind(TimeStepping | EventDriven, "of simulate or integrate")
    ]
    _: KW_ONLY
    version: Text = _core.__version__
    note: Text = ""

    def __reduce__(self) -> tuple[Any, ...]:
        # As in a file: what a function of the user is in cannot be copied to another process.
        return super(Origin, self._stored()).__reduce__()

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
