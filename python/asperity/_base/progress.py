"""Progress bars."""

from __future__ import annotations

import itertools
from collections.abc import Callable, Iterator
from contextlib import AbstractContextManager, contextmanager, nullcontext
from typing import Any

from asperity.errors import ParameterError


@contextmanager
def bar(steps: int) -> Iterator[Callable[[int, int], object]]:
    """Show a tqdm bar and yield the function that moves it."""
    try:
        from tqdm.auto import tqdm
    except ImportError:
        raise ParameterError(
            "progress", "True needs tqdm (pip install tqdm); or pass a function of (step, steps)"
        ) from None
    with tqdm(total=steps, unit="step", unit_scale=True) as display:
        yield lambda step, _: display.update(step - display.n)


def _on_a_terminal(**options: Any) -> AbstractContextManager[Any]:
    """Return a tqdm bar that only a terminal shows, or what is None if there is no tqdm."""
    try:
        from tqdm.auto import tqdm
    except ImportError:
        return nullcontext()
    return tqdm(disable=None, leave=False, **options)


@contextmanager
def bar_if_there() -> Iterator[Callable[[int, int], object]]:
    """Yield a function of (step, steps) that moves a bar."""
    with _on_a_terminal(unit="step") as display:

        def move(step: int, steps: int) -> None:
            if display is not None:
                display.total = steps
                display.update(step - display.n)

        yield move


@contextmanager
def stages(count: int) -> Iterator[Callable[[str], object]]:
    """Yield a function that announces the next of `count` stages."""
    begun = itertools.count()
    with _on_a_terminal(total=count, unit="stage") as display:

        def announce(name: str) -> None:
            if display is not None:
                display.set_description(name)
                display.update(next(begun) - display.n)

        yield announce
