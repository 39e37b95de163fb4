"""Sets as tables of data, and in files of their own."""

from __future__ import annotations

import os
from typing import Any

import asperity._core as _core
from asperity import sets
from asperity._base.storage import data, provenance, toml
from asperity._base.storage.data import HEAD_SCHEMA, FileFormat, Kinds
from asperity._base.storage.provenance import Provenance
from asperity._base.storage.toml import TABLE, Schema, TomlFile
from asperity.errors import ParameterError
from asperity.sets.star import StarSet

KINDS: Kinds = {
    name: kind for name, kind in data.classes(sets).items() if issubclass(kind, StarSet)
}
"""The only classes that are made of what stands in a file."""

FORMAT = FileFormat("asperity set", 1)
_SCHEMA: Schema = {**HEAD_SCHEMA, "set": TABLE, "provenance": provenance.SCHEMA}
_COMMENTS = {"": "A set of forces or directions. Angles are in rad."}


def table_of(value: StarSet, key: str) -> dict[str, Any]:
    """Return a set as a table: its ``type`` and the arguments of that constructor.

    Raises:
        ParameterError: for a set of a class that is not asperity's.
    """
    return data.typed(value, key, KINDS)


def set_of(table: Any, key: str) -> StarSet:
    """Return the set of a table.

    Raises:
        ParameterError: whose argument is the key of what is wrong.
    """
    found = data.built_as_typed(table, key, KINDS)
    assert isinstance(found, StarSet)
    return found


def save(value: StarSet, path: str | os.PathLike[str], note: str) -> None:
    """Write a set."""
    origin = Provenance(note=note).written_by(_core.__version__)
    written = {"set": table_of(value, "set"), "provenance": origin.table()}
    toml.write(path, {**FORMAT.head(), **written}, _COMMENTS)


def load(path: str | os.PathLike[str]) -> StarSet:
    """Read a set."""
    file = TomlFile(path, _SCHEMA, FORMAT.check)
    with file.named():
        if "set" not in file.values:
            raise ParameterError("set", "is missing")
        return set_of(file.values["set"], "set")
