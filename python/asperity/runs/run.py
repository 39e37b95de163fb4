"""What time stepping and event-driven integration have in common: series over time."""

from __future__ import annotations

import os
from typing import Any, ClassVar

import numpy as np
from numpy.typing import ArrayLike, NDArray

from asperity._base import arrays
from asperity._base.arrays import Array
from asperity._base.tables import write_columns
from asperity._base.value import Value
from asperity.errors import ParameterError
from asperity.status import Outcome

_UNITS = {"t": "s", "slip": "m/s", "force": "N", "normal_force": "N", "q": "SI", "u": "SI"}


class Run(Value):
    """States, forces and phases over time; base of `Trajectory` and `Motion`."""

    t: Array
    q: Array
    u: Array
    slip: Array
    force: Array
    normal_force: Array
    phase: NDArray[np.int8]
    status: Outcome
    steps: int

    _series: ClassVar[dict[str, type[np.generic]]] = {
        **dict.fromkeys(("t", "q", "u", "slip", "force", "normal_force"), np.float64),
        "phase": np.int8,
    }

    @classmethod
    def _frozen(cls, *series: ArrayLike) -> dict[str, NDArray[Any]]:
        """Return the series by their names, as arrays that refuse writing."""
        return {
            name: arrays.read_only(np.asarray(values, dtype=kind))
            for (name, kind), values in zip(cls._series.items(), series, strict=True)
        }

    def __len__(self) -> int:
        return len(self.t)

    def __repr__(self) -> str:
        until = f" to t = {self.t[-1]:.9g} s" if len(self) > 0 else ""
        return (
            f"<{type(self).__name__}: {self._extent()}{until}, "
            f"{self.q.shape[1]} coordinates, {self.phase.shape[1]} contacts, {self.status}>"
        )

    def _extent(self) -> str:
        return f"{len(self)} samples"

    def _between(self, t0: float, t1: float) -> dict[str, NDArray[Any]]:
        """Return the parts of the series with t0 ≤ t ≤ t1."""
        kept = (self.t >= arrays.number(t0, "t0")) & (self.t <= arrays.number(t1, "t1"))
        if not kept.any():
            raise ParameterError("t0", f"leaves no sample between {t0!r} and {t1!r} s")
        return {name: getattr(self, name)[kept] for name in self._series}

    def to_csv(self, path: str | os.PathLike[str]) -> None:
        """Write a table with one row per sample; the header holds names and units.

        Coordinates carry the unit SI, since they may be lengths or angles.
        """
        columns = {}
        for name in self._series:
            values, unit = getattr(self, name), _UNITS.get(name, "-")
            for index in np.ndindex(values.shape[1:]):
                columns["_".join([name, *map(str, index)]) + f" [{unit}]"] = values[:, *index]
        write_columns(path, columns)
