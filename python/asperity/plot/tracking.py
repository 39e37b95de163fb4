"""Plots of what a camera has seen."""

from __future__ import annotations

from typing import Any

import numpy as np
from matplotlib.axes import Axes
from numpy.typing import NDArray

from asperity._base import arrays
from asperity.errors import ParameterError
from asperity.plot import look
from asperity.track import Sight, Track

# Saturated, since they are drawn on photographs.
_SEEN = {
    Sight.GOOD: ("#00E5FF", "good"),
    Sight.BLURRED: ("#FFD400", "blurred"),
    Sight.REFLECTION: ("#FF7AF2", "reflection"),
    Sight.AMBIGUOUS: ("#FF3B30", "ambiguous"),
}


def plot_track(
    track: Track,
    *,
    ax: Axes | None = None,
    image: NDArray[np.uint8] | None = None,
    every: int = 1,
    **kwargs: Any,
) -> Axes:
    """Draw the tracked centres in the image, and the last circle.

    Args:
        track: what was seen.
        ax: axes; default new ones.
        image: a frame for the background, shape ``(rows, columns, 3)`` of uint8.
        every: draws every n-th frame.
        **kwargs: of the centres, as for ``Axes.plot``.

    Returns:
        The axes.

    Reference: [WL19] Fig. 18b.

    >>> import matplotlib
    >>> matplotlib.use("Agg")
    >>> import numpy as np
    >>> from asperity.plot import plot_track
    >>> from asperity.track import PlaneView, track_mark
    >>> frame = np.full((60, 80, 3), 120, dtype=np.uint8)
    >>> frame[20:40, 30:50] = 200, 30, 30
    >>> track = track_mark([frame] * 3, fps=500.0, scene=PlaneView.from_scale(1e-3))
    >>> plot_track(track, image=frame).get_ylabel()
    'row'
    """
    arrays.of_kind(track, "track", Track, "a Track")
    every = arrays.count(every, "every")
    if image is not None and (np.ma.isMaskedArray(image) or np.asarray(image).dtype != np.uint8):
        raise ParameterError("image", "must be an array of uint8, (rows, columns, 3)")
    with look.drawing(ax) as ax:
        if image is not None:
            ax.imshow(image)
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
                ax.plot(
                    *track.pixel[shown].T,
                    **{"color": colour, "label": label, **options, **look.line_options(kwargs)},
                )
        _last_circle(track, ax)
        ax.set_aspect("equal")
        ax.grid(False)
        ax.set(xlabel="column", ylabel="row")
        return ax


def _last_circle(track: Track, ax: Axes) -> None:
    known = np.flatnonzero(~np.isnan(track.diameter))
    if not len(known):
        return
    last = known[-1]
    turn = np.linspace(0.0, 2.0 * np.pi, 181)
    rim = track.position[last] + 0.5 * track.diameter[last] * arrays.unit_vectors(turn)
    ax.plot(*track.scene.to_pixels(rim).T, color="#FFFFFF", linewidth=1.0)
