"""Figures 1–8 and 10–27 with their data and checks: ``asperity figures``."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from pathlib import Path

import matplotlib as mpl
import matplotlib.pyplot as plt

from asperity._base.tables import write_columns
from asperity.errors import ParameterError
from asperity.paper import (
    associated,
    convexity,
    dry,
    extended,
    fig13,
    identified,
    instability,
    limit_cycle,
    nonassociated,
    sliding_paths,
    tribometer,
    validation,
)
from asperity.paper.checks import Check
from asperity.paper.redrawn import Redrawn
from asperity.plot import save_figure

FIGURES: dict[int, Callable[[], Redrawn]] = {
    1: convexity.fig01,
    2: convexity.fig02,
    3: dry.fig03,
    4: associated.fig04,
    5: associated.fig05,
    6: associated.fig06,
    7: associated.fig07,
    8: nonassociated.fig08,
    10: nonassociated.fig10,
    11: extended.fig11,
    12: extended.fig12,
    13: fig13.fig13,
    14: instability.fig14,
    15: instability.fig15,
    16: instability.fig16,
    17: limit_cycle.fig17,
    18: sliding_paths.fig18,
    19: sliding_paths.fig19,
    20: tribometer.fig20,
    21: tribometer.fig21,
    22: tribometer.fig22,
    23: tribometer.fig23,
    24: tribometer.fig24,
    25: tribometer.fig25,
    26: identified.fig26,
    27: validation.fig27,
}
"""What draws a figure, by its number in the paper."""

LEFT_OUT = {9: "a sketch of a spring on an inclined plane"}
"""Figures among them that are not redrawn, and what they show."""


def numbers(text: str) -> list[int]:
    """Return the numbers that a text such as ``1-4,7`` names, ascending, each once.

    Args:
        text: numbers and ranges of figures, separated by commas.

    Raises:
        ParameterError: if the text cannot be read or names an unknown figure.

    >>> from asperity.paper.redraw import numbers
    >>> numbers("7,1-4,3")
    [1, 2, 3, 4, 7]
    """
    named: set[int] = set()
    for part in text.split(","):
        ends = [end.strip() for end in part.split("-")]
        if len(ends) > 2 or not all(end.isascii() and end.isdigit() for end in ends):
            raise ParameterError("only", f"must hold numbers and ranges like 1-4,7, got {text!r}")
        first, last = int(ends[0]), int(ends[-1])
        if first > last:
            raise ParameterError("only", f"must hold ascending ranges, got {part.strip()!r}")
        for end in (first, last):
            _check_known(end)
        named.update(range(first, last + 1))
    return sorted(named)


def _check_known(number: int) -> None:
    if number in FIGURES or number in LEFT_OUT:
        return
    raise ParameterError("only", f"must name figures from 1-8,10-27, got {number}")


def run(folder: Path, chosen: Sequence[int]) -> list[Check]:
    """Write figNN.png and figNN.csv of the chosen figures into `folder`; return the checks.

    Raises:
        ParameterError: if all the chosen figures are left out.
    """
    mpl.use("Agg")
    drawn = [number for number in chosen if number in FIGURES]
    if not drawn:
        raise ParameterError("only", "; ".join(left_out(chosen)))
    folder.mkdir(parents=True, exist_ok=True)
    checks: list[Check] = []
    for number in drawn:
        redrawn = FIGURES[number]()
        save_figure(redrawn.figure, folder / f"fig{number:02d}.png")
        write_columns(folder / f"fig{number:02d}.csv", redrawn.curves.columns())
        plt.close(redrawn.figure)
        checks += redrawn.checks
    return checks


def left_out(chosen: Sequence[int]) -> list[str]:
    """Return a sentence for each chosen figure that is not redrawn."""
    return [
        f"Fig. {number}, {LEFT_OUT[number]}, is not redrawn"
        for number in chosen
        if number in LEFT_OUT
    ]
