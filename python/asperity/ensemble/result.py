"""What comes out of many runs."""

from __future__ import annotations

import math
from collections import Counter
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, ClassVar

import numpy as np
from numpy.typing import NDArray

from asperity._base import arrays
from asperity._base.arrays import Array
from asperity._base.result import NO_UNIT, Axis, Series, Table, TableResult, counted
from asperity._base.value import Value
from asperity.errors import DimensionError, ParameterError
from asperity.runs.run import Run
from asperity.status import Outcome, Phase
from asperity.system.labels import Labels

if TYPE_CHECKING:
    import xarray

OUTCOMES = (
    Outcome.FINISHED,
    Outcome.AT_REST,
    Outcome.SECTION,
    Outcome.FAILED,
    Outcome.INTERRUPTED,
)
"""The outcomes by their number in the core; an interrupted run has the last one."""
# Series by name: their axes after those of the runs, unit and meaning.
_MEANINGS: dict[str, tuple[tuple[str, ...], str, str]] = {
    "t": ((), "s", "time at the end"),
    "q": (("coordinate",), "", "coordinates at the end"),
    "u": (("velocity",), "", "velocities at the end"),
    "slip": (("contact", "component"), "m/s", "slip velocity at the end"),
    "force": (("contact", "component"), "N", "friction force on the body at the end"),
    "normal_force": (("contact",), "N", "normal force at the end"),
    "phase": (("contact",), NO_UNIT, "phase of the contact at the end"),
    "steps": ((), NO_UNIT, "number of steps"),
    "ambiguous": ((), NO_UNIT, "number of steps or events with several solutions"),
    "extent": (("coordinate",), "", "largest less smallest value of the coordinates"),
    "stick_share": (("contact",), NO_UNIT, "part of the time in which the contact sticks"),
    "rest_time": ((), "s", "time from which on everything rests"),
    "crossings": ((), NO_UNIT, "number of crossings of the section"),
    "crossing_time": ((), "s", "time of the last crossing"),
    "crossing_q": (("coordinate",), "", "coordinates at the last crossing"),
    "crossing_u": (("velocity",), "", "velocities at the last crossing"),
    "period": ((), "s", "time between the last two crossings"),
}
_SAMPLED = ("t", "q", "u", "slip", "force", "normal_force", "phase")
_TOLD = 3


@dataclass(frozen=True)
class MemberFailure:
    """A run of an ensemble that failed.

    Attributes:
        index: of the run, along the axes of the ensemble.
        time: up to which it came, in s.
        error: what `simulate` or `integrate` would have raised.
    """

    index: tuple[int, ...]
    time: float
    error: BaseException

    def __str__(self) -> str:
        return f"run {', '.join(map(str, self.index))} at t = {self.time:.9g} s: {self.error}"


class Ensemble(TableResult, Value):
    """The ends of many runs, and what was asked for of the way; made by `simulate_many`.

    Arrays begin with the axes of the ensemble, those to which start states and replaced values were
    broadcast; what there is not, as in runs that failed before their first step, is NaN.

    Attributes:
        status: how each run ended, `Outcome` as words.
        t: time at the end in s.
        q: coordinates there, shape ``(*shape, n)``.
        u: velocities there, shape ``(*shape, n)``.
        slip: relative velocities γ in m/s, shape ``(*shape, n_contact, p)``.
        force: friction forces λ on the body in N, shape ``(*shape, n_contact, p)``.
        normal_force: λ_N in N, shape ``(*shape, n_contact)``.
        phase: `Phase` as integers, shape ``(*shape, n_contact)``.
        steps: number of steps done.
        ambiguous: number of steps, or events, at which a contact had several solutions.
        extent: largest less smallest coordinates, shape ``(*shape, n)``.
        stick_share: parts of the time in which contacts stick, shape ``(*shape, n_contact)``.
        rest_time: time in s from which on all velocities vanish, NaN unless they do at the end.
        crossings: number of crossings of the section.
        crossing_time: of the last crossing in s.
        crossing_q: coordinates at the last crossing, shape ``(*shape, n)``.
        crossing_u: velocities at the last crossing, shape ``(*shape, n)``.
        period: time between the last two crossings in s.
        samples: samples on the way by name, of shape ``(*shape, n_t, …)``; empty unless asked for.
        failures: the runs that failed, in their order.
        values: the values that replaced parts of the system, by dotted name.
        axes: names of the axes.

    What was not asked for is ``None``.

    >>> import numpy as np
    >>> from asperity import FrictionLaw, SlidingPoint, simulate_many
    >>> block = SlidingPoint(1.0, law=FrictionLaw.isotropic(0.5), gravity=10.0)
    >>> many = simulate_many(block, dt=0.01, t_end=1.0, u0=[[1.0, 0.0], [2.0, 0.0]])
    >>> print(many.summary())
    2 runs: 2 finished. They took 200 steps.
    """

    _picture: ClassVar[str | None] = None
    _descriptive = frozenset({"labels", "again"})

    t: Array
    q: Array
    u: Array
    slip: Array
    force: Array
    normal_force: Array
    phase: NDArray[np.int8]
    steps: NDArray[np.int64]
    ambiguous: NDArray[np.int64]
    extent: Array | None
    stick_share: Array | None
    rest_time: Array | None
    crossings: NDArray[np.int64] | None
    crossing_time: Array | None
    crossing_q: Array | None
    crossing_u: Array | None
    period: Array | None
    shape: tuple[int, ...]
    samples: Mapping[str, NDArray[Any]]
    failures: tuple[MemberFailure, ...]
    values: Mapping[str, NDArray[Any]]
    axes: tuple[str, ...]
    labels: Labels

    def __init__(
        self,
        series: Mapping[str, NDArray[Any]],
        outcomes: NDArray[np.int8],
        *,
        samples: Mapping[str, NDArray[Any]],
        failures: Sequence[MemberFailure],
        values: Mapping[str, NDArray[Any]],
        axes: Sequence[str],
        labels: Labels,
        again: Any = None,
    ) -> None:
        series = {name: arrays.read_only(array) for name, array in series.items()}
        self._set(
            series=series,
            outcomes=arrays.read_only(outcomes),
            samples={name: arrays.read_only(array) for name, array in samples.items()},
            failures=tuple(failures),
            values={name: arrays.read_only(array) for name, array in values.items()},
            axes=tuple(axes),
            labels=labels,
            again=again,
        )
        self._keep(shape=outcomes.shape, **{name: series.get(name) for name in _MEANINGS})

    @property
    def status(self) -> NDArray[np.str_]:
        """How each run ended, as the words of `Outcome`."""
        words = np.array([str(outcome) for outcome in OUTCOMES])
        numbers: NDArray[np.int8] = self._parameters["outcomes"]
        return words[numbers]

    @property
    def failed(self) -> tuple[NDArray[np.intp], ...]:
        """The indices of the runs that failed, an array per axis, as those of `numpy.nonzero`."""
        indices = np.array([failure.index for failure in self.failures], dtype=np.intp)
        return tuple(indices.reshape(-1, len(self.shape)).T)

    def __len__(self) -> int:
        """Return the number of runs."""
        return math.prod(self.shape)

    def repeat(self, index: int | tuple[int, ...]) -> Run:
        """Make one of the runs again, alone and with all its samples.

        Args:
            index: of the run, along the axes of the ensemble.

        Raises:
            ParameterError: if there is no such run, or if the ensemble does not know what made it.

        >>> from asperity import FrictionLaw, SlidingPoint, simulate_many
        >>> block = SlidingPoint(1.0, law=FrictionLaw.isotropic(0.5), gravity=10.0)
        >>> many = simulate_many(block, dt=0.01, t_end=1.0, replace={"mass": [1.0, 2.0]})
        >>> len(many.repeat(1))
        101
        """
        again = self._parameters["again"]
        if again is None:
            raise ParameterError("index", "cannot be run again: what made it is not known")
        run: Run = again.repeat(self._number(index))
        return run

    def system(self, index: int | tuple[int, ...]) -> Any:
        """Return the system of one of the runs.

        Args:
            index: of the run, along the axes of the ensemble.
        """
        again = self._parameters["again"]
        if again is None:
            raise ParameterError("index", "has no system: what made the runs is not known")
        return again.system(self._number(index))

    def _number(self, index: int | tuple[int, ...]) -> int:
        given = index if isinstance(index, tuple) else (index,)
        places = tuple(arrays.count(one, "index", least=0) for one in given)
        if len(places) != len(self.shape):
            raise DimensionError("index", f"must have an entry per axis {self.axes}, got {index!r}")
        if any(place >= length for place, length in zip(places, self.shape, strict=True)):
            raise ParameterError("index", f"must lie within {self.shape}, got {index!r}")
        return int(np.ravel_multi_index(places, self.shape)) if places else 0

    def __repr__(self) -> str:
        sizes = ", ".join(f"{name} {n}" for name, n in zip(self.axes, self.shape, strict=True))
        return f"<Ensemble: {counted(len(self), 'run')} ({sizes}), {self._ends()}>"

    def _ends(self) -> str:
        words = Counter(self.status.ravel().tolist())
        listed = [f"{words[outcome]} {outcome.replace('_', ' ')}" for outcome in OUTCOMES
                  if words[outcome]]  # fmt: skip
        return ", ".join(listed) or "none"

    def summary(self) -> str:
        """Return how the runs ended, in sentences."""
        lines = [
            f"{counted(len(self), 'run')}: {self._ends()}. "
            f"They took {counted(int(self.steps.sum()), 'step')}."
        ]
        lines += [f"Failed: {failure}." for failure in self.failures[:_TOLD]]
        if len(self.failures) > _TOLD:
            lines.append(f"`failures` has the other {len(self.failures) - _TOLD}.")
        return "\n".join(lines)

    def _table(self) -> Table:
        """Return a row per run; the values that were replaced are columns."""
        count = len(self)
        names = self.labels
        p = self.slip.shape[-1]
        axes = {
            "run": Axis(np.arange(count), "", "number of the run"),
            "coordinate": Axis(names.coordinates, "", "coordinate", names.coordinate_units),
            "velocity": Axis(names.velocities, "", "velocity", names.velocity_units),
            "contact": Axis(names.contacts, "", "contact"),
            "component": Axis([str(k + 1) for k in range(p)], "", "component along the law's axes"),
        }
        series = {
            name: Series(values.reshape(count), ("run",), description=f"value of {name}")
            for name, values in self._wide_values().items()
        }
        codes = self._parameters["outcomes"].reshape(count)
        words = {number: str(outcome) for number, outcome in enumerate(OUTCOMES)}
        series["status"] = Series(codes, ("run",), NO_UNIT, "how the run ended", words)
        for name, (inner, unit, words_for) in _MEANINGS.items():
            values = getattr(self, name)
            if values is not None:
                phases = {int(p): p.name.lower() for p in Phase} if name == "phase" else {}
                flat = values.reshape(count, *values.shape[len(self.shape) :])
                series[name] = Series(
                    flat, ("run", *inner), unit, words_for, phases, bare=name in ("q", "u")
                )
        facts: dict[str, str | int | float] = {
            "title": repr(self)[1:-1],
            "runs": count,
            "failed": len(self.failures),
        }
        return Table(axes, series, facts)

    def _wide_values(self) -> dict[str, NDArray[Any]]:
        """Return the numbers that were replaced, one per run."""
        return {
            name: np.broadcast_to(values, self.shape)
            for name, values in self.values.items()
            if values.dtype != object and values.ndim <= len(self.shape)
        }

    def to_xarray(self) -> xarray.Dataset:
        """Return the arrays with the axes of the ensemble, and the values along them.

        A value that varies along one axis is a coordinate of that axis.

        Raises:
            ImportError: without xarray, which ``pip install "asperity[xarray]"`` installs.
        """
        flat = super().to_xarray()
        variables: dict[str, Any] = {}
        for name, variable in flat.data_vars.items():
            inner = variable.dims[1:]
            values = variable.values.reshape(*self.shape, *variable.shape[1:])
            variables[str(name)] = ((*self.axes, *inner), values, variable.attrs)
        for name, values in self.samples.items():
            inner = ("sample", *_MEANINGS[name][0])
            variables[f"sampled_{name}"] = ((*self.axes, *inner), values, {})
        coordinates: dict[str, Any] = {
            str(name): (one.dims, one.values, one.attrs)
            for name, one in flat.coords.items()
            if name != "run"
        }
        for name, values in self.values.items():
            if name in variables:
                varying = [k for k, n in enumerate(_padded(values.shape, len(self.shape))) if n > 1]
                if len(varying) == 1:
                    coordinates[name] = ((self.axes[varying[0]],), values.ravel())
                    del variables[name]
        return flat.__class__(variables, coordinates, flat.attrs)


def _padded(shape: tuple[int, ...], count: int) -> tuple[int, ...]:
    return (*(1,) * (count - len(shape)), *shape)
