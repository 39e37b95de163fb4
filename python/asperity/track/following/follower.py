"""Where to look for the mark in the next frame, and what is seen there."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace

import numpy as np

from asperity._base import arrays
from asperity._base.arrays import Array
from asperity.track.film.frames import Frame
from asperity.track.following.sight import Sight, Sighting
from asperity.track.image.circle import Circle, fit_circle
from asperity.track.image.scene import PlaneView
from asperity.track.image.segmentation import Candidates, Mark, Outline, outline, search

# The region of interest in radii of the mark, and how often it may be widened.
_REGION, _WIDENING, _TRIES = 1.4, 1.6, 4
_BORDER = 8
# Steps of the search of a whole frame, in pixels: coarse first.
_STEPS = (4, 1)
# From here on the outline is broken by a reflection; beyond the last one it is another thing.
_FILLING, _COVERAGE, _RMS, _SIZE, _OTHER_SIZE = 0.95, 0.95, 0.05, 0.15, 0.5
_SHARPEST_RMS = 0.5
# Distances of the outline from the circle, in pixels, that blur and filter explain.
_RESOLUTION = 0.1
# How far from where it was heading a mark is found again: a push in radii within one frame, and
# an acceleration in m/s² that friction hardly exceeds. Areas as alike as this are the same mark's.
_PUSH, _ACCELERATION, _ALIKE = 4.0, 20.0, 2.0


@dataclass(frozen=True)
class _Whole:
    """The last frame in which the mark was whole.

    Attributes:
        place: of its centre in pixels.
        step: to there from the frame before.
        frames: number of frames since, in which it was not whole.
    """

    place: Array
    step: Array
    frames: int = 0


class Follower:
    """The mark as it was in the frames so far."""

    def __init__(self, scene: PlaneView, mark: Mark, fps: float) -> None:
        arrays.of_kind(mark, "mark", Mark, "a Mark")
        self.scene = scene
        self.mark = mark
        self._fps = fps
        self._diameter: float | None = None
        self._place: Array | None = None
        self._step: Array | None = None
        self._lost = 0
        self._radius = 0.0
        self._background: float | None = None
        self._last_whole: _Whole | None = None
        self._doubtful = False

    def look(self, frame: Frame) -> Sighting:
        """Return what the next frame shows."""
        sighting = Sighting.none(Sight.LOST)
        if self._place is not None and not self._lost:
            step = np.zeros(2) if self._step is None else self._step
            reach = _REGION * self._radius + 0.5 * float(np.hypot(*step)) + _BORDER
            sighting = self._measure(frame, self._place + step, reach)
        if Sight.LOST in sighting.status:
            sighting = self._search(frame)
        sighting = self._doubted(sighting, frame)
        self._remember(sighting)
        return sighting

    def _doubted(self, sighting: Sighting, frame: Frame) -> Sighting:
        """Mark what may be another one, in this frame or since an earlier one."""
        if math.isnan(sighting.diameter):
            return sighting
        if Sight.AMBIGUOUS in sighting.status or not self._is_same(sighting, frame):
            self._doubtful = True
        if not self._doubtful:
            return sighting
        return replace(sighting, status=sighting.status | Sight.AMBIGUOUS)

    def _is_same(self, sighting: Sighting, frame: Frame) -> bool:
        """Whether a mark that is whole again is the one that was whole before.

        Marks that cross hide each other; then the other one may be followed. Equal circles that
        are apart have centres apart by two radii at least: the one within a radius, and what
        friction may have turned, of the way from before is the same, if no other is there, too.
        """
        before = self._last_whole
        if before is None or not before.frames or Sight.REFLECTION in sighting.status:
            return True
        # The largest step at which a mark of this size is found.
        coarseness = next((step for step in _STEPS if 2.0 * step < self._radius), _STEPS[-1])
        found = search(frame.crop(slice(None), slice(None)), self.mark, coarseness)
        middles = _middles(found)
        alike = np.abs(np.log(found.areas / (math.pi * self._radius**2))) <= math.log(_ALIKE)
        others = middles[alike & (np.hypot(*(middles - sighting.pixel).T) > self._radius)]
        if not len(others):
            return True
        away, turned = self._from_way(
            np.vstack([sighting.pixel, others]), before.place, before.step, before.frames + 1
        )
        near = away <= self._radius + turned
        return bool(near[0] and not near[1:].any())

    def _search(self, frame: Frame) -> Sighting:
        whole = frame.crop(slice(None), slice(None))
        for step in _STEPS:
            found = search(whole, self.mark, step)
            self._background = found.background
            box, alone = self._choose(found, frame)
            if box is not None:
                middle = 0.5 * (box[:2] + box[2:])[::-1]
                reach = 0.6 * float(np.max(box[2:] - box[:2])) + _BORDER
                sighting = self._measure(frame, middle, reach)
                known = alone or math.isnan(sighting.diameter)
                status = sighting.status | (Sight.GOOD if known else Sight.AMBIGUOUS)
                return replace(sighting, status=status)
        return Sighting.none(Sight.LOST)

    def _choose(self, found: Candidates, frame: Frame) -> tuple[Array | None, bool]:
        """Return the box of the mark, if it can be there, and whether no other is like it."""
        away, reach = self._away(_middles(found))
        near = np.flatnonzero(away <= reach)
        if not len(near):
            return None, True
        areas = found.areas[near]
        area = self._area(frame) or float(areas.max())
        unlike = np.abs(np.log(areas / area))
        alike = unlike <= math.log(_ALIKE)
        # Among marks of its size the nearest; what is partly hidden has no size to go by.
        nearest = unlike if self._step is None else away[near]
        best = np.where(alike, nearest, np.inf).argmin() if alike.any() else unlike.argmin()
        return found.boxes[near[best]], int(alike.sum()) < 2

    def _away(self, points: Array) -> tuple[Array, float]:
        """Return distances from where the mark was heading, and the largest that is possible."""
        if self._place is None or self._step is None:
            return np.zeros(len(points)), math.inf
        away, turned = self._from_way(points, self._place, self._step, self._lost + 1)
        return away, _PUSH * self._radius + _BORDER + turned

    def _from_way(
        self, points: Array, place: Array, step: Array, frames: int
    ) -> tuple[Array, float]:
        """Return distances from the way of so many frames, and what friction may turn of it."""
        # Friction may have stopped it anywhere on its way.
        way = frames * step
        share = (points - place) @ way / max(float(way @ way), 1e-12)
        nearest = place + np.clip(share, 0.0, 1.0)[:, None] * way
        size = self.scene.pixel_size(place)
        turned = 0.5 * _ACCELERATION * (frames / self._fps) ** 2 / size
        return np.hypot(*(points - nearest).T), turned

    def _area(self, frame: Frame) -> float | None:
        """Return the expected area in square pixels, if it is known."""
        radius = self._radius
        if not radius and self.mark.diameter is not None:
            rows, columns = frame.shape
            radius = 0.5 * self.mark.diameter / self.scene.pixel_size([0.5 * columns, 0.5 * rows])
        return math.pi * radius**2 if radius else None

    def _measure(self, frame: Frame, middle: Array, reach: float) -> Sighting:
        """Look into a square region; widen it while the mark reaches its border."""
        rows, columns = frame.shape
        for _ in range(_TRIES):
            left, top = np.maximum(np.floor(middle - reach).astype(int), 0).tolist()
            right, bottom = np.minimum(
                np.ceil(middle + reach).astype(int) + 1, [columns, rows]
            ).tolist()
            if right - left < 3 or bottom - top < 3:
                return Sighting.none(Sight.LOST)
            part = frame.crop(slice(top, bottom), slice(left, right))
            seen = outline(part, self.mark, self._area(frame), self._background)
            if seen is None:
                return Sighting.none(Sight.LOST)
            if not seen.cut:
                self._background = seen.background
                return self._sighting(seen, np.array([left, top]))
            corners = seen.hull + np.array([left, top])
            if (corners < 1.0).any() or (corners > [columns - 2.0, rows - 2.0]).any():
                return Sighting.none(Sight.CLIPPED)
            reach *= _WIDENING
        return Sighting.none(Sight.LOST)

    def _sighting(self, seen: Outline, corner: Array) -> Sighting:
        points = self.scene.to_plane(seen.points + corner)
        size = self.scene.pixel_size(seen.points.mean(axis=0) + corner)
        circle = fit_circle(points, robust=True, resolution=_RESOLUTION * size)
        pixel = self.scene.to_pixels(circle.centre)
        expected = self._diameter or 2.0 * circle.radius
        ratio = 2.0 * circle.radius / expected
        if not 1.0 - _OTHER_SIZE < ratio < 1.0 + _OTHER_SIZE:
            return Sighting.none(Sight.LOST)
        return Sighting(
            pixel=pixel,
            position=circle.centre,
            position_error=np.sqrt(np.diag(circle.covariance)[:2]),
            diameter=2.0 * circle.radius,
            blur=seen.blur,
            filling=seen.filling,
            coverage=circle.coverage,
            status=self._status(seen, circle, size, ratio),
        )

    def _status(self, seen: Outline, circle: Circle, size: float, ratio: float) -> Sight:
        status = Sight.GOOD
        if seen.blur * size > self.mark.blur_limit * 2.0 * circle.radius:
            status |= Sight.BLURRED
        if (
            seen.filling < _FILLING
            or circle.coverage < _COVERAGE
            or circle.rms > max(_RMS * circle.radius, _SHARPEST_RMS * size)
            or abs(ratio - 1.0) > _SIZE
        ):
            status |= Sight.REFLECTION
        return status

    def _remember(self, sighting: Sighting) -> None:
        if self._last_whole is not None:
            self._last_whole = replace(self._last_whole, frames=self._last_whole.frames + 1)
        if math.isnan(sighting.diameter):
            self._lost += 1
            return
        if self._place is not None:
            self._step = (sighting.pixel - self._place) / (self._lost + 1)
        self._lost = 0
        self._place = sighting.pixel
        self._diameter = self._diameter or sighting.diameter
        self._radius = 0.5 * sighting.diameter / self.scene.pixel_size(sighting.pixel)
        if self._step is not None and Sight.REFLECTION not in sighting.status:
            self._last_whole = _Whole(self._place, self._step)


def _middles(found: Candidates) -> Array:
    """Return the middles (column, row) of the boxes."""
    return 0.5 * (found.boxes[:, :2] + found.boxes[:, 2:])[:, ::-1]
