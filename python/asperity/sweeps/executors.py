"""Whatever executes tasks: the own pool of processes, any executor, a client of dask."""

from __future__ import annotations

import threading
from collections.abc import Callable
from concurrent.futures import (
    CancelledError,
    Executor,
    Future,
    ProcessPoolExecutor,
    ThreadPoolExecutor,
)
from concurrent.futures.process import BrokenProcessPool
from contextlib import suppress
from queue import Empty, SimpleQueue
from typing import Any, TypeAlias

from asperity._base.pool import WorkerPool, available_cores
from asperity.errors import ParameterError
from asperity.sweeps.task import Call, portable

# Tasks in flight. Where chunks take a millisecond and the cores have other work, workers wait for
# the next one: with 2 of them `benches/python_sweep.py` took 1.5 times a bare map, with 8 0.9.
_PER_WORKER = 8
Answer: TypeAlias = tuple[Any, BaseException | None]
"""What a task has returned, or what it or handing it out has raised."""


class Workers:
    """Those who compute tasks, and can be replaced when they have died.

    Ctrl-C comes between any two instructions of the main thread, also while that holds the lock of
    a future or of an executor, which then stays locked for ever. The main thread only meets queues
    without locks of Python; everything else is done in a thread of its own.

    Args:
        executor: None for processes of its own; an executor; a function that returns one, which is
            called again when that breaks; a client of dask.

    Raises:
        ParameterError: naming `executor`, if it cannot be used.
    """

    def __init__(self, executor: Any) -> None:
        self._make: Callable[[], Executor] | None = None
        if executor is None:
            self._make = WorkerPool
        elif isinstance(executor, Executor):
            self._executor: Executor = executor
        elif hasattr(executor, "get_executor"):
            # A client of dask would take calls that look alike for the same one.
            self._executor = executor.get_executor(pure=False)
        elif callable(executor):
            self._make = executor
        else:
            raise ParameterError(
                "executor",
                "must be an executor of concurrent.futures, a function that returns one, a client "
                f"of dask or None, got {executor!r}",
            )
        if self._make is not None:
            self._executor = self._begun()
        _refuse_forks(self._executor)
        self._orders: SimpleQueue[Callable[[], object] | None] = SimpleQueue()
        self._answers: SimpleQueue[tuple[int, Answer]] = SimpleQueue()
        self._futures: set[Future[Any]] = set()
        self._thread = threading.Thread(target=self._serve, daemon=True)
        self._thread.start()

    def _begun(self) -> Executor:
        """Make an executor that works."""
        assert self._make is not None
        executor = self._make()
        if not isinstance(executor, Executor):
            raise ParameterError("executor", f"must return an executor, got {executor!r}")
        if isinstance(executor, WorkerPool):
            try:
                executor.submit(available_cores).result()
            except BrokenProcessPool:
                raise ParameterError(
                    "executor",
                    "worker processes end before they begin. They import the script that "
                    'started them: put its code behind if __name__ == "__main__":',
                ) from None
        return executor

    @property
    def renewable(self) -> bool:
        """Whether there can be others when these have died."""
        return self._make is not None

    @property
    def in_flight(self) -> int:
        """How many tasks are handed out at a time."""
        return _PER_WORKER * max(_count(self._executor), 1)

    def packed(self, call: Call) -> Call | bytes:
        """Return a call as these workers take it: as it is, or as bytes, once for all tasks."""
        with_own_code = type(self._executor).__module__.startswith("distributed")
        if isinstance(self._executor, ThreadPoolExecutor) or with_own_code:
            return call
        return portable(call)

    def submit(self, number: int, function: Callable[..., Any], *arguments: Any) -> None:
        """Hand out a task, whose answer has this number."""
        self._orders.put(lambda: self._submit(number, function, arguments))

    def answers(self) -> dict[int, Answer]:
        """Wait for answers and return those that are there, by number."""
        number, answer = self._answers.get()
        answers = {number: answer}
        with suppress(Empty):
            while True:
                number, answer = self._answers.get_nowait()
                answers[number] = answer
        return answers

    def renew(self) -> None:
        """Replace those who have died; processes of the own pool replace each other."""
        self._ask(self._renew)

    def end(self) -> None:
        """End those who were made here; all tasks are done."""
        if self._make is not None:
            self._ask(self._executor.shutdown)
        self._orders.put(None)
        self._thread.join()

    def abort(self) -> None:
        """Give up all tasks, and end at once those who were made here."""
        self._ask(self._give_up)
        self._orders.put(None)

    def _renew(self) -> None:
        if not isinstance(self._executor, WorkerPool):
            self._executor.shutdown(wait=False)
            self._executor = self._begun()

    def _give_up(self) -> None:
        for future in list(self._futures):
            future.cancel()
        if isinstance(self._executor, WorkerPool):
            self._executor.terminate()
        elif self._make is not None:
            self._executor.shutdown(wait=False, cancel_futures=True)

    def _ask(self, order: Callable[[], object]) -> None:
        """Have something done and wait for its end."""
        done: SimpleQueue[BaseException | None] = SimpleQueue()

        def call() -> None:
            try:
                order()
            except BaseException as error:
                done.put(error)
            else:
                done.put(None)

        self._orders.put(call)
        error = done.get()
        if error is not None:
            raise error

    def _serve(self) -> None:
        while (order := self._orders.get()) is not None:
            order()

    def _submit(
        self, number: int, function: Callable[..., Any], arguments: tuple[Any, ...]
    ) -> None:
        try:
            future = self._executor.submit(function, *arguments)
        except BaseException as error:
            self._answers.put((number, (None, error)))
            return
        self._futures.add(future)
        future.add_done_callback(lambda future: self._bring(number, future))

    def _bring(self, number: int, future: Future[Any]) -> None:
        """Put the answer of a future that is done into the queue, in whatever thread."""
        self._futures.discard(future)
        try:
            error = future.exception()
        except CancelledError as cancelled:
            error = cancelled
        self._answers.put((number, (future.result() if error is None else None, error)))


def _refuse_forks(executor: Executor) -> None:
    context = getattr(executor, "_mp_context", None)
    if not isinstance(executor, ProcessPoolExecutor) or context is None:
        return
    if context.get_start_method() == "fork":
        raise ParameterError(
            "executor",
            "must not be a ProcessPoolExecutor that forks: the copy of a process with threads may "
            "wait for ever. Leave it out for processes of its own, or give it "
            'mp_context=multiprocessing.get_context("forkserver")',
        )


def _count(executor: Any) -> int:
    """Return how many workers an executor has, as far as it tells."""
    client = getattr(executor, "_client", None)
    if client is not None and hasattr(client, "nthreads"):
        return sum(client.nthreads().values())
    for name in ("workers", "_max_workers", "num_workers"):
        number = getattr(executor, name, None)
        if isinstance(number, int):
            return number
    return available_cores()
