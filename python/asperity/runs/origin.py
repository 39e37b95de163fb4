"""What made a run, so that it can be repeated."""

from __future__ import annotations

import json
from collections.abc import Mapping
from typing import Any

from numpy.typing import NDArray

from asperity import _core, law, sets, solvers, system
from asperity._base import encoding
from asperity._base.arrays import Array
from asperity._base.value import Record, Value
from asperity.errors import ParameterError
from asperity.runs.model import Model
from asperity.runs.section import Section
from asperity.runs.state import State
from asperity.solvers import Solver
from asperity.system.labels import Labels


class TimeStepping(Record, kw_only=True):
    """Options of `simulate`, with the state that the run starts from.

    >>> from asperity import FrictionLaw, SlidingPoint, simulate
    >>> block = SlidingPoint(1.0, FrictionLaw.isotropic(0.5))
    >>> simulate(block, dt=0.01, t_end=0.2, u0=[2.0, 0.0]).options.dt
    0.01
    """

    dt: float
    t_end: float
    start: State
    solver: Solver
    tolerance: float
    save_every: int
    until_rest: bool
    on_failure: str


class EventDriven(Record, kw_only=True):
    """Options of `integrate`, with the state that the run starts from.

    >>> from asperity import FrictionLaw, SlidingPoint, integrate
    >>> block = SlidingPoint(1.0, FrictionLaw.isotropic(0.5))
    >>> integrate(block, t_end=1.0, u0=[2.0, 0.0]).options.tolerance
    1e-10
    """

    t_end: float
    q0: Array
    u0: Array
    tolerance: float
    dt: float | None
    max_step: float | None
    section: Section | None
    max_events: int


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
        arrays: dict[str, NDArray[Any]] = {}
        return read, (self.written(arrays), arrays)

    def written(self, arrays: dict[str, NDArray[Any]]) -> str:
        """Return the origin as text, with large arrays beside it; without a system that is no data.

        Args:
            arrays: where large arrays are put, by their places.
        """
        data = encoding.encoded(self, KNOWN, place="origin", arrays=arrays)
        return json.dumps(data, ensure_ascii=False)

    def _stored(self) -> Origin:
        return self if self.unsaved is None else self.replace(system=None, note=self.unsaved)

    @property
    def unsaved(self) -> str | None:
        """Why no file can hold the system; ``None`` if one can."""
        try:
            encoding.encoded(self.system, KNOWN, place="system", arrays={})
        except ParameterError as error:
            return f"{error.argument} {error.message}"
        return None


KNOWN: encoding.Known = {
    **encoding.classes(sets, law, system, solvers),
    **{one.__name__: one for one in (Origin, TimeStepping, EventDriven, State, Section)},
}
"""Classes that the origin of a run is made of."""


def read(text: str, arrays: Mapping[str, NDArray[Any]]) -> Origin:
    """Return the origin of a text, given the arrays beside it.

    Raises:
        ParameterError: naming the place of what is wrong.
    """
    found = _decoded(text, "origin", arrays)
    if not isinstance(found, Origin):
        raise ParameterError("origin", f"must be of the type Origin, got {found!r:.60}")
    return found


def labels_written(labels: Labels) -> str:
    """Return labels as text."""
    return json.dumps(encoding.encoded(labels, KNOWN), ensure_ascii=False)


def read_labels(text: str) -> Labels:
    """Return the labels of a text.

    Raises:
        ParameterError: naming the place of what is wrong.
    """
    found = _decoded(text, "labels", {})
    if not isinstance(found, Labels):
        raise ParameterError("labels", f"must be of the type Labels, got {found!r:.60}")
    return found


def _decoded(text: str, key: str, arrays: Mapping[str, NDArray[Any]]) -> Any:
    try:
        return encoding.decoded(json.loads(text), KNOWN, place=key, arrays=arrays)
    except ParameterError:
        raise
    except (ValueError, RecursionError) as error:
        raise ParameterError(key, f"must be the text that asperity writes: {error}") from None
