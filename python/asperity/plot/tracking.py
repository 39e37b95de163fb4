"""Plots of what a camera has seen."""

from __future__ import annotations

from typing import Any

import numpy as np
from matplotlib.artist import Artist
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from numpy.typing import NDArray

from asperity._base import arrays
from asperity.errors import ParameterError
from asperity.plot import look
from asperity.track import MeasuredPath, Sight, Track

# Saturated, since they are drawn on photographs.
_SEEN = {
    Sight.GOOD: ("#00E5FF", "good"),
    Sight.BLURRED: ("#FFD400", "blurred"),
    Sight.REFLECTION: ("#FF7AF2", "reflection"),
    Sight.AMBIGUOUS: ("#FF3B30", "ambiguous"),
}


def plot_track(
    track: Track,
    ax: Axes | None = None,
    *,
    image: NDArray[np.uint8] | None = None,
    every: int = 1,
    **kwargs: Any,
) -> list[Artist]:
    """Draw the tracked centres in the image, and the last circle.

    Args:
        track: what was seen.
        ax: axes; default new ones.
        image: a frame for the background, shape ``(rows, columns, 3)`` of uint8.
        every: draws every n-th frame.
        **kwargs: of the centres, as for ``Axes.plot``.

    Returns:
        The image if there is one, the centres by status, and the last circle.

    Reference: [WL19] Fig. 18b.

    >>> import matplotlib
    >>> matplotlib.use("Agg")
    >>> import numpy as np
    >>> from asperity.plot import plot_track
    >>> from asperity.track import Scene, track_mark
    >>> frame = np.full((60, 80, 3), 120, dtype=np.uint8)
    >>> frame[20:40, 30:50] = 200, 30, 30
    >>> track = track_mark([frame] * 3, fps=500.0, scene=Scene.from_scale(1e-3))
    >>> len(plot_track(track, image=frame))
    3
    """
    if not isinstance(track, Track):
        raise ParameterError("track", f"must be a Track, got {track!r}")
    every = arrays.count(every, "every")
    if image is not None and (np.ma.isMaskedArray(image) or np.asarray(image).dtype != np.uint8):
        raise ParameterError("image", "must be an array of uint8, (rows, columns, 3)")
    ax = look.axes_or_new(ax)
    artists: list[Artist] = []
    if image is not None:
        artists.append(ax.imshow(image))
    elif not ax.yaxis_inverted():
        ax.invert_yaxis()
    options = {"marker": "+", "markersize": 5.0, "linestyle": "none"}
    chosen = np.arange(len(track)) % every == 0
    known = ~np.isnan(track.pixel[:, 0])
    reflection = track.status & int(Sight.REFLECTION) > 0
    blurred = (track.status & int(Sight.BLURRED) > 0) & ~reflection
    ambiguous = track.status & int(Sight.AMBIGUOUS) > 0
    groups = {
        Sight.GOOD: ~reflection & ~blurred & ~ambiguous,
        Sight.BLURRED: blurred & ~ambiguous,
        Sight.REFLECTION: reflection & ~ambiguous,
        Sight.AMBIGUOUS: ambiguous,
    }
    for sight, group in groups.items():
        shown = group & known & chosen
        if shown.any():
            colour, label = _SEEN[sight]
            artists += ax.plot(
                *track.pixel[shown].T,
                **{"color": colour, "label": label, **options, **look.line_options(kwargs)},
            )
    artists += _last_circle(track, ax)
    ax.set_aspect("equal")
    ax.grid(False)
    ax.set_xlabel("column")
    ax.set_ylabel("row")
    return artists


def plot_motion(path: MeasuredPath, figure: Figure | None = None) -> list[Artist]:
    """Draw path, speed and acceleration with bands of two standard errors.

    Args:
        path: of `Track.path`.
        figure: default a new one.

    Returns:
        The path and its end, hollow without rest, then curve and band of speed and of both
        accelerations.

    >>> import matplotlib
    >>> matplotlib.use("Agg")
    >>> import numpy as np
    >>> from asperity.plot import plot_motion
    >>> from asperity.track import MeasuredPath
    >>> t = np.linspace(0.0, 0.3, 151)
    >>> x = np.column_stack([1.5 * t - 2.5 * t**2, 0.5 * t])
    >>> len(plot_motion(MeasuredPath(t, x, np.full_like(x, 1e-5))))
    8
    """
    if not isinstance(path, MeasuredPath):
        raise ParameterError("path", f"must be a MeasuredPath, got {path!r}")
    if figure is None:
        import matplotlib.pyplot as plt

        with look.style():
            figure = plt.figure(figsize=(9.0, 4.5), layout="constrained")
    with look.style():
        grid = figure.add_gridspec(2, 2)
        plane = figure.add_subplot(grid[:, 0])
        speeds = figure.add_subplot(grid[0, 1])
        accelerations = figure.add_subplot(grid[1, 1], sharex=speeds)
    artists: list[Artist] = list(plane.plot(*1e3 * path.position.T, color=look.SLIDING))
    last = path.end if path.comes_to_rest else path.position[path.seen][-1]
    face = look.INK if path.comes_to_rest else "none"
    artists += plane.plot(*1e3 * last, "o", color=look.INK, markerfacecolor=face, markersize=4.5)
    plane.set_aspect("equal", adjustable="datalim")
    plane.set_xlabel(r"$x_1$ [mm]")
    plane.set_ylabel(r"$x_2$ [mm]")
    speed = np.hypot(*path.velocity.T)
    along = path.velocity / np.maximum(speed, np.finfo(float).tiny)[:, None]
    error = np.sqrt(((along * path.velocity_error) ** 2).sum(axis=1))
    artists += _band(speeds, path.time, speed, error, look.SLIDING, "")
    for i, colour in enumerate((look.RESERVOIR, look.DIRECTION)):
        artists += _band(
            accelerations,
            path.time,
            path.acceleration[:, i],
            path.acceleration_error[:, i],
            colour,
            rf"$\ddot x_{i + 1}$",
        )
    accelerations.legend()
    speeds.set_ylabel("speed [m/s]")
    accelerations.set_ylabel("acceleration [m/s²]")
    accelerations.set_xlabel("time [s]")
    speeds.set_title(f"cubics within ± {1e3 * path.bandwidth:.3g} ms, 2 standard errors")
    return artists


def _band(ax: Axes, time: Any, values: Any, error: Any, colour: str, label: str) -> list[Artist]:
    (line,) = ax.plot(time, values, color=colour, label=label)
    band = ax.fill_between(
        time, values - 2.0 * error, values + 2.0 * error, color=colour, alpha=0.25, linewidth=0.0
    )
    return [line, band]


def _last_circle(track: Track, ax: Axes) -> list[Artist]:
    known = np.flatnonzero(~np.isnan(track.diameter))
    if not len(known):
        return []
    last = known[-1]
    turn = np.linspace(0.0, 2.0 * np.pi, 181)
    rim = track.position[last] + 0.5 * track.diameter[last] * arrays.unit_vectors(turn)
    return list(ax.plot(*track.scene.to_pixels(rim).T, color="#FFFFFF", linewidth=1.0))
