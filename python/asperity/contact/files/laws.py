"""Friction laws as JSON: the tables of their own files."""

from __future__ import annotations

import json
from collections.abc import Sequence

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
        ParameterError: whose argument is the key, and whose message says why it is wrong.
    """
    try:
        tables = json.loads(text)
        arrays.of_kind(tables, key, list, "a list of laws")
        return [law_of(table, f"{key}[{i}]") for i, table in enumerate(tables)]
    except ParameterError as error:
        raise type(error)(key, str(error)) from None
    except (ValueError, RecursionError) as error:
        raise ParameterError(key, f"must be laws that asperity has written: {error}") from None
