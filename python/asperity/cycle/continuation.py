"""Continuation of limit cycles over the members of a family."""

from __future__ import annotations

from collections.abc import Sequence
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass, field

from asperity.cycle.limit_cycle import limit_cycle
from asperity.cycle.orbit import LimitCycle
from asperity.errors import AsperityError
from asperity.simulate import Model

# A run through an interval of instability ends after so many members in a row without a cycle.
_GIVE_UP = 3


@dataclass
class Found:
    """Cycles and reasons for their absence, by the number of the member."""

    cycles: dict[int, LimitCycle] = field(default_factory=dict)
    failures: dict[int, str] = field(default_factory=dict)

    def add(self, other: Found) -> None:
        """Take over what is not known yet."""
        self.cycles = {**other.cycles, **self.cycles}
        self.failures = {**other.failures, **self.failures}


@dataclass(frozen=True)
class Continuation:
    """The search for the cycles of a family, some of whose members are unstable."""

    systems: Sequence[Model]
    unstable: Sequence[bool]
    tolerance: float

    def everywhere(self, threads: int) -> Found:
        """Search from the middle of every interval of instability to both sides.

        What is found does not depend on the number of threads: the runs know nothing of each other
        and are merged in a fixed order.
        """
        found = Found()
        with ThreadPoolExecutor(threads) as pool:
            starts = list(pool.map(self._first, self._intervals()))
            runs = [(start, step) for start in starts for step in (1, -1) if start.cycles]
            for start in starts:
                found.add(start)
            for run in pool.map(lambda run: self._follow(*run), runs):
                found.add(run)
        return found

    def _intervals(self) -> list[range]:
        edges = [
            i
            for i in range(len(self.unstable) + 1)
            if (i > 0 and self.unstable[i - 1]) != (i < len(self.unstable) and self.unstable[i])
        ]
        return [range(a, b) for a, b in zip(edges[::2], edges[1::2], strict=True)]

    def _first(self, interval: range) -> Found:
        """Search without a neighbour: in the middle of the interval, then nearer its ends."""
        found = Found()
        places = [interval[int(share * (len(interval) - 1))] for share in (0.5, 0.25, 0.75)]
        for index in dict.fromkeys(places):
            if self._try(index, None, found):
                break
        return found

    def _follow(self, start: Found, step: int) -> Found:
        """Continue from member to member until the cycle is lost."""
        found = Found()
        (index, near), *_ = start.cycles.items()
        missed = 0
        while 0 <= index + step < len(self.systems) and missed < _GIVE_UP:
            index += step
            if self._try(index, near, found):
                near, missed = found.cycles[index], 0
            elif self.unstable[index]:
                # An unstable equilibrium sends the motion somewhere: perhaps to another cycle.
                if self._try(index, None, found):
                    near, missed = found.cycles[index], 0
                else:
                    missed += 1
            else:
                del found.failures[index]
                break
        return found

    def _try(self, index: int, near: LimitCycle | None, found: Found) -> bool:
        try:
            cycle = limit_cycle(self.systems[index], near=near, tolerance=self.tolerance)
        except AsperityError as error:
            found.failures[index] = str(error)
            return False
        found.cycles[index] = cycle
        found.failures.pop(index, None)
        return True
