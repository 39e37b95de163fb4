"""The progress bar."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from contextlib import contextmanager

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


@contextmanager
def bar_if_there() -> Iterator[Callable[[int, int], object] | None]:
    """Yield a function of (step, steps) that moves a bar; None without a terminal or tqdm."""
    try:
        from tqdm.auto import tqdm
    except ImportError:
        yield None
        return
    with tqdm(unit="step", disable=None, leave=False) as display:

        def move(step: int, steps: int) -> None:
            display.total = steps
            display.update(step - display.n)

        yield move


@contextmanager
def stages(count: int) -> Iterator[Callable[[str], object]]:
    """Yield a function that announces the next of `count` stages.

    On a terminal a tqdm bar shows them, if there is tqdm; else nothing does.
    """
    try:
        from tqdm.auto import tqdm
    except ImportError:
        yield lambda _: None
        return
    with tqdm(total=count, unit="stage", disable=None, leave=False) as display:
        begun = 0

        def announce(name: str) -> None:
            nonlocal begun
            display.set_description(name)
            display.update(begun - display.n)
            begun += 1

        yield announce
