"""Pools of worker processes, and how many threads a call may use where it runs.

A worker is one of many that share the cores: BLAS and the library's own loops use one thread in it.
"""

from __future__ import annotations

import os
import signal
import sys
import threading
from collections.abc import Callable, Iterator
from concurrent.futures import Future, ProcessPoolExecutor
from contextlib import contextmanager, suppress
from multiprocessing import get_context, parent_process
from typing import ParamSpec, TypeVar

Given = ParamSpec("Given")
Found = TypeVar("Found")

_ONE_THREAD = {
    f"{library}_NUM_THREADS": "1"
    for library in ("OMP", "OPENBLAS", "MKL", "BLIS", "VECLIB", "NUMEXPR", "RAYON")
}
_environment = threading.Lock()
_worker = threading.local()
# Of a process all of whose threads are workers.
_in_a_pool = False


def available_cores() -> int:
    """Return how many cores this process may use.

    >>> from asperity._base.pool import available_cores
    >>> available_cores() >= 1
    True
    """
    if hasattr(os, "sched_getaffinity"):
        return len(os.sched_getaffinity(0))
    return os.cpu_count() or 1


def threads_to_use() -> int:
    """Return how many threads a call may use here: one in a worker, else all cores.

    >>> from asperity._base.pool import one_of_many, threads_to_use
    >>> with one_of_many():
    ...     threads_to_use()
    1
    """
    return 1 if _in_a_pool or getattr(_worker, "busy", False) else available_cores()


@contextmanager
def one_of_many() -> Iterator[None]:
    """Make the calling thread a worker for a while, whatever executor it belongs to."""
    before = getattr(_worker, "busy", False)
    _worker.busy = True
    try:
        yield
    finally:
        _worker.busy = before


class WorkerPool(ProcessPoolExecutor):
    """Processes that start clean, use one thread each and end with the process that made them.

    They are started by a fork server, on Windows by spawning: a fork of a process that has threads,
    such as those of BLAS, may wait for ever. As with every such pool, functions and arguments must
    be picklable, and a script that starts one does so behind ``if __name__ == "__main__":``.

    Args:
        workers: their number; by default that of the cores.

    >>> from asperity._base.pool import WorkerPool
    >>> with WorkerPool(1) as pool:
    ...     list(pool.map(abs, [-1, 2]))
    [1, 2]
    """

    def __init__(self, workers: int | None = None) -> None:
        super().__init__(
            workers or available_cores(),
            mp_context=get_context("spawn" if sys.platform == "win32" else "forkserver"),
            initializer=_begin,
        )

    def submit(
        self, fn: Callable[Given, Found], /, *args: Given.args, **kwargs: Given.kwargs
    ) -> Future[Found]:
        """Submit a call, as every executor does."""
        # Libraries read the variables when they are loaded. The processes inherit them from this
        # one, or from a fork server that is started now.
        with _one_thread_for_children():
            return super().submit(fn, *args, **kwargs)

    def terminate(self) -> None:
        """End all workers at once; what they were at is lost."""
        processes = list((self._processes or {}).values())
        self.shutdown(wait=False, cancel_futures=True)
        for process in processes:
            process.terminate()
        for process in processes:
            process.join()


def _begin() -> None:
    """Make a process that has just started a worker."""
    global _in_a_pool
    _in_a_pool = True
    # Ctrl-C is for the process that hands out the work.
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    threading.Thread(target=_end_with_the_parent, daemon=True).start()
    # A fork server that somebody else has started has other variables.
    with suppress(ImportError):
        from threadpoolctl import threadpool_limits

        threadpool_limits(1)


def _end_with_the_parent() -> None:
    """Wait until the process that made the pool is gone, be it killed, and end.

    A worker that waits for its next call would never notice.
    """
    parent = parent_process()
    if parent is not None:
        parent.join()
        os._exit(1)


@contextmanager
def _one_thread_for_children() -> Iterator[None]:
    with _environment:
        before = {name: os.environ.get(name) for name in _ONE_THREAD}
        os.environ.update(_ONE_THREAD)
        try:
            yield
        finally:
            for name, value in before.items():
                if value is None:
                    os.environ.pop(name, None)
                else:
                    os.environ[name] = value
