"""What many computations of one kind have in common: their axes, how each ended, tables."""

from __future__ import annotations

import math
from collections import Counter
from collections.abc import Iterator, Mapping, Sequence
from typing import TYPE_CHECKING, Annotated, Any, ClassVar, NamedTuple

import numpy as np
from numpy.typing import NDArray

from asperity._base import arrays
from asperity._base.result import NO_UNIT, Axis, Series, Table, TableResult, counted
from asperity._base.value import Number, Record, Value
from asperity.errors import DimensionError, ParameterError
from asperity.status import Phase
from asperity.system.labels import Labels

if TYPE_CHECKING:
    import xarray

_TOLD = 3


class Meaning(NamedTuple):
    """What a series of an ensemble is.

    Attributes:
        axes: after those of the ensemble.
        unit: empty where an axis holds the units.
        description: in a few words.
    """

    axes: tuple[str, ...]
    unit: str
    description: str


def _index(value: Any, argument: str) -> tuple[int, ...]:
    return tuple(arrays.count(one, argument, least=0) for one in arrays.several(value, argument))


class MemberFailure(Record):
    """A run of an ensemble that failed.

    Attributes:
        index: of the run, along the axes of the ensemble.
        time: up to which it came, in s; None of a search for a cycle.
        error: what `simulate`, `integrate` or `limit_cycle` would have raised.
    """

    _descriptive = frozenset({"error"})

    index: Annotated[tuple[int, ...], _index]
    time: Number | None
    error: BaseException

    def __str__(self) -> str:
        when = "" if self.time is None else f" at t = {self.time:.9g} s"
        return f"{', '.join(map(str, self.index))}{when}: {self.error}"


class AnyEnsemble(TableResult, Value):
    """Results of many computations of one kind; base of `Ensemble` and `CycleEnsemble`."""

    _meanings: ClassVar[Mapping[str, Meaning]]
    _endings: ClassVar[tuple[str, ...]]
    """The words for how a computation ends, by number."""
    _noun: ClassVar[str]
    _plural: ClassVar[str]
    _descriptive = frozenset({"labels", "again"})
    _is_result = True

    shape: tuple[int, ...]
    failures: tuple[MemberFailure, ...]
    values: Mapping[str, NDArray[Any]]
    axes: tuple[str, ...]
    labels: Labels

    def __init__(
        self,
        series: Mapping[str, NDArray[Any]],
        endings: NDArray[np.int8],
        *,
        others: Mapping[str, Any],
        failures: Sequence[MemberFailure],
        values: Mapping[str, NDArray[Any]],
        inner: Mapping[str, int],
        axes: Sequence[str],
        labels: Labels,
        again: Any = None,
    ) -> None:
        numbers = np.asarray(endings)
        known = (
            numbers.dtype.kind in "iu" and ((numbers >= 0) & (numbers < len(self._endings))).all()
        )
        if not known or np.ma.is_masked(endings):
            raise ParameterError("endings", f"must be numbers of {', '.join(self._endings)}")
        series = {name: arrays.read_only(array) for name, array in series.items()}
        for name, array in series.items():
            if array.shape[: numbers.ndim] != numbers.shape:
                raise DimensionError(
                    name, f"must have the axes {numbers.shape} first, has the shape {array.shape}"
                )
        self._set(
            series=series,
            endings=arrays.read_only(numbers.astype(np.int8)),
            others=dict(others),
            failures=tuple(failures),
            values={name: arrays.read_only(array) for name, array in values.items()},
            inner=dict(inner),
            axes=tuple(axes),
            labels=labels,
            again=again,
        )
        self._keep(shape=numbers.shape, **others)
        self._keep(**{name: series.get(name) for name in self._meanings})

    @property
    def status(self) -> NDArray[np.str_]:
        """How each ended, in words."""
        endings: NDArray[np.int8] = self._parameters["endings"]
        return np.asarray(np.array(self._endings)[endings])

    @property
    def failed(self) -> tuple[NDArray[np.intp], ...]:
        """The indices of those that failed, an array per axis, as those of `numpy.nonzero`."""
        indices = np.array([failure.index for failure in self.failures], dtype=np.intp)
        return tuple(indices.reshape(-1, len(self.shape)).T)

    def __len__(self) -> int:
        """Return how many there are."""
        return math.prod(self.shape)

    def system(self, index: int | tuple[int, ...]) -> Any:
        """Return the system of one of them.

        Args:
            index: along the axes of the ensemble.
        """
        return self._parameters["again"].system(self._number(index))

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
        count = counted(len(self), self._noun, self._plural)
        return f"<{type(self).__name__}: {count} ({sizes}), {self._ends()}>"

    def _ends(self) -> str:
        """Return how many ended in which way, in words."""
        numbers = Counter(self.status.ravel().tolist())
        ends = [f"{numbers[end]} {end.replace('_', ' ')}" for end in self._endings if numbers[end]]
        return ", ".join(ends)

    def summary(self) -> str:
        """Return how they ended, in sentences."""
        lines = [" ".join(self._sentences())]
        lines += [f"Failed: {self._noun} {failure}." for failure in self.failures[:_TOLD]]
        if len(self.failures) > _TOLD:
            lines.append(f"`failures` has the other {len(self.failures) - _TOLD}.")
        return "\n".join(lines)

    def _sentences(self) -> Iterator[str]:
        yield f"{counted(len(self), self._noun, self._plural)}: {self._ends()}."

    def _table(self) -> Table:
        """Return a row for each; the values that were replaced are columns."""
        count, names = len(self), self.labels
        axes = {
            self._noun: Axis(np.arange(count), "", f"number of the {self._noun}"),
            "coordinate": Axis(names.coordinates, "", "coordinate", names.coordinate_units),
            "velocity": Axis(names.velocities, "", "velocity", names.velocity_units),
            "contact": Axis(names.contacts, "", "contact"),
        }
        rows = (self._noun,)
        series = {
            name: Series(values.reshape(count), rows, description=f"value of {name}")
            for name, values in self._wide_values().items()
        }
        series["status"] = Series(
            self._parameters["endings"].reshape(count),
            rows,
            NO_UNIT,
            f"how the {self._noun} ended",
            dict(enumerate(self._endings)),
        )
        for name, (inner, unit, description) in self._meanings.items():
            values = getattr(self, name)
            if values is None:
                continue
            phases = {int(p): p.name.lower() for p in Phase} if name == "phase" else {}
            flat = values.reshape((count, *values.shape[len(self.shape) :]))
            if "component" in inner:
                numbers = [str(k + 1) for k in range(flat.shape[-1])]
                axes["component"] = Axis(numbers, "", "component along the axes of the law")
            series[name] = Series(
                flat, (*rows, *inner), unit, description, phases, bare=name in ("q", "u")
            )
        facts: dict[str, str | int | float] = {
            "title": repr(self)[1:-1],
            self._plural: count,
            "failed": len(self.failures),
        }
        return Table(axes, series, facts)

    def _wide_values(self) -> dict[str, NDArray[Any]]:
        """Return the numbers that were replaced, one for each."""
        inner = self._parameters["inner"]
        return {
            name: np.broadcast_to(values, self.shape)
            for name, values in self.values.items()
            if values.dtype != object and not inner[name]
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
            values = variable.values.reshape((*self.shape, *variable.shape[1:]))
            variables[str(name)] = ((*self.axes, *inner), values, variable.attrs)
        variables |= self._more_variables()
        coordinates: dict[str, Any] = {
            str(name): (one.dims, one.values, one.attrs)
            for name, one in flat.coords.items()
            if name != self._noun
        }
        for name, values in self.values.items():
            if name in variables:
                ahead = len(self.shape) - values.ndim
                varying = [k for k, n in enumerate(values.shape, ahead) if n > 1]
                if len(varying) == 1:
                    coordinates[name] = ((self.axes[varying[0]],), values.ravel())
                    del variables[name]
        return flat.__class__(variables, coordinates, flat.attrs)

    def _more_variables(self) -> dict[str, Any]:
        """Return what xarray can hold and a table cannot."""
        return {}
