"""The runs of an ensemble: systems and start states, broadcast against each other."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

import asperity._core as _core
from asperity._base import arrays
from asperity._base.arrays import Array
from asperity._base.value import keep_views
from asperity.ensemble.ends import OUTCOMES, Ensemble
from asperity.ensemble.result import MemberFailure
from asperity.ensemble.variants import Variants
from asperity.errors import DimensionError, ParameterError
from asperity.runs.model import Model, labels_of, laws_of
from asperity.runs.state import State
from asperity.runs.time_stepping import beginning
from asperity.status import Outcome, Phase
from asperity.system import RigidBodies
from asperity.system.custom import System

# So many runs, with the systems that Python makes for them, are prepared before they are run.
_CHUNK = 256
# Of so many runs that fail with what the core says Python makes the system again, for its words.
_REWORDED = 1000
_FAILED, _INTERRUPTED = OUTCOMES.index(Outcome.FAILED), OUTCOMES.index(Outcome.INTERRUPTED)


@dataclass(frozen=True)
class Part:
    """Runs that the core makes in one call.

    Attributes:
        members: their numbers; None of all.
        runs: what the core takes.
    """

    members: NDArray[np.int64] | None
    runs: tuple[Any, ...]


class Members:
    """The runs of an ensemble, in the order of its axes.

    Args:
        variants: the systems.
        q0: initial coordinates ``(..., n)``, or None for those of the systems.
        u0: initial velocities ``(..., n)``, or None for those of the systems.
        axes: names of the axes, or None.
    """

    def __init__(
        self,
        variants: Variants,
        q0: ArrayLike | None,
        u0: ArrayLike | None,
        axes: Any,
    ) -> None:
        self.variants = variants
        system = variants.first
        # Whether the state that a system starts from by itself is known without what is given.
        has_own = not isinstance(system, System) or system.coordinates is None or q0 is None
        own = beginning(system, None, None, None) if has_own else None
        sizes = (None, None) if own is None else (len(own.q), len(own.u))
        self.q0 = _states(q0, "q0", sizes[0])
        self.u0 = _states(u0, "u0", sizes[1] or variants.first.dof)
        shapes = {"replace" if variants.values else "systems": variants.shape}
        shapes |= {
            name: s.shape[:-1] for name, s in (("q0", self.q0), ("u0", self.u0)) if s is not None
        }
        self.shape: tuple[int, ...] = ()
        for name, shape in shapes.items():
            if 0 in shape:
                raise DimensionError(name, f"must give a run at least, gives the shape {shape}")
            try:
                self.shape = np.broadcast_shapes(self.shape, shape)
            except ValueError:
                listed = ", ".join(f"{name} {shape}" for name, shape in shapes.items())
                raise DimensionError(name, f"must broadcast with the others: {listed}") from None
        self.count = math.prod(self.shape)
        self.axes = _axes(axes, len(self.shape))

    def __len__(self) -> int:
        return self.count

    @property
    def sizes(self) -> dict[str, int]:
        """Numbers of coordinates, velocities, contacts and components of their laws."""
        first = self.variants.first
        state = _state(first, self.q0, self.u0)
        dimensions = [law.dimension for law in laws_of(first)]
        return {
            "coordinate": len(state.q),
            "velocity": len(state.u),
            "contact": len(dimensions),
            "component": max(dimensions, default=0),
        }

    def nothing(self) -> dict[str, NDArray[Any]]:
        """Return the series of runs none of which was begun."""
        sizes = self.sizes
        series: dict[str, NDArray[Any]] = {
            name: np.full((self.count, *(sizes[a] for a in Ensemble._meanings[name].axes)), np.nan)
            for name in ("t", "q", "u", "slip", "force", "normal_force")
        }
        series["phase"] = np.full((self.count, sizes["contact"]), int(Phase.NONE), dtype=np.int8)
        counts = ("steps", "ambiguous")
        return {**series, **{name: np.zeros(self.count, dtype=np.int64) for name in counts}}

    def system(self, member: int) -> Model:
        """Return the system of a run."""
        shape = self.variants.shape
        # The last axes are those of the systems; of an axis with one system all runs have that.
        places = self.index(member)[len(self.shape) - len(shape) :]
        own = tuple(k if n > 1 else 0 for k, n in zip(places, shape, strict=True))
        return self.variants.system(int(np.ravel_multi_index(own, shape)) if own else 0)

    @property
    def _variants(self) -> NDArray[np.int64]:
        numbers = np.arange(self.variants.count).reshape(self.variants.shape)
        return np.broadcast_to(numbers, self.shape).reshape(-1).astype(np.int64)

    def index(self, member: int) -> tuple[int, ...]:
        """Return the index of a run along the axes."""
        return tuple(int(k) for k in np.unravel_index(member, self.shape)) if self.shape else ()

    def start(self, member: int) -> dict[str, Array]:
        """Return the start of a run as arguments of `simulate` and `integrate`."""
        index = self.index(member)
        given = {"q0": self.q0, "u0": self.u0}
        return {
            name: np.broadcast_to(states, (*self.shape, states.shape[-1]))[index]
            for name, states in given.items()
            if states is not None
        }

    def parts(
        self, check: Callable[[Model], None]
    ) -> Iterator[Part | tuple[NDArray[np.int64], Exception]]:
        """Yield runs for the core, and those whose system cannot be made with what it raises.

        Args:
            check: raises what is wrong with a system beside what its constructor finds.
        """
        made = self.variants.of_the_core()
        listed = self.variants.listed
        first = self.variants.first
        by_themselves = any(isinstance(system, RigidBodies) for system in listed) and (
            self.q0 is not None or self.variants.count > 1
        )
        calls_python = any(_core.calls_python(system._core) for system in listed)
        if calls_python or by_themselves or (made is None and self.variants.values):
            yield from self._pieces(check, 1 if calls_python else _CHUNK)
            return
        for system in listed:
            check(system)
        state = _state(first, self.q0, self.u0)
        rows = (
            self._rows(own if given is None else given)
            for given, own in ((self.q0, state.q), (self.u0, state.u))
        )
        numbers = self._variants if self.variants.count > 1 else None
        systems = [system._core for system in listed]
        yield Part(None, (systems, made, numbers, *rows, self.count))

    def _rows(self, states: Array) -> Array:
        """Return a row per run, or one for all."""
        if states[..., 0].size <= 1:
            return np.ascontiguousarray(states.reshape(1, -1))
        wide = np.broadcast_to(states, (*self.shape, states.shape[-1]))
        return np.ascontiguousarray(wide).reshape(self.count, -1)

    def _pieces(
        self, check: Callable[[Model], None], chunk: int
    ) -> Iterator[Part | tuple[NDArray[np.int64], Exception]]:
        """Yield chunks of runs whose systems Python makes, or that call Python."""
        numbers = self._variants
        order = np.argsort(numbers, kind="stable")
        bounds = np.searchsorted(numbers[order], np.arange(self.variants.count + 1))
        members: list[NDArray[np.int64]] = []
        systems: list[Model] = []
        for variant in range(self.variants.count):
            own = order[bounds[variant] : bounds[variant + 1]]
            try:
                system = self.variants.system(variant)
                check(system)
            except Exception as error:
                yield own, error
                continue
            for begin in range(0, len(own), chunk):
                members.append(own[begin : begin + chunk])
                systems.append(system)
                if sum(map(len, members)) >= chunk:
                    yield from self._chunk(systems, members)
                    members, systems = [], []
        if systems:
            yield from self._chunk(systems, members)

    def _chunk(
        self, systems: list[Model], members: list[NDArray[np.int64]]
    ) -> Iterator[Part | tuple[NDArray[np.int64], Exception]]:
        numbers, runs, q, u = [], [], [], []
        for number, (system, own) in enumerate(zip(systems, members, strict=True)):
            for member in own:
                own_start = self.start(int(member))
                try:
                    state = beginning(system, own_start.get("q0"), own_start.get("u0"), None)
                except Exception as error:
                    yield np.array([member]), error
                    continue
                numbers.append(number)
                runs.append(member)
                q.append(state.q)
                u.append(state.u)
        if runs:
            arguments = (
                [s._core for s in systems],
                None,
                np.array(numbers, dtype=np.int64),
                np.array(q),
                np.array(u),
            )
            yield Part(np.array(runs, dtype=np.int64), (*arguments, len(runs)))


def _state(system: Model, q0: Array | None, u0: Array | None) -> State:
    """Return the state of the first run, or that of all."""

    def first(states: Array | None) -> Array | None:
        return None if states is None else states.reshape(-1, states.shape[-1])[0]

    return beginning(system, first(q0), first(u0), None)


def _states(given: ArrayLike | None, argument: str, size: int | None) -> Array | None:
    if given is None:
        return None
    states = arrays.array(given, argument)
    if states.ndim == 0 or (size is not None and states.shape[-1] != size):
        wanted = "n" if size is None else size
        raise DimensionError(argument, f"must have shape (..., {wanted}), got {states.shape}")
    return states


def _axes(given: Any, count: int) -> tuple[str, ...]:
    if given is None:
        return ("run",) if count == 1 else tuple(f"axis_{k}" for k in range(count))
    axes = (given,) if isinstance(given, str) else arrays.several(given, "axes")
    fits = len(axes) == count and len({*axes, *_TAKEN}) == count + len(_TAKEN)
    if not fits or not all(isinstance(name, str) and name for name in axes):
        raise ParameterError(
            "axes",
            f"must be a name for each of the {count} axes, all different and none of a result, "
            f"got {given!r}",
        )
    return axes


_TAKEN = (
    *("coordinate", "velocity", "contact", "component", "sample", "status", "run", "search"),
    *(name for name in Ensemble._meanings),
)


@dataclass(frozen=True)
class Again:
    """Makes runs of an ensemble again, alone.

    Attributes:
        members: the runs.
        engine: `simulate`, `integrate` or `limit_cycle`.
        options: of the runs.
    """

    members: Members
    engine: Callable[..., Any]
    options: Mapping[str, Any]

    def __post_init__(self) -> None:
        keep_views(self)

    def system(self, member: int) -> Model:
        """Return the system of a run."""
        return self.members.system(member)

    def repeat(self, member: int, **more: Any) -> Any:
        """Make a run again."""
        start = self.members.start(member)
        return self.engine(self.system(member), **start, **self.options, **more)


class Collection:
    """Results of parts of the runs, put where they belong."""

    def __init__(self, count: int) -> None:
        self._count = count
        self._series: dict[str, NDArray[Any]] = {}
        self._samples: dict[str, NDArray[Any]] = {}
        self.outcomes = np.full(count, _INTERRUPTED, dtype=np.int8)
        self.failures: list[tuple[int, float, dict[str, Any]]] = []

    def add(self, part: Part, found: dict[str, Any]) -> None:
        """Add what the core has found."""
        members = np.arange(self._count) if part.members is None else part.members
        ending, failures = found.pop("ending"), found.pop("failures")
        # The core says −1 of runs that were interrupted.
        self.outcomes[members] = np.where(ending < 0, _INTERRUPTED, ending)
        for name, rows in found.pop("samples", {}).items():
            by_run = rows.reshape(len(members), -1, *rows.shape[1:])
            self._put(self._samples, name, part.members, by_run)
        for name, rows in found.items():
            self._put(self._series, name, part.members, rows)
        for failure in failures:
            self.failures.append((int(members[failure["member"]]), failure["time"], failure))

    def _put(
        self,
        into: dict[str, NDArray[Any]],
        name: str,
        members: NDArray[np.int64] | None,
        rows: NDArray[Any],
    ) -> None:
        if members is None:
            into[name] = rows
            return
        if name not in into:
            empty = np.nan if rows.dtype.kind == "f" else int(Phase.NONE) if name == "phase" else 0
            into[name] = np.full((self._count, *rows.shape[1:]), empty, dtype=rows.dtype)
        into[name][members] = rows

    def refuse(self, members: NDArray[np.int64], error: Exception) -> None:
        """Add runs that could not begin."""
        self.outcomes[members] = _FAILED
        for member in members.tolist():
            self.failures.append((member, 0.0, {"error": error}))

    def ensemble(
        self,
        members: Members,
        errors: Callable[[dict[str, Any], Model], BaseException],
        again: Again,
        names: frozenset[str],
    ) -> Ensemble:
        """Return the results of all runs.

        Args:
            members: the runs.
            errors: returns what a failure would have raised, given the system of the run.
            again: makes a run again.
            names: of the quantities that were asked for.
        """
        self.failures.sort(key=lambda failure: failure[0])
        if not self._series:
            self._series = members.nothing()
        for name in names - self._series.keys():
            inner = Ensemble._meanings[name].axes
            sizes = (members.sizes[axis] for axis in inner)
            self._series[name] = np.full((self._count, *sizes), np.nan)
        shape = members.shape
        failures = [
            MemberFailure(
                members.index(member),
                time,
                _error(found, members, member, errors, reworded=number < _REWORDED),
            )
            for number, (member, time, found) in enumerate(self.failures)
        ]
        return Ensemble(
            {name: rows.reshape((*shape, *rows.shape[1:])) for name, rows in self._series.items()},
            self.outcomes.reshape(shape),
            others={
                "samples": {
                    name: arrays.read_only(rows.reshape((*shape, *rows.shape[1:])))
                    for name, rows in self._samples.items()
                }
            },
            failures=failures,
            values=members.variants.values,
            inner={name: members.variants.inner_axes(name) for name in members.variants.values},
            axes=members.axes,
            labels=labels_of(members.variants.first),
            again=again,
        )


def _error(
    found: dict[str, Any],
    members: Members,
    member: int,
    errors: Callable[[dict[str, Any], Model], BaseException],
    *,
    reworded: bool,
) -> BaseException:
    """Return what a run alone would have raised."""
    if found["error"] is not None and not reworded:
        error: BaseException = found["error"]
        return error
    try:
        system = members.system(member)
    except Exception as raised:
        # The core has refused the same numbers in words of its own.
        return raised
    return found["error"] or errors(found, system)
