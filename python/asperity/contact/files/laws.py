"""Friction laws as JSON: the tables of their own files."""

from __future__ import annotations

import json
from collections.abc import Sequence
from typing import Any

from asperity._base import arrays
from asperity.errors import ParameterError
from asperity.law import FrictionLaw
from asperity.law.file import law_of, table_of


def written(laws: Sequence[FrictionLaw]) -> str:
    """Return the laws as text; floats keep all their bits.

    Raises:
        ParameterError: for a law, or a set in it, of a class that is not asperity's.
    """
    return json.dumps([table_of(law, f"laws[{i}]") for i, law in enumerate(laws)])


def read(text: str, key: str) -> list[FrictionLaw]:
    """Return the laws of a text.

    Raises:
        ParameterError: whose argument is the key, and whose message tells what in it is wrong.
    """
    try:
        tables = json.loads(text)
        arrays.of_kind(tables, key, list, "a list of laws")
        return [law_of(_of_today(table), f"{key}[{i}]") for i, table in enumerate(tables)]
    except ParameterError as error:
        raise type(error)(key, str(error)) from None
    except (ValueError, RecursionError) as error:
        raise ParameterError(key, f"must be laws that asperity has written: {error}") from None


def _of_today(table: Any) -> Any:
    """Return the table of a law that version 0.1 has written.

    It had the arguments of every object under a key of their own, and the types of all.
    """
    if not isinstance(table, dict) or "parameters" not in table:
        return table
    law = _flat(table)
    for name in ("rate", "report"):
        if isinstance(law.get(name), dict):
            del law[name]["type"]
    if law.pop("type") != "FrictionLaw":
        raise ValueError(f"no law, {table.get('type')!r}")
    return {name: value for name, value in law.items() if value is not None}


def _flat(value: Any) -> Any:
    if isinstance(value, list):
        return [_flat(one) for one in value]
    if not isinstance(value, dict):
        return value
    if not isinstance(value.get("parameters"), dict) or not isinstance(value.get("type"), str):
        raise ValueError("a table of version 0.1 without its type or its parameters")
    return {
        "type": value["type"],
        **{name: _flat(one) for name, one in value["parameters"].items() if one is not None},
    }
