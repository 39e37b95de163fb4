"""Where the contents of a file come from."""

from __future__ import annotations

import datetime
import hashlib
import os
import stat
from collections.abc import Iterable, Mapping
from pathlib import Path
from typing import Any

from asperity._base import arrays
from asperity._base.storage import toml
from asperity._base.storage.toml import TABLE, TEXT, Kind, Schema, Tables
from asperity._base.value import Value
from asperity.errors import ParameterError

SCHEMA: Schema = {
    "asperity": TEXT,
    "date": Kind("a date", lambda value: isinstance(value, str | datetime.date)),
    "made_by": TEXT,
    "note": TEXT,
    "files": Tables({"name": TEXT, "sha256": TEXT}),
    "configuration": TABLE,
}
"""Of the section ``[provenance]``."""


class Provenance(Value):
    """Where a law or a set comes from, as its file says.

    Args:
        asperity: version of the package that wrote the file.
        date: of writing, as ``"2026-11-22"``.
        made_by: command or function that made it.
        note: free text.
        files: name and SHA-256 of what it was made of.
        configuration: the options with which these files were read, by sections; what a file says
            of them is kept: lists for tuples and arrays, nothing for None.

    >>> from asperity import Provenance
    >>> Provenance(note="PVC on PVC, dry").note
    'PVC on PVC, dry'
    """

    asperity: str
    date: str
    made_by: str
    note: str
    files: tuple[tuple[str, str], ...]
    configuration: Mapping[str, Any] | None

    def __init__(
        self,
        *,
        asperity: str = "",
        date: str = "",
        made_by: str = "",
        note: str = "",
        files: Iterable[tuple[str, str]] = (),
        configuration: Mapping[str, Any] | None = None,
    ) -> None:
        texts = {"asperity": asperity, "date": date, "made_by": made_by, "note": note}
        for name, words in texts.items():
            arrays.of_kind(words, name, str, "a text")
        pairs = tuple(map(_name_and_hash, arrays.several(files, "files")))
        if not isinstance(configuration, Mapping | None):
            raise ParameterError("configuration", f"must hold sections, got {configuration!r}")
        kept = None if configuration is None else toml.plain(configuration, "configuration")
        self._set(**texts, files=pairs, configuration=kept)

    def __hash__(self) -> int:
        # Without the sections, which are equal in any order and cannot be hashed.
        return hash((self.asperity, self.date, self.made_by, self.note, self.files))

    @classmethod
    def of_files(cls, paths: Iterable[str | os.PathLike[str]], **others: Any) -> Provenance:
        """Return the provenance of what was made of some files, with the hashes of regular ones.

        Args:
            paths: of the files.
            others: arguments of `Provenance`.

        Raises:
            OSError: if a file is not there or cannot be read.
        """
        known = [Path(one) for one in paths]
        # A pipe is empty once it has been read; what is not there is an error.
        regular = [stat.S_ISREG(one.stat().st_mode) for one in known]
        hashes = [_sha256(one) if kept else "" for one, kept in zip(known, regular, strict=True)]
        return cls(
            files=[(p.name, found) for p, found in zip(known, hashes, strict=True)], **others
        )

    def written_by(self, version: str) -> Provenance:
        """Return the provenance with the version of the package that writes, and today's date."""
        return self.replace(asperity=version, date=datetime.date.today().isoformat())

    def table(self) -> dict[str, Any]:
        """Return the section of the file."""
        texts = ("asperity", "date", "made_by", "note")
        return {
            **{name: self._parameters[name] or None for name in texts},
            "configuration": self.configuration,
            "files": [{"name": name, "sha256": digest} for name, digest in self.files] or None,
        }

    @classmethod
    def of_table(cls, table: Mapping[str, Any], key: str) -> Provenance:
        """Return what a section says that fits `SCHEMA`.

        Raises:
            ParameterError: whose argument is the key of what is wrong.
        """
        files = []
        for i, one in enumerate(table.get("files", [])):
            for name in ("name", "sha256"):
                if name not in one:
                    raise ParameterError(f"{key}.files[{i}].{name}", "is missing")
            files.append((one["name"], one["sha256"]))
        texts = {"date": str(table["date"])} if "date" in table else {}
        return cls(**{**table, **texts, "files": files})


def _name_and_hash(value: Any) -> tuple[str, str]:
    if not isinstance(value, tuple | list) or [type(word) for word in value] != [str, str]:
        raise ParameterError("files", f"must be pairs of name and hash, got {value!r}")
    return value[0], value[1]


def _sha256(path: Path) -> str:
    with path.open("rb") as file:
        return hashlib.file_digest(file, "sha256").hexdigest()
