"""Samples of the friction force over the sliding direction, ordered by turns."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from typing import Any, TypeAlias

import numpy as np
from numpy.typing import ArrayLike, NDArray

from asperity._base import arrays
from asperity._base.arrays import Array
from asperity.errors import DimensionError, FitError
from asperity.identify.evidence.coefficient.static import sliding
from asperity.identify.evidence.coefficient.turns import runs_of as runs_of_recordings
from asperity.identify.forces.processing import ProcessedData
from asperity.identify.forces.strokes import Axes

Measured: TypeAlias = ProcessedData | tuple[ArrayLike, ArrayLike] | tuple[ArrayLike, ...]

WRAPPED = (
    "φ starts again with each turn, so that it counts as one turn: unwrap it, np.unwrap(phi), or "
    "give the numbers of the turns as third array, (phi, force, turn)"
)
# Samples that fit into the cache with all that is evaluated at them.
_CHUNK = 8192
_FEWEST = 24
# The scatter of fewer runs says less than that of their turns.
_FEWEST_RUNS = 3


@dataclass(frozen=True, eq=False)
class Samples:
    """Forces −λ in N at sliding directions φ with the normal forces λ_N, as runs of equal turns.

    `runs` holds first, past-the-end and number of the turn of samples that follow each other;
    samples outside of turns are in none.
    """

    phi: Array
    force: Array
    normal: Array
    runs: NDArray[np.intp]
    turns: int

    def chunks(self) -> Iterator[tuple[slice, int]]:
        """Yield slices of at most a chunk with the number of their turn, turns in order."""
        for first, end, turn in self.runs:
            for start in range(first, end, _CHUNK):
                yield slice(start, min(start + _CHUNK, end)), int(turn)

    def __len__(self) -> int:
        return int((self.runs[:, 1] - self.runs[:, 0]).sum())


def frozen(data: Any, _: str = "data") -> Any:
    """Return data that nobody else can change: arrays that can be are copied."""
    if not isinstance(data, tuple | list):
        return data
    return tuple(
        part if not part.flags.writeable else arrays.read_only(part) for part in _series(data)
    )


def samples_of(data: Any) -> Samples:
    """Return the samples of processed data, or of arrays (φ, −λ/λ_N) or (φ, −λ/λ_N, turn).

    Those in which the pin still sticks at the start of a stroke are outside of it.
    """
    if isinstance(data, tuple | list):
        phi, force, *given = _series(data)
        turn = given[0] if given else _counted_turns(phi)
        normal = np.broadcast_to(np.float64(1.0), phi.shape)
    elif getattr(getattr(data, "raw", None), "one_channel", False):
        raise FitError(
            "data: one channel tells no direction set: friction_coefficient has the coefficient "
            "along the sliding, and an isotropic law where there is one"
        )
    elif all(hasattr(data, name) for name in ("phi", "force", "normal_force", "turn")):
        phi, force, normal, turn = data.phi, data.force, data.normal_force, data.turn
        if isinstance(data, ProcessedData):
            turn = np.where(sliding(data), turn, -1)
    else:
        raise FitError(f"data: must be what process() returns or (phi, force), got {data!r:.60}")
    if turn.shape != phi.shape or turn.dtype.kind not in "iu":
        raise DimensionError(
            "data.turn", f"must be integers of shape {phi.shape}, got {turn.shape}"
        )
    runs, turns = _runs(turn)
    samples = Samples(phi, force, normal, runs, turns)
    _check(samples)
    return samples


def _series(data: Sequence[Any]) -> list[NDArray[Any]]:
    if len(data) not in (2, 3):
        raise DimensionError("data", f"must be (phi, force) or (phi, force, turn), got {len(data)}")
    phi = arrays.array(data[0], "data.phi", (None,))
    force = arrays.array(data[1], "data.force", (phi.size, 2))
    return [phi, force, *map(np.asarray, data[2:])]


def by_axes(samples: Samples, data: Any) -> list[tuple[Samples, Axes]]:
    """Return samples apart by how the axes of the sensor lie while they slide.

    Of a pin on a disk these are the runs that turn forwards and those that turn backwards; of a
    stage, those with one orientation of the surface.
    """
    if not hasattr(data, "axes"):
        return [(samples, Axes())]
    found = [data.axes(int(first), past=int(past)) for first, past, _ in samples.runs]
    parts = []
    for axes in sorted(set(found)):
        chosen = np.array([one == axes for one in found])
        parts.append((replace(samples, runs=samples.runs[chosen]), axes))
    return parts


def inside(samples: Samples, most: int | None = None) -> NDArray[np.intp]:
    """Return numbers of the samples in turns, of `most` at least and evenly spread if given."""
    numbers = np.concatenate([np.arange(first, end) for first, end, _ in samples.runs])
    return numbers if most is None else numbers[:: max(1, numbers.size // most)]


def chosen(samples: Samples, rows: NDArray[np.intp], kept: NDArray[np.bool_]) -> Samples:
    """Return some of the samples in turns, whose numbers are `rows`; turns keep their numbers."""
    ends = np.cumsum(samples.runs[:, 1] - samples.runs[:, 0])
    last = np.append(0, np.cumsum(kept))[ends]
    runs = np.stack([np.append(0, last[:-1]), last, samples.runs[:, 2]], axis=-1)
    at = rows[kept]
    return Samples(samples.phi[at], samples.force[at], samples.normal[at], runs, samples.turns)


def reads_normal_force(data: Any) -> bool:
    """Return whether λ_N comes from the normal channel; else it is given, whatever T's row 3."""
    raw = getattr(data, "raw", None)
    return raw is None or raw.normal_load is None


def channels_turn(data: Any) -> bool:
    """Return whether forces come from channels that turn with the direction of sliding."""
    raw = getattr(data, "raw", None)
    if raw is None:
        return False
    return all(getattr(run, "velocity", None) is None for run in raw.recordings)


def is_angled(data: Any) -> bool:
    """Return whether angles say how the surface lay under a stage."""
    raw = getattr(data, "raw", None)
    return raw is not None and any(
        run.velocity is not None and bool(run.angle.any()) for run in raw.recordings
    )


def runs_of(samples: Samples, data: Any) -> NDArray[np.intp]:
    """Return the number of the run of each turn; arrays are one run, and so are pieces of one."""
    result = np.zeros(samples.turns, dtype=np.intp)
    if getattr(data, "raw", None) is not None:
        recording = np.searchsorted(data.run, samples.runs[:, 0], side="right") - 1
        result[samples.runs[:, 2]] = runs_of_recordings(data)[recording]
    return result


def clusters_of(samples: Samples, data: Any) -> NDArray[np.intp]:
    """Return for each turn what it shares its scatter with: its run if there are enough, or none.

    Between runs the pin is set down anew, and friction need not be what it was.
    """
    if getattr(data, "raw", None) is not None:
        runs, number = np.unique(runs_of(samples, data), return_inverse=True)
        if runs.size >= _FEWEST_RUNS:
            return number
    return np.arange(samples.turns)


def _counted_turns(phi: Array) -> NDArray[Any]:
    """Return numbers of the turns of an unwrapped direction; −1 in an incomplete last one."""
    if phi.size < 2 or np.ptp(phi) <= 2.0 * np.pi:
        return np.zeros(phi.size, dtype=np.intp)
    per_turn = np.sign(phi[-1] - phi[0]) / (2.0 * np.pi)
    # One step is missing from the last turn when it ends just before its start.
    last, before = (phi[-1] - phi[0]) * per_turn, (phi[-2] - phi[0]) * per_turn
    complete = int(np.floor(last + 1.5 * abs(last - before)))
    turn = np.empty(phi.size, dtype=np.int32)
    for start in range(0, phi.size, _CHUNK):
        part = slice(start, start + _CHUNK)
        number = np.floor((phi[part] - phi[0]) * per_turn + 1e-9)
        turn[part] = np.where((number < 0.0) | (number >= complete), -1.0, number)
    return turn


def is_wrapped(samples: Samples) -> bool:
    """Return whether a direction that goes on for turns starts again at each of them."""
    steps = np.abs(np.diff(samples.phi))
    jumps = steps[steps > np.pi]
    # Of directions in any order, most are far from the next one.
    if not jumps.size or jumps.min() < 1.5 * np.pi or np.median(steps) > 0.5:
        return False
    return bool(np.ptp(np.unwrap(samples.phi)) > 1.9 * 2.0 * np.pi)


def _runs(turn: NDArray[Any]) -> tuple[NDArray[np.intp], int]:
    edges = [
        np.flatnonzero(np.diff(turn[start : start + _CHUNK + 1])) + start + 1
        for start in range(0, turn.size, _CHUNK)
    ]
    first = np.concatenate([[0], *edges]).astype(np.intp)[: turn.size]
    end = np.append(first[1:], turn.size)
    inside = turn[first] >= 0
    labels, number = np.unique(turn[first[inside]], return_inverse=True)
    return np.stack([first[inside], end[inside], number], axis=-1), labels.size


def _check(samples: Samples) -> None:
    count = len(samples)
    if count < _FEWEST:
        raise FitError(
            f"data: {count} samples lie in complete turns, at least {_FEWEST} are needed: "
            "record one turn or more"
        )
    for part, _ in samples.chunks():
        # Sums of finite numbers are finite.
        if not np.isfinite(samples.force[part].sum() + samples.phi[part].sum()):
            raise FitError(f"data: samples {part.start}..{part.stop} hold NaN or infinity")
        if not samples.normal[part].min() > 0.0:
            raise FitError(
                f"data: the normal force is not positive in samples {part.start}..{part.stop}: "
                "leave out where the pin was lifted"
            )


def bin_of(phi: Array, bins: int) -> NDArray[np.intp]:
    """Return the number of the bin of equal width that each direction lies in."""
    part = phi * (1.0 / (2.0 * np.pi))
    part -= np.floor(part)
    return np.minimum((part * bins).astype(np.intp), bins - 1)
