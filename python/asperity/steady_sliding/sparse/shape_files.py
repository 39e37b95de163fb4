"""Mode shapes on a mesh as files of VTK."""

from __future__ import annotations

import os
from collections.abc import Iterator
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from asperity._base import arrays
from asperity._base.arrays import Array
from asperity._base.storage.files import atomic
from asperity.errors import DimensionError, ParameterError
from asperity.steady_sliding.linearised.pencil import Complex

# VTK's number of a cell by its number of nodes: vertex, tetrahedra, wedge and hexahedra.
_CELLS = {1: 1, 4: 10, 6: 13, 8: 12, 10: 24, 20: 25}


def write_vtk(
    path: str | os.PathLike[str],
    modes: Complex,
    names: list[str],
    coordinates: ArrayLike,
    positions: ArrayLike,
    cells: ArrayLike | None,
) -> None:
    """Write real and imaginary parts of modes as vectors at the nodes."""
    places = arrays.array(positions, "positions", (None, 3))
    numbers = _whole(arrays.array(coordinates, "coordinates", (len(places), 3)), "coordinates")
    if numbers.max(initial=-1) >= len(modes) or numbers.min(initial=0) < -1:
        raise ParameterError(
            "coordinates", f"must be numbers below {len(modes)}, or −1 where a node is held"
        )
    listed = arrays.array(np.arange(len(places))[:, None] if cells is None else cells, "cells")
    if listed.ndim != 2 or listed.shape[1] not in _CELLS:
        kinds = ", ".join(str(count) for count in _CELLS)
        raise DimensionError("cells", f"must have one of {kinds} nodes each")
    nodes = _whole(listed, "cells")
    if nodes.max(initial=0) >= len(places) or nodes.min(initial=0) < 0:
        raise ParameterError("cells", f"must name nodes from 0 to {len(places) - 1}")
    # A row of zeros for coordinates that are held.
    moved = np.concatenate([modes, np.zeros((1, modes.shape[1]))])[numbers]
    with atomic(path) as file:
        for line in _lines(places, nodes, moved, names):
            file.write(f"{line}\n".encode("ascii"))


def _whole(values: Array, argument: str) -> NDArray[np.intp]:
    if (values != np.floor(values)).any():
        raise ParameterError(argument, "must be whole numbers")
    return values.astype(np.intp)


def _lines(places: Array, nodes: NDArray[Any], moved: Complex, names: list[str]) -> Iterator[str]:
    count, each = nodes.shape
    yield "# vtk DataFile Version 3.0\nMode shapes by asperity\nASCII\nDATASET UNSTRUCTURED_GRID"
    yield f"POINTS {len(places)} double"
    yield from _rows(places)
    yield f"CELLS {count} {count * (each + 1)}"
    yield from (f"{each} {' '.join(map(str, row))}" for row in nodes.tolist())
    yield f"CELL_TYPES {count}"
    yield from [str(_CELLS[each])] * count
    yield f"POINT_DATA {len(places)}"
    for k, name in enumerate(names):
        for part, values in (("real", moved[..., k].real), ("imaginary", moved[..., k].imag)):
            yield f"VECTORS {name}_{part} double"
            yield from _rows(values)


def _rows(values: Array) -> Iterator[str]:
    return (" ".join(map(repr, row)) for row in values.tolist())
