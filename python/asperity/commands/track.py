"""Tracking a recording from its file, the command ``asperity track``."""

from __future__ import annotations

import base64
import html
import io
from collections.abc import Callable, Iterator
from contextlib import AbstractContextManager, nullcontext
from dataclasses import dataclass
from importlib.util import find_spec
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from asperity._base.files import all_or_none, check_folder
from asperity._base.progress import bar
from asperity.errors import ParameterError
from asperity.track import MeasuredPath, Sight, Track, TrackConfig, read_config, track_mark
from asperity.track.frames import Frame, Frames, Pixels, open_frames

if TYPE_CHECKING:
    from matplotlib.figure import Figure

_LOST_AT_MOST = 0.1
_LISTED = 20
_FILES = ("path.csv", "frames.csv", "overlay.png", "motion.png", "report.html")


@dataclass(frozen=True)
class Result:
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

    def rows(self) -> list[tuple[str, str]]:
        """Return what there is to say, as pairs of name and text."""
        track, path = self.track, self.path
        first = path.onset
        x0 = path.position[first]
        error = np.nanmedian(track.position_error, axis=0)
        rows = [
            ("recording", f"{self.source}, {len(track)} frames at {track.fps:g} 1/s (stated)"),
            ("frames", track.summary()),
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

    def text(self) -> str:
        """Return the rows as a table."""
        width = max(len(name) for name, _ in self.rows())
        return "\n".join(f"{name:<{width}}  {value}" for name, value in self.rows())


def _first_velocity(path: MeasuredPath) -> str:
    v0, error = path.velocity[path.onset], 2.0 * path.velocity_error[path.onset]
    if np.isnan(v0).any():
        return "not known: too few frames with the mark are near"
    return f"{v0[0]:.4f} ± {error[0]:.4f}, {v0[1]:.4f} ± {error[1]:.4f} m/s (2 standard errors)"


def _end_point(path: MeasuredPath) -> str:
    if not path.comes_to_rest:
        return "none: the body does not come to rest in view"
    return "{:.3f}, {:.3f} mm".format(*1e3 * path.end)


def run(video: Path, config: Path, out: Path) -> Result:
    """Track a recording and write tables, figures and report, after everything has succeeded.

    Raises:
        ParameterError: naming the file or argument and what is wrong with it.
    """
    check_folder(out, _FILES)
    settings = read_config(config)
    frames = _Watched(open_frames(video))
    with _bar(len(frames)) as move:
        track = track_mark(
            frames, fps=settings.fps, scene=settings.scene, mark=settings.mark, progress=move
        )
    try:
        path = track.path(settings.bandwidth, start=settings.start, stop=settings.stop)
    except ParameterError as error:
        if error.argument in ("bandwidth", "section"):
            key = "bandwidth" if error.argument == "bandwidth" else "start, stop"
            told = str(error).removeprefix(f"{error.argument}: ")
            raise ParameterError(config.name, f"{key}: {told}") from None
        raise ParameterError(str(video), f"is too short a recording: {error}") from None
    result = Result(str(video), settings, track, path, frames.last)
    overlay, motion = _overlay(result), _motion(path)
    with all_or_none(out, _FILES) as folder:
        path.to_csv(folder / "path.csv")
        track.to_csv(folder / "frames.csv")
        (folder / "overlay.png").write_bytes(overlay)
        (folder / "motion.png").write_bytes(motion)
        (folder / "report.html").write_text(_report(result, overlay, motion), encoding="utf-8")
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


def _bar(frames: int) -> AbstractContextManager[Callable[[int, int], object] | None]:
    return bar(frames) if find_spec("tqdm") else nullcontext()


def _overlay(result: Result) -> bytes:
    import matplotlib.pyplot as plt

    from asperity.plot import plot_track, style

    with style():
        figure, ax = plt.subplots(figsize=(9.0, 5.5), layout="constrained")
        plot_track(result.track, ax, image=result.last)
        ax.set_title(f"{len(result.track)} frames, {1e3 / result.track.fps:.3g} ms apart")
        ax.legend(loc="upper right", labelcolor="white")
    return _png(figure)


def _motion(path: MeasuredPath) -> bytes:
    import matplotlib.pyplot as plt

    from asperity.plot import plot_motion, style

    with style():
        figure = plt.figure(figsize=(9.0, 4.5), layout="constrained")
        plot_motion(path, figure)
    return _png(figure)


def _png(figure: Figure) -> bytes:
    import matplotlib.pyplot as plt

    file = io.BytesIO()
    figure.savefig(file, dpi=150, format="png")
    plt.close(figure)
    return file.getvalue()


def _report(result: Result, *figures: bytes) -> str:
    rows = "\n".join(
        f"<tr><th>{html.escape(name)}</th><td>{html.escape(value)}</td></tr>"
        for name, value in result.rows()
    )
    images = "\n".join(
        f'<img alt="figure" src="data:image/png;base64,{base64.b64encode(one).decode()}">'
        for one in figures
    )
    return f"""<!doctype html>
<html lang="en">
<meta charset="utf-8">
<title>Tracked path: {html.escape(result.source)}</title>
<style>
body {{ font: 16px/1.5 system-ui, sans-serif; color: #222; max-width: 60em; margin: 2em auto; }}
th {{ text-align: left; font-weight: 600; padding-right: 2em; vertical-align: top; }}
img {{ display: block; width: 100%; margin-top: 2em; }}
</style>
<h1>Tracked path</h1>
<table>
{rows}
</table>
{images}
</html>
"""


def _spans(numbers: NDArray[np.int64]) -> str:
    """Return numbers as text, runs of them as first-last."""
    parts = np.split(numbers, np.flatnonzero(np.diff(numbers) > 1) + 1)
    spans = [str(p[0]) if len(p) == 1 else f"{p[0]}-{p[-1]}" for p in parts]
    return ", ".join(spans[:_LISTED] + ["…"] * (len(spans) > _LISTED))
