"""Files of results: an archive of arrays with a text that says what they are.

A result is what a computation has given. Each entry of the archive is therefore compared with the
digest that was written with it: what somebody has changed is refused by its name, and need not be
told from what the computation gives.
"""

from __future__ import annotations

import hashlib
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
        from asperity import __version__

        arrays: dict[str, Any] = {}
        text = json.dumps(data.typed(self, "", self._known(), arrays), ensure_ascii=False)
        entries = {"content": np.asarray(text), **arrays}
        digests = json.dumps({key: _digest(entry) for key, entry in entries.items()})
        with atomic(path) as file:
            np.savez_compressed(
                file, format=FORMAT, version=__version__, digests=np.asarray(digests), **entries
            )

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
            for key in ("format", "content", "digests"):
                if key not in file:
                    raise ParameterError(key, f"is missing: {file.path} must be a {cls.__name__}")
            number = file["format"]
            if number.shape or number.dtype.kind != "i" or not 1 <= int(number) <= FORMAT:
                raise ParameterError("format", f"must be {FORMAT} or older, in {file.path}")
            entries = {key: file[key] for key in file.keys if key not in _HEAD}
            try:
                _compare(entries, _parsed(file["digests"], "digests"))
                return cls._made(_parsed(entries.pop("content"), "content"), entries)
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


_HEAD = ("format", "version", "digests")


def _digest(entry: NDArray[Any]) -> str:
    kind = f"{entry.dtype.str}{entry.shape}".encode()
    return hashlib.blake2b(kind + np.ascontiguousarray(entry).tobytes(), digest_size=16).hexdigest()


def _compare(entries: dict[str, NDArray[Any]], digests: Any) -> None:
    """Refuse entries that are not those that were written."""
    if not isinstance(digests, dict):
        raise ParameterError("digests", "must be the text that asperity writes")
    for key in digests:
        if key not in entries:
            raise ParameterError(key, "is missing")
    for key, entry in entries.items():
        if key not in digests:
            raise ParameterError(key, "is no part of it")
        if _digest(entry) != digests[key]:
            raise ParameterError(key, "is not as it was written")


def _parsed(text: NDArray[Any], key: str) -> Any:
    if text.shape or text.dtype.kind != "U":
        raise ParameterError(key, "must be one text")
    try:
        return json.loads(str(text))
    except (ValueError, RecursionError) as error:
        raise ParameterError(key, f"must be the text that asperity writes: {error}") from None
