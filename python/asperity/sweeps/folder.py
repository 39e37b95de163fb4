"""The store of a sweep in a folder: a zarr group, which anyone can open while it grows.

A chunk of points is a file of every array. Whatever files hold beyond the chunks whose status is
written is computed and written again. That the arrays of results are all there is said by the list
of arrays in the metadata of the group.
"""

from __future__ import annotations

import hashlib
import json
import math
import os
import shutil
import time
import warnings
from collections.abc import Iterable, Iterator, Mapping, Sequence
from contextlib import contextmanager, suppress
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from asperity._base.extras import library
from asperity._base.log import log
from asperity._base.storage.files import atomic, replaced
from asperity.errors import ParameterError
from asperity.sweeps.grid import Block, Grid
from asperity.sweeps.outputs import NO_FLAG, Output, Schema
from asperity.sweeps.store import DONE, FAILED, MISSING, STATUS_ATTRIBUTES, Line, Store
from asperity.sweeps.task import Answer

if TYPE_CHECKING:
    import xarray

SESSION, STATUS_FILES = "session.json", "c*"
"""When work was last begun, and the chunks of the status."""

_MESSAGES = "failures.jsonl"
_FORMAT = 1
_FEW = 5
# Chunks are files of one folder, as they are in memory: compressed and written by zarr itself they
# take 0.9 ms each, against 0.1 ms.
_PLAIN = {"compressors": None, "chunk_key_encoding": {"name": "default", "separator": "."}}


class Folder(Store):
    """A sweep in a folder.

    Args:
        path: of the folder, which is made unless it exists.
        grid: of the points.
        size: of chunks, if the folder is new.
        facts: what is said of the sweep, and must be the same if it exists.
        units: of results.

    Raises:
        ParameterError: naming `store` and what differs, or what is damaged.
        OSError: naming the folder, if it cannot be made.
    """

    def __init__(
        self,
        path: Path,
        grid: Grid,
        *,
        size: tuple[int, ...],
        facts: Mapping[str, Any],
        units: Mapping[str, str],
    ) -> None:
        self._path = path
        if not path.exists():
            _make_group(path, grid, size, facts)
        zarr = library("zarr", extra="sweep")
        try:
            self._group = zarr.open_group(path, mode="r+")
            self._check(grid, facts)
            status = self._group["status"]
            super().__init__(grid, size=tuple(status.chunks), facts=facts, units=units)
            self.status = np.array(status[...])
            if not np.isin(self.status, (MISSING, DONE, FAILED)).all():
                raise ValueError("the status of points is none of those there are")
            self.schema = self._stored_schema()
            if self.schema is not None:
                self._check_units(self.schema)
        except ParameterError:
            raise
        except Exception as error:
            # Decoders of other or damaged files raise errors of any class.
            raise ParameterError(
                "store", f"must hold a sweep, {path} does not or is damaged: {error}"
            ) from error
        self._arrays = {name: self._group[name] for name in self.schema or ()}
        self._forget_lost_results()

    def begin(self, wanted: Sequence[int]) -> bool:
        """Return whether points of some status are left; write down when work on them begins.

        Raises:
            ParameterError: if the folder cannot be written into.
        """
        left = super().begin(wanted)
        if self.known:
            log.info(
                "sweep: of %d points, %d are taken from the store %s, which asperity %s began; "
                "files beside that of the function were not compared",
                self.status.size,
                self.known,
                self._path,
                self._group.attrs.get("asperity"),
            )
        if left:
            if not os.access(self._path, os.W_OK | os.X_OK):
                raise ParameterError(
                    "store", f"must be a folder to write into, {self._path} does not allow it"
                )
            facts = {"started": time.time(), "points": self.known}
            with self._named(), atomic(self._path / SESSION) as file:
                file.write(json.dumps(facts).encode())
        return left

    def commit(self, block: Block, answer: Answer) -> None:
        """Write the results of a chunk, then messages, then the status.

        Raises:
            OSError: naming the folder, if it cannot be written; it can be gone on with.
        """
        with self._named():
            super().commit(block, answer)

    @contextmanager
    def _named(self) -> Iterator[None]:
        """Say which store it is about where it cannot be written."""
        try:
            yield
        except OSError as error:
            if error.errno is None:
                raise
            raise OSError(error.errno, error.strerror, os.fspath(self._path)) from error

    def _forget_lost_results(self) -> None:
        """Take chunks for missing whose results are, and say so.

        The status of a chunk is written last, so that the files of its results were there.
        """
        lost = []
        for name, array in self._arrays.items():
            if not array.size:
                continue
            with self._named():
                sizes = {one.name: one.stat().st_size for one in os.scandir(self._path / name)}
            whole = math.prod(array.chunks) * array.dtype.itemsize
            for block in self.chunks:
                if not (self.status[block] == DONE).any():
                    continue
                key = _key(self._starts(block), array)
                if sizes.get(key) != whole:
                    lost.append((block, f"{name}/{key}"))
        for block, _ in lost:
            # The whole chunk, failures too: nothing of a damaged file is then kept.
            self.status[block] = MISSING
        self.known = int(np.count_nonzero(self.status))
        if lost:
            warnings.warn(
                f"the store {self._path} has missing or damaged results: "
                f"{_enumerated([file for _, file in lost])}; their points count as missing",
                RuntimeWarning,
                stacklevel=4,
            )

    def _add_lines(self, lines: Iterable[Line]) -> None:
        text = "".join(f"{json.dumps(line)}\n" for line in lines)
        if text:
            with (self._path / _MESSAGES).open("ab") as file:
                # What a process that was killed has not finished is a line of its own.
                file.write(f"\n{text}".encode())

    def _failed_lines(self) -> Iterator[Line]:
        if (self._path / _MESSAGES).exists():
            with (self._path / _MESSAGES).open(encoding="utf-8", errors="replace") as file:
                for text in file:
                    with suppress(ValueError):
                        line = json.loads(text)
                        if isinstance(line, dict) and {"index", "message"} <= line.keys():
                            yield line

    def _make(self, schema: Schema) -> None:
        try:
            self.schema = schema
            self._make_arrays(schema)
        except BaseException:
            # Arrays that are not listed are none: readers would look for them.
            self.schema = None
            raise

    def _make_arrays(self, schema: Schema) -> None:
        lengths, chunks = self._lengths(), list(self._lengths())
        for name, size in zip(self._grid.names, self.chunks.size, strict=True):
            chunks[list(self._grid.axes).index(name)] = size
        for name, output in schema.items():
            extra = self._extra(output)
            self._arrays[name] = self._group.create_array(
                name,
                shape=(*lengths, *extra),
                # Of a result without any number, nothing is written.
                chunks=(*chunks, *(max(n, 1) for n in extra)),
                dtype=output.dtype,
                fill_value=output.nothing,
                dimension_names=self._dimensions(name, output),
                attributes=self._attributes(name),
                # Of a process that was killed before the list was written.
                overwrite=True,
                **_PLAIN,
            )
        _list_arrays(self._group)

    def _write(self, name: str, block: Block, values: NDArray[Any]) -> None:
        if values.size:
            self._put(name, self._starts(block), self._arrays[name], values)

    def _starts(self, block: Block) -> tuple[int, ...]:
        """Return where a chunk begins along all axes."""
        return tuple(part.start or 0 for part in self._whole(block))

    def _write_status(self, block: Block, status: NDArray[np.int8]) -> None:
        self._put("status", tuple(part.start for part in block), self._group["status"], status)

    def _written_status(self, block: Block) -> NDArray[np.int8]:
        return np.asarray(self._group["status"][block])

    def _put(self, name: str, starts: tuple[int, ...], array: Any, values: NDArray[Any]) -> None:
        """Write a chunk as zarr would: its bytes, in a file that is replaced."""
        chunk = np.full(array.chunks, array.fill_value, array.dtype.newbyteorder("<"))
        chunk[tuple(slice(n) for n in values.shape)] = values
        with replaced(self._path / name / _key(starts, array)) as temporary:
            temporary.write_bytes(chunk.tobytes())

    def _labelled(self) -> xarray.Dataset:
        """Return arrays that are read when they are used."""
        dataset: xarray.Dataset = library("xarray", extra="sweep").open_zarr(
            self._path, chunks=None
        )
        return dataset[[*(self.schema or ()), "status"]]

    def _stored_schema(self) -> Schema | None:
        """Return what the listed arrays hold, None if there are no results yet."""
        schema: Schema = {}
        # In an order that does not depend on the release of zarr: warnings name what is first.
        for name, array in sorted(self._group.arrays(), key=lambda one: str(one[0])):
            if name == "status" or name in self._grid.axes:
                continue
            shape = (*self._grid.vector_shape, *array.shape[len(self._grid.axes) :])
            numbers = array.attrs.get("flag_values", ())
            words = array.attrs.get("flag_meanings", "").split()
            meanings = tuple(one for one in zip(numbers, words, strict=True) if one[0] != NO_FLAG)
            kinds = [Output("real"), Output("complex"), Output("flag")]
            kind = next(one.kind for one in kinds if one.dtype == array.dtype)
            schema[name] = Output(kind, shape, meanings)
        return schema or None

    def _check(self, grid: Grid, facts: Mapping[str, Any]) -> None:
        """Refuse a group of something else."""
        if self._group.attrs.get("sweep") != _FORMAT:
            raise ParameterError(
                "store", f"must be new or hold a sweep of this format, {self._path} does not"
            )
        differing = [*_other_axes(self._group, grid), *_other_facts(self._group.attrs, facts)]
        if differing:
            raise ParameterError(
                "store", f"{self._path} holds another sweep. It differs in {'; '.join(differing)}"
            )


def folder_of(store: Any) -> Path:
    """Return the folder of a store.

    Raises:
        ParameterError: naming `store`, if it names none.
    """
    # An empty path would be the working folder.
    if not isinstance(store, str | os.PathLike) or not os.fspath(store):
        raise ParameterError("store", f"must name a folder, got {store!r}")
    return Path(store)


def _key(starts: Sequence[int], array: Any) -> str:
    """Return the name of the file of a chunk, which holds whole results."""
    places = (*starts, *[0] * (array.ndim - len(starts)))
    numbers = (start // size for start, size in zip(places, array.chunks, strict=True))
    return ".".join(["c", *map(str, numbers)])


def _enumerated(files: Sequence[str]) -> str:
    few = ", ".join(files[:_FEW])
    return few if len(files) <= _FEW else f"{few} and {len(files) - _FEW} more"


def _make_group(path: Path, grid: Grid, size: tuple[int, ...], facts: Mapping[str, Any]) -> None:
    """Make a folder with coordinates and status; once it has its name it is complete."""
    zarr = library("zarr", extra="sweep")
    path.parent.mkdir(parents=True, exist_ok=True)
    with replaced(path) as temporary:
        try:
            group = zarr.create_group(temporary, attributes={"sweep": _FORMAT, **facts})
            for name, values in grid.axes.items():
                group.create_array(
                    name,
                    shape=values.shape,
                    # Texts of one length have no specification in zarr yet.
                    dtype=str if values.dtype.kind == "U" else values.dtype,
                    dimension_names=(name,),
                    attributes=grid.attributes(name),
                )[...] = values
            group.create_array(
                "status",
                shape=grid.shape,
                chunks=size,
                dtype="int8",
                fill_value=MISSING,
                dimension_names=grid.names,
                attributes=STATUS_ATTRIBUTES,
                **_PLAIN,
            )
            _list_arrays(group)
        except BaseException:
            shutil.rmtree(temporary, ignore_errors=True)
            raise


def _list_arrays(group: Any) -> None:
    """Write down which arrays the group has; readers then need not look for them."""
    with warnings.catch_warnings():
        # The list is not yet part of the third version of the format.
        warnings.simplefilter("ignore")
        library("zarr", extra="sweep").consolidate_metadata(group.store)


def _other_axes(group: Any, grid: Grid) -> Iterator[str]:
    names = group["status"].metadata.dimension_names or ()
    stored = [name for name, array in group.arrays() if array.metadata.dimension_names == (name,)]
    if sorted(stored) != sorted(grid.axes) or tuple(names) != grid.names:
        yield f"the axes: {', '.join(stored)} there, {', '.join(grid.axes)} here"
        return
    for name, mine in grid.axes.items():
        theirs, unit = np.asarray(group[name][...]), group[name].attrs.get("units")
        if len(theirs) != len(mine):
            yield f"axis {name}: {len(theirs)} values there, {len(mine)} here"
        elif theirs.tolist() != mine.tolist():
            first = next(i for i, value in enumerate(theirs) if value != mine[i])
            yield f"axis {name}: {theirs[first]} there, {mine[first]} here"
        elif unit != grid.units.get(name):
            yield f"unit of {name}: {unit} there, {grid.units.get(name)} here"


def _other_facts(stored: Mapping[str, Any], facts: Mapping[str, Any]) -> Iterator[str]:
    for name, mine in facts.items():
        theirs = stored.get(name)
        if name == "asperity" and _series(theirs) == _series(mine):
            continue
        if name != "fingerprint" and theirs != mine:
            advice = " (the function or another part of its file)" * (name == "source")
            yield f"{name}: {theirs} there, {mine} here{advice}"


def _series(version: Any) -> list[str]:
    """Return what releases share that only mend errors, such as 0.2.0 and 0.2.1."""
    return str(version).split(".")[:2]


def fingerprint(grid: Grid, facts: Mapping[str, Any]) -> str:
    """Return a hash of the grid, the function and the options."""
    compared = {**facts, "asperity": _series(facts["asperity"])}
    whole = hashlib.sha256(json.dumps(compared, sort_keys=True).encode())
    for name, values in grid.axes.items():
        whole.update(f"{name} {grid.units.get(name)} {values.tolist()!r}".encode())
    return whole.hexdigest()
