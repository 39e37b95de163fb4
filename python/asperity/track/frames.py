"""Where frames come from: arrays, folders of images, videos."""

from __future__ import annotations

import os
import re
from collections.abc import Iterable, Iterator, Sequence
from itertools import pairwise
from pathlib import Path
from typing import Protocol, runtime_checkable

import numpy as np
from numpy.typing import NDArray

from asperity.errors import DimensionError, ParameterError

Pixels = NDArray[np.uint8]

IMAGE_SUFFIXES = (".png", ".jpg", ".jpeg", ".tif", ".tiff", ".bmp")
_NUMBER = re.compile(r"(\d+)(?=\D*$)")


class Frame(Protocol):
    """A frame whose pixels are made when they are asked for."""

    @property
    def shape(self) -> tuple[int, int]:
        """Number of rows and columns."""

    def crop(self, rows: slice, columns: slice) -> Pixels:
        """Return red, green and blue of a part, shape ``(rows, columns, 3)``."""


@runtime_checkable
class Frames(Protocol):
    """Frames of one size, each as long after the last one as that after its own."""

    @property
    def source(self) -> str:
        """What messages call it."""

    def __len__(self) -> int:
        """Return the number of frames, 0 if the file does not say."""

    def __iter__(self) -> Iterator[Frame]: ...


class ArrayFrame:
    """A frame in memory."""

    def __init__(self, pixels: Pixels) -> None:
        self._pixels = pixels

    @property
    def shape(self) -> tuple[int, int]:
        """Number of rows and columns."""
        rows, columns, _ = self._pixels.shape
        return rows, columns

    def crop(self, rows: slice, columns: slice) -> Pixels:
        """Return a part."""
        return self._pixels[rows, columns]


class _Arrays:
    source = "frames"

    def __init__(self, frames: Iterable[Pixels]) -> None:
        self._frames = frames

    def __len__(self) -> int:
        return len(self._frames) if isinstance(self._frames, Sequence) else 0

    def __iter__(self) -> Iterator[Frame]:
        first: tuple[int, ...] | None = None
        for number, frame in enumerate(self._frames):
            pixels = np.asarray(frame)
            if pixels.ndim != 3 or pixels.shape[2] != 3 or pixels.dtype != np.uint8:
                raise DimensionError(
                    "frames",
                    f"must be (rows, columns, 3) of uint8, frame {number} is "
                    f"{pixels.shape} of {pixels.dtype}",
                )
            first = first or pixels.shape
            if pixels.shape != first:
                raise DimensionError(
                    "frames", f"must be of one size, frame {number} is {pixels.shape}, not {first}"
                )
            yield ArrayFrame(pixels)


class ImageFolder:
    """The images of a folder in the order of the last number in their names.

    Args:
        folder: of PNG, JPEG, TIFF or BMP images; Pillow reads them (extra ``video``).

    Raises:
        ParameterError: if there are none, or a number is missing or there twice.
    """

    def __init__(self, folder: str | os.PathLike[str]) -> None:
        self._folder = Path(folder)
        self._paths = _numbered(self._folder)
        self.source = os.fspath(folder)

    def __len__(self) -> int:
        return len(self._paths)

    def __iter__(self) -> Iterator[Frame]:
        from PIL import Image, UnidentifiedImageError

        size = None
        for path in self._paths:
            try:
                with Image.open(path) as image:
                    pixels = np.asarray(image.convert("RGB"))
            except (UnidentifiedImageError, OSError, ValueError, SyntaxError) as error:
                raise ParameterError(
                    str(path), f"is no image that can be read ({error}): replace the file"
                ) from None
            size = size or pixels.shape
            if pixels.shape != size:
                raise ParameterError(
                    str(path),
                    f"has {pixels.shape[1]} x {pixels.shape[0]} pixels, the first image "
                    f"{size[1]} x {size[0]}: all must be of one size",
                )
            yield ArrayFrame(pixels)


def open_frames(source: str | os.PathLike[str] | Frames | Iterable[Pixels]) -> Frames:
    """Return the frames of a folder of images, of a video, or of arrays.

    Args:
        source: a folder, a video file (PyAV reads it, extra ``video``), or arrays
            ``(rows, columns, 3)`` of uint8; what is `Frames` already stays as it is.

    Raises:
        ParameterError: if there is no such file or folder, or no image in it.

    >>> import numpy as np
    >>> len(open_frames([np.zeros((4, 6, 3), dtype=np.uint8)]))
    1
    """
    if isinstance(source, Frames):
        return source
    if not isinstance(source, str | os.PathLike):
        if not isinstance(source, Iterable):
            raise ParameterError("frames", f"must be a path or arrays, got {source!r}")
        return _Arrays(source)
    path = Path(source)
    if path.is_dir():
        return ImageFolder(path)
    if not path.is_file():
        raise ParameterError(str(path), "is neither a video file nor a folder of images")
    from asperity.track.video import VideoFile

    return VideoFile(path)


def _numbered(folder: Path) -> list[Path]:
    paths = [one for one in folder.iterdir() if one.suffix.lower() in IMAGE_SUFFIXES]
    if not paths:
        raise ParameterError(str(folder), f"must hold images ({', '.join(IMAGE_SUFFIXES)})")
    numbers: dict[int, Path] = {}
    for path in paths:
        match = _NUMBER.search(path.stem)
        if match is None:
            raise ParameterError(
                str(path), "has no number in its name: number the images in their order"
            )
        number = int(match[1])
        if number in numbers:
            raise ParameterError(str(path), f"has the number of {numbers[number].name}: remove one")
        numbers[number] = path
    order = sorted(numbers)
    for before, after in pairwise(order):
        if after != before + 1:
            raise ParameterError(
                str(folder),
                f"image {before + 1} is missing after {numbers[before].name}: later times would "
                "be wrong; restore it, or renumber and track the parts apart",
            )
    return [numbers[number] for number in order]
