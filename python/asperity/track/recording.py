"""From a recording and its configuration to a path, with figures, tables and a report."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from asperity._base.progress import Progress
from asperity._base.report import Facts, Picture, Section, write_report
from asperity._base.storage.files import ResultFolder
from asperity._base.tables import aligned
from asperity.errors import ParameterError
from asperity.track.config import TrackConfig, read_config
from asperity.track.film.frames import Frame, Frames, Pixels, open_frames
from asperity.track.following.sight import Sight
from asperity.track.path import MeasuredPath
from asperity.track.track import Track, track_mark

if TYPE_CHECKING:
    from matplotlib.figure import Figure

_LOST_AT_MOST = 0.1
_LISTED = 20
FILES = ("frames.csv", "path.csv", "overlay.png", "motion.png", "report.html")
"""What `track_recording` writes."""


@dataclass(frozen=True)
class TrackedRecording:
    """A tracked recording.

    Attributes:
        source: name of the recording.
        config: what was read from the configuration.
        track: what was seen.
        path: the measured path.
        last: the last frame.
    """

    source: str
    config: TrackConfig
    track: Track
    path: MeasuredPath
    last: Pixels

    @property
    def complete(self) -> bool:
        """Whether the position is known in nine frames of ten, and the body rests in the end."""
        known = bool(np.mean(~self.path.seen) <= _LOST_AT_MOST)
        return known and self.path.comes_to_rest

    def facts(self) -> list[tuple[str, str]]:
        """Return what there is to say, as pairs of name and text."""
        track, path = self.track, self.path
        first = path.onset
        x0 = path.position[first]
        error = np.nanmedian(track.position_error, axis=0)
        rows = [
            ("recording", f"{self.source}, {len(track)} frames at {track.fps:g} 1/s (stated)"),
            ("frames", track.quality),
            ("diameter of the mark", f"{1e3 * np.nanmedian(track.diameter):.4g} mm"),
            (
                "standard error of a centre",
                f"{1e6 * error[0]:.2g}, {1e6 * error[1]:.2g} µm "
                "(of the outline; those of the scene come on top)",
            ),
            ("motion", f"{path.section[0]:.4f} to {path.section[1]:.4f} s"),
            ("position at its onset", f"{1e3 * x0[0]:.3f}, {1e3 * x0[1]:.3f} mm"),
            ("velocity at its onset", _first_velocity(path)),
            ("end point", _end_point(path)),
            ("bandwidth", f"± {1e3 * path.bandwidth:.3g} ms, local cubics"),
        ]
        if self.config.mismatch:
            rows.append(("points of the scene", f"{self.config.mismatch:.2g} pixels off (rms)"))
        if path.misfit.any():
            numbers = np.flatnonzero(path.misfit).astype(np.int64)
            rows.append(("smoothed over", f"frames {_spans(numbers)}: the bandwidth is too wide"))
        for sight in Sight:
            numbers = track.frames(sight)
            if len(numbers):
                rows.append((str(sight), f"frames {_spans(numbers)}"))
        return rows

    def summary(self) -> str:
        """Return what there is to say as lines of text."""
        return aligned(self.facts())

    def write(self, folder: Path) -> None:
        """Write what `FILES` lists into a folder."""
        from asperity.plot.look import png

        self.path.to_csv(folder / "path.csv")
        self.track.to_csv(folder / "frames.csv")
        pictures = [Picture(name, png(one, 150)) for name, one in self._figures().items()]
        for picture in pictures:
            (folder / f"{picture.name}.png").write_bytes(picture.png)
        contents = Section("", Facts(self.facts()), *pictures)
        write_report(folder / "report.html", f"Tracked path: {self.source}", [contents])

    def _figures(self) -> dict[str, Figure]:
        from matplotlib.figure import Figure

        from asperity.plot import plot_history, plot_path, plot_track, style

        with style():
            overlay = Figure(figsize=(9.0, 5.5), layout="constrained")
            motion = Figure(figsize=(9.0, 4.5), layout="constrained")
            ax = plot_track(self.track, ax=overlay.add_subplot(), image=self.last)
            ax.set_title(f"{len(self.track)} frames, {1e3 / self.track.fps:.3g} ms apart")
            ax.legend(loc="upper right", labelcolor="white")
            grid = motion.add_gridspec(2, 2)
            plot_path(self.path, ax=motion.add_subplot(grid[:, 0]))
            speed = motion.add_subplot(grid[0, 1])
            plot_history(self.path, quantity="speed", ax=speed)
            acceleration = motion.add_subplot(grid[1, 1], sharex=speed)
            plot_history(self.path, quantity="acceleration", ax=acceleration)
            speed.set_title(
                f"cubics within ± {1e3 * self.path.bandwidth:.3g} ms, 2 standard errors"
            )
        return {"overlay": overlay, "motion": motion}


def _first_velocity(path: MeasuredPath) -> str:
    v0, error = path.velocity[path.onset], 2.0 * path.velocity_error[path.onset]
    if np.isnan(v0).any():
        return "not known: too few frames with the mark are near"
    return f"{v0[0]:.4f} ± {error[0]:.4f}, {v0[1]:.4f} ± {error[1]:.4f} m/s (2 standard errors)"


def _end_point(path: MeasuredPath) -> str:
    if not path.comes_to_rest:
        return "none: the body does not come to rest in view"
    return "{:.3f}, {:.3f} mm".format(*1e3 * path.end)


def track_recording(
    video: Path,
    config: Path,
    out: Path,
    *,
    progress: Progress = None,
) -> TrackedRecording:
    """Track a recording and write what `FILES` lists into `out`; nothing if something is wrong.

    Args:
        video: a video, or a folder of images.
        config: TOML file, see `read_config`.
        out: folder; made if it is not there.
        progress: as of `track_mark`.

    Raises:
        ConfigurationError: naming file, line and key.
        ParameterError: naming the recording or the folder and what is wrong with it.
    """
    folder = ResultFolder(out, FILES, [video, config])
    settings = read_config(config)
    frames = _Watched(open_frames(video))
    track = track_mark(
        frames, fps=settings.fps, scene=settings.scene, mark=settings.mark, progress=progress
    )
    try:
        path = track.path(settings.bandwidth, start=settings.start, stop=settings.stop)
    except ParameterError as error:
        key = {"section": "start"}.get(error.argument, error.argument)
        if settings.file is not None and key in settings.file.values:
            raise settings.file.error(key, error.message) from None
        raise ParameterError(str(video), f"is too short a recording: {error}") from None
    result = TrackedRecording(str(video), settings, track, path, frames.last)
    with folder.filled() as place:
        result.write(place)
    return result


class _Watched:
    """Frames of which the last one is kept."""

    def __init__(self, frames: Frames) -> None:
        self._frames = frames
        self._last: Frame | None = None
        self.source = frames.source

    def __len__(self) -> int:
        return len(self._frames)

    def __iter__(self) -> Iterator[Frame]:
        for frame in self._frames:
            self._last = frame
            yield frame

    @property
    def last(self) -> Pixels:
        if self._last is None:
            raise ParameterError(self.source, "holds no frame")
        return self._last.crop(slice(None), slice(None))


def _spans(numbers: NDArray[np.int64]) -> str:
    """Return numbers as text, runs of them as first-last."""
    parts = np.split(numbers, np.flatnonzero(np.diff(numbers) > 1) + 1)
    spans = [str(p[0]) if len(p) == 1 else f"{p[0]}-{p[-1]}" for p in parts]
    return ", ".join(spans[:_LISTED] + ["…"] * (len(spans) > _LISTED))
