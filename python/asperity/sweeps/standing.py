"""How far a sweep is, from its store alone."""

from __future__ import annotations

import json
import math
import os
import time
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from asperity._base.result import Result, counted
from asperity.errors import ParameterError
from asperity.sweeps.folder import SESSION, STATUS_FILES, folder_of
from asperity.sweeps.store import DONE, FAILED

_MINUTE, _HOUR, _DAY = 60.0, 3600.0, 86400.0


@dataclass(frozen=True)
class SweepStatus(Result):
    """How far a sweep is, found by `sweep_status`.

    Attributes:
        points: all points of the grid.
        done: those with a result.
        failed: those at which the function failed.
        seconds_left: time that the others will take at the rate since the sweep was last started;
            NaN if that is not known yet.
        idle: time since something was last written in s.
    """

    points: int
    done: int
    failed: int
    seconds_left: float
    idle: float

    @property
    def missing(self) -> int:
        """Points that have not been computed."""
        return self.points - self.done - self.failed

    def __repr__(self) -> str:
        return (
            f"<SweepStatus: {self.done} of {self.points} points done, {self.failed} failed, "
            f"{self.missing} missing>"
        )

    def summary(self) -> str:
        """Return what is done and what is left, in sentences."""
        share = (self.done + self.failed) / self.points
        text = (
            f"Of {counted(self.points, 'point')} {self.done} are done, {self.failed} failed, "
            f"{self.missing} are missing: {share:.1%}."
        )
        if not self.missing:
            return text
        if math.isfinite(self.seconds_left):
            text += (
                f"\nAt the rate of its last start the rest takes {_duration(self.seconds_left)}."
            )
        return f"{text}\nSomething was last written {_duration(self.idle)} ago."


def sweep_status(store: str | os.PathLike[str]) -> SweepStatus:
    """Return how far a sweep is; it may be running or not.

    Args:
        store: the folder that `sweep` was given.

    Raises:
        ParameterError: if it is not the store of a sweep.

    >>> import tempfile
    >>> from concurrent.futures import ThreadPoolExecutor
    >>> from asperity import sweep, sweep_status
    >>> def square(x):
    ...     return x**2
    >>> with tempfile.TemporaryDirectory() as folder, ThreadPoolExecutor() as threads:
    ...     _ = sweep(square, {"x": [1.0, 2.0]}, store=f"{folder}/x.zarr", executor=threads)
    ...     print(sweep_status(f"{folder}/x.zarr").summary())
    Of 2 points 2 are done, 0 failed, 0 are missing: 100.0%.
    """
    path = folder_of(store)
    folder = path / "status"
    try:
        meta = json.loads((folder / "zarr.json").read_text(encoding="utf-8"))
        points = math.prod(meta["shape"])
        size = math.prod(meta["chunk_grid"]["configuration"]["chunk_shape"])
        counts = np.zeros(FAILED + 1, np.int64)
        # Written without compression for this: through zarr it takes a hundred times longer.
        for file in folder.glob(STATUS_FILES):
            status = np.fromfile(file, np.int8)
            if status.size != size:
                raise ValueError(f"{file.name} has {status.size} bytes instead of {size}")
            counts += np.bincount(status, minlength=FAILED + 1)
        if counts[DONE] + counts[FAILED] > points:
            raise ValueError("more points are done than there are")
        written = folder.stat().st_mtime
    except (OSError, ValueError, KeyError, TypeError) as error:
        raise ParameterError(
            "store", f"must hold a sweep, {path} does not or is damaged: {error}"
        ) from None
    done, failed = int(counts[DONE]), int(counts[FAILED])
    left = points - done - failed
    seconds = _pace(path / SESSION, written, done + failed) * left if left else 0.0
    return SweepStatus(points, done, failed, seconds, max(time.time() - written, 0.0))


def _pace(session: Path, written: float, known: int) -> float:
    """Return the time per point since work was last begun; NaN if it is not known."""
    try:
        begun = json.loads(session.read_text(encoding="utf-8"))
        seconds, new = written - begun["started"], known - begun["points"]
    except (OSError, ValueError, KeyError, TypeError):
        return math.nan
    return seconds / new if new > 0 and seconds > 0.0 else math.nan


def _duration(seconds: float) -> str:
    """Return a time in words.

    >>> from asperity.sweeps.standing import _duration
    >>> [_duration(t) for t in (3.2, 200.0, 7300.0, 2e5)]
    ['3 s', '3 min', '2.0 h', '2.3 days']
    """
    if seconds < 2.0 * _MINUTE:
        return f"{seconds:.0f} s"
    if seconds < 2.0 * _HOUR:
        return f"{seconds / _MINUTE:.0f} min"
    return f"{seconds / _HOUR:.1f} h" if seconds < 2.0 * _DAY else f"{seconds / _DAY:.1f} days"
