"""Tables of data beside the figures."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from asperity._base.arrays import Array


class Curves:
    """Labelled points and arrows of a figure, in long form: panel, curve, x, y, dx, dy.

    An arrow leads from (x, y) to (x + dx, y + dy), a point has neither dx nor dy. Figures with
    points in space have a column z besides.

    >>> import numpy as np
    >>> from asperity.paper.data import Curves
    >>> curves = Curves()
    >>> curves.add("a", "bdry C", np.array([[1.0, 2.0]]))
    >>> curves.add_arrows("a", "force", np.zeros((1, 2)), np.array([[3.0, 4.0]]))
    >>> list(curves.columns().items())[1:4]
    [('curve', ['bdry C', 'force']), ('x', [1.0, 0.0]), ('y', [2.0, 0.0])]
    >>> list(curves.columns().items())[4:]
    [('dx', [None, 3.0]), ('dy', [None, 4.0])]
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

    def columns(self) -> dict[str, list[str | float | None]]:
        """Return the columns by name."""
        return {name: [row[name] for row in self._rows] for name in self._names}
