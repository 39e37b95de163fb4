"""Files of results: an archive of arrays with a text that says what they are.

Each entry has its checksum, which reading compares.
"""

from __future__ import annotations

import json
import os
from typing import Any, Self

import numpy as np
from numpy.typing import NDArray

from asperity._base.result import TableResult
from asperity._base.storage import data
from asperity._base.storage.archive import Archive
from asperity._base.storage.data import Kinds
from asperity._base.storage.files import atomic
from asperity._core import __version__
from asperity.errors import ParameterError

FORMAT = 1
"""Number of the file layout."""


class SavedResult(TableResult):
    """Base of results that have files of their own."""

    @classmethod
    def _known(cls) -> Kinds:
        """Return all classes that the result is made of, by name."""
        raise NotImplementedError

    def save(self, path: str | os.PathLike[str]) -> None:
        """Write a NumPy ``.npz`` file without pickled objects, with the systems that are data.

        Args:
            path: of the file, which replaces an older one only when it is complete.
        """
        arrays: dict[str, Any] = {}
        text = json.dumps(data.typed(self, "", self._known(), arrays), ensure_ascii=False)
        head: dict[str, Any] = {
            "format": FORMAT,
            "version": __version__,
            "content": np.asarray(text),
        }
        with atomic(path) as file:
            np.savez_compressed(file, **head, **arrays)

    @classmethod
    def load(cls, path: str | os.PathLike[str]) -> Self:
        """Read a file written by `save`.

        Args:
            path: of the file.

        Raises:
            ParameterError: naming what is missing, damaged or of something else.
            FileNotFoundError: if there is none.
        """
        with Archive(path, f"a {cls.__name__} that this version can read") as file:
            for key in ("format", "content"):
                if key not in file:
                    raise ParameterError(key, f"is missing: {file.path} must be a {cls.__name__}")
                if key == "format" and not np.array_equal(file[key], FORMAT):
                    raise ParameterError(key, f"must be {FORMAT}, in {file.path}")
            entries = {key: file[key] for key in file.keys if key not in ("format", "version")}
            try:
                found = cls._made(_parsed(entries.pop("content"), "content"), entries)
                for key in entries:
                    raise ParameterError(key, "does not belong to it")
                return found
            except ParameterError as error:
                raise type(error)(error.argument, f"{error.message}, in {file.path}") from None

    @classmethod
    def _made(cls, table: Any, arrays: data.Arrays) -> Self:
        name = table.get("type") if isinstance(table, dict) else None
        if name != cls.__name__:
            raise ParameterError("content", f"must be of the type {cls.__name__}, is of {name!r}")
        found = data.built_as_typed(table, "", cls._known(), arrays)
        assert isinstance(found, cls)
        return found


def _parsed(text: NDArray[Any], key: str) -> Any:
    if text.shape or text.dtype.kind != "U":
        raise ParameterError(key, "must be one text")
    try:
        return json.loads(str(text))
    except (ValueError, RecursionError) as error:
        raise ParameterError(key, f"must be the text that asperity writes: {error}") from None
