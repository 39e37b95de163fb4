"""Tables of data beside the figures."""

from __future__ import annotations

import csv
import io
from collections.abc import Iterable, Mapping, Sequence
from pathlib import Path

import numpy as np

from asperity._arrays import Array
from asperity._files import atomic


class Curves:
    """Labelled points of a figure, in long form: panel, curve, x, y.

    >>> import numpy as np
    >>> from asperity.paper.data import Curves
    >>> curves = Curves()
    >>> curves.add("a", "bdry C", np.array([[1.0, 2.0]]))
    >>> curves.columns()
    {'panel': ['a'], 'curve': ['bdry C'], 'x': [1.0], 'y': [2.0]}
    """

    def __init__(self, coordinates: Sequence[str] = ("x", "y")) -> None:
        self._coordinates = coordinates
        self._labels: list[tuple[str, str]] = []
        self._points: list[Array] = []

    def add(self, panel: str, curve: str, points: Array) -> None:
        """Append the points ``(n, k)`` of a curve; k is the number of coordinates."""
        self._points.append(np.asarray(points).reshape(-1, len(self._coordinates)))
        self._labels += [(panel, curve)] * len(self._points[-1])

    def columns(self) -> dict[str, list[str] | list[float]]:
        """Return the columns by name."""
        panels, names = zip(*self._labels, strict=True)
        points = np.vstack(self._points).T.tolist()
        return {
            "panel": list(panels),
            "curve": list(names),
            **dict(zip(self._coordinates, points, strict=True)),
        }


def write_csv(target: Path, columns: Mapping[str, Iterable[object]]) -> None:
    """Write columns of one length; the file is complete or not there."""
    text = io.StringIO(newline="")
    writer = csv.writer(text, lineterminator="\n")
    writer.writerow(columns)
    writer.writerows(zip(*columns.values(), strict=True))
    with atomic(target) as file:
        file.write(text.getvalue().encode())
