"""Work in threads that Ctrl-C in the main thread ends at once.

Not futures: Ctrl-C comes between any two instructions of the main thread. Where that waits for
many futures it holds the locks of all, and one that is left locked keeps the thread that wants to
set it from ever ending. The main thread meets only queues without locks of Python here.
"""

from __future__ import annotations

import threading
from collections.abc import Callable, Sequence
from contextlib import suppress
from queue import Empty, SimpleQueue
from typing import Generic, TypeVar

Given = TypeVar("Given")
Found = TypeVar("Found")

# How often Ctrl-C is looked for in s.
_ASK_EVERY = 0.05


class GivenUp(Exception):
    """Work was given up, as all other work was."""


class Stop:
    """Tells threads that nobody waits for them any more."""

    def __init__(self) -> None:
        self._event = threading.Event()

    def set(self) -> None:
        """Give up what threads are at."""
        self._event.set()

    def is_set(self) -> bool:
        """Return whether work is given up."""
        return self._event.is_set()

    def ask(self, *_: float) -> None:
        """Raise `GivenUp` if work is given up: what long work calls to report its progress."""
        if self.is_set():
            raise GivenUp


class Work(Generic[Found]):
    """Numbered parts of work in threads, which hand over what they find through queues.

    Args:
        function: of the number of a part.
        count: number of parts.
        stop: what the function asks.
    """

    def __init__(self, function: Callable[[int], Found], count: int, stop: Stop) -> None:
        self._function, self._stop = function, stop
        self._parts: SimpleQueue[int] = SimpleQueue()
        self._answers: SimpleQueue[tuple[int, Found | BaseException]] = SimpleQueue()
        self._threads: list[threading.Thread] = []
        for part in range(count):
            self._parts.put(part)

    def begin(self, threads: int) -> None:
        """Start so many threads."""
        for _ in range(min(threads, self._parts.qsize())):
            self._threads.append(threading.Thread(target=self._serve, daemon=True))
            self._threads[-1].start()

    def answers(self) -> dict[int, Found | Exception]:
        """Return what has been found since, after a while if there is nothing."""
        found: dict[int, Found | Exception] = {}
        with suppress(Empty):
            part, answer = self._answers.get(timeout=_ASK_EVERY)
            while True:
                if isinstance(answer, BaseException) and not isinstance(answer, Exception):
                    raise answer
                found[part] = answer
                part, answer = self._answers.get_nowait()
        return found

    def end(self) -> None:
        """Give up what is not done, and wait for the threads."""
        self._stop.set()
        for thread in self._threads:
            thread.join()

    def _serve(self) -> None:
        with suppress(Empty):
            while not self._stop.is_set():
                part = self._parts.get_nowait()
                answer: Found | BaseException
                try:
                    answer = self._function(part)
                except BaseException as error:
                    answer = error
                self._answers.put((part, answer))


def in_threads(
    function: Callable[[Given, Stop], Found], given: Sequence[Given], threads: int
) -> list[Found]:
    """Return what a function gives for each of its arguments, in their order.

    The function also takes the `Stop` to ask. The first exception ends all.

    >>> from asperity._base.threads import in_threads
    >>> in_threads(lambda x, stop: x * x, [1, 2, 3], threads=2)
    [1, 4, 9]
    """
    stop = Stop()
    work = Work(lambda part: function(given[part], stop), len(given), stop)
    found: dict[int, Found] = {}
    try:
        work.begin(threads)
        while len(found) < len(given):
            for part, answer in work.answers().items():
                if isinstance(answer, Exception):
                    raise answer
                found[part] = answer
    finally:
        work.end()
    return [found[part] for part in range(len(given))]
