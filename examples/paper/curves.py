"""The data of a figure: points of its lines and tails and vectors of its arrows, by panel."""

import csv
from collections import defaultdict
from collections.abc import Iterable, Sequence
from pathlib import Path
from typing import Any

import numpy as np
from matplotlib.artist import Artist
from matplotlib.contour import ContourSet
from matplotlib.figure import Figure
from matplotlib.quiver import Quiver
from paper.drawing import Array

Curve = tuple[str, str, Array]
"""Panel, name, and an array of points (x, y) or (x, y, z), or of arrows (x, y, dx, dy)."""


def named(name: str, artists: Iterable[Artist]) -> None:
    """Give lines and arrows the name that they have in the table."""
    for artist in artists:
        artist.set_gid(name)


def drawn_curves(figure: Figure) -> list[Curve]:
    """Return lines, contours and arrows that have a name or, lines, a label.

    Those of one name in a panel are numbered. The titles of panels begin with (a), (b), …; NaN,
    which interrupts a line, is left out.
    """
    lines: dict[tuple[str, str], list[Array]] = defaultdict(list)
    arrows: list[Curve] = []
    for ax in figure.axes:
        title = ax.get_title("left") or ax.get_title()
        line: Any
        for line in ax.lines:
            name = line.get_gid() or str(line.get_label()).replace("$", "")
            # Lines across the whole panel have coordinates of their own.
            if not name.startswith("_") and line.get_transform() == ax.transData:
                space = ax.name == "3d"
                points = np.column_stack(line.get_data_3d() if space else line.get_data(orig=True))
                lines[title[1], name].append(points[np.isfinite(points).all(axis=1)])
        for one in ax.collections:
            name = one.get_gid() or ""
            if isinstance(one, Quiver) and name:
                vectors = np.column_stack([np.asarray(one.get_offsets()), one.U, one.V])
                arrows.append((title[1], name, vectors))
            if isinstance(one, ContourSet) and name:
                lines[title[1], name] += [np.asarray(path.vertices) for path in one.get_paths()]
    numbered = [
        (panel, name if len(several) == 1 else f"{name} {k}", points)
        for (panel, name), several in lines.items()
        for k, points in enumerate(several, start=1)
    ]
    return numbered + arrows


def write_curves(path: Path, curves: Sequence[Curve]) -> None:
    """Write panel, curve, x, y, dx, dy in long form; and z, if there are points in space."""
    space = ["z"] if any(values.shape[1] == 3 for _, _, values in curves) else []
    header = ["panel", "curve", "x", "y", *space, "dx", "dy"]
    with path.open("w", newline="", encoding="utf-8") as file:
        table = csv.DictWriter(file, header)
        table.writeheader()
        for panel, name, values in curves:
            columns = ("x", "y", "dx", "dy") if values.shape[1] == 4 else ("x", "y", "z")
            for row in values.tolist():
                numbers = dict(zip(columns, row, strict=False))
                table.writerow({"panel": panel, "curve": name, **numbers})
