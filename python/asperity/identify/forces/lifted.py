"""Strokes in which the pin is lifted: on the way back, say, so that the pin slides one way only."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from asperity._base.arrays import Array
from asperity.identify.forces.strokes import Strokes
from asperity.identify.records.record import Recording
from asperity.identify.records.sliding.stretches import FEWEST, rows_of

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


def loaded_strokes(
    runs: Sequence[Recording], strokes: Sequence[Strokes], pressing: Callable[[int], Array]
) -> Loaded:
    """Return the strokes in which the pin is pressed down; turns of a disk are left as they are.

    Args:
        runs: all recordings.
        strokes: of these, numbered over all of them.
        pressing: λ_N of a recording by its number, not filtered.
    """
    total = 1 + max(int(one.number.max()) for one in strokes)
    keeps = np.zeros(total, dtype=np.bool_)
    rows: dict[int, list[NDArray[np.intp]]] = {}
    middles: dict[int, Array] = {}
    for at, one in enumerate(strokes):
        if isinstance(one.turned, float):
            keeps[one.number[one.number >= 0]] = True
            continue
        normal, rows[at] = pressing(at), rows_of(one.number)
        middles[at] = np.array([float(np.median(normal[part])) for part in rows[at]])
    least = _least(runs, middles)
    changed: dict[int, NDArray[np.int32]] = {}
    for at, own in rows.items():
        one = strokes[at]
        # What pulls has another sign or another unit, which is said elsewhere.
        is_loaded = np.abs(middles[at]) >= least[at]
        normal = pressing(at)
        if is_loaded.all() and not _lifts_between(normal, one.number):
            keeps[one.number[one.number >= 0]] = True
            continue
        number = np.full(one.number.shape, -1, dtype=np.int32)
        for part, level, is_kept in zip(own, middles[at], is_loaded, strict=True):
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
        parts = [slice(int(part[0]), int(part[-1]) + 1) for part in rows_of(number)]
        pressed.append(tuple(parts) if at in changed else None)
    return Loaded(found, int(total - keeps.sum()), tuple(pressed))


def _least(runs: Sequence[Recording], middles: Mapping[int, Array]) -> dict[int, float]:
    """Return the least normal force of a loaded stroke for each recording.

    It follows from those of all pieces of its file, and a hundredth from those of all files, as a
    file may have no loaded stroke.
    """

    def usual(chosen: Sequence[int]) -> float:
        values = np.concatenate([np.abs(middles[at]) for at in chosen])
        return float(np.quantile(values, _LOADED, method="higher")) if values.size else 0.0

    if not middles:
        return {}
    of_all = _NO_LOAD * usual(list(middles))
    files: dict[str, list[int]] = {}
    for at in middles:
        files.setdefault(runs[at].file or str(at), []).append(at)
    return {at: _NO_LOAD * max(usual(chosen), of_all) for chosen in files.values() for at in chosen}


def _lifts_between(normal: Array, number: NDArray[np.int32]) -> bool:
    """Return whether the pin is lifted between strokes, for as long as a stroke lasts at least."""
    from scipy.ndimage import uniform_filter1d

    used = number >= 0
    if used.all() or not used.any():
        return False
    level = float(np.median(normal[used]))
    return bool(level > 0.0 and uniform_filter1d(normal, FEWEST)[~used].min() < _DOWN * level)


def _down(normal: Array, level: float) -> slice:
    """Return the samples of a loaded stroke from the first to the last that are pressed."""
    from scipy.ndimage import uniform_filter1d

    smooth = uniform_filter1d(normal * np.sign(level), max(1, normal.size // _PART), mode="nearest")
    rows = np.flatnonzero(smooth > _DOWN * abs(level))
    return slice(int(rows[0]), int(rows[-1]) + 1)
