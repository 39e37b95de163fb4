"""The friction coefficient along the sliding, turn by turn or stroke by stroke."""

from __future__ import annotations

import math
from collections.abc import Iterable
from itertools import pairwise
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from asperity._base.arrays import Array, along_and_across
from asperity._base.quantiles import student
from asperity.identify.forces.processing import ProcessedData
from asperity.identify.models.coordinates import Estimate
from asperity.identify.records.sliding.stretches import rows_of

# After a reversal the pin sticks until the force has grown: where it has come to this part of the
# usual force of the stroke, the rest of the way follows from a straight line, with some more.
_NEARLY, _MORE = 0.8, 1.1
# A stroke that starts with more than this part of it slides on a surface whose friction varies.
_SLIDES = 0.5
# Strokes whose directions differ by less are of one direction.
_SAME = math.radians(2.0)
# Turns that follow each other are no independent values where friction drifts: an interval comes
# from the means of so many groups of them.
_GROUPS = 20


class Turns(NamedTuple):
    """What the turns or strokes of all runs say, each of shape ``(m,)``.

    Attributes:
        coefficient: mean of l_t/λ_N, friction against the sliding; of strokes while the pin slips,
            NaN where it does not.
        load: mean λ_N in N.
        speed: mean ‖γ‖ in m/s; NaN where it is not known.
        rate: mean turns of the disk per second; NaN of a stage.
        direction: mean φ in rad of strokes; NaN of turns.
        run: number of the file or window.
        kept: which samples count, ``(n,)``.
    """

    coefficient: Array
    load: Array
    speed: Array
    rate: Array
    direction: Array
    run: NDArray[np.intp]
    kept: NDArray[np.bool_]


def turns_of(data: ProcessedData, left_out: Iterable[slice] = ()) -> Turns:
    """Return the coefficient of each turn or stroke; the stick at the start of strokes is left out.

    Pieces of a file that was cut at its defects are one run.

    Args:
        data: processed data.
        left_out: samples besides in which the pin sticks.
    """
    y = along_and_across(data.force, data.phi)[0] / np.where(
        data.turn >= 0, data.normal_force, np.inf
    )
    kept = data.turn >= 0
    for rows in left_out:
        kept[rows] = False
    direction = np.full(data.turns, math.nan)
    if not data.goes_round:
        strokes = rows_of(data.turn)
        first = np.unique(data.turn[[rows[0] for rows in strokes]], return_index=True)[1]
        starts = [strokes[at] for at in first]
        way = np.array([data.phi[rows[rows.size // 2]] for rows in starts])
        direction = np.arctan2(np.sin(way), np.cos(way))
        medians = np.array([np.median(y[rows]) for rows in starts])
        for group in by_direction(direction):
            usual = float(np.median(medians[group]))
            for at in group:
                kept[starts[at][: _stick(y[starts[at]], usual)]] = False
    number = data.turn[kept]
    count = np.bincount(number, minlength=data.turns)

    def mean(values: Array) -> Array:
        with np.errstate(invalid="ignore"):
            return np.asarray(np.bincount(number, values[kept], data.turns) / count)

    turning = np.concatenate(
        [
            data._angular_speed(at) if run.velocity is None else np.full(len(run), math.nan)
            for at, run in enumerate(data.raw.recordings)
        ]
    )
    speed = np.concatenate(
        [
            (data.raw.radius or math.nan) * turning[slice(*data.run[at : at + 2])]
            if run.velocity is None
            else np.hypot(run.velocity[:, 0], run.velocity[:, 1])
            for at, run in enumerate(data.raw.recordings)
        ]
    )
    first = np.unique(data.turn[data.turn >= 0], return_index=True)[1]
    recording = np.searchsorted(data.run, np.flatnonzero(data.turn >= 0)[first], side="right") - 1
    return Turns(
        mean(y),
        mean(data.normal_force),
        mean(speed),
        mean(turning) / (2.0 * math.pi),
        direction,
        runs_of(data)[recording],
        kept,
    )


def runs_of(data: ProcessedData) -> NDArray[np.intp]:
    """Return the number of the run of each recording: pieces of a file are one, windows are not."""
    names: dict[str, int] = {}
    return np.array(
        [
            names.setdefault(one.file if one.source != one.file else f" {at}", len(names))
            for at, one in enumerate(data.raw.recordings)
        ],
        dtype=np.intp,
    )


def count_of_runs(data: ProcessedData) -> int:
    """Return how many runs have complete turns or strokes; pieces of a file are one."""
    used = [bool((data.turn[slice(*ends)] >= 0).any()) for ends in pairwise(data.run)]
    return len(set(runs_of(data)[used].tolist()))


def _stick(y: Array, usual: float) -> int:
    """Return how many samples of a stroke pass until the pin surely slips; all if it does not."""
    near = _NEARLY * usual
    if usual <= 0.0 or y[0] >= _SLIDES * usual:
        return 0
    slips = y >= near
    at = int(slips.argmax()) if slips.any() else y.size
    return math.ceil(_MORE * at * (usual - y[0]) / (near - y[0]))


def by_direction(phi: Array) -> list[NDArray[np.intp]]:
    """Return which strokes are along one direction, by direction."""
    groups: list[NDArray[np.intp]] = []
    rest = np.arange(phi.size)
    while rest.size:
        off = np.abs((phi[rest] - phi[rest[0]] + math.pi) % (2.0 * math.pi) - math.pi)
        groups.append(rest[off < _SAME])
        rest = rest[off >= _SAME]
    return sorted(groups, key=lambda at: float(phi[at[0]]) % (2.0 * math.pi))


class Values(NamedTuple):
    """Values of one run that may be taken for independent.

    Attributes:
        values: each with the mean of its line of strokes replaced by that of all.
        place: of each in the run, without the mean of its line; from first to last is 1.
        degrees: of freedom of their scatter: without one for each line.
    """

    values: Array
    place: Array
    degrees: int


def independent(values: Array, direction: Array) -> Values:
    """Return values of one run that may be taken for independent.

    Two strokes there and back are one value: in it the zero of the sensor cancels. How friction
    depends on the line of the strokes is no scatter.

    Args:
        values: of its turns or strokes, in their order.
        direction: φ of strokes in rad; NaN of turns.
    """
    turns = bool(np.isnan(direction).all())
    lines = [np.arange(values.size)] if turns else by_direction(2.0 * direction)
    own, place = [], []
    for at in lines:
        pairs = at[: at.size // 2 * 2].reshape(-1, 2) if not turns and at.size > 1 else at[:, None]
        parts = np.array_split(pairs, min(len(pairs), max(_GROUPS // len(lines), 2)))
        own.append(np.array([values[part].mean() for part in parts]))
        place.append(np.array([part.mean() for part in parts]))
    every = np.concatenate(own)
    reach = np.ptp(np.concatenate(place)) or 1.0
    return Values(
        np.concatenate([one - one.mean() for one in own]) + every.mean(),
        np.concatenate([one - one.mean() for one in place]) / reach,
        every.size - len(lines),
    )


def interval(
    values: Array, confidence: float, *, known: float = 0.0, degrees: int | None = None
) -> Estimate:
    """Return the mean of independent values with its interval by Student's t.

    Args:
        values: independent values.
        confidence: of the interval.
        known: variance that all values share, from calibration and zeros (Welch 1947).
        degrees: of freedom of their scatter; by default one less than values.
    """
    mean, n = float(values.mean()), values.size
    free = n - 1 if degrees is None else degrees
    if free < 1:
        return Estimate(mean, math.nan, math.nan, math.nan)
    scatter = float(((values - mean) ** 2).sum()) / free / n
    error = math.sqrt(scatter + known)
    freedom = free * (1.0 + known / scatter) ** 2 if scatter else math.inf
    half = student(confidence, min(freedom, 1e9)) * error
    return Estimate(mean, mean - half, mean + half, error)


def shared_variance(data: ProcessedData, rows: NDArray[np.bool_]) -> tuple[float, float]:
    """Return what errors of zeros and calibration make of the variance of a mean of l_t/λ_N.

    With s and c of the angle from the tangential axis to the sliding, l_t = c F_t + s F_r; an error
    δz of the readings without load is δF = −T δz, one of the calibration δF = δT T⁻¹ F.

    Args:
        data: processed data.
        rows: samples of the mean, ``(n,)``.
    """
    by_force, by_gain, count = np.zeros(3), np.zeros((3, 3)), 0
    for at, (run, turned) in enumerate(zip(data.raw.recordings, data._turned, strict=True)):
        part = slice(data.run[at], data.run[at + 1])
        used = rows[part]
        normal = data.normal_force[part][used]
        angle = np.broadcast_to(turned, used.shape)[used]
        c, s = np.cos(angle), np.sin(angle)
        along, across = along_and_across(data.force[part][used], run.angle[used] + data.grid_angle)
        weights = np.stack([c, s, -(c * along + s * across) / normal]) / normal
        if data.is_load_given:
            weights[2] = 0.0
        by_force += weights.sum(axis=1)
        by_gain += weights @ np.stack([along, across, normal], axis=1)
        count += normal.size
    to_zero = data.matrix.T @ by_force / count
    to_gain = (by_gain @ np.linalg.inv(data.matrix).T / count).ravel()
    zero, gain = data.zero_covariance, data.calibration_covariance
    stated = 0.0
    if data.is_load_given and data.raw.gain_error is not None:
        # That of the load itself.
        stated = float(by_gain[0, 0] + by_gain[1, 1]) / count * float(data.raw.gain_error[2])
    return (
        0.0 if zero is None else float(to_zero @ zero @ to_zero),
        (0.0 if gain is None else float(to_gain @ gain @ to_gain)) + stated**2,
    )
