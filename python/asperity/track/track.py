"""Following a mark from frame to frame."""

from __future__ import annotations

import math
import os
from collections.abc import Iterable, Sequence

import numpy as np
from numpy.typing import NDArray

from asperity._base import arrays
from asperity._base.arrays import Array
from asperity._base.log import log
from asperity._base.progress import Progress, reporter
from asperity._base.result import Axis, Series, Table, TableResult, counted
from asperity._base.value import Positive, Record
from asperity.errors import ParameterError
from asperity.track.film.frames import Frames, Pixels, open_frames
from asperity.track.following import repeats
from asperity.track.following.follower import Follower
from asperity.track.following.sight import Sight, Sighting
from asperity.track.image.scene import PlaneView
from asperity.track.image.segmentation import Mark
from asperity.track.path import MeasuredPath

_WRONG_SCALE = 0.1


class Track(TableResult, Record):
    """What was seen of a mark in every frame; all arrays are read-only.

    Frame k is taken at k/fps. Frames without a position hold NaN.

    Attributes:
        fps: frames per second of the recording in 1/s.
        scene: from pixels to the plane.
        pixel: image of the centre (column, row), shape ``(n, 2)``.
        position: centre in m, shape ``(n, 2)``.
        position_error: its standard errors from the scatter of the outline in m, shape ``(n, 2)``.
        diameter: of the circle in m, shape ``(n,)``.
        blur: width of the most blurred edges in pixels, shape ``(n,)``.
        filling: share of the mark's hull that has its colour, shape ``(n,)``.
        coverage: share of the circle on which the outline was used, shape ``(n,)``.
        status: `Sight` of each frame as integers, shape ``(n,)``.
    """

    _picture = "plot_track"
    _digits = 10

    fps: Positive
    scene: PlaneView
    pixel: Array
    position: Array
    position_error: Array
    diameter: Array
    blur: Array
    filling: Array
    coverage: Array
    status: NDArray[np.int64]

    def __len__(self) -> int:
        return len(self.status)

    def __repr__(self) -> str:
        return f"<Track: {len(self)} frames at {self.fps:.9g}/s, {self.quality}>"

    @property
    def time(self) -> Array:
        """Times of the frames in s, shape ``(n,)``."""
        return np.arange(len(self)) / self.fps

    def frames(self, sight: Sight) -> NDArray[np.int64]:
        """Return the numbers of the frames with a status, such as ``Sight.LOST``."""
        return np.flatnonzero(self.status & int(sight)).astype(np.int64)

    @property
    def quality(self) -> str:
        """Return how many frames are good, blurred and so on."""
        good = int((self.status == 0).sum())
        troubles = [(one.name or "", len(self.frames(one))) for one in Sight if one]
        told = (f"{count} {name.lower()}" for name, count in troubles if count)
        return ", ".join([f"{good} good", *told])

    def summary(self) -> str:
        """Return what the frames show, in sentences."""
        lines = [
            f"The film has {counted(len(self), 'frame')} at {self.fps:.9g} frames per second: "
            f"{self.quality}."
        ]
        seen = np.isfinite(self.position).all(axis=1)
        if seen.any():
            ends = np.flatnonzero(seen)[[0, -1]]
            (x, y), (v, w) = 1e3 * self.position[ends]
            lines.append(
                f"The mark goes from ({x:.6g}, {y:.6g}) mm to ({v:.6g}, {w:.6g}) mm between "
                f"t = {self.time[ends[0]]:.6g} s and {self.time[ends[1]]:.6g} s; its diameter is "
                f"{1e3 * np.nanmedian(self.diameter):.4g} mm."
            )
        return "\n".join(lines)

    def path(
        self,
        bandwidth: float | None = None,
        *,
        start: float | None = None,
        stop: float | None = None,
    ) -> MeasuredPath:
        """Return the path with velocity and acceleration.

        Args:
            bandwidth: half width of the window of their local cubics in s; default a tenth of the
                time in which the body moves.
            start: time of the first frame in which it moves in s; default what the frames show.
            stop: time of the last one in s.
        """
        found = MeasuredPath(self.time, self.position, self.position_error)
        if start is not None or stop is not None:
            first, last = found.section
            section = (
                first if start is None else arrays.number(start, "start"),
                last if stop is None else arrays.number(stop, "stop"),
            )
            found = MeasuredPath(self.time, self.position, self.position_error, section=section)
        return found if bandwidth is None else found.replace(bandwidth=bandwidth)

    def _table(self) -> Table:
        frame = ("frame",)
        words = np.array([str(Sight(status)) for status in self.status.tolist()], dtype=np.str_)
        series = {"t": Series(self.time, frame, "s", "time")}
        for name, labels, unit in (
            ("pixel", ("column", "row"), "px"),
            ("position", ("x1", "x2"), "m"),
            ("position_error", ("x1_error", "x2_error"), "m"),
        ):
            values = getattr(self, name)
            for k, label in enumerate(labels):
                series[label] = Series(values[:, k], frame, unit, f"{name} of the mark")
        for name, unit in (("diameter", "m"), ("blur", "px"), ("filling", "-"), ("coverage", "-")):
            series[name] = Series(getattr(self, name), frame, unit, f"{name} of the mark")
        series["status"] = Series(words, frame, "", "how well the mark is seen")
        return Table({"frame": Axis(np.arange(len(self)), "", "frame")}, series, {"fps": self.fps})


def track_mark(
    frames: str | os.PathLike[str] | Frames | Iterable[Pixels],
    *,
    fps: float,
    scene: PlaneView,
    mark: Mark | None = None,
    progress: Progress = None,
) -> Track:
    """Follow a round mark through the frames.

    In a region around the expected place, and where it is not there as far from its last way as
    friction and a push may have moved it: Gaussian
    filter, regions of the mark's colour, edge between pixels, convex hull, least-squares circle in
    the plane of the mark. The circle is fitted in the plane, since the image of its centre is not
    the centre of its image under perspective.

    Args:
        frames: a folder of images, a video file, or arrays ``(rows, columns, 3)`` of uint8.
        fps: frames per second at which they were recorded in 1/s; the rate a slow-motion file
            states is that of its playback.
        scene: from pixels to the plane in which the mark moves.
        mark: what to look for; default `Mark`, red.
        progress: ``True`` for a bar of tqdm, or a function of (frames done, all frames), where 0 is
            not known.

    Raises:
        ParameterError: if frames cannot be read, no frame shows the mark, or its diameter is not
            the stated one.

    Reference: [WL19] §5.1.

    >>> import numpy as np
    >>> row, column = np.mgrid[:80, :120]
    >>> frames = np.full((9, 80, 120, 3), 120, dtype=np.uint8)
    >>> for k, frame in enumerate(frames):
    ...     frame[np.hypot(column - 40.0 - 3.0 * k, row - 40.0) < 12.0] = 200, 30, 30
    >>> track = track_mark(frames, fps=500.0, scene=PlaneView.from_scale(1e-3))
    >>> track.quality
    '9 good'
    >>> (track.pixel[8] - track.pixel[0]).round(3).tolist()
    [24.0, 0.0]
    """
    fps = arrays.positive(fps, "fps")
    arrays.of_kind(scene, "scene", PlaneView, "a PlaneView")
    source = open_frames(frames)
    follower = Follower(scene, mark or Mark(), fps)
    changes = repeats.Changes()
    sightings = []
    with reporter(progress, "frame") as report:
        for number, frame in enumerate(source):
            sightings.append(follower.look(frame))
            changes.add(frame)
            if report is not None:
                report(number + 1, len(source))
    _check(sightings, follower.mark, source.source)
    unseen = sum(math.isnan(one.diameter) for one in sightings)
    if unseen:
        log.warning("track_mark: %d of %d frames do not show the mark", unseen, len(sightings))
    sightings = repeats.marked(sightings, changes)
    return Track(
        fps,
        scene,
        *(np.array([getattr(one, name) for one in sightings]) for name in _SERIES),
    )


_SERIES = (
    "pixel", "position", "position_error", "diameter", "blur", "filling", "coverage", "status"
)  # fmt: skip


def _check(sightings: Sequence[Sighting], mark: Mark, source: str) -> None:
    if not sightings:
        raise ParameterError(source, "holds no frame")
    diameters = [one.diameter for one in sightings if not math.isnan(one.diameter)]
    if not diameters:
        raise ParameterError(
            source,
            f"shows no {mark.colour} mark in any of {len(sightings)} frames: check the colour and "
            f"the threshold {mark.threshold:g} of the mark",
        )
    seen = float(np.median(diameters))
    if mark.diameter is not None and abs(seen / mark.diameter - 1.0) > _WRONG_SCALE:
        raise ParameterError(
            "mark.diameter",
            f"is stated as {1e3 * mark.diameter:.4g} mm, the {mark.colour} mark in {source} has "
            f"{1e3 * seen:.4g} mm: check it and the scale of the scene (lengths are in m)",
        )
