"""Friction laws as JSON: the names of constructors and their parameters."""

from __future__ import annotations

import json
from collections.abc import Sequence
from typing import Any

import numpy as np

from asperity import sets
from asperity._base.value import Value
from asperity.errors import ParameterError
from asperity.law import FlowReport, FrictionLaw
from asperity.law.rate import Stribeck

# Only these are called, with parameters that are numbers, words, lists or each other.
_CONSTRUCTORS: dict[str, type[Value]] = {
    kind.__name__: kind
    for kind in [FrictionLaw, FlowReport, Stribeck, *map(vars(sets).get, sets.__all__)]
    if isinstance(kind, type) and issubclass(kind, Value) and kind is not sets.StarSet
}


def written(laws: Sequence[FrictionLaw]) -> str:
    """Return the laws as text; floats keep all their bits."""
    return json.dumps([_tree(law) for law in laws])


def read(text: str, key: str) -> list[FrictionLaw]:
    """Return the laws of a text."""
    try:
        trees = json.loads(text)
        laws = [_built(tree, key) for tree in trees]
    except (TypeError, ValueError, RecursionError) as error:
        raise ParameterError(key, f"must be laws that asperity has written: {error}") from None
    for law in laws:
        if not isinstance(law, FrictionLaw):
            raise ParameterError(key, f"must hold friction laws, got {law!r}")
    return laws


def _tree(value: Any) -> Any:
    if isinstance(value, Value):
        parameters = {name: _tree(part) for name, part in value._parameters.items()}
        return {"type": type(value).__name__, "parameters": parameters}
    if isinstance(value, tuple):
        return [_tree(part) for part in value]
    return value.tolist() if isinstance(value, np.ndarray) else value


def _built(tree: Any, key: str) -> Any:
    if isinstance(tree, list):
        return [_built(part, key) for part in tree]
    if not isinstance(tree, dict):
        return tree
    name, parameters = tree.get("type"), tree.get("parameters")
    if name not in _CONSTRUCTORS or not isinstance(parameters, dict):
        raise ParameterError(key, f"must hold sets and laws of asperity only, got {name!r}")
    built = {word: _built(part, key) for word, part in parameters.items()}
    return _CONSTRUCTORS[name](**built)
