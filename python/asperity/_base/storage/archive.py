"""Archives of arrays (``.npz``), read so that damage is refused by name.

NumPy reads an entry only as far as its header says, and so neither meets the checksum at its end
nor what stands behind: entries are read whole here. Checksums do not cover names, which stand in
front of each entry and again in the list at the end: both must agree, and no entry may be missing
from the list, or what may be left out would be taken for left out. Nothing is unpickled.
"""

from __future__ import annotations

import io
import os
import struct
import zipfile
from types import TracebackType
from typing import Any, Self

import numpy as np
from numpy.typing import NDArray

from asperity.errors import ParameterError

# Bytes of the header of an entry, without its name and extra fields, and where their lengths stand.
_HEADER, _LENGTHS = 30, 26


class Archive:
    """An open archive whose errors name the key.

    Args:
        path: of the file.
        kind: what the file should be, for messages.

    Raises:
        ParameterError: if it is not an archive.
        OSError: if there is no such file, or it cannot be read.
    """

    def __init__(self, path: str | os.PathLike[str], kind: str = "an .npz file") -> None:
        self.path = os.fspath(path)
        if os.path.isdir(self.path):
            raise ParameterError("path", f"must be {kind}: {self.path} is a folder")
        self._bytes = open(self.path, "rb")  # noqa: SIM115
        try:
            self._refuse_one_array()
            self._zip = zipfile.ZipFile(self._bytes)
            self._compare_lists()
        except Exception as error:
            self._bytes.close()
            if isinstance(error, ParameterError):
                raise
            # Damaged bytes raise whatever the reader stumbles over.
            raise ParameterError("path", f"must be {kind}: {self.path}: {error}") from None
        names = self._zip.namelist()
        self.keys = tuple(name.removesuffix(".npy") for name in names)
        if len(set(self.keys)) < len(names):
            self._bytes.close()
            raise ParameterError("path", f"must be {kind}: {self.path} holds a key twice")

    def __enter__(self) -> Self:
        return self

    def __exit__(
        self,
        kind: type[BaseException] | None,
        error: BaseException | None,
        traceback: TracebackType | None,
    ) -> None:
        self._zip.close()
        self._bytes.close()

    def __contains__(self, key: str) -> bool:
        return key in self.keys

    def __getitem__(self, key: str) -> NDArray[Any]:
        if key not in self.keys:
            raise ParameterError(key, f"is missing in {self.path}")
        try:
            # Reading to the end compares the checksum.
            entry = io.BytesIO(self._zip.read(f"{key}.npy"))
            found = np.lib.format.read_array(entry, allow_pickle=False)
        except Exception as error:
            why = "it holds Python objects" if "pickle" in str(error) else str(error)
            raise ParameterError(key, f"cannot be read from {self.path}: {why}") from None
        if entry.read(1):
            raise ParameterError(key, f"cannot be read from {self.path}: more than it states")
        return np.asarray(found)

    def _compare_lists(self) -> None:
        """Refuse an archive whose list of entries is not that of the entries themselves."""
        end = 0
        for entry in sorted(self._zip.infolist(), key=lambda entry: entry.header_offset):
            self._refuse_hidden(end, entry.header_offset)
            # Opening compares the two names.
            self._zip.open(entry).close()
            self._bytes.seek(entry.header_offset + _LENGTHS)
            lengths = struct.unpack("<HH", self._bytes.read(4))
            end = entry.header_offset + _HEADER + sum(lengths) + entry.compress_size
        self._refuse_hidden(end, self._zip.start_dir)

    def _refuse_hidden(self, end: int, start: int) -> None:
        if start - end >= _HEADER:
            raise zipfile.BadZipFile(f"bytes {end} to {start} belong to no entry")

    def _refuse_one_array(self) -> None:
        first = self._bytes.read(len(np.lib.format.MAGIC_PREFIX))
        if first == np.lib.format.MAGIC_PREFIX:
            raise ParameterError(
                "path", f"must be an .npz file with keys, {self.path} is one array"
            )
        self._bytes.seek(0)
