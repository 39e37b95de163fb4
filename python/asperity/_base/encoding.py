"""Values as data, the form in which files hold them: tables of names, numbers, words and lists.

A value is a table with its ``type``, the name of its class, and its parameters by their names, as
``{"type": "Ellipse", "a": 0.5, "b": 0.3, "angle": 0.0}``, which is JSON and, without None, TOML.
Reading calls the constructors of classes that the caller names, with such data only, so that a file
can neither run code nor make what the constructors would refuse. Floats keep all their bits.
"""

from __future__ import annotations

import difflib
import inspect
from collections.abc import Iterable, Mapping
from enum import IntEnum
from inspect import Parameter
from types import ModuleType
from typing import Any, TypeAlias

import numpy as np
from numpy.typing import NDArray

from asperity._base.value import Value
from asperity.errors import ParameterError

Known: TypeAlias = Mapping[str, type[Value]]
"""Classes by name: all that data may be made into."""

# Arrays of more entries are kept beside the text, where there is a place for them.
_INLINE = 64


def classes(*rooms: ModuleType) -> dict[str, type[Value]]:
    """Return the public classes of values of some rooms by their names."""
    public = (getattr(room, name) for room in rooms for name in room.__all__)
    return {one.__name__: one for one in public if isinstance(one, type) and issubclass(one, Value)}


def encoded(
    value: object, known: Known, *, place: str = "", arrays: dict[str, NDArray[Any]] | None = None
) -> Any:
    """Return a value, or a sequence of such, as data.

    Args:
        value: made of the known classes, arrays, tuples, lists, numbers, words and None.
        known: classes that `decoded` will be given.
        place: name of the value, for messages and arrays.
        arrays: where to put large arrays by their place; by default they become lists.

    Raises:
        ParameterError: whose argument is the dotted place of what is no data, such as a function.

    >>> from asperity import sets
    >>> from asperity._base.encoding import classes, encoded
    >>> encoded(sets.Disk(0.5), classes(sets))
    {'type': 'Disk', 'radius': 0.5}
    """
    if isinstance(value, Value):
        name = type(value).__name__
        if known.get(name) is not type(value):
            raise ParameterError(
                place or name, f"is of the class {name}, which files cannot hold: it is not public"
            )
        signature = inspect.signature(type(value)).parameters
        return {
            "type": name,
            **{
                key: encoded(part, known, place=_joined(place, key), arrays=arrays)
                for key, part in value._parameters.items()
                # What is left out is the default; every other default may change.
                if part is not None or signature[key].default is not None
            },
        }
    if isinstance(value, np.ndarray):
        # Lists have neither complex numbers nor the shape of what has no entries.
        inline = 0 < value.size <= _INLINE and value.dtype.kind != "c"
        if arrays is not None and not inline:
            arrays[place] = value
            return {"array": place}
        return value.tolist()
    if isinstance(value, tuple | list):
        return [
            encoded(part, known, place=f"{place}[{number}]", arrays=arrays)
            for number, part in enumerate(value)
        ]
    if isinstance(value, np.generic):
        return value.item()
    if value is None or isinstance(value, bool | float):
        return value
    # Members of enumerations are the words and numbers that make them.
    if isinstance(value, str):
        return str(value)
    if isinstance(value, int | IntEnum):
        return int(value)
    what = "a function" if callable(value) else f"an object of the class {type(value).__name__}"
    raise ParameterError(place, f"is {what}, which files cannot hold")


def decoded(
    data: Any, known: Known, *, place: str = "", arrays: Mapping[str, NDArray[Any]] | None = None
) -> Any:
    """Return what data of `encoded` stand for.

    Args:
        data: tables, lists, numbers and words.
        known: classes that may be made.
        place: name of the value, for messages.
        arrays: the arrays beside the text by their place.

    Raises:
        ParameterError: whose argument is the dotted place of what is wrong.

    >>> from asperity import sets
    >>> from asperity._base.encoding import classes, decoded
    >>> decoded({"type": "Ellipse", "a": 0.5, "b": 0.3}, classes(sets))
    Ellipse(0.5, 0.3)
    >>> decoded({"type": "Disk", "radios": 0.5}, classes(sets), place="reservoir")
    Traceback (most recent call last):
    asperity.errors.ParameterError: reservoir.radios: is not known, did you mean 'radius'?
    """
    if isinstance(data, list | tuple):
        return [
            decoded(part, known, place=f"{place}[{number}]", arrays=arrays)
            for number, part in enumerate(data)
        ]
    if not isinstance(data, Mapping):
        return data
    if arrays is not None and data.keys() == {"array"}:
        key = data["array"]
        if key not in arrays:
            raise ParameterError(place, f"needs the array {key!r}, which is missing")
        return arrays[key]
    name = data.get("type")
    if not isinstance(name, str) or name not in known:
        raise ParameterError(
            _joined(place, "type"), _not_known(name, known, "must name one of the known classes")
        )
    return _made(name, data, known, place, arrays)


def _made(
    name: str,
    data: Mapping[str, Any],
    known: Known,
    place: str,
    arrays: Mapping[str, NDArray[Any]] | None,
) -> Value:
    signature = inspect.signature(known[name]).parameters
    given = {key: part for key, part in data.items() if key != "type"}
    for key in given:
        if key not in signature:
            raise ParameterError(
                _joined(place, key), _not_known(key, signature, f"is no argument of {name}")
            )
    for key, parameter in signature.items():
        if key not in given and parameter.default is Parameter.empty:
            raise ParameterError(_joined(place, key), f"is missing, {name} needs it")
    arguments = {
        key: decoded(part, known, place=_joined(place, key), arrays=arrays)
        for key, part in given.items()
    }
    try:
        return known[name](**arguments)
    except ParameterError as error:
        raise type(error)(_joined(place, error.argument), error.message) from None
    except (TypeError, ValueError, AttributeError, ArithmeticError, LookupError) as error:
        # Constructors check numbers and sets; a table in the place of a word meets no check.
        raise ParameterError(place or name, f"cannot be made into {name}: {error}") from None


def _not_known(word: object, known: Iterable[str], otherwise: str) -> str:
    near = difflib.get_close_matches(word, list(known), 1) if isinstance(word, str) else []
    return f"is not known, did you mean {near[0]!r}?" if near else f"{otherwise}, got {word!r}"


def _joined(place: str, key: str) -> str:
    return f"{place}.{key}" if place else key
