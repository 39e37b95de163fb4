"""Progress bars."""

from __future__ import annotations

import threading
from collections.abc import Callable, Iterator, Sequence
from contextlib import AbstractContextManager, contextmanager, nullcontext
from typing import Any, Literal, TypeAlias, TypeVar

from asperity.errors import ParameterError

Part = TypeVar("Part")
Report = Callable[[float, float], object]
"""A function of what is done and of all there is to do; 0 where that is not known."""

Progress: TypeAlias = Literal[True] | Report | None
"""Report of progress: ``True`` for a bar of tqdm, or a function that is called a few times a second
with (done, all)."""


def reporter(progress: Any, unit: str) -> AbstractContextManager[Report | None]:
    """Return a context that yields what reports progress, a bar where `progress` is True."""
    if progress is True:
        return _bar(unit)
    if progress is not None and not callable(progress):
        raise ParameterError("progress", f"must be True, None or a function, got {progress!r}")
    return nullcontext(progress)


class Count:
    """Counts parts of work, each once, and reports how many there are; from several threads."""

    def __init__(self, whole: int, report: Report | None) -> None:
        self._whole, self._report = whole, report
        self._seen: set[int] = set()
        self._lock = threading.Lock()

    def add(self, number: int) -> None:
        """Report that a part has begun, if it is a new one."""
        with self._lock:
            new = number not in self._seen
            self._seen.add(number)
            if new and self._report is not None:
                self._report(len(self._seen) - 1, self._whole)

    def finish(self) -> None:
        """Report that all is done."""
        if self._report is not None:
            self._report(self._whole, self._whole)


def part_of(report: Report | None, done: float, whole: float) -> Report | None:
    """Return what reports a part of work, before which so much of the whole is done."""
    return None if report is None else lambda more, _: report(done + more, whole)


def each(parts: Sequence[Part], report: Report | None) -> Iterator[Part]:
    """Yield parts of work one after the other, and report how many are done."""
    count = Count(len(parts), report)
    for number, part in enumerate(parts):
        count.add(number)
        yield part
    count.finish()


@contextmanager
def _bar(unit: str) -> Iterator[Report]:
    """Show a tqdm bar and yield the function that moves it."""
    try:
        from tqdm.auto import tqdm
    except ImportError:
        raise ParameterError(
            "progress", "True needs tqdm (pip install tqdm); or pass a function of (done, all)"
        ) from None
    with tqdm(unit=unit, unit_scale=True) as display:
        yield _mover(display)


def _mover(display: Any) -> Report:
    """Return the function of (done, all) that moves a bar, if there is one."""

    def move(done: float, whole: float) -> None:
        if display is not None:
            display.total = whole or None
            display.update(done - display.n)

    return move


def _on_a_terminal(**options: Any) -> AbstractContextManager[Any]:
    """Return a tqdm bar that only a terminal shows, or what is None if there is no tqdm."""
    try:
        from tqdm.auto import tqdm
    except ImportError:
        return nullcontext()
    return tqdm(disable=None, leave=False, **options)


class Bar:
    """A bar that a terminal shows: called with what is done and all, it moves."""

    def __init__(self, display: Any) -> None:
        self._display, self._move = display, _mover(display)

    def __call__(self, done: float, whole: float) -> None:
        """Move."""
        self._move(done, whole)

    def announce(self, name: str) -> None:
        """Say what is being done."""
        if self._display is not None:
            self._display.set_description(name)


@contextmanager
def bar_if_there(unit: str = "step") -> Iterator[Bar]:
    """Yield a function of (done, all) that moves a bar, if there is a terminal and tqdm."""
    with _on_a_terminal(unit=unit) as display:
        yield Bar(display)
