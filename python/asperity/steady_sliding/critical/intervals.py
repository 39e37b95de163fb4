"""Intervals of angle in which sliding is critical."""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence

import numpy as np
from numpy.typing import DTypeLike

from asperity._base import arrays
from asperity._base.arrays import Array
from asperity._base.result import Axis, Series, Table, TableResult, counted
from asperity._base.value import Value

Interval = tuple[float, float]


class CriticalIntervals(TableResult, Value):
    """Intervals of an angle in which a body with M ∝ I slides unsteadily; a sequence of pairs.

    Args:
        intervals: (begin, end) in rad, each with begin < end.
        angle: what the angle is of, in words.
        period: of the angle in rad.

    >>> import math
    >>> from asperity import Ellipse, FrictionLaw, critical_directions
    >>> law = FrictionLaw(Ellipse(3.0, 1.0, angle=math.pi / 6), Ellipse(3.0, 1.0))
    >>> print(critical_directions(law).summary())
    Steady sliding is critical in 2 intervals of the sliding direction:
    from 44.106° to 75.894°,
    from 224.106° to 255.894°.
    """

    intervals: tuple[Interval, ...]
    angle: str
    period: float

    def __init__(
        self, intervals: Sequence[Interval], *, angle: str, period: float = 2.0 * math.pi
    ) -> None:
        rows = arrays.array(np.reshape(intervals, (-1, 2)), "intervals")
        self._set(
            intervals=tuple((begin, end) for begin, end in rows.tolist()),
            angle=str(angle),
            period=arrays.positive(period, "period"),
        )

    def __len__(self) -> int:
        return len(self.intervals)

    def __getitem__(self, number: int) -> Interval:
        return self.intervals[number]

    def __iter__(self) -> Iterator[Interval]:
        return iter(self.intervals)

    def __array__(self, dtype: DTypeLike | None = None, copy: bool | None = None) -> Array:
        return np.array(self.intervals, dtype=dtype).reshape(-1, 2)

    def __eq__(self, other: object) -> bool:
        # As the list of pairs that it stands for.
        if isinstance(other, list | tuple):
            return list(self.intervals) == list(other)
        return super().__eq__(other)

    __hash__ = Value.__hash__

    def __contains__(self, angle: object) -> bool:
        """Whether an angle in rad is critical; a pair, whether it is one of the intervals."""
        if isinstance(angle, tuple):
            return angle in self.intervals
        turned = arrays.number(angle, "angle")
        return any((turned - begin) % self.period <= end - begin for begin, end in self)

    def __repr__(self) -> str:
        pairs = " and ".join(map(_degrees, self))
        return (
            f"<CriticalIntervals: {self.angle} from {pairs}>"
            if pairs
            else (f"<CriticalIntervals: no {self.angle}>")
        )

    def summary(self) -> str:
        """Return the intervals in degrees."""
        if not self:
            return f"Steady sliding is critical for no {self.angle}."
        if self[0] == (0.0, self.period):
            return f"Steady sliding is critical for every {self.angle}."
        where = f"{counted(len(self), 'interval')} of the {self.angle}"
        lines = [f"from {_degrees(pair)}" for pair in self]
        return f"Steady sliding is critical in {where}:\n" + ",\n".join(lines) + "."

    def _table(self) -> Table:
        rows = np.asarray(self)
        return Table(
            {"interval": Axis(np.arange(len(self)), "", "number of the interval")},
            {
                name: Series(rows[:, k], ("interval",), "rad", f"{name} in the {self.angle}")
                for k, name in enumerate(("begin", "end"))
            },
            {"angle": self.angle, "period": self.period},
        )


def _degrees(pair: Interval) -> str:
    begin, end = np.rad2deg(pair)
    return f"{begin:.3f}° to {end:.3f}°"
