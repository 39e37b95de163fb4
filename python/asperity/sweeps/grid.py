"""The grid of a sweep: named axes, and the chunks of points that are computed together."""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from asperity._base import arrays
from asperity.errors import DimensionError, ParameterError

Block = tuple[slice, ...]
"""A chunk of points: a range along every axis that is gone through point by point."""

RESERVED = ("status", "message")
"""Names of variables that every sweep has."""

# Few points make about two hundred chunks, which occupy many workers to the end; many points make
# chunks of five hundred, beside which handing over and writing (2 ms) do not count; and however
# many there are, four variables stay within ten thousand files.
_CHUNKS, _POINTS, _MOST_CHUNKS = 200, 500, 2500


@dataclass(frozen=True)
class Grid:
    """All combinations of values along named axes.

    Attributes:
        axes: values by name, one-dimensional.
        units: of the axes that have one.
        vector: names of the axes that are handed over whole.
    """

    axes: Mapping[str, NDArray[Any]]
    units: Mapping[str, str]
    vector: tuple[str, ...]

    @property
    def names(self) -> tuple[str, ...]:
        """Names of the axes that are gone through point by point."""
        return tuple(name for name in self.axes if name not in self.vector)

    @property
    def shape(self) -> tuple[int, ...]:
        """Lengths of the axes that are gone through point by point."""
        return tuple(len(self.axes[name]) for name in self.names)

    @property
    def points(self) -> int:
        """How often the function is called."""
        return math.prod(self.shape)

    @property
    def vector_shape(self) -> tuple[int, ...]:
        """Lengths of the axes that are handed over whole."""
        return tuple(len(self.axes[name]) for name in self.vector)

    def attributes(self, name: str) -> dict[str, str]:
        """Return those of the coordinate."""
        return {"units": self.units[name]} if name in self.units else {}

    def values(self, block: Block) -> tuple[NDArray[Any], ...]:
        """Return the values along the axes of a chunk."""
        return tuple(self.axes[name][part] for name, part in zip(self.names, block, strict=True))

    def point(self, index: Sequence[int]) -> dict[str, Any]:
        """Return the values of a point by its indices."""
        return {name: self.axes[name][i].item() for name, i in zip(self.names, index, strict=True)}


def block_shape(block: Block) -> tuple[int, ...]:
    """Return how many points a chunk has along every axis."""
    return tuple(part.stop - part.start for part in block)


def index_in(block: Block, place: int) -> list[int]:
    """Return the indices of a point of a chunk, in the order of its points.

    >>> from asperity.sweeps.grid import index_in
    >>> index_in((slice(2, 4), slice(10, 15)), 6)
    [3, 11]
    """
    offsets = np.unravel_index(place, block_shape(block)) if block else ()
    return [part.start + int(k) for part, k in zip(block, offsets, strict=True)]


def grid_of(grid: Any, vector: Any, units: Mapping[str, str]) -> Grid:
    """Return the grid that a user describes.

    Raises:
        ParameterError: naming `grid` and the axis, or `vector`.
    """
    if not isinstance(grid, Mapping) or not grid:
        raise ParameterError("grid", f"must hold values by names, got {grid!r}")
    axes = {name: _axis(name, values) for name, values in grid.items()}
    # Coordinates of xarray have their unit as an attribute.
    known = {
        name: str(values.attrs["units"])
        for name, values in grid.items()
        if "units" in getattr(values, "attrs", {})
    }
    wholes = (vector,) if isinstance(vector, str) else arrays.several(vector, "vector")
    for name in wholes:
        if name not in axes:
            raise ParameterError("vector", f"must name axes of the grid, got {name!r}")
    given = {name: unit for name, unit in units.items() if name in axes}
    return Grid(axes, {**known, **given}, tuple(name for name in axes if name in wholes))


def _axis(name: Any, values: Any) -> NDArray[Any]:
    if not isinstance(name, str) or not name.isidentifier() or name in RESERVED:
        raise ParameterError(
            "grid",
            f"must have names of parameters, other than {' and '.join(RESERVED)}, got {name!r}",
        )
    argument = f"grid[{name!r}]"
    arrays.refuse_masked(values, argument)
    raw = np.asarray(values)
    if raw.dtype.kind in "OT" and raw.size and all(isinstance(one, str) for one in raw.flat):
        raw = raw.astype(str)
    if raw.dtype.kind not in "iuU":
        raw = arrays.array(values, argument)
    if raw.ndim != 1 or not raw.size:
        raise DimensionError(argument, f"must have shape (n,) with n > 0, got {raw.shape}")
    if len(np.unique(raw)) < len(raw):
        raise ParameterError(argument, "must hold no value twice")
    return arrays.read_only(raw)


def chunk_shape(shape: Sequence[int], points: int) -> tuple[int, ...]:
    """Return the shape of chunks of about so many points, last axes first, of nearly equal sizes.

    >>> from asperity.sweeps.grid import chunk_shape
    >>> chunk_shape((1000, 501), 500), chunk_shape((40, 30), 100)
    ((1, 251), (3, 30))
    """
    sizes = [1] * len(shape)
    for k in range(len(shape) - 1, -1, -1):
        parts = math.ceil(shape[k] / max(1, points))
        sizes[k] = math.ceil(shape[k] / parts)
        points //= shape[k]
        if points <= 1:
            break
    return tuple(sizes)


def automatic_points(points: int) -> int:
    """Return how many points a chunk has unless the user says.

    >>> from asperity.sweeps.grid import automatic_points
    >>> [automatic_points(n) for n in (100, 10_000, 1_000_000, 10_000_000)]
    [1, 50, 500, 4000]
    """
    return max(min(math.ceil(points / _CHUNKS), _POINTS), math.ceil(points / _MOST_CHUNKS))


@dataclass(frozen=True)
class Chunks:
    """The chunks of a grid, numbered in the order of its points.

    Attributes:
        shape: of the grid.
        size: of a chunk; those at the ends of axes may be smaller.
    """

    shape: tuple[int, ...]
    size: tuple[int, ...]

    @property
    def counts(self) -> tuple[int, ...]:
        """How many there are along every axis."""
        return tuple(math.ceil(n / m) for n, m in zip(self.shape, self.size, strict=True))

    def __len__(self) -> int:
        return math.prod(self.counts)

    def __iter__(self) -> Iterator[Block]:
        for place in np.ndindex(*self.counts):
            yield tuple(
                slice(i * m, min((i + 1) * m, n))
                for i, m, n in zip(place, self.size, self.shape, strict=True)
            )
