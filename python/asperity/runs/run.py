"""What time stepping and event-driven integration have in common: series over time."""

from __future__ import annotations

import os
import warnings
from collections.abc import Iterator
from typing import TYPE_CHECKING, Annotated, Any, ClassVar, TypeAlias

import numpy as np
from numpy.typing import ArrayLike, NDArray

from asperity._base import arrays
from asperity._base.arrays import Array
from asperity._base.result import Axis, Series, Table, counted
from asperity._base.storage.data import Kinds
from asperity._base.storage.result_file import SavedResult
from asperity._base.value import AnyArray, Given, Record, field, unchecked
from asperity.errors import DimensionError, ParameterError
from asperity.runs.event import Event
from asperity.runs.model import Model
from asperity.runs.origin import KNOWN, EventDriven, Origin, TimeStepping
from asperity.runs.state import State
from asperity.status import Outcome, Phase
from asperity.system.labels import Labels, numbered

AnyPhases: TypeAlias = Annotated[Given[ArrayLike, NDArray[np.int8]], unchecked]
AnyLabels: TypeAlias = Annotated[Given[Labels | None, Labels], unchecked]
"""Names and units, by default numbers."""

# Axes, unit and meaning of the series; coordinates and velocities have units of their own.
_MEANINGS: dict[str, tuple[tuple[str, ...], str, str]] = {
    "t": (("t",), "s", "time"),
    "q": (("t", "coordinate"), "", "coordinates"),
    "u": (("t", "velocity"), "", "velocities"),
    "slip": (("t", "contact", "component"), "m/s", "slip velocity"),
    "force": (("t", "contact", "component"), "N", "friction force on the body"),
    "normal_force": (("t", "contact"), "N", "normal force"),
    "phase": (("t", "contact"), "-", "phase of the contact"),
    "iterations": (("t",), "-", "iterations of the contact solver"),
    "residual": (("t",), "-", "natural-map residual of the contact problem"),
}
_ENDS = {
    Outcome.FINISHED: "The run went on to its end",
    Outcome.AT_REST: "Everything came to rest, and the run ended",
    Outcome.SECTION: "The motion came to the section, and the run ended",
    Outcome.INTERRUPTED: "The run was interrupted",
    Outcome.FAILED: "The run failed",
}
# Most contacts in a summary; a table has them all.
_TOLD = 8


class Run(SavedResult, Record):
    """States, forces and phases over time; base of `Trajectory` and `Motion`.

    Two runs are equal if all their numbers are: names, and what made them, are not compared.
    """

    t: AnyArray = field(init=False)
    q: AnyArray = field(init=False)
    u: AnyArray = field(init=False)
    slip: AnyArray = field(init=False)
    force: AnyArray = field(init=False)
    normal_force: AnyArray = field(init=False)
    phase: AnyPhases = field(init=False)
    status: Outcome = field(init=False)
    steps: int = field(init=False)
    labels: Labels = field(init=False)
    origin: Origin | None = field(init=False)

    if TYPE_CHECKING:

        @property
        def end(self) -> State | None:
            """The state from which another run goes on."""

    _picture = "plot_history"
    _descriptive = frozenset({"labels", "origin"})
    _is_result = True
    _series: ClassVar[dict[str, type[np.generic]]] = {
        **dict.fromkeys(("t", "q", "u", "slip", "force", "normal_force"), np.float64),
        "phase": np.int8,
    }

    def _complete(self, given: dict[str, Any]) -> None:
        series = {
            name: arrays.read_only(_cast(given[name], name, kind))
            for name, kind in self._series.items()
        }
        lengths: dict[str, int] = {}
        for name, values in series.items():
            axes = _MEANINGS[name][0]
            wanted = values.ndim == len(axes) and tuple(
                lengths.setdefault(axis, length)
                for axis, length in zip(axes, values.shape, strict=True)
            )
            if wanted != values.shape:
                raise DimensionError(
                    name, f"must have an axis for {', '.join(axes)} like the others, has shape "
                    f"{values.shape}"
                )  # fmt: skip
        given.update(series)
        counts = series["q"].shape[1], series["u"].shape[1], series["phase"].shape[1]
        if given["labels"] is None:
            given["labels"] = numbered(*counts)
        labels = given["labels"]
        arrays.of_kind(labels, "labels", Labels, "Labels or None")
        found = len(labels.coordinates), len(labels.velocities), len(labels.contacts)
        if found != counts:
            raise DimensionError(
                "labels", f"must name {counts} coordinates, velocities and contacts, names {found}"
            )
        arrays.of_kind(given["origin"], "origin", Origin | None, "an Origin or None")

    @property
    def coordinate_names(self) -> tuple[str, ...]:
        """Names of the coordinates, such as ``"body 0 x"``."""
        return self.labels.coordinates

    @property
    def coordinate_units(self) -> tuple[str, ...]:
        """Their units; ``"SI"`` of those that may be lengths or angles."""
        return self.labels.coordinate_units

    @property
    def velocity_names(self) -> tuple[str, ...]:
        """Names of the velocities, such as ``"body 0 vx"``."""
        return self.labels.velocities

    @property
    def velocity_units(self) -> tuple[str, ...]:
        """Their units."""
        return self.labels.velocity_units

    @property
    def contact_names(self) -> tuple[str, ...]:
        """Names of the contacts, such as ``"body 0 on plane corner 3"``."""
        return self.labels.contacts

    @property
    def system(self) -> Model | None:
        """The system with its laws; ``None`` if it is not known, see `repeat`."""
        return None if self.origin is None else self.origin.system

    @property
    def options(self) -> TimeStepping | EventDriven | None:
        """The options that the run was made with; ``None`` if they are not known."""
        return None if self.origin is None else self.origin.options

    def _again(self, system: Model | None) -> tuple[Model, dict[str, Any]]:
        """Return the system and the options that make the run again."""
        if self.origin is None:
            raise ParameterError("run", "has no origin: it was put together by hand")
        system = self.system if system is None else system
        if system is None:
            raise ParameterError(
                "system", f"must be given, it is not in the file: {self.origin.note}"
            )
        return system, dict(self.origin.options._parameters)

    def __len__(self) -> int:
        return len(self.t)

    def __repr__(self) -> str:
        until = f" to t = {self.t[-1]:.9g} s" if len(self) > 0 else ""
        return (
            f"<{type(self).__name__}: {self._extent()}{until}, "
            f"{counted(self.q.shape[1], 'coordinate')}, "
            f"{counted(self.phase.shape[1], 'contact')}, {self.status}>"
        )

    def _extent(self) -> str:
        return counted(len(self), "sample")

    def summary(self) -> str:
        """Return sentences on how the run ended and what its contacts did."""
        return "\n".join(self._sentences())

    def _sentences(self) -> Iterator[str]:
        if len(self):
            # The last sample of a slice is not the end of the run.
            yield f"{_ENDS[self.status]}. It has {self._extent()}, up to t = {self.t[-1]:.9g} s."
        else:
            yield f"{_ENDS[self.status]} before the first sample. It has {self._extent()}."
        shares = self._shares()
        for name, contact in list(zip(self.contact_names, shares, strict=True))[:_TOLD]:
            words = zip(("was open", "stuck", "slipped"), contact, strict=True)
            told = " and ".join(f"{verb} {share:.1%}" for verb, share in words if share > 0.0)
            yield f"{name} {told} of the time." if told else f"{name} was in no step."
        if len(shares) > _TOLD:
            yield f"A table has the other {counted(len(shares) - _TOLD, 'contact')}."
        if self.origin is not None and self.origin.note:
            yield f"The system is not known: {self.origin.note}."

    def _shares(self) -> Array:
        """Return the shares of the time in which each contact is open, sticks and slips."""
        raise NotImplementedError

    def _between(self, t0: float, t1: float) -> dict[str, NDArray[Any]]:
        """Return the parts of the series with t0 ≤ t ≤ t1."""
        kept = (self.t >= arrays.number(t0, "t0")) & (self.t <= arrays.number(t1, "t1"))
        if not kept.any():
            raise ParameterError("t0", f"leaves no sample between {t0!r} and {t1!r} s")
        return {name: getattr(self, name)[kept] for name in self._series}

    def _table(self) -> Table:
        names = self.labels
        axes = {
            "t": Axis(self.t, "s", "time"),
            "coordinate": Axis(names.coordinates, "", "coordinate", names.coordinate_units),
            "velocity": Axis(names.velocities, "", "velocity", names.velocity_units),
            "contact": Axis(names.contacts, "", "contact"),
            "component": Axis(
                [str(axis + 1) for axis in range(self.slip.shape[2])],
                "",
                "component along the axes of the law",
            ),
        }
        series = {
            name: Series(
                getattr(self, name),
                *_MEANINGS[name],
                names={int(p): p.name.lower() for p in Phase} if name == "phase" else {},
                bare=name in ("q", "u"),
            )
            for name in self._series
            if name != "t"
        }
        return Table(axes, series, self._facts())

    def _drawing(self) -> dict[str, object]:
        """Return the first parts of what has many: a picture of thousands shows nothing."""
        parts = {"coordinates": self.u.shape[1], "contacts": self.phase.shape[1]}
        return {name: range(_TOLD) for name, count in parts.items() if count > _TOLD}

    def _facts(self) -> dict[str, str | int | float]:
        """Return what is said of the whole run."""
        return {"title": repr(self)[1:-1], "status": str(self.status), "steps": self.steps}

    def save(self, path: str | os.PathLike[str]) -> None:
        """Write a NumPy ``.npz`` file without pickled objects, under exactly this name.

        It holds the arrays by their names, names and units, and the system, laws, solver and
        options with which `repeat` makes the run again. Python functions and systems of classes of
        the user cannot be saved: the file is then without its system, which a warning says.

        Args:
            path: of the file, which replaces an older one only when it is complete.
        """
        if self.origin is not None and self.origin.unsaved is not None:
            warnings.warn(
                f"the run is saved without its system: {self.origin.unsaved}", stacklevel=2
            )
        super().save(path)

    @classmethod
    def _known(cls) -> Kinds:
        return {**KNOWN, **{one.__name__: one for one in (cls, Event, Labels)}}


def _cast(values: ArrayLike, name: str, kind: type[np.generic]) -> NDArray[Any]:
    """Return numbers as those of a type, which must hold them."""
    given = np.asarray(values)
    if given.dtype.kind in "iuf":
        with np.errstate(invalid="ignore", over="ignore"):
            cast = given.astype(kind, copy=False)
        if cast.dtype.kind == "f" or (cast == given).all():
            return cast
    known = "real" if np.issubdtype(kind, np.floating) else f"{np.dtype(kind)}"
    raise ParameterError(name, f"must hold {known} numbers")
