"""Mode shapes on a mesh as files of VTK."""

from __future__ import annotations

import os
from collections.abc import Iterator, Sequence
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from asperity._base import arrays
from asperity._base.arrays import Array
from asperity._base.storage.files import atomic
from asperity.errors import DimensionError, ParameterError
from asperity.steady_sliding.linearised.pencil import Complex

# VTK's number of a cell by its number of nodes: vertex, tetrahedra, pyramid, wedges and hexahedra.
_CELLS = {1: 1, 4: 10, 5: 14, 6: 13, 8: 12, 10: 24, 15: 26, 20: 25}


def write_vtk(
    path: str | os.PathLike[str],
    modes: Complex,
    names: list[str],
    coordinates: ArrayLike,
    positions: ArrayLike,
    cells: ArrayLike | Sequence[ArrayLike] | None,
) -> None:
    """Write real and imaginary parts of modes as vectors at the nodes."""
    places = arrays.array(positions, "positions", (None, 3))
    numbers = _whole(arrays.array(coordinates, "coordinates", (len(places), 3)), "coordinates")
    if numbers.max(initial=-1) >= len(modes) or numbers.min(initial=0) < -1:
        raise ParameterError(
            "coordinates", f"must be numbers below {len(modes)}, or −1 where a node is held"
        )
    blocks = [_block(one, len(places)) for one in _blocks(cells, len(places))]
    # A row of zeros for coordinates that are held.
    moved = np.concatenate([modes, np.zeros((1, modes.shape[1]))])[numbers]
    with atomic(path) as file:
        for line in _lines(places, blocks, moved, names):
            file.write(f"{line}\n".encode("ascii"))


def _blocks(cells: Any, nodes: int) -> Sequence[ArrayLike]:
    """Return the cells of each kind; the nodes themselves where there are none."""
    if cells is None:
        return [np.arange(nodes)[:, None]]
    several = isinstance(cells, list | tuple) and all(np.ndim(one) == 2 for one in cells)
    return cells if several else [cells]


def _block(cells: ArrayLike, count: int) -> NDArray[np.intp]:
    listed = arrays.array(cells, "cells")
    if listed.ndim != 2 or listed.shape[1] not in _CELLS:
        kinds = ", ".join(str(count) for count in _CELLS)
        raise DimensionError("cells", f"must have one of {kinds} nodes each")
    nodes = _whole(listed, "cells")
    if nodes.max(initial=0) >= count or nodes.min(initial=0) < 0:
        raise ParameterError("cells", f"must name nodes from 0 to {count - 1}")
    return nodes


def _whole(values: Array, argument: str) -> NDArray[np.intp]:
    if (values != np.floor(values)).any():
        raise ParameterError(argument, "must be whole numbers")
    return values.astype(np.intp)


def _lines(
    places: Array, blocks: list[NDArray[np.intp]], moved: Complex, names: list[str]
) -> Iterator[str]:
    yield "# vtk DataFile Version 3.0\nMode shapes by asperity\nASCII\nDATASET UNSTRUCTURED_GRID"
    yield f"POINTS {len(places)} double"
    yield from _rows(places)
    count = sum(map(len, blocks))
    yield f"CELLS {count} {count + sum(nodes.size for nodes in blocks)}"
    for nodes in blocks:
        yield from (f"{len(row)} {' '.join(map(str, row))}" for row in nodes.tolist())
    yield f"CELL_TYPES {count}"
    for nodes in blocks:
        yield from [str(_CELLS[nodes.shape[1]])] * len(nodes)
    yield f"POINT_DATA {len(places)}"
    for k, name in enumerate(names):
        for part, values in (("real", moved[..., k].real), ("imaginary", moved[..., k].imag)):
            yield f"VECTORS {name}_{part} double"
            yield from _rows(values)


def _rows(values: Array) -> Iterator[str]:
    return (" ".join(map(repr, row)) for row in values.tolist())
