"""Animations of runs."""

from __future__ import annotations

import math
import os
from collections.abc import Iterator, Sequence
from pathlib import Path
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure
from numpy.typing import NDArray

from asperity._base import arrays
from asperity._base.arrays import Array
from asperity._base.storage.files import atomic
from asperity.errors import ParameterError
from asperity.plot import look
from asperity.plot.runs import chosen
from asperity.plot.runs.bodies import Stage, View, draw_bodies, draw_paths, dress, staged
from asperity.plot.runs.chosen import Drawable
from asperity.runs.run import Run
from asperity.system.linear import LinearSystem
from asperity.system.rigid import RigidBodies
from asperity.track import write_video

# Free space around what moves, relative to its size.
_MARGIN = 0.08
_MOST = 10_000
# Width of a block relative to the range of all displacements, and so many lines that have names.
_BLOCK, _MOST_NAMED = 0.04, 12
_COLOURS = 64


def save_animation(
    run: Drawable,
    path: str | os.PathLike[str],
    *,
    system: RigidBodies | None = None,
    view: View = "above",
    bodies: int | Sequence[int] | None = None,
    contacts: int | Sequence[int] | None = None,
    forces: bool = True,
    paths: bool = True,
    fps: int = 25,
    speed: float = 1.0,
    size: tuple[float, float] = (4.6, 3.45),
    dpi: float = 100.0,
) -> None:
    """Write a run as a moving picture, GIF or MP4; the file is complete or not there.

    Rigid bodies are drawn as by `plot_bodies`; a `LinearSystem` whose contacts have one direction,
    such as a chain, as a block for each coordinate, which moves along a line of its own; every
    other run as a point that moves in the plane of its first two coordinates. The picture at each
    moment is that of the nearest sample.

    Args:
        run: a `Trajectory`, a `Motion` or a `LimitCycle`, of which one period is shown.
        path: ends in ``.gif``, which needs Pillow, or ``.mp4``, which needs PyAV (extra
            ``video``).
        system: the `RigidBodies` of a run without its system.
        view: as of `plot_bodies`.
        bodies: likewise.
        contacts: likewise.
        forces: likewise.
        paths: whether the paths up to the moment are drawn.
        fps: pictures per second.
        speed: seconds of the run per second of the animation: 0.1 is slow motion.
        size: width and height in inches.
        dpi: pixels per inch.

    Raises:
        ParameterError: naming the argument; ``path`` if it has another ending, or what it needs is
            not installed.
        OSError: if the file cannot be written.

    >>> import tempfile
    >>> from pathlib import Path
    >>> from asperity import FrictionLaw, SlidingPoint, simulate
    >>> from asperity.plot import save_animation
    >>> block = SlidingPoint(1.0, law=FrictionLaw.isotropic(0.5))
    >>> run = simulate(block, dt=1e-3, t_end=0.2, u0=[1.0, 1.0])
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     save_animation(run, Path(folder, "block.gif"), speed=0.5)
    """
    one = chosen.one_run(run)
    ending = Path(path).suffix.lower()
    if ending not in (".gif", ".mp4"):
        raise ParameterError("path", f"must end in .gif or .mp4, got {os.fspath(path)!r}")
    rate = arrays.count(fps, "fps")
    # GIF counts in hundredths of a second.
    interval = 1.0 / rate if ending == ".mp4" else max(round(100.0 / rate), 2) / 100.0
    moments = _moments(one, interval * arrays.positive(speed, "speed"))
    draw: _Point | _Blocks | _Bodies
    if system is not None or isinstance(one.system, RigidBodies):
        stage, times = staged(one, system, view, bodies, contacts)
        draw = _Bodies(stage, times, forces=forces, paths=paths)
    elif isinstance(one.system, LinearSystem) and all(
        contact.law.dimension == 1 for contact in one.system.contacts
    ):
        draw = _Blocks(one, paths=paths)
    elif view != "above":
        raise ParameterError("system", f"must be given for view={view!r}")
    else:
        draw = _Point(one, paths=paths)
    inches = arrays.array(size, "size", (2,))
    figure = Figure((inches[0], inches[1]), arrays.positive(dpi, "dpi"), layout="constrained")
    pictures = _pictures(figure, draw, moments)
    if ending == ".gif":
        _write_gif(pictures, path, interval)
    else:
        _write_mp4(pictures, path, rate)


class _Point:
    """Draws the point of the first two coordinates."""

    projection = None

    def __init__(self, run: Run, *, paths: bool) -> None:
        if run.q.shape[1] < 2:
            raise ParameterError(
                "run", f"must have two coordinates to be drawn, it has {run.q.shape[1]}"
            )
        self._times, self._points, self._paths = run.t, run.q[:, :2], paths
        self.limits = np.stack([self._points.min(axis=0), self._points.max(axis=0)])

    def __call__(self, ax: Axes, moment: float) -> None:
        last = _nearest(self._times, moment)
        if self._paths:
            ax.plot(*self._points[: last + 1].T, color=look.GREY, linewidth=1.2)
        ax.plot(*self._points[last : last + 1].T, "o", color=look.SLIDING, markersize=7.0)
        ax.set(aspect="equal", xlabel="$q_1$ in m", ylabel="$q_2$ in m")


class _Blocks:
    """Draws the coordinates as blocks, each on a line of its own, the first one at the top."""

    projection = None

    def __init__(self, run: Run, *, paths: bool) -> None:
        self._times, self._q, self._names, self._paths = run.t, run.q, run.labels.coordinates, paths
        low, high = float(run.q.min()), float(run.q.max())
        self._width = _BLOCK * (high - low or 1.0)
        lower, upper = low - 0.5 * self._width, high + 0.5 * self._width
        self.limits = np.array([[lower, lower], [upper, upper]])

    def __call__(self, ax: Axes, moment: float) -> None:
        last = _nearest(self._times, moment)
        rows = np.arange(self._q.shape[1])
        if self._paths:
            travelled = self._q[: last + 1]
            ax.hlines(rows, travelled.min(axis=0), travelled.max(axis=0), color=look.GREY, lw=1.0)
        left = self._q[last] - 0.5 * self._width
        ax.barh(rows, np.full(rows.size, self._width), 0.7, left, color=look.SLIDING)
        named = rows[:: math.ceil(rows.size / _MOST_NAMED)]
        ax.set_yticks(named, [self._names[row] for row in named])
        ax.set(xlabel="displacement", ylim=(rows.size - 0.5, -0.5))


class _Bodies:
    def __init__(self, stage: Stage, times: Array, *, forces: bool, paths: bool) -> None:
        self._stage, self._times, self._forces, self._paths = stage, times, forces, paths
        self.limits = stage.limits
        self.projection = "3d" if len(stage.seen) == 3 else None

    def __call__(self, ax: Axes, moment: float) -> None:
        last = _nearest(self._times, moment)
        if self._paths:
            draw_paths(ax, self._stage, last)
        draw_bodies(ax, self._stage, last, alpha=1.0, forces=self._forces)
        dress(ax, self._stage, room=False)


def _nearest(times: Array, moment: float) -> int:
    return int(np.abs(times - moment).argmin())


def _moments(run: Run, interval: float) -> Array:
    """Return the times of the pictures, the last of which is the end of the run."""
    begin, end = float(run.t[0]), float(run.t[-1])
    count = (end - begin) / interval
    if count > _MOST:
        raise ParameterError(
            "speed", f"must leave at most {_MOST} pictures, {count:.3g} s would be drawn"
        )
    return np.append(begin + interval * np.arange(int(np.ceil(count - 1e-9))), end)


def _pictures(
    figure: Figure, draw: _Point | _Blocks | _Bodies, moments: Array
) -> Iterator[NDArray[np.uint8]]:
    """Yield the pictures, shape ``(rows, columns, 3)``, with the axes at the same place in all."""
    # Its methods have no types.
    canvas: Any = FigureCanvasAgg(figure)
    with look.style():
        ax = figure.add_subplot(projection=draw.projection)
    lower, upper = draw.limits
    margin = _MARGIN * max(float(np.ptp(draw.limits, axis=0).max()), np.finfo(float).tiny)
    for number, moment in enumerate(moments):
        with look.style():
            ax.clear()
            names = ("x", "y", "z")[: len(lower)]
            for name, low, high in zip(names, lower - margin, upper + margin, strict=True):
                ax.set(**{f"{name}lim": (low, high)})
            draw(ax, float(moment))
            ax.set_title(f"t = {moment:.3f} s")
            canvas.draw()
        if number == 0:
            figure.set_layout_engine("none")
        yield np.asarray(canvas.buffer_rgba())[..., :3].copy()


def _write_gif(
    pictures: Iterator[NDArray[np.uint8]], path: str | os.PathLike[str], interval: float
) -> None:
    try:
        from PIL import Image
    except ImportError:
        raise ParameterError("path", ".gif needs Pillow (pip install pillow)") from None
    images = [Image.fromarray(one).quantize(_COLOURS) for one in pictures]
    with atomic(path) as file:
        options = {"duration": round(1e3 * interval), "loop": 0, "disposal": 2}
        images[0].save(file, "GIF", save_all=True, append_images=images[1:], **options)


def _write_mp4(
    pictures: Iterator[NDArray[np.uint8]], path: str | os.PathLike[str], rate: int
) -> None:
    # The format has even numbers of rows and columns.
    even = (one[: len(one) // 2 * 2, : one.shape[1] // 2 * 2] for one in pictures)
    try:
        write_video(even, path, rate=rate)
    except ImportError:
        raise ParameterError(
            "path", '.mp4 needs PyAV (pip install "asperity[video]"); .gif does without'
        ) from None
