"""Tables of data beside the figures."""

from __future__ import annotations

import csv
from collections.abc import Sequence
from pathlib import Path

import numpy as np

from paper.drawing import Array


class Curves:
    """Labelled points and arrows of a figure, in long form: panel, curve, x, y, dx, dy.

    An arrow leads from (x, y) to (x + dx, y + dy), a point has neither dx nor dy. Figures with
    points in space have a column z besides.
    """

    def __init__(self, coordinates: Sequence[str] = ("x", "y")) -> None:
        self._names = ("panel", "curve", *coordinates, "dx", "dy")
        self._empty: dict[str, str | float | None] = dict.fromkeys(self._names)
        self._rows: list[dict[str, str | float | None]] = []

    def add(self, panel: str, curve: str, points: Array) -> None:
        """Append the points of a curve, ``(n, 2)`` or ``(n, 3)``."""
        self._append(panel, curve, "xyz", np.atleast_2d(points))

    def add_arrows(self, panel: str, curve: str, tails: Array, vectors: Array) -> None:
        """Append plane arrows; tails and vectors have the shape ``(n, 2)``."""
        self._append(panel, curve, ("x", "y", "dx", "dy"), np.hstack([tails, vectors]))

    def _append(self, panel: str, curve: str, names: Sequence[str], values: Array) -> None:
        for row in values.tolist():
            numbers = dict(zip(names, row, strict=False))
            self._rows.append({**self._empty, "panel": panel, "curve": curve, **numbers})

    def write(self, path: Path) -> None:
        """Write a table."""
        columns = self.columns()
        with path.open("w", newline="", encoding="utf-8") as file:
            csv.writer(file).writerows([list(columns), *zip(*columns.values(), strict=True)])

    def columns(self) -> dict[str, list[str | float | None]]:
        """Return the columns by name."""
        return {name: [row[name] for row in self._rows] for name in self._names}
