"""Where frames come from: arrays, folders of images, videos."""

from __future__ import annotations

import os
import re
from collections.abc import Iterable, Iterator, Sequence
from contextlib import contextmanager
from itertools import pairwise
from pathlib import Path
from typing import Any, Protocol, runtime_checkable

import numpy as np
from numpy.typing import NDArray

from asperity._base import arrays
from asperity.errors import DimensionError, ParameterError

Pixels = NDArray[np.uint8]

IMAGE_SUFFIXES = (".png", ".jpg", ".jpeg", ".tif", ".tiff", ".bmp")
# Modes of Pillow with more than 8 bits, which it would clip; the value of white; and the share of
# it below which an image holds fewer bits, or hardly any contrast.
_DEEP, _WHITE, _DARK = ("I;16", "I;16B", "I;16L", "I;16N", "I", "F"), 65535, 1.0 / 8.0
_NUMBER = re.compile(r"(\d+)(?=\D*$)")


class Frame(Protocol):
    """A frame whose pixels are made when they are asked for."""

    @property
    def shape(self) -> tuple[int, int]:
        """Number of rows and columns."""

    def crop(self, rows: slice, columns: slice) -> Pixels:
        """Return red, green and blue of a part, shape ``(rows, columns, 3)``."""

    def levels(self, rows: slice, columns: slice) -> Pixels:
        """Return what is stored of a part, shape ``(rows, columns, channels)``."""


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

    levels = crop


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
        folder: of PNG, JPEG, TIFF or BMP images; Pillow reads them (extra ``video``). They are
            turned upright as their EXIF data say; 16 bits are scaled to 8 by their full range.

    Raises:
        ParameterError: if there are none, or a number is missing or there twice; on reading, if
            an image cannot be read, has another size, or uses less than an eighth of 16 bits.
    """

    def __init__(self, folder: str | os.PathLike[str]) -> None:
        self._paths = _numbered(Path(folder))
        self.source = os.fspath(folder)

    def __len__(self) -> int:
        return len(self._paths)

    def __iter__(self) -> Iterator[Frame]:
        return _of_one_size((path, self._only(path)) for path in self._paths)

    def _only(self, path: Path) -> Pixels:
        with _opened(path) as image:
            pages = getattr(image, "n_frames", 1)
            if pages > 1:
                raise ParameterError(
                    str(path),
                    f"holds {pages} pages: give this file alone, as the film of its pages",
                )
            return _colours(image, path)


class ImageStack:
    """The pages of a TIFF image in their order, as cameras and ImageJ write films.

    Args:
        path: of the file; its pages are read as the images of an `ImageFolder`.

    Raises:
        ParameterError: if it cannot be read, or holds one page only.
    """

    def __init__(self, path: Path) -> None:
        self._path = path
        self.source = os.fspath(path)
        with _opened(path) as image:
            self._pages = int(getattr(image, "n_frames", 1))
        if self._pages < 2:
            raise ParameterError(
                self.source, "is an image of one page: give the folder of all images, or a film"
            )

    def __len__(self) -> int:
        return self._pages

    def __iter__(self) -> Iterator[Frame]:
        return _of_one_size(self._numbered())

    def _numbered(self) -> Iterator[tuple[str, Pixels]]:
        with _opened(self._path) as image:
            for number in range(self._pages):
                image.seek(number)
                yield f"{self.source}, page {number}", _colours(image, self._path)


@contextmanager
def _opened(path: Path) -> Iterator[Any]:
    from PIL import Image

    try:
        with Image.open(path) as image:
            yield image
    except ParameterError:
        raise
    # Decoders raise errors of many kinds on damaged bytes.
    except Exception as error:
        raise ParameterError(
            str(path), f"is no image that can be read ({error}): replace the file"
        ) from None


def _of_one_size(images: Iterable[tuple[str | Path, Pixels]]) -> Iterator[Frame]:
    size = None
    for name, pixels in images:
        size = size or pixels.shape
        if pixels.shape != size:
            raise ParameterError(
                str(name),
                f"has {pixels.shape[1]} x {pixels.shape[0]} pixels, the first image "
                f"{size[1]} x {size[0]}: all must be of one size",
            )
        yield ArrayFrame(pixels)


def _colours(image: Any, path: Path) -> Pixels:
    """Return red, green and blue, upright as viewers show it."""
    from PIL import ImageOps

    upright = ImageOps.exif_transpose(image)
    if upright.mode not in _DEEP:
        return np.asarray(upright.convert("RGB"))
    values = np.asarray(upright)
    largest = float(values.max())
    if upright.mode == "F" or values.min() < 0 or largest > _WHITE:
        raise ParameterError(
            str(path), f"must hold 8 or 16 bits per colour, it holds numbers of mode {upright.mode}"
        )
    if largest < _DARK * _WHITE:
        raise ParameterError(
            str(path),
            f"is at most {largest:g} of {_WHITE} bright, as 10 or 12 bits within 16 are: convert "
            "the images so that they use the full range",
        )
    grey = np.rint(values * (255.0 / _WHITE)).astype(np.uint8)
    return np.repeat(grey[..., None], 3, axis=2)


def open_frames(source: str | os.PathLike[str] | Frames | Iterable[Pixels]) -> Frames:
    """Return the frames of a folder of images, of a video, of a stack of images, or of arrays.

    Args:
        source: a folder, a video file (PyAV reads it, extra ``video``), a TIFF of several pages, or
            arrays ``(rows, columns, 3)`` of uint8; what was opened stays as it is.

    Raises:
        ParameterError: if there is no such file or folder, or no image in it.

    >>> import numpy as np
    >>> len(open_frames([np.zeros((4, 6, 3), dtype=np.uint8)]))
    1
    """
    if isinstance(source, Frames):
        return source
    if not isinstance(source, str | os.PathLike):
        arrays.of_kind(source, "frames", Iterable, "a path or arrays")
        return _Arrays(source)
    path = Path(source)
    if path.is_dir():
        return ImageFolder(path)
    if not path.is_file():
        raise ParameterError(str(path), "is neither a video file nor a folder of images")
    if path.suffix.lower() in (".tif", ".tiff"):
        return ImageStack(path)
    from asperity.track.film.video import VideoFile

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
