"""Strokes in which the pin is lifted: on the way back, say, so that the pin slides one way only."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from asperity._base.arrays import Array
from asperity.identify.forces.strokes import Strokes
from asperity.identify.records.stretches import FEWEST

# A stroke whose normal force is below this part of that of loaded ones has none.
_NO_LOAD = 0.1
# Of the strokes of a record, one that is loaded.
_LOADED = 0.9
# At the ends of a loaded stroke, samples below this part of its normal force are those of putting
# down and lifting; noise is averaged over this part of the stroke.
_DOWN, _PART = 0.5, 50


@dataclass(frozen=True, eq=False)
class Loaded:
    """Strokes with load.

    Attributes:
        strokes: of each recording; those without load have no number.
        lifted: how many have none.
        pressed: rows of the loaded strokes of each recording in which the pin is lifted in between;
            None where it is not.
    """

    strokes: list[Strokes]
    lifted: int
    pressed: tuple[tuple[slice, ...] | None, ...]


def loaded_strokes(strokes: Sequence[Strokes], pressing: Callable[[int], Array]) -> Loaded:
    """Return the strokes in which the pin is pressed down; turns of a disk are left as they are.

    Args:
        strokes: of all recordings, numbered over all of them.
        pressing: λ_N of a recording by its number, not filtered.
    """
    total = 1 + max(int(one.number.max()) for one in strokes)
    keeps = np.zeros(total, dtype=np.bool_)
    changed: dict[int, NDArray[np.int32]] = {}
    for at, one in enumerate(strokes):
        if isinstance(one.turned, float):
            keeps[one.number[one.number >= 0]] = True
            continue
        normal = pressing(at)
        rows = _rows_of(one.number)
        middle = np.array([float(np.median(normal[part])) for part in rows])
        usual = float(np.quantile(middle, _LOADED, method="higher")) if middle.size else 0.0
        is_loaded = middle >= _NO_LOAD * usual
        # What pulls has another sign or another unit, which is said elsewhere.
        if usual <= 0.0 or is_loaded.all():
            keeps[one.number[one.number >= 0]] = True
            continue
        number = np.full(one.number.shape, -1, dtype=np.int32)
        for part, level, is_kept in zip(rows, middle, is_loaded, strict=True):
            inside = _down(normal[part], level) if is_kept else slice(0)
            if len(part[inside]) >= FEWEST:
                number[part[inside]] = one.number[part[inside]]
        keeps[number[number >= 0]] = True
        changed[at] = number
    if not changed:
        return Loaded(list(strokes), 0, (None,) * len(strokes))
    new = np.where(keeps, np.cumsum(keeps) - 1, -1).astype(np.int32)
    found: list[Strokes] = []
    pressed: list[tuple[slice, ...] | None] = []
    for at, one in enumerate(strokes):
        number = changed.get(at, one.number)
        number = np.where(number >= 0, new[np.maximum(number, 0)], -1).astype(np.int32)
        found.append(replace(one, number=number))
        parts = [slice(int(part[0]), int(part[-1]) + 1) for part in _rows_of(number)]
        pressed.append(tuple(parts) if at in changed else None)
    return Loaded(found, int(total - keeps.sum()), tuple(pressed))


def _rows_of(number: NDArray[np.int32]) -> list[NDArray[np.intp]]:
    """Return the rows of each stroke."""
    edges = np.flatnonzero(np.diff(number)) + 1
    return [part for part in np.split(np.arange(number.size), edges) if number[part[0]] >= 0]


def _down(normal: Array, level: float) -> slice:
    """Return the samples of a loaded stroke from the first to the last that are pressed."""
    from scipy.ndimage import uniform_filter1d

    smooth = uniform_filter1d(normal, max(1, normal.size // _PART), mode="nearest")
    rows = np.flatnonzero(smooth > _DOWN * level)
    return slice(int(rows[0]), int(rows[-1]) + 1)
