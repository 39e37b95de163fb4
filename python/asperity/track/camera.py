"""A camera that films simulated paths: frames whose truth is known."""

from __future__ import annotations

import math
import os
from collections.abc import Iterator
from dataclasses import KW_ONLY
from pathlib import Path
from typing import Annotated, Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from asperity._base import arrays
from asperity._base.arrays import Array
from asperity._base.storage.files import atomic
from asperity._base.value import (
    Given,
    Index,
    NonNegative,
    Number,
    Positive,
    Record,
    field,
    of_kind,
    unchecked,
)
from asperity.errors import DimensionError, ParameterError
from asperity.runs.run import Run
from asperity.track.config import config_text
from asperity.track.film.frames import Pixels
from asperity.track.image.scene import PlaneView
from asperity.track.image.segmentation import Mark

_Image = NDArray[np.float32]

_PAINT = {
    "red": (195, 35, 40),
    "green": (35, 170, 60),
    "blue": (40, 60, 200),
    "yellow": (215, 200, 40),
    "magenta": (200, 40, 180),
    "cyan": (40, 190, 200),
    "white": (245, 245, 245),
    "black": (12, 12, 12),
}
_STEEL, _DISK, _GLARE = 128.0, (70.0, 72.0, 75.0), 250.0
_HEIGHT = 1.0
# Lengths of the default image around the path in diameters of the disk.
_SURROUNDINGS = 1.0
# Parts of a pixel in each direction, and pixels per picture of the motion within the exposure.
_PARTS, _STRIDE, _MOST_PICTURES = 2, 0.5, 64


class VirtualCamera(Record):
    """Films a disk with a round mark that slides on ground steel.

    The picture is that of a pinhole camera: anti-aliased, out of focus, averaged over the
    exposure, with Gaussian noise, 8 bit. Frame k shows the time k/fps in the middle of its
    exposure; between the samples of the run the disk moves uniformly, and after its end it stays.

    Args:
        run: a `Trajectory` or `Motion` whose coordinates contain the position of the disk in m.
        fps: frames per second in 1/s.
        coordinates: numbers of the two coordinates.
        size: columns and rows of the image.
        scene: from pixels to the plane; default a camera 1 m above the middle of the path.
        tilt: of the default camera against the vertical in rad.
        mark: colour and diameter (default 10 mm) of the mark.
        disk_diameter: in m.
        defocus: standard deviation of the blur in pixels.
        exposure: in s, at most 1/fps.
        noise: standard deviation in levels of 255.
        glare: diameter of a white reflection on the rim of the mark, as a share of the mark's.
        rest: how long it films after the end of the run in s.
        seed: of the noise and of the steel's texture.

    >>> from asperity import FrictionLaw, SlidingPoint, simulate
    >>> block = SlidingPoint(0.018, law=FrictionLaw.isotropic(0.5))
    >>> run = simulate(block, dt=1e-3, t_end=0.1, u0=[0.4, 0.3])
    >>> camera = VirtualCamera(run, fps=100.0, size=(320, 240))
    >>> next(camera.frames()).shape, len(camera)
    ((240, 320, 3), 13)
    """

    run: Annotated[Run, of_kind(Run, "a Trajectory or a Motion")]
    _: KW_ONLY
    fps: Positive = 500.0
    coordinates: Annotated[tuple[int, int], unchecked] = (0, 1)
    size: Annotated[tuple[int, int], _size] = (1920, 1080)
    scene: PlaneView | None = None
    tilt: Number = 0.0
    mark: Annotated[Given[Mark | None, Mark], _mark] = field(default=None)
    disk_diameter: Positive = 0.028
    defocus: NonNegative = 0.8
    exposure: NonNegative = 5e-4
    noise: NonNegative = 2.0
    glare: NonNegative = 0.0
    rest: NonNegative = 0.02
    seed: Index = 0
    view: PlaneView = field(init=False)
    time: Array = field(init=False)
    position: Array = field(init=False)
    pixel: Array = field(init=False)

    def _complete(self, given: dict[str, Any]) -> None:
        run, exposure = given["run"], given["exposure"]
        given["coordinates"] = _two(given["coordinates"], run.q.shape[1])
        if len(run) < 2:
            raise ParameterError("run", f"must hold at least two samples, got {len(run)}")
        if not exposure <= 1.0 / given["fps"]:
            raise ParameterError("exposure", f"must not exceed 1/fps, got {exposure!r}")

    def _derive(self) -> None:
        end = float(self.run.t[-1] - self.run.t[0]) + self.rest
        # Frames are counted: 0.1 s at 100 1/s must not end at 9.999….
        time = np.arange(math.floor(end * self.fps * (1.0 + 1e-12)) + 1) / self.fps
        position = self._at(time)
        view = self.scene or self._facing(self.tilt)
        self._keep(view=view, time=time, position=position, pixel=view.to_pixels(position))

    def __len__(self) -> int:
        return len(self.time)

    def frames(self) -> Iterator[Pixels]:
        """Yield the frames as arrays ``(rows, columns, 3)`` of uint8, the same ones every time."""
        steel = self._steel()
        for number in range(len(self)):
            yield self._frame(number, steel)

    def write(self, folder: str | os.PathLike[str], *, point_error: float = 0.1) -> None:
        """Write the frames as PNG images and ``track.toml``, which `asperity track` takes.

        The scene is handed on as nine points, as measured with a target on the plane.

        Args:
            folder: is made if it is not there.
            point_error: standard deviation of the points' pixels.
        """
        from PIL import Image

        config = self.config(point_error=point_error)
        out = Path(folder)
        out.mkdir(parents=True, exist_ok=True)
        digits = len(str(len(self)))
        for number, pixels in enumerate(self.frames()):
            with atomic(out / f"frame_{number:0{digits}}.png") as file:
                Image.fromarray(pixels).save(file, format="png", compress_level=1)
        with atomic(out / "track.toml") as file:
            file.write(config.encode())

    def config(self, *, point_error: float = 0.1) -> str:
        """Return the text of ``track.toml``."""
        point_error = arrays.non_negative(point_error, "point_error")
        columns, rows = self.size
        share = np.array([0.1, 0.5, 0.9])
        pixel = np.stack(np.meshgrid(columns * share, rows * share), axis=-1).reshape(-1, 2)
        plane = self.view.to_plane(pixel).round(4)
        rng = np.random.default_rng([self.seed, 1])
        read = self.view.to_pixels(plane) + point_error * rng.standard_normal(plane.shape)
        return config_text(self.fps, self.mark, read.round(2), plane)

    def _at(self, time: Array) -> Array:
        run = self.run
        since = run.t - run.t[0]
        places = run.q[:, list(self.coordinates)]
        # The first exposure begins before the run.
        early = np.minimum(time, 0.0)[:, None] * (places[1] - places[0]) / (since[1] - since[0])
        along = [np.interp(time, since, coordinate) for coordinate in places.T]
        return np.column_stack(along) + early

    def _facing(self, tilt: float) -> PlaneView:
        places = self.run.q[:, list(self.coordinates)]
        low, high = places.min(axis=0), places.max(axis=0)
        needed = high - low + 2.0 * (0.5 + _SURROUNDINGS) * self.disk_diameter
        middle = 0.5 * (low + high)
        focal = _HEIGHT * float(np.min(np.array(self.size) / needed))
        back, up = _HEIGHT * math.sin(tilt), _HEIGHT * math.cos(tilt)
        eye = [middle[0], middle[1] - back, up]
        return PlaneView.from_camera(eye, target=middle, focal_length=focal, size=self.size)

    def _steel(self) -> _Image:
        """Return the plate: grooves along e₂, darker towards the corners."""
        columns, rows = self.size
        row, column = np.mgrid[:rows, :columns].astype(np.float32)
        place = self.view.to_plane(np.stack([column, row], axis=-1).reshape(-1, 2))
        grooves = np.random.default_rng([self.seed, 0]).normal(0.0, 6.0, 4096)
        level = np.interp(place[:, 0] / 1e-4 % 4096.0, np.arange(4096), grooves).reshape(rows, -1)
        away = ((column / columns - 0.5) ** 2 + (row / rows - 0.5) ** 2) / 0.5
        return ((_STEEL + level) * (1.0 - 0.25 * away)).astype(np.float32)

    def _frame(self, number: int, steel: _Image) -> Pixels:
        image = np.repeat(steel[..., None], 3, axis=2)
        self._draw(image, self.time[number])
        if self.noise > 0.0:
            rng = np.random.default_rng([self.seed, 2, number])
            image += self.noise * rng.standard_normal(image.shape, dtype=np.float32)
        return np.clip(np.rint(image), 0.0, 255.0).astype(np.uint8)

    def _draw(self, image: _Image, time: float) -> None:
        half = 0.5 * self.exposure
        ends = self.view.to_pixels(self._at(np.array([time - half, time, time + half])))
        moved = float(np.hypot(*(ends[2] - ends[0])))
        pictures = min(math.ceil(moved / _STRIDE) + 1, _MOST_PICTURES)
        shares = (np.arange(pictures) + 0.5) / pictures - 0.5
        places = self._at(time + shares * self.exposure)
        disk, mark = 0.5 * self.disk_diameter, 0.5 * float(self.mark.diameter or 0.0)
        reach = disk / self.view.pixel_size(ends[1]) * 1.3 + moved + 5.0 * self.defocus + 3.0
        top, left, part = _part(image, ends[1], reach)
        if not part.size:
            return
        paint = np.array(_PAINT[self.mark.colour], dtype=np.float32)
        # The reflection stays at the side of the lamp while the disk may turn.
        glare = mark * self.glare, mark * np.array([math.cos(0.7), math.sin(0.7)])
        layers: list[tuple[float, Array, Any]] = [
            (disk, np.zeros(2), np.array(_DISK, dtype=np.float32)),
            (mark, np.zeros(2), paint),
            (glare[0], glare[1], _GLARE),
        ]
        for radius, offset, colour in layers:
            if radius > 0.0:
                share = self._share(part.shape[:2], (left, top), places + offset, radius)
                part += share[..., None] * (colour - part)

    def _share(
        self, shape: tuple[int, int], corner: tuple[int, int], places: Array, radius: float
    ) -> _Image:
        """Return which share of each pixel a disk covers, averaged over its places."""
        from scipy.ndimage import gaussian_filter

        rows, columns = shape
        fine = (np.arange(_PARTS) + 0.5) / _PARTS - 0.5
        row = (np.arange(rows)[:, None] + fine).ravel() + corner[1]
        column = (np.arange(columns)[:, None] + fine).ravel() + corner[0]
        grid = np.stack(np.meshgrid(column, row), axis=-1)
        points = self.view.to_plane(grid.reshape(-1, 2))
        width = self.view.pixel_size(grid[len(row) // 2, len(column) // 2]) / _PARTS
        share = np.zeros(len(points))
        for place in places:
            share += np.clip((radius - np.hypot(*(points - place).T)) / width + 0.5, 0.0, 1.0)
        parts = (share / len(places)).reshape(rows, _PARTS, columns, _PARTS)
        covered: _Image = parts.mean(axis=(1, 3)).astype(np.float32)
        if self.defocus > 0.0:
            covered = gaussian_filter(covered, self.defocus)
        return covered


def _part(image: _Image, middle: Array, reach: float) -> tuple[int, int, _Image]:
    low = np.maximum(np.floor(middle - reach), 0.0).astype(int)
    high = np.maximum(np.ceil(middle + reach) + 1.0, 0.0).astype(int)
    part: _Image = image[low[1] : high[1], low[0] : high[0]]
    return int(low[1]), int(low[0]), part


def _two(coordinates: ArrayLike, count: int) -> tuple[int, int]:
    pair = tuple(arrays.count(one, "coordinates", least=0) for one in np.ravel(coordinates))
    if len(pair) != 2 or max(pair) >= count:
        raise DimensionError("coordinates", f"must be two of 0..{count - 1}, got {coordinates!r}")
    return pair


def _mark(value: Mark | None, argument: str) -> Mark:
    mark = Mark(diameter=0.01) if value is None else value
    if arrays.of_kind(mark, argument, Mark, "a Mark").diameter is None:
        raise ParameterError(argument, "must have a diameter")
    return mark


def _size(size: ArrayLike, argument: str) -> tuple[int, int]:
    pair = tuple(arrays.count(one, argument, least=16) for one in np.ravel(size))
    if len(pair) != 2:
        raise DimensionError(argument, f"must be (columns, rows), got {size!r}")
    return pair
