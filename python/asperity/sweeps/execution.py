"""The loop that hands out chunks and commits what comes back."""

from __future__ import annotations

import math
from collections.abc import Iterable, Iterator, Sequence
from concurrent.futures import BrokenExecutor
from dataclasses import dataclass
from typing import Any

from asperity._base.progress import Report
from asperity.errors import SweepError
from asperity.sweeps.executors import Workers
from asperity.sweeps.grid import Block, Grid, block_shape, index_in
from asperity.sweeps.store import Store
from asperity.sweeps.task import Answer, Call, Failure, compute

# What an executor says of a task whose worker has died, while others go on.
_OF_ONE_WORKER = ("KilledWorker",)


@dataclass(frozen=True)
class Task:
    """A chunk and the places of its points to compute."""

    number: int
    block: Block
    places: Sequence[int]


class Execution:
    """Computes what is missing in a store.

    Args:
        store: that it is written to, here and nowhere else.
        grid: of the points.
        call: of the function.
        workers: who call it.
        strict: whether the first failure ends all.
        report: of points that are done, and all.
    """

    def __init__(
        self,
        store: Store,
        grid: Grid,
        call: Call,
        workers: Workers,
        *,
        strict: bool,
        report: Report | None,
    ) -> None:
        self._store, self._grid, self._workers = store, grid, workers
        self._call, self._strict, self._report = workers.packed(call), strict, report
        self._running: dict[int, Task] = {}
        # Chunks that came back before it is known what the function returns: the first good result
        # of all says so, in the order of the points, whoever computes it.
        self._held: dict[int, tuple[Task, Answer]] = {}
        self._next = 0

    def run(self, missing: Iterable[tuple[Block, Sequence[int]]]) -> None:
        """Compute chunks.

        Raises:
            SweepError: at the first failure, if that ends all, and if an executor of the user
                breaks.
        """
        tasks = (Task(k, block, places) for k, (block, places) in enumerate(missing))
        try:
            self._tell()
            self._go_through(tasks)
        except BaseException:
            self._workers.abort()
            raise
        self._workers.end()

    def _go_through(self, tasks: Iterator[Task]) -> None:
        while True:
            self._fill(tasks)
            if not self._running:
                return
            if lost := self._collect():
                # One of these tasks has ended its worker and so all others. Alone, it will again.
                while self._running:
                    lost.extend(self._collect())
                for task in sorted(lost, key=lambda one: one.number):
                    self._alone(task)

    def _fill(self, tasks: Iterator[Task]) -> None:
        """Hand out tasks."""
        while len(self._running) + len(self._held) < self._workers.in_flight:
            task = next(tasks, None)
            if task is None:
                break
            self._submit(task)

    def _submit(self, task: Task) -> None:
        self._running[task.number] = task
        self._workers.submit(
            task.number,
            compute,
            self._call,
            self._grid.values(task.block),
            task.places,
            self._store.schema,
            self._strict,
        )

    def _collect(self) -> list[Task]:
        """Wait for tasks and commit them; return those whose workers have died."""
        ready = self._workers.answers()
        return [task for number in sorted(ready) for task in self._taken(number, *ready[number])]

    def _taken(self, number: int, answer: Any, error: BaseException | None) -> list[Task]:
        """Commit a task that has ended; return it if its worker has died."""
        task = self._running.pop(number)
        if isinstance(error, BrokenExecutor):
            return [task]
        if error is None:
            self._take(task, answer)
        elif type(error).__name__ in _OF_ONE_WORKER:
            self._give_up(task, error)
        else:
            raise error
        return []

    def _alone(self, task: Task) -> None:
        """Compute a task that was in flight when workers died."""
        if not self._workers.renewable:
            raise SweepError(
                "the worker processes of the executor have died; what was done before is kept: "
                "sweep again with another one, or give a function that returns executors"
            )
        self._workers.renew()
        self._submit(task)
        if self._collect():
            self._give_up(task, BrokenExecutor("a worker process died at these points, twice"))
            self._workers.renew()

    def _give_up(self, task: Task, error: BaseException) -> None:
        count = math.prod(block_shape(task.block))
        self._take(task, Answer.lost(count, task.places, Failure.of(error)))

    def _take(self, task: Task, answer: Answer) -> None:
        if self._strict and answer.failures:
            place, why = next(iter(answer.failures.items()))
            raise SweepError(str(why), self._grid.point(index_in(task.block, place)), why.traceback)
        self._held[task.number] = task, answer
        while self._next in self._held:
            self._commit(self._next)
            self._next += 1
        if self._store.schema is not None:
            for number in sorted(self._held):
                self._commit(number)

    def _commit(self, number: int) -> None:
        task, answer = self._held.pop(number)
        self._store.commit(task.block, answer)
        self._tell()

    def _tell(self) -> None:
        if self._report is not None:
            self._report(self._store.known, self._grid.points)
