"""Where to look for the mark in the next frame, and what is seen there."""

from __future__ import annotations

import math

import numpy as np

from asperity._arrays import Array
from asperity.errors import ParameterError
from asperity.track.circle import Circle, fit_circle
from asperity.track.frames import Frame
from asperity.track.scene import Scene
from asperity.track.segmentation import Candidates, Mark, Outline, outline, search
from asperity.track.sight import Sight, Sighting

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


class Follower:
    """The mark as it was in the frames so far."""

    def __init__(self, scene: Scene, mark: Mark) -> None:
        if not isinstance(mark, Mark):
            raise ParameterError("mark", f"must be a Mark, got {mark!r}")
        self.scene = scene
        self.mark = mark
        self._diameter: float | None = None
        self._place: Array | None = None
        self._step = np.zeros(2)
        self._radius = 0.0
        self._background: float | None = None

    def look(self, frame: Frame) -> Sighting:
        """Return what the next frame shows."""
        sighting = Sighting.none(Sight.LOST)
        if self._place is not None:
            reach = _REGION * self._radius + 0.5 * float(np.hypot(*self._step)) + _BORDER
            sighting = self._measure(frame, self._place + self._step, reach)
        if Sight.LOST in sighting.status:
            sighting = self._search(frame)
        self._remember(sighting)
        return sighting

    def _search(self, frame: Frame) -> Sighting:
        whole = frame.crop(slice(None), slice(None))
        for step in _STEPS:
            found = search(whole, self.mark, step)
            self._background = found.background
            if len(found.boxes):
                box = found.boxes[self._chosen(found, frame)]
                middle = 0.5 * (box[:2] + box[2:])[::-1]
                reach = 0.6 * float(np.max(box[2:] - box[:2])) + _BORDER
                return self._measure(frame, middle, reach)
        return Sighting.none(Sight.LOST)

    def _chosen(self, found: Candidates, frame: Frame) -> int:
        area = self._area(frame)
        if area is None:
            return int(found.areas.argmax())
        return int(np.abs(np.log(found.areas / area)).argmin())

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
        if math.isnan(sighting.diameter):
            # Without a place the next frame is searched.
            self._place = None
            self._step = np.zeros(2)
            return
        self._step = np.zeros(2) if self._place is None else sighting.pixel - self._place
        self._place = sighting.pixel
        self._diameter = self._diameter or sighting.diameter
        self._radius = 0.5 * sighting.diameter / self.scene.pixel_size(sighting.pixel)
