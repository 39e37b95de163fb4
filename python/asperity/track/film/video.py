"""Videos, read and written with PyAV (extra ``video``)."""

from __future__ import annotations

import os
from collections.abc import Iterable, Iterator, Sequence
from contextlib import suppress
from typing import Any, NoReturn

import numpy as np

from asperity._base import arrays
from asperity._base.storage.files import replaced
from asperity.errors import ParameterError
from asperity.track.film.frames import Frame, Pixels

# Clocks of cameras jitter and count in ticks: an interval of a constant rate differs from the usual
# one by less than this factor or by one tick, and a stamp from an even clock's by one interval.
_JITTER = 1.6
_TEXT = bytes([*range(7, 14), 27, *range(32, 127)])


class VideoFile:
    """The frames of a video; its own frame rate is not used.

    Args:
        path: of the video.

    Raises:
        ParameterError: if it is no video, is damaged, or its frame rate varies.
    """

    def __init__(self, path: str | os.PathLike[str]) -> None:
        self.source = os.fspath(path)
        self._check_bytes()
        with self._open() as container:
            self._length = int(container.streams.video[0].frames)

    def __len__(self) -> int:
        return self._length

    def __iter__(self) -> Iterator[Frame]:
        import av

        # The packets say when frames are shown long before all of them are decoded.
        self._check_clock(self._announced())
        stamps: list[int | None] = []
        with self._open() as container:
            stream = container.streams.video[0]
            stream.thread_type = "AUTO"
            try:
                for frame in container.decode(stream):
                    stamps.append(frame.pts)
                    yield _VideoFrame(frame)
            except (av.error.FFmpegError, ValueError, MemoryError) as error:
                raise ParameterError(
                    self.source, f"is damaged after frame {len(stamps) - 1}: {_reason(error)}"
                ) from None
        self._check_clock(stamps)

    def _announced(self) -> list[int | None]:
        """Return the time stamps of the packets in the order in which their frames are shown."""
        import av

        stamps: list[int | None] = []
        # Decoding names the frame at which a damaged file ends.
        with self._open() as container, suppress(av.error.FFmpegError):
            for packet in container.demux(container.streams.video[0]):
                # The last one is empty; the discarded ones are not shown.
                if packet.size and not packet.is_discard:
                    stamps.append(packet.pts)
        known = [stamp for stamp in stamps if stamp is not None]
        return [*sorted(known)] if len(known) == len(stamps) else []

    def _check_bytes(self) -> None:
        """Refuse what is no video before PyAV is asked for."""
        if os.path.isdir(self.source):
            raise ParameterError(self.source, "is no video but a folder")
        with open(self.source, "rb") as file:
            first = file.read(4096)
        if not first:
            raise ParameterError(self.source, "is empty: copy the video again")
        # Text but for that of raw frames, which says so.
        if not first.startswith(b"YUV4MPEG2") and not first.translate(None, _TEXT):
            raise ParameterError(self.source, "is no video that can be read: it holds text")

    def _open(self) -> Any:
        import av

        try:
            container = av.open(self.source)
        # Damaged bytes are met in texts and numbers, too.
        except Exception as error:
            raise ParameterError(
                self.source, f"is no video that can be read: {_reason(error)}"
            ) from None
        if not container.streams.video:
            container.close()
            raise ParameterError(self.source, "holds no video stream")
        return container

    def _check_clock(self, stamps: Sequence[int | None]) -> None:
        """Refuse frames that are not taken at a constant rate.

        The rate of the file is that of its playback, and an average where it varies: frames are
        compared with the usual interval, and with the clock that shows all of them evenly.
        """
        known = np.array([stamp for stamp in stamps if stamp is not None], dtype=np.float64)
        if len(known) < 3 or len(known) < len(stamps):
            return
        intervals = np.diff(known)
        usual = float(np.median(intervals))
        longest, shortest = _JITTER * usual, usual / _JITTER
        even = (np.abs(intervals - usual) <= 1.0) | (intervals <= longest) & (intervals >= shortest)
        if not even.all():
            self._refuse_clock(int(even.argmin()) + 1)
        mean = (known[-1] - known[0]) / (len(known) - 1)
        off = np.abs(known - known[0] - mean * np.arange(len(known)))
        if off.max() > max(mean, 1.0):
            self._refuse_clock(int(off.argmax()))

    def _refuse_clock(self, number: int) -> NoReturn:
        raise ParameterError(
            self.source,
            f"lacks frames before frame {number}, or its frame rate varies: record "
            "with a constant frame rate, or track the parts apart",
        )


def _reason(error: Exception) -> str:
    return str(getattr(error, "strerror", None) or error)


class _VideoFrame:
    def __init__(self, frame: Any) -> None:
        self._frame = frame
        self._whole: Pixels | None = None

    @property
    def shape(self) -> tuple[int, int]:
        return self._frame.height, self._frame.width

    def crop(self, rows: slice, columns: slice) -> Pixels:
        """Convert only the part: that of a full frame takes longer than to track the mark."""
        height, width = self.shape
        top, bottom, _ = rows.indices(height)
        left, right, _ = columns.indices(width)
        small = 2 * (bottom - top) < height and 2 * (right - left) < width
        if self._frame.format.name != "yuv420p" or not small:
            if self._whole is None:
                self._whole = self._frame.to_ndarray(format="rgb24")
            return self._whole[rows, columns]
        # Two rows of even number above and below, and as many columns, share their colours.
        start_row, start_column = max(top // 2 - 2, 0), max(left // 2 - 2, 0)
        end_row, end_column = min(bottom // 2 + 3, height // 2), min(right // 2 + 3, width // 2)
        part = self._part(start_row, end_row, start_column, end_column)
        part = part[top - 2 * start_row :, left - 2 * start_column :]
        return part[: bottom - top, : right - left]

    def levels(self, rows: slice, columns: slice) -> Pixels:
        """Return the brightness alone where it is a plane of its own, which needs no conversion."""
        if self._frame.format.name != "yuv420p":
            return self.crop(rows, columns)
        plane = self._frame.planes[0]
        samples = np.frombuffer(plane, dtype=np.uint8).reshape(-1, plane.line_size)
        return samples[: self._frame.height, : self._frame.width][rows, columns, None]

    def _part(self, start_row: int, end_row: int, start_column: int, end_column: int) -> Pixels:
        import av

        rows, columns = 2 * (end_row - start_row), 2 * (end_column - start_column)
        packed = []
        for plane, scale in zip(self._frame.planes, (2, 1, 1), strict=True):
            samples = np.frombuffer(plane, dtype=np.uint8).reshape(-1, plane.line_size)
            packed.append(
                samples[
                    scale * start_row : scale * end_row, scale * start_column : scale * end_column
                ].reshape(-1)
            )
        planes = np.concatenate(packed).reshape(3 * rows // 2, columns)
        part = av.VideoFrame.from_ndarray(planes, format="yuv420p")
        part.colorspace, part.color_range = self._frame.colorspace, self._frame.color_range
        return np.asarray(part.to_ndarray(format="rgb24"), dtype=np.uint8)


def write_video(
    frames: Iterable[Pixels], path: str | os.PathLike[str], *, quality: int = 12, rate: int = 30
) -> None:
    """Write frames as an H.264 video, by default of 30 per second, as slow-motion cameras do.

    Args:
        frames: arrays ``(rows, columns, 3)`` of uint8, rows and columns even.
        path: of the file, such as ``slow.mp4``.
        quality: constant rate factor; 0 best, 18 good, 51 worst.
        rate: frames per second at which the video is played.

    The file is complete or not there.
    """
    import av

    quality = arrays.count(quality, "quality", least=0)
    rate = arrays.count(rate, "rate")
    # The ending of the name tells the format of the container.
    ending = f".tmp{os.path.splitext(path)[1]}"
    with replaced(path, ending) as temporary, av.open(os.fspath(temporary), "w") as container:
        stream: Any = None
        for pixels in frames:
            if stream is None:
                stream = container.add_stream("libx264", rate=rate, options={"crf": str(quality)})
                stream.height, stream.width = pixels.shape[:2]
                stream.pix_fmt = "yuv420p"
            frame = av.VideoFrame.from_ndarray(np.ascontiguousarray(pixels), format="rgb24")
            for packet in stream.encode(frame):
                container.mux(packet)
        if stream is not None:
            for packet in stream.encode():
                container.mux(packet)
