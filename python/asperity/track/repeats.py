"""Frames that show an earlier moment again, as players and capture programs fill gaps."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from asperity._arrays import Array
from asperity.track.sight import Sight, Sighting

# A mark that went on by `_MOVING` pixels per frame before and after cannot have stood still, to
# this share of it, in `_LONGEST` frames or fewer in between: what slides comes to rest gradually.
_STILL, _MOVING, _LONGEST = 0.1, 1.0, 8
# How alike the motions before and after are: ratio of the steps, cosine of the angle in between.
_AS_LARGE, _AS_DIRECTED = 2.0, 0.5


def marked(sightings: Sequence[Sighting]) -> list[Sighting]:
    """Return what was seen, without positions in repeated frames."""
    repeated = repeats(np.array([one.pixel for one in sightings]).reshape(-1, 2))
    nothing = Sighting.none(Sight.REPEATED)
    return [
        replace(nothing, status=one.status | Sight.REPEATED) if again else one
        for one, again in zip(sightings, repeated, strict=True)
    ]


def repeats(pixel: Array) -> NDArray[np.bool_]:
    """Return which positions, shape ``(n, 2)``, are those of a frame shown again.

    A repeated frame stands still between two steps of a motion that goes on: the step after it is
    the usual one, or, where frames were dropped for it, longer by as many.
    """
    steps = np.diff(pixel, axis=0)
    lengths = np.hypot(*steps.T)
    found = np.zeros(len(pixel), dtype=np.bool_)
    before: int | None = None
    for k, length in enumerate(lengths.tolist()):
        if length >= _MOVING:
            if before is not None and 1 < k - before <= _LONGEST + 1:
                found[before + 2 : k + 1] = _goes_on(steps[before], steps[k], k - before)
            before = k
        elif before is not None and not length <= _STILL * lengths[before]:
            # It slows down, or is not seen.
            before = None
    return found


def _goes_on(before: Array, after: Array, dropped: int) -> bool:
    """Whether the step after some frames is the one before them, or as many as were dropped."""
    lengths = float(np.hypot(*before)), float(np.hypot(*after))
    ratio = lengths[1] / lengths[0]
    alike = 1.0 / _AS_LARGE <= ratio <= _AS_LARGE * dropped
    return alike and float(before @ after) >= _AS_DIRECTED * lengths[0] * lengths[1]
