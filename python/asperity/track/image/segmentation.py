"""The outline of a coloured mark in a part of a frame."""

from __future__ import annotations

import math
from dataclasses import KW_ONLY, dataclass
from typing import Annotated, Literal

import numpy as np
from numpy.typing import NDArray

from asperity._base import arrays
from asperity._base.arrays import Array
from asperity._base.value import Positive, Record
from asperity.errors import ParameterError
from asperity.track.film.frames import Pixels

Colour = Literal["red", "green", "blue", "yellow", "magenta", "cyan", "white", "black"]
_COLOURS: dict[str, tuple[tuple[int, ...], tuple[int, ...]]] = {
    "red": ((0,), (1, 2)),
    "green": ((1,), (0, 2)),
    "blue": ((2,), (0, 1)),
    "yellow": ((0, 1), (2,)),
    "magenta": ((0, 2), (1,)),
    "cyan": ((1, 2), (0,)),
    "white": ((0, 1, 2), ()),
    "black": ((), (0, 1, 2)),
}

_Mask = NDArray[np.bool_]
_FEWEST_PIXELS = 12
# How far inside the hull a point still counts as one of the outline, in pixels.
_HULL_DEPTH = 1.0
# The strength of the mark as a percentile: blurred edges and reflections are below it.
_FULL = 75.0
# The width of the most blurred edges, as a percentile of all.
_WIDEST = 90.0
# Beyond these no mark is found, or the filter is wider than the mark and takes for ever.
_STRONGEST, _SMOOTHEST = 254.0, 50.0


def _threshold(value: float, argument: str) -> float:
    return _at_most(_STRONGEST, arrays.positive(value, argument), argument)


def _smoothing(value: float, argument: str) -> float:
    return _at_most(_SMOOTHEST, arrays.non_negative(value, argument), argument)


def _at_most(limit: float, value: float, argument: str) -> float:
    if value > limit:
        raise ParameterError(argument, f"must be at most {limit:g}, got {value:g}")
    return value


class Mark(Record):
    """A round mark of one colour on the body that slides.

    Args:
        colour: ``"red"``, ``"green"``, ``"blue"``, ``"yellow"``, ``"magenta"``, ``"cyan"``,
            ``"white"`` or ``"black"``. The strength of red is R − max(G, B), that of yellow
            min(R, G) − B, so that grey and its reflections have none.
        diameter: in m; ``None`` takes the mark as it is in the first frame. A diameter that is
            seen 10 % off is an error: it reveals a wrong scale.
        threshold: strength above that of the background from which a pixel may be of the mark;
            at most 254; black to white is 255.
        smoothing: standard deviation of the Gaussian filter in pixels, at most 50.
        blur_limit: edge width, as a share of the mark's diameter, from which a frame is marked as
            blurred.

    >>> Mark("blue", diameter=0.01)
    Mark(colour='blue', diameter=0.01)
    """

    colour: Colour = "red"
    _: KW_ONLY
    diameter: Positive | None = None
    threshold: Annotated[float, _threshold] = 40.0
    smoothing: Annotated[float, _smoothing] = 1.0
    blur_limit: Positive = 0.25

    def strength(self, pixels: Pixels) -> NDArray[np.float32]:
        """Return how much of the colour each pixel has, shape ``(rows, columns)``."""
        channels = np.moveaxis(pixels, -1, 0).astype(np.float32)
        present, absent = _COLOURS[self.colour]
        if not absent:
            return _mean(channels)
        if not present:
            return -_mean(channels)
        return np.minimum.reduce([channels[i] for i in present]) - np.maximum.reduce(
            [channels[i] for i in absent]
        )


def _mean(channels: NDArray[np.float32]) -> NDArray[np.float32]:
    return channels.mean(axis=0, dtype=np.float32)


@dataclass(frozen=True)
class Outline:
    """What a part of a frame shows of the mark; pixels (column, row) of that part.

    Attributes:
        points: of the edge that lie on the convex hull, shape ``(n, 2)``.
        hull: corners of the convex hull, counter-clockwise, shape ``(m, 2)``.
        filling: share of the hull's area that has the mark's colour.
        blur: width in pixels of the most blurred edges; what the Gaussian filter adds is taken off.
        cut: whether the mark reaches the border of the part.
        background: strength of what is not the mark.
    """

    points: Array
    hull: Array
    filling: float
    blur: float
    cut: bool
    background: float


def outline(
    pixels: Pixels, mark: Mark, area: float | None = None, background: float | None = None
) -> Outline | None:
    """Return the outline of the mark, ``None`` if there is no pixel region of its colour.

    Gaussian filter → regions above the threshold → the one whose area is nearest to the expected
    one → crossings of the level half-way to the background between neighbouring pixels → convex
    hull (Delaunay).

    Args:
        pixels: part of a frame.
        mark: what to look for.
        area: expected area in square pixels; default the largest.
        background: strength around the mark as far as it is known; default the median of the part,
            of which the mark must then fill less than half.
    """
    from scipy.ndimage import gaussian_filter
    from scipy.spatial import ConvexHull, QhullError

    strength = mark.strength(pixels)
    if mark.smoothing > 0.0:
        strength = gaussian_filter(strength, mark.smoothing, truncate=3.0)
    if background is None:
        background = float(np.median(strength))
    coloured = strength > background + mark.threshold
    region = _region(coloured, area)
    if region is None:
        return None
    if not coloured.all():
        # At hand: what has been remembered may be of another place or light.
        background = float(np.median(strength[~coloured]))
    level = background + max(
        mark.threshold, 0.5 * (float(np.percentile(strength[region], _FULL)) - background)
    )
    inside = region & (strength > level)
    points, widths = _crossings(strength, inside, level, 2.0 * (level - background))
    try:
        hull = ConvexHull(points)
    except (QhullError, ValueError):
        return None
    depth = -(points @ hull.equations[:, :2].T + hull.equations[:, 2]).max(axis=1)
    kept = depth <= _HULL_DEPTH
    return Outline(
        points=points[kept],
        hull=points[hull.vertices],
        # The volume of a hull in the plane is its area.
        filling=min(float(inside.sum()) / hull.volume, 1.0),
        blur=_blur(widths[kept], mark.smoothing),
        cut=bool(inside[0].any() or inside[-1].any() or inside[:, 0].any() or inside[:, -1].any()),
        background=background,
    )


@dataclass(frozen=True)
class Candidates:
    """Regions of the mark's colour in a frame.

    Attributes:
        boxes: first row, column, last row, column, shape ``(n, 4)``.
        areas: in square pixels, shape ``(n,)``.
        background: strength of what is not the mark.
    """

    boxes: Array
    areas: Array
    background: float


def search(pixels: Pixels, mark: Mark, step: int) -> Candidates:
    """Return the regions of the mark's colour on every `step`-th pixel.

    Args:
        pixels: a whole frame.
        mark: what to look for.
        step: pixels to go on by; the mark must be several steps wide.
    """
    from scipy.ndimage import find_objects, label

    strength = mark.strength(pixels[::step, ::step])
    background = float(np.median(strength))
    regions, _ = label(strength > background + mark.threshold)
    sizes = np.bincount(regions.ravel())[1:]
    large = np.flatnonzero(sizes >= _FEWEST_PIXELS)
    places = find_objects(regions)
    boxes = [
        (rows.start - 1, columns.start - 1, rows.stop, columns.stop)
        for rows, columns in (places[i] for i in large)
    ]
    return Candidates(
        boxes=step * np.array(boxes, dtype=np.float64).reshape(-1, 4),
        areas=step**2 * sizes[large].astype(np.float64),
        background=background,
    )


def _region(coloured: _Mask, area: float | None) -> _Mask | None:
    from scipy.ndimage import label

    regions, _ = label(coloured)
    sizes = np.bincount(regions.ravel())
    sizes[0] = 0
    if sizes.max() < _FEWEST_PIXELS:
        return None
    if area is not None:
        ratio = np.log(np.maximum(sizes, 1e-3) / area)
        chosen = int(np.argmin(np.where(sizes >= _FEWEST_PIXELS, np.abs(ratio), np.inf)))
    else:
        chosen = int(sizes.argmax())
    return regions == chosen


def _crossings(
    strength: NDArray[np.float32], inside: _Mask, level: float, contrast: float
) -> tuple[Array, Array]:
    """Return where the level is crossed between neighbours, and how wide the edge is there."""
    found, widths = [], []
    slope_down, slope_right = np.gradient(strength)
    slope = np.hypot(slope_down, slope_right)
    for axis in (0, 1):
        before, after = (_shifted(strength, axis, end) for end in (0, 1))
        changes = _shifted(inside, axis, 0) != _shifted(inside, axis, 1)
        rows, columns = np.nonzero(changes)
        first, second = before[changes], after[changes]
        # Where two regions touch a pixel of the other is above the level as well: the middle.
        with np.errstate(divide="ignore", invalid="ignore"):
            share = (level - first) / (second - first)
        share = np.where((share >= 0.0) & (share <= 1.0), share, 0.5)
        ahead = rows + (axis == 0) * (share > 0.5), columns + (axis == 1) * (share > 0.5)
        found.append(np.column_stack([columns + (axis == 1) * share, rows + (axis == 0) * share]))
        widths.append(contrast / np.maximum(slope[ahead], 1e-3 * contrast))
    return np.concatenate(found).astype(np.float64), np.concatenate(widths).astype(np.float64)


def _shifted(values: NDArray[np.generic], axis: int, end: int) -> NDArray[np.generic]:
    """Return the array without its last (0) or first (1) line."""
    part = slice(1, None) if end else slice(None, -1)
    return values[part] if axis == 0 else values[:, part]


def _blur(widths: Array, smoothing: float) -> float:
    """Return the width of the widest edges.

    A step through the filter has the width sqrt(2π) σ, and an edge within a pixel one more pixel.
    """
    if not len(widths):
        return 0.0
    own = 2.0 * math.pi * smoothing**2 + 1.0
    return math.sqrt(max(float(np.percentile(widths, _WIDEST)) ** 2 - own, 0.0))
