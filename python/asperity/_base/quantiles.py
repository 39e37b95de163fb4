"""Quantiles, without the second that `scipy.stats` takes to import."""

from __future__ import annotations

from typing import Any, overload

from asperity._base.arrays import Array


@overload
def student(level: float, degrees: float) -> float: ...
@overload
def student(level: float, degrees: Array) -> Array: ...
@overload
def student(level: Array, degrees: float) -> Array: ...
def student(level: float | Array, degrees: float | Array) -> float | Array:
    """Return what |t| of Student's distribution stays below with the probability `level`."""
    from scipy.special import stdtrit

    found: Any = stdtrit(degrees, 0.5 + 0.5 * level)
    return found if found.ndim else float(found)
