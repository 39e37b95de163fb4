"""Files of results: an archive of arrays with a text that says what they are."""

from __future__ import annotations

import json
import os
from typing import Any, Self, TypeVar

import numpy as np

from asperity._base.result import TableResult
from asperity._base.storage import data
from asperity._base.storage.archive import Archive
from asperity._base.storage.data import Kinds
from asperity._base.storage.files import atomic
from asperity.errors import ParameterError

FORMAT = 1
"""Number of the file layout."""

Kind = TypeVar("Kind")


def save(value: object, known: Kinds, path: str | os.PathLike[str]) -> None:
    """Write a result as a NumPy ``.npz`` file without pickled objects; it is complete or not there.

    Args:
        value: of one of the known classes.
        known: all classes that it is made of, by name.
        path: of the file.
    """
    from asperity import __version__

    arrays: dict[str, Any] = {}
    text = json.dumps(data.typed(value, "", known, arrays), ensure_ascii=False)
    with atomic(path) as file:
        np.savez_compressed(file, format=FORMAT, version=__version__, content=text, **arrays)


def load(kind: type[Kind], known: Kinds, path: str | os.PathLike[str]) -> Kind:
    """Read a result that `save` has written.

    Args:
        kind: its class.
        known: as of `save`.
        path: of the file.

    Raises:
        ParameterError: naming the place of what is wrong, or ``path`` if the file is something
            else.
        FileNotFoundError: if there is none.
    """
    with Archive(path, f"a {kind.__name__} that this version can read") as file:
        for key in ("format", "content"):
            if key not in file:
                raise ParameterError(key, f"is missing: {file.path} must be a {kind.__name__}")
        number, text = file["format"], file["content"]
        if number.shape or number.dtype.kind != "i" or not 1 <= int(number) <= FORMAT:
            raise ParameterError("format", f"must be {FORMAT} or older, in {file.path}")
        if text.shape or text.dtype.kind != "U":
            raise ParameterError("content", f"must be one text, in {file.path}")
        arrays = {key: file[key] for key in file.keys if key not in _OWN}
        try:
            table = _parsed(str(text))
            name = table.get("type") if isinstance(table, dict) else None
            if name != kind.__name__:
                raise ParameterError(
                    "content", f"must be of the type {kind.__name__}, is of {name!r}"
                )
            found = data.built_as_typed(table, "", known, arrays)
            assert isinstance(found, kind)
        except ParameterError as error:
            raise type(error)(error.argument, f"{error.message}, in {file.path}") from None
        return found


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
        save(self, self._known(), path)

    @classmethod
    def load(cls, path: str | os.PathLike[str]) -> Self:
        """Read a file written by `save`.

        Args:
            path: of the file.

        Raises:
            ParameterError: naming what is missing, damaged or of something else.
            FileNotFoundError: if there is none.
        """
        return load(cls, cls._known(), path)


_OWN = ("format", "version", "content")


def _parsed(text: str) -> Any:
    try:
        return json.loads(text)
    except (ValueError, RecursionError) as error:
        raise ParameterError("content", f"must be the text that asperity writes: {error}") from None
