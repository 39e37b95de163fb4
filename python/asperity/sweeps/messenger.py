"""A thread that meets the executor, so that Ctrl-C cannot come in between."""

from __future__ import annotations

import threading
from collections.abc import Callable
from concurrent.futures import CancelledError, Future
from contextlib import suppress
from queue import Empty, SimpleQueue
from typing import Any, TypeAlias

from asperity.sweeps.executors import Workers

Answer: TypeAlias = tuple[Any, BaseException | None]
"""What a task has returned, or what it or handing it out has raised."""


class Messenger:
    """Hands tasks to workers, and brings back what they return.

    Ctrl-C comes between any two instructions of the main thread, also while that holds the lock of
    a future or of an executor, which then stays locked for ever. The main thread only meets queues
    without locks of Python; everything else is done in a thread of the messenger.
    """

    def __init__(self, workers: Workers) -> None:
        self._workers = workers
        self._orders: SimpleQueue[Callable[[], object] | None] = SimpleQueue()
        self._answers: SimpleQueue[tuple[int, Answer]] = SimpleQueue()
        self._futures: set[Future[Any]] = set()
        self._thread = threading.Thread(target=self._serve, daemon=True)
        self._thread.start()

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
        """Replace workers who have died."""
        self._ask(self._workers.renew)

    def end(self) -> None:
        """End the workers who were made here; all tasks are done."""
        self._ask(self._workers.end)
        self._orders.put(None)
        self._thread.join()

    def abort(self) -> None:
        """Give up all tasks, and end at once the workers who were made here."""
        self._ask(self._give_up)
        self._orders.put(None)

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
            future = self._workers.submit(function, *arguments)
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

    def _give_up(self) -> None:
        for future in list(self._futures):
            future.cancel()
        self._workers.abort()
