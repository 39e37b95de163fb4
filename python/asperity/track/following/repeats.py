"""Frames that show an earlier moment again, as players and capture programs fill gaps.

A mark that stands still for some frames is at rest, as bodies are that stick and slip, or it is
shown again. Images tell: those of a camera differ by its noise, also where nothing moves, those of
a frame that is shown again do not, but for what compression does. Where compression has taken the
noise away, or there was none, nothing tells the one from the other.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from asperity._base.arrays import Array
from asperity.track.film.frames import Frame
from asperity.track.following.sight import Sight, Sighting

# A mark that went on by `_MOVING` pixels per frame before and after and hardly moves, to this share
# of it, in `_LONGEST` frames or fewer in between, may have been shown again.
_STILL, _MOVING, _LONGEST = 0.1, 1.0, 8
# How alike the motions before and after are: ratio of the steps, cosine of the angle in between.
_AS_LARGE, _AS_DIRECTED = 2.0, 0.5
# Patches of so many pixels, in so many rows and columns, in which frames are compared.
_PATCH, _PATCHES = 24, 3
# Frames between which the mark moves by so many pixels are different ones; noise is known from so
# many of them.
_DIFFERENT, _FEWEST = 0.5, 5
# The least change of levels that counts as noise, and the share of it below which frames are equal.
# Noise of 1 and 3 levels of 255 in H.264 at the rate factor 12: different frames differ by 0.29 and
# 1.9 at least, equal ones by 0.03 at most; at 23 both do by less than 0.15.
_NOISE, _EQUAL = 0.25, 0.25


class Changes:
    """How much each frame differs from the one before it in patches all over the image."""

    def __init__(self) -> None:
        self._before: NDArray[np.uint8] | None = None
        self._found: list[Array] = []

    def add(self, frame: Frame) -> None:
        """Compare the next frame with the last one."""
        patches = np.stack([frame.levels(*place) for place in _places(frame.shape)])
        if self._before is not None:
            off = patches.astype(np.int16) - self._before
            self._found.append(np.abs(off).mean(axis=(1, 2, 3)))
        self._before = patches

    def equal(self, pixel: Array) -> NDArray[np.bool_] | None:
        """Return which frames are those before them, ``None`` if the images do not tell.

        Args:
            pixel: places of the mark, ``(n, 2)``.
        """
        steps = np.hypot(*np.diff(pixel, axis=0).T)
        moved = steps >= _DIFFERENT
        if moved.sum() < _FEWEST:
            return None
        found = np.stack(self._found)
        # Light that flickers changes some frames more than others, but none by less than its noise.
        noise = np.percentile(found[moved], 10.0, axis=0)
        telling = noise >= _NOISE
        # What moves through a few patches changes these without noise, too.
        if 2 * telling.sum() <= telling.size:
            return None
        share = np.median(found[:, telling] / noise[telling], axis=1)
        return np.concatenate([[False], (share < _EQUAL) & (steps < _DIFFERENT)])


def _places(shape: tuple[int, int]) -> list[tuple[slice, slice]]:
    """Return rows and columns of the patches."""
    starts = []
    for length in shape:
        size = min(_PATCH, length)
        middles = length * (np.arange(_PATCHES) + 0.5) / _PATCHES
        first = np.clip(np.rint(middles - 0.5 * size).astype(int), 0, length - size)
        starts.append([slice(start, start + size) for start in first.tolist()])
    return [(rows, columns) for rows in starts[0] for columns in starts[1]]


def marked(sightings: Sequence[Sighting], changes: Changes) -> list[Sighting]:
    """Return what was seen, without positions in repeated frames."""
    pixel = np.array([one.pixel for one in sightings]).reshape(-1, 2)
    repeated = changes.equal(pixel)
    if repeated is None:
        return [
            replace(one, status=one.status | Sight.STILL) if still else one
            for one, still in zip(sightings, stands_still(pixel), strict=True)
        ]
    nothing = Sighting.none(Sight.REPEATED)
    return [
        replace(nothing, status=one.status | Sight.REPEATED) if again else one
        for one, again in zip(sightings, repeated, strict=True)
    ]


def stands_still(pixel: Array) -> NDArray[np.bool_]:
    """Return where a mark, at ``(n, 2)``, stands still between two steps of a motion that goes on.

    The step after it is the one before it, or, where frames were dropped for it, longer by as many.
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
