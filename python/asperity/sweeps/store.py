"""What is known of a sweep: a status for every point, and the arrays of results.

The process that hands out the tasks is the only one that writes: results, then messages, then the
status of a chunk, which is the commit.
"""

from __future__ import annotations

import math
from collections.abc import Iterable, Iterator, Mapping, Sequence
from contextlib import suppress
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from asperity._base.extras import library
from asperity._base.storage.toml import advice_on
from asperity.errors import ParameterError
from asperity.sweeps.grid import Block, Chunks, Grid, block_shape, index_in
from asperity.sweeps.outputs import NO_FLAG, Output, Schema
from asperity.sweeps.task import Answer

if TYPE_CHECKING:
    import xarray

MISSING, DONE, FAILED = 0, 1, 2
"""Status of a point."""

STATUS_ATTRIBUTES = {
    "flag_values": [MISSING, DONE, FAILED],
    "flag_meanings": "missing done failed",
    "long_name": "what is known of the points",
}
_NO_WORD = "no_result"
Line = dict[str, Any]
"""Of a point that failed: ``index``, ``point`` by name, ``error``, ``message``, ``traceback``."""


class Store:
    """A sweep in memory; in a folder, see `Folder`.

    Args:
        grid: of the points.
        size: of chunks.
        facts: what is said of the sweep.
        units: of results.
    """

    def __init__(
        self,
        grid: Grid,
        *,
        size: tuple[int, ...],
        facts: Mapping[str, Any],
        units: Mapping[str, str],
    ) -> None:
        self._grid, self._facts, self._units = grid, facts, units
        self._lines: list[Line] = []
        self._arrays: dict[str, Any] = {}
        self.chunks = Chunks(grid.shape, size)
        self.schema: Schema | None = None
        self.status = np.full(grid.shape, MISSING, np.int8)
        self.known = 0
        self._last: Block | None = None

    def missing(self, wanted: Sequence[int]) -> Iterator[tuple[Block, Sequence[int]]]:
        """Yield the chunks that hold points of some status, and the places of these in them."""
        for block in self.chunks:
            places = np.flatnonzero(np.isin(self.status[block], wanted))
            if places.size:
                whole = places.size == math.prod(block_shape(block))
                yield block, range(places.size) if whole else places.tolist()

    def begin(self, wanted: Sequence[int]) -> bool:
        """Return whether points of some status are left; say so where others look."""
        return bool(np.isin(self.status, wanted).any())

    def commit(self, block: Block, answer: Answer) -> None:
        """Write the results of a chunk, then messages, then the status."""
        if self.schema is None and answer.schema is not None:
            self._check_units(answer.schema)
            self._make(answer.schema)
            self.schema = answer.schema
        if self.schema is not None:
            answer = answer.fitted(self.schema)
            for name, values in answer.arrays.items():
                self._write(name, block, self._laid_out(name, block, values, answer))
        self._add_lines(
            {
                "index": index,
                "point": self._grid.point(index),
                "error": why.error,
                "message": str(why),
                "traceback": why.traceback,
            }
            for i, why in answer.failures.items()
            for index in [index_in(block, i)]
        )
        status = self.status[block].reshape(-1).copy()
        status[answer.places] = DONE
        status[list(answer.failures)] = FAILED
        self._last = block
        self._write_status(block, status.reshape(block_shape(block)))
        self.known += int(np.count_nonzero(status)) - int(np.count_nonzero(self.status[block]))
        self.status[block] = status.reshape(block_shape(block))

    def _check_units(self, schema: Schema) -> None:
        """Refuse units of what is neither an axis nor a result, once results are known."""
        known = [*self._grid.axes, *schema]
        for name in self._units:
            if name not in known:
                advice = advice_on(name, known)
                raise ParameterError("units", f"{name!r} is neither an axis nor a result{advice}")

    def settle(self) -> None:
        """Count what is written, where Ctrl-C may have come between a commit and its count."""
        if self._last is not None:
            self.status[self._last] = self._written_status(self._last)
        self.known = int(np.count_nonzero(self.status))

    def dataset(self) -> xarray.Dataset:
        """Return what is known, with the messages of failures."""
        message = np.full(self._grid.shape, "", dtype=object)
        for line in self._failed_lines():
            # A line that is damaged may name any point.
            with suppress(IndexError, TypeError):
                index = tuple(line["index"])
                if self.status[index] == FAILED:
                    message[index] = str(line["message"])
        words = {"long_name": "why points failed"}
        return self._labelled().assign(message=(self._grid.names, message, words))

    def _add_lines(self, lines: Iterable[Line]) -> None:
        """Keep why points failed, before the chunk is committed."""
        self._lines.extend(lines)

    def _failed_lines(self) -> Iterable[Line]:
        return self._lines

    def _make(self, schema: Schema) -> None:
        """Make the arrays of results."""
        for name, output in schema.items():
            shape = (*self._lengths(), *self._extra(output))
            self._arrays[name] = np.full(shape, output.nothing, output.dtype)

    def _write(self, name: str, block: Block, values: NDArray[Any]) -> None:
        self._arrays[name][self._whole(block)] = values

    def _write_status(self, block: Block, status: NDArray[np.int8]) -> None:
        """Commit a chunk, where others see it."""

    def _written_status(self, block: Block) -> NDArray[np.int8]:
        """Return what others see of a chunk."""
        return self.status[block]

    def _labelled(self) -> xarray.Dataset:
        """Return arrays with the names of their axes."""
        variables = {
            name: (self._dimensions(name, output), self._arrays[name], self._attributes(name))
            for name, output in (self.schema or {}).items()
        }
        variables["status"] = (self._grid.names, self.status, STATUS_ATTRIBUTES)
        coordinates = {
            name: (name, values, self._grid.attributes(name))
            for name, values in self._grid.axes.items()
        }
        dataset: xarray.Dataset = library("xarray", extra="sweep").Dataset(
            variables, coordinates, dict(self._facts)
        )
        return dataset

    def _lengths(self) -> tuple[int, ...]:
        return tuple(len(values) for values in self._grid.axes.values())

    def _extra(self, output: Output) -> tuple[int, ...]:
        """Return the shape of a result without axes of the grid."""
        return output.shape[len(self._grid.vector) :]

    def _dimensions(self, name: str, output: Output) -> tuple[str, ...]:
        taken = {*self._grid.axes, *(self.schema or ())}
        names = []
        for k in range(len(self._extra(output))):
            one = f"{name}_{k}"
            while one in taken:
                one += "_"
            names.append(one)
        return (*self._grid.axes, *names)

    def _attributes(self, name: str) -> dict[str, Any]:
        """Return unit and meanings of a result."""
        output, unit = (self.schema or {})[name], self._units.get(name, "")
        attributes: dict[str, Any] = {"units": unit} if unit else {}
        if output.words:
            words = ((NO_FLAG, _NO_WORD), *output.words)
            attributes["flag_values"] = [number for number, _ in words]
            attributes["flag_meanings"] = " ".join(word for _, word in words)
        return attributes

    def _whole(self, block: Block) -> Block:
        """Return the ranges of a chunk along all axes, those that are handed over whole, too."""
        parts = dict(zip(self._grid.names, block, strict=True))
        return tuple(parts.get(name, slice(None)) for name in self._grid.axes)

    def _laid_out(
        self, name: str, block: Block, values: NDArray[Any], answer: Answer
    ) -> NDArray[Any]:
        """Return results ``(n, …)`` of a chunk with axes in the order of the grid.

        Axes that are handed over whole come behind the others in what workers return.
        """
        order = (*self._grid.names, *self._grid.vector)
        moved = [order.index(one) for one in self._grid.axes]
        rest = range(len(order), len(order) + values.ndim - 1 - len(self._grid.vector))
        if len(answer.places) < answer.count:
            old = np.asarray(self._arrays[name][self._whole(block)])
            old = old.transpose(*np.argsort(moved), *rest).reshape(values.shape)
            values = np.array(values)
            others = np.setdiff1d(np.arange(answer.count), answer.places)
            values[others] = old[others]
        return values.reshape(*block_shape(block), *values.shape[1:]).transpose(*moved, *rest)
