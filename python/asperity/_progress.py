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
