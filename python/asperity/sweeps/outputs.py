"""What the function of a sweep returns, and the arrays that hold it."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from enum import Enum
from typing import Any, Literal, TypeAlias

import numpy as np
from numpy.typing import NDArray

from asperity.sweeps.grid import RESERVED

NO_FLAG = -128
"""In the place of a flag where there is no result."""

_FALSE_OR_TRUE = ((0, "false"), (1, "true"))
# As many numbers from zero on as a flag of eight bits has.
_MOST_FLAGS = 128


@dataclass(frozen=True)
class Output:
    """What one of the results is at every point.

    Attributes:
        kind: numbers, or flags that stand for words.
        shape: of the result at one point; with axes that are handed over whole, theirs first.
        words: numbers of flags and what they mean.
    """

    kind: Literal["real", "complex", "flag"]
    shape: tuple[int, ...] = ()
    words: tuple[tuple[int, str], ...] = ()

    @property
    def nothing(self) -> complex:
        """The number in places without a result."""
        return {"real": np.nan, "complex": complex(np.nan, np.nan), "flag": NO_FLAG}[self.kind]

    @property
    def dtype(self) -> np.dtype[Any]:
        """Of the array."""
        return np.dtype({"real": "f8", "complex": "c16", "flag": "i1"}[self.kind])

    def __str__(self) -> str:
        words = {"real": "real", "complex": "complex"}.get(
            self.kind, "one of " + ", ".join(word for _, word in self.words)
        )
        return f"{words}, shape {self.shape}" if self.shape else words


Schema: TypeAlias = dict[str, Output]
"""What a function returns, by name."""

Results: TypeAlias = dict[str, Any]
"""What it has returned at one point."""

_REAL, _BOOL = Output("real"), Output("flag", (), _FALSE_OR_TRUE)


def named(returned: Any) -> Results:
    """Return results by name: those of a mapping, or a single one as ``value``."""
    return dict(returned) if isinstance(returned, Mapping) else {"value": returned}


def sample_of(
    results: Results, axes: Iterable[str], vector_shape: tuple[int, ...]
) -> tuple[Schema, Results]:
    """Return what results are, and the results as numbers and arrays of numbers.

    Raises:
        TypeError: naming one that no array can hold, or a name that it cannot have.
        Exception: whatever else a result raises when it is looked at.
    """
    for name in results:
        if not isinstance(name, str) or not name.isidentifier() or name in RESERVED:
            raise TypeError(
                "must return results by names that are identifiers, other than "
                f"{' and '.join(RESERVED)}, got {name!r}"
            )
    if not results:
        raise TypeError("must return results, got an empty mapping")
    found = {name: _output(name, value) for name, value in results.items()}
    schema = {name: output for name, (output, _) in found.items()}
    for name in schema.keys() & set(axes):
        raise TypeError(f"{name}: is the name of an axis, so that no result can have it")
    for name, output in schema.items():
        if output.shape[: len(vector_shape)] != vector_shape:
            raise TypeError(
                f"{name}: must begin with the shape {vector_shape} of the axes that are handed "
                f"over whole, got shape {output.shape}"
            )
    return schema, {name: plain for name, (_, plain) in found.items()}


def _output(name: str, value: Any) -> tuple[Output, Any]:
    if type(value) is float:
        return _REAL, value
    if isinstance(value, Enum):
        return _flag(name, value)
    array = np.asarray(value)
    if array.dtype.kind == "b":
        return Output("flag", array.shape, _FALSE_OR_TRUE) if array.shape else _BOOL, array
    if array.dtype.kind in "iuf":
        return Output("real", array.shape) if array.shape else _REAL, array
    if array.dtype.kind == "c":
        return Output("complex", array.shape), array
    raise TypeError(
        f"{name}: must be a number, a truth value, an enumerator or an array of numbers, "
        f"got {value!r}"
    )


def _flag(name: str, value: Enum) -> tuple[Output, int]:
    """Return an enumeration and the number of a member: its own if all are small integers."""
    kind, members = type(value), list(type(value))
    if len(members) > _MOST_FLAGS or value not in members:
        raise TypeError(
            f"{name}: must be a member of an enumeration of at most {_MOST_FLAGS}, got {value!r} "
            f"of {kind.__name__}, which has {len(members)}"
        )
    own = all(isinstance(one.value, int) and NO_FLAG < one.value < 128 for one in members)
    numbers = [int(one.value) if own else k for k, one in enumerate(members)]
    # The words of all flags are one text, with spaces between them.
    words = ["_".join(one.name.lower().split()) for one in members]
    place = next(k for k, one in enumerate(members) if one is value)
    return Output("flag", (), tuple(zip(numbers, words, strict=True))), numbers[place]


def misfit(schema: Schema, wanted: Schema) -> str:
    """Say what of a result differs from the first one; empty if nothing does."""
    if schema == wanted:
        return ""
    if schema.keys() != wanted.keys():
        return f"must return {', '.join(wanted)} as before, got {', '.join(schema)}"
    name = next(one for one, output in wanted.items() if schema[one] != output)
    return f"{name}: must be {wanted[name]} as before, got {schema[name]}"


def are_real(results: Sequence[Results | None], schema: Schema) -> bool:
    """Whether all results are plain floats where such are wanted: by far the most frequent case."""
    names = schema.keys()
    if not all(output is _REAL for output in schema.values()):
        return False
    if not all(one is not None and one.keys() == names for one in results):
        return False
    return all({type(one[name]) for one in results if one} == {float} for name in names)


def packed(results: Sequence[Results | None], schema: Schema) -> dict[str, NDArray[Any]]:
    """Return arrays ``(n, …)`` of plain results of a schema, see `sample_of`."""
    known = [i for i, one in enumerate(results) if one is not None]
    found = {}
    for name, output in schema.items():
        values = [one[name] for one in results if one is not None]
        whole = np.full((len(results), *output.shape), output.nothing, output.dtype)
        if known:
            whole[known] = np.array(values, output.dtype)
        found[name] = whole
    return found
