"""Whatever executes tasks: the own pool of processes, any executor, a client of dask."""

from __future__ import annotations

from collections.abc import Callable
from concurrent.futures import Executor, Future, ProcessPoolExecutor, ThreadPoolExecutor
from concurrent.futures.process import BrokenProcessPool
from typing import Any

from asperity._base.pool import WorkerPool, available_cores
from asperity.errors import ParameterError
from asperity.sweeps.task import Call, portable

# Tasks in flight. Where chunks take a millisecond and the cores have other work, workers wait for
# the next one: with 2 of them `benches/python_sweep.py` took 1.5 times a bare map, with 8 0.9.
_PER_WORKER = 8


class Workers:
    """Those who compute tasks, and can be replaced when they have died.

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
                    'started them: what it does must stand behind if __name__ == "__main__":',
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

    def submit(self, function: Callable[..., Any], *arguments: Any) -> Future[Any]:
        """Hand out a task."""
        return self._executor.submit(function, *arguments)

    def renew(self) -> None:
        """Replace those who have died; processes of the own pool replace each other."""
        if not isinstance(self._executor, WorkerPool):
            self._executor.shutdown(wait=False)
            self._executor = self._begun()

    def end(self) -> None:
        """End those who were made here; all tasks are done."""
        if self._make is not None:
            self._executor.shutdown()

    def abort(self) -> None:
        """End at once those who were made here; what they are at is lost."""
        if isinstance(self._executor, WorkerPool):
            self._executor.terminate()
        elif self._make is not None:
            self._executor.shutdown(wait=False, cancel_futures=True)


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
