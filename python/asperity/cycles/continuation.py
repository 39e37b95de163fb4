"""Continuation of limit cycles over the members of a family."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, field

from asperity._base.progress import Count
from asperity._base.threads import Stop, in_threads
from asperity.cycles.orbit import LimitCycle
from asperity.cycles.search import limit_cycle
from asperity.errors import AsperityError
from asperity.runs.model import Model

# A run through an interval of instability ends after so many members in a row without a cycle.
_GIVE_UP = 3
# A step of the parameter that loses the cycle is halved so often.
_HALVINGS = 3


@dataclass
class Found:
    """Cycles and reasons for their absence, by the number of the member."""

    cycles: dict[int, LimitCycle] = field(default_factory=dict)
    failures: dict[int, str] = field(default_factory=dict)

    def add(self, other: Found) -> None:
        """Take over what is not known yet."""
        self.cycles = {**other.cycles, **self.cycles}
        failures = {**other.failures, **self.failures}
        self.failures = {i: why for i, why in failures.items() if i not in self.cycles}


@dataclass(frozen=True)
class Continuation:
    """The search for the cycles of a family, some of whose members are unstable."""

    member: Callable[[float], Model]
    values: Sequence[float]
    unstable: Sequence[bool]
    tolerance: float
    t_end: float | None
    count: Count

    def everywhere(self, threads: int) -> Found:
        """Search from the middle of every interval of instability to both sides.

        What is found does not depend on the number of threads: the runs know nothing of each other
        and are merged in a fixed order.
        """
        found = Found()
        starts = in_threads(self._first, self._intervals(), threads)
        runs = [(start, step) for start in starts for step in (1, -1) if start.cycles]
        followed = in_threads(lambda run, stop: self._follow(*run, stop), runs, threads)
        for part in [*starts, *followed]:
            found.add(part)
        self._fill(found)
        self._explain(found)
        return found

    def _intervals(self) -> list[range]:
        flags = [False, *self.unstable, False]
        edges = [i for i in range(len(flags) - 1) if flags[i] != flags[i + 1]]
        return [range(a, b) for a, b in zip(edges[::2], edges[1::2], strict=True)]

    def _first(self, interval: range, stop: Stop) -> Found:
        """Search without a neighbour: in the middle of the interval, then nearer its ends."""
        found = Found()
        places = [interval[int(share * (len(interval) - 1))] for share in (0.5, 0.25, 0.75)]
        for index in dict.fromkeys(places):
            if self._try(index, None, found, stop):
                break
        return found

    def _follow(self, start: Found, step: int, stop: Stop) -> Found:
        """Continue from member to member until the cycle is lost."""
        found = Found()
        [last] = start.cycles
        near, missed, index = start.cycles[last], 0, last + step
        while 0 <= index < len(self.values) and missed < _GIVE_UP:
            if self._try(index, (last, near), found, stop):
                last, near, missed = index, found.cycles[index], 0
            elif not self.unstable[index]:
                del found.failures[index]
                break
            # An unstable equilibrium sends the motion somewhere: perhaps to another cycle.
            elif self._try(index, None, found, stop):
                last, near, missed = index, found.cycles[index], 0
            else:
                missed += 1
            index += step
        return found

    def _fill(self, found: Found) -> None:
        """Try once more where the equilibrium is unstable, from the neighbours on both sides."""
        stop = Stop()
        for index, unstable in enumerate(self.unstable):
            for side in (index + 1, index - 1):
                if unstable and index not in found.cycles and side in found.cycles:
                    self._try(index, (side, found.cycles[side]), found, stop)

    def _explain(self, found: Found) -> None:
        """Give a reason to the unstable equilibria at which the runs have not arrived."""
        failed = dict(found.failures)
        for index, unstable in enumerate(self.unstable):
            if unstable and index not in found.cycles and index not in failed:
                near = min(failed, key=lambda other: abs(other - index))
                found.failures[index] = (
                    f"not searched for, as the search failed at {self.values[near]:.9g}: "
                    f"{failed[near]}"
                )

    def _try(
        self, index: int, near: tuple[int, LimitCycle] | None, found: Found, stop: Stop
    ) -> bool:
        """Look for the cycle of a member, from that of another one if there is one."""
        stop.ask()
        # Cycles are counted after as many equilibria.
        self.count.add(len(self.values) + index)
        try:
            if near is None:
                system = self.member(self.values[index])
                cycle = limit_cycle(
                    system, tolerance=self.tolerance, t_end=self.t_end, progress=stop.ask
                )
            else:
                start = self.values[near[0]]
                cycle = self._reach(near[1], (start, self.values[index]), _HALVINGS, stop)
        except AsperityError as error:
            found.failures[index] = str(error)
            return False
        found.cycles[index] = cycle
        found.failures.pop(index, None)
        return True

    def _reach(
        self, near: LimitCycle, ends: tuple[float, float], halvings: int, stop: Stop
    ) -> LimitCycle:
        """Continue a cycle from one value to another, by way of the middle if need be."""
        start, end = ends
        try:
            return limit_cycle(
                self.member(end), near=near, tolerance=self.tolerance, progress=stop.ask
            )
        except AsperityError:
            if not halvings:
                raise
        middle = 0.5 * (start + end)
        near = self._reach(near, (start, middle), halvings - 1, stop)
        return self._reach(near, (middle, end), halvings - 1, stop)
