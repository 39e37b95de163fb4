"""Pools of worker processes, and how many threads a call may use where it runs.

A worker is one of many that share the cores: BLAS and the library's own loops use one thread in it.
"""

from __future__ import annotations

import atexit
import os
import pickle
import signal
import sys
import threading
import traceback
from collections.abc import Callable, Iterator
from concurrent.futures import Executor, Future
from concurrent.futures.process import BrokenProcessPool
from contextlib import contextmanager, suppress
from dataclasses import dataclass
from multiprocessing import get_context, parent_process
from queue import Empty, SimpleQueue
from typing import TYPE_CHECKING, Any, ParamSpec, TypeVar

if TYPE_CHECKING:
    from multiprocessing.connection import Connection
    from multiprocessing.process import BaseProcess

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


class WorkerPool(Executor):
    """Processes that start clean, use one thread each and end with the process that made them.

    They are started by a fork server, on Windows by spawning: a fork of a process that has threads,
    such as those of BLAS, may wait for ever. As with every such pool, functions and arguments must
    be picklable, and a script that starts one does so behind ``if __name__ == "__main__":``.

    A process that dies costs the call that it was at, whose future then holds a
    `BrokenProcessPool`; another one takes its place. (One dead process of a `ProcessPoolExecutor`
    costs all calls, and calls that are submitted meanwhile may never end in Python 3.11.)

    Args:
        workers: their number; by default that of the cores.

    >>> from asperity._base.pool import WorkerPool
    >>> with WorkerPool(1) as pool:
    ...     list(pool.map(abs, [-1, 2]))
    [1, 2]
    """

    def __init__(self, workers: int | None = None) -> None:
        self.workers = workers or available_cores()
        self._context: Any = get_context("spawn" if sys.platform == "win32" else "forkserver")
        self._calls: SimpleQueue[tuple[Future[Any], bytes] | None] = SimpleQueue()
        self._lock = threading.Lock()
        self._ended = self._terminated = False
        self._processes: set[BaseProcess] = set()
        self._threads = [
            threading.Thread(target=self._serve, daemon=True) for _ in range(self.workers)
        ]
        for thread in self._threads:
            thread.start()
        # At its end Python waits for processes, which wait for calls.
        atexit.register(self.terminate)

    def submit(
        self, fn: Callable[Given, Found], /, *args: Given.args, **kwargs: Given.kwargs
    ) -> Future[Found]:
        """Submit a call, as every executor does.

        Raises:
            Exception: of pickle, if the call cannot be sent.
        """
        call = pickle.dumps((fn, args, kwargs))
        future: Future[Found] = Future()
        with self._lock:
            if self._ended:
                raise RuntimeError("cannot submit calls after the end of a pool")
            self._calls.put((future, call))
        return future

    def shutdown(self, wait: bool = True, *, cancel_futures: bool = False) -> None:
        """End the processes when their calls are done."""
        with self._lock:
            ended, self._ended = self._ended, True
        if cancel_futures:
            self._cancel()
        if not ended:
            for _ in self._threads:
                self._calls.put(None)
        if wait:
            for thread in self._threads:
                thread.join()
            atexit.unregister(self.terminate)

    def terminate(self) -> None:
        """End all processes at once; what they were at is lost."""
        self.shutdown(wait=False, cancel_futures=True)
        with self._lock:
            self._terminated = True
            for process in self._processes:
                process.terminate()
        self.shutdown()

    def _cancel(self) -> None:
        with suppress(Empty):
            while (call := self._calls.get_nowait()) is not None:
                call[0].cancel()

    def _serve(self) -> None:
        """Send calls to one process, and start another one when it has died."""
        worker: _Worker | None = None
        while (call := self._calls.get()) is not None:
            future, data = call
            if not future.set_running_or_notify_cancel():
                continue
            try:
                if worker is None:
                    worker = self._start()
                good, value = worker.answer(data)
            except (EOFError, OSError):
                future.set_exception(BrokenProcessPool("the worker process has died"))
                self._end(worker)
                worker = None
            except BaseException as error:
                future.set_exception(error)
            else:
                (future.set_result if good else future.set_exception)(value)
        self._end(worker)

    def _start(self) -> _Worker:
        with self._lock:
            if self._terminated:
                raise EOFError
            mine, its = self._context.Pipe()
            # Not a daemon: these may not start processes of their own.
            process = self._context.Process(target=_work, args=(its,))
            # Libraries read the variables when they are loaded. The process inherits them from
            # this one, or from a fork server that is started now.
            with _one_thread_for_children():
                process.start()
            its.close()
            self._processes.add(process)
        return _Worker(process, mine)

    def _end(self, worker: _Worker | None) -> None:
        if worker is not None:
            worker.connection.close()
            worker.process.join()
            with self._lock:
                self._processes.discard(worker.process)


@dataclass(frozen=True)
class _Worker:
    process: BaseProcess
    connection: Connection[Any, Any]

    def answer(self, call: bytes) -> tuple[bool, Any]:
        """Return whether a call has succeeded, and what it returned or raised."""
        self.connection.send_bytes(call)
        good, value = pickle.loads(self.connection.recv_bytes())
        return good, value


def _work(connection: Connection[Any, Any]) -> None:
    """Answer calls until there are no more."""
    global _in_a_pool
    _in_a_pool = True
    # Ctrl-C is for the process that hands out the work.
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    threading.Thread(target=_end_with_the_parent, daemon=True).start()
    # A fork server that somebody else has started has other variables.
    with suppress(ImportError):
        from threadpoolctl import threadpool_limits

        threadpool_limits(1)
    with suppress(EOFError, OSError):
        while True:
            connection.send_bytes(_answer(connection.recv_bytes()))


def _answer(call: bytes) -> bytes:
    try:
        function, arguments, keywords = pickle.loads(call)
        return pickle.dumps((True, function(*arguments, **keywords)))
    except BaseException as error:
        error.add_note("".join(traceback.format_exception(error)))
        try:
            return pickle.dumps((False, error))
        except Exception:
            return pickle.dumps((False, RuntimeError(f"{type(error).__name__}: {error}")))


def _end_with_the_parent() -> None:
    """Wait until the process that made the pool is gone, be it killed, and end."""
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
