"""Breakaway: the static coefficient from the starts of strokes, beside the kinetic one."""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from asperity._base import arrays
from asperity._base.arrays import Array
from asperity._base.result import NO_UNIT, Axis, Result, Series, Table, TableResult, counted
from asperity.errors import FitError
from asperity.identify.estimator.covariance import level_of
from asperity.identify.evidence.coefficient.turns import (
    Turns,
    by_direction,
    interval,
    runs_of,
    shared_variance,
    turns_of,
)
from asperity.identify.forces.processing import ProcessedData
from asperity.identify.models.coordinates import Estimate
from asperity.identify.records.sliding.stretches import rows_of

# Below this part of the kinetic force the pin sticks for certain.
_STICKS = 0.8
# The stick part is a line from so many samples on.
_FEWEST = 3
# The peak is looked for up to this multiple of the kinetic force.
_HIGHEST = 3.0
# Of the posterior of a mean: places along each axis, the smallest and the largest standard
# deviation in what values differ by, and the density that is left out.
_GRID, _SMALLEST, _WIDEST, _NEGLIGIBLE = 100, 1e-3, 30.0, 1e-5
# A force whose mean falls by so many standard errors below the kinetic one swings; it is looked for
# in at most so many samples. Inertia that adds less than the last part of the excess is corrected.
_SURE, _LONGEST, _SMALL = 5.0, 2000, 0.5
# Strokes swing alike whose speeds over loads differ by less than this factor.
_ALIKE = 1.25
# Sample rates that differ by less are one: clocks are not exact.
_SAME_RATE = 0.01
# A quarter of a period with fewer samples shows no swing.
_UNRESOLVED = 1.5
# Samples tell apart what differs by more than so many standard deviations of the noise.
_APART = 3.0
# An interval that allows a larger excess does not tell that there is none.
_TOLD = 0.05
# More directions are not spoken of one by one.
_SHOWN = 4
# Where the pin sticks over more than this part of the way, the rest tells no kinetic force;
# ends of the way are this part of it. A rise below this part of the level is no sticking.
_STUCK, _END, _FLAT = 0.8, 0.05, 0.5
# A pin without load does not stick: λ_N is less than this part of that of the stroke.
_PRESSED = 0.5
_NONE = Estimate(math.nan, math.nan, math.nan, math.nan, identifiable=False)


@dataclass(frozen=True)
class Segment:
    """A stroke with the reversal or the rest before it.

    Attributes:
        number: of the stroke.
        forwards: whether it goes along the axis of the sensor.
        rows: of its samples, from the reversal on.
        path: way of the stage or of the disk since then in m (in rad without a radius), ``(k,)``.
        force: −λ along the stroke over λ_N, ``(k,)``.
        load: mean λ_N in N.
        sample_rate: in Hz.
    """

    number: int
    forwards: bool
    rows: slice
    path: Array
    force: Array
    load: float
    sample_rate: float


def segments(data: ProcessedData) -> Iterator[Segment]:
    """Yield the strokes of all runs, from reversal to reversal."""
    for at, (run, turned) in enumerate(zip(data.raw.recordings, data._turned, strict=True)):
        part = slice(data.run[at], data.run[at + 1])
        force, normal = data.force[part], data.normal_force[part]
        place = _place(data, at)
        found = rows_of(data.turn[part])
        starts = []
        for before, rows in zip([None, *found], found, strict=False):
            first = 0 if before is None else int(before[-1]) + 1
            way = np.broadcast_to(turned, len(run))[rows[0]]
            e = np.array([math.cos(way), math.sin(way)])
            along = place[first : rows[0] + 1] @ e
            # The last place where the pin is as far back as it comes, with load.
            start = first + along.size - 1 - int(along[::-1].argmin())
            least = _PRESSED * float(np.median(normal[rows]))
            lifted = np.flatnonzero(normal[start : rows[0] + 1] < least)
            starts.append((start + int(lifted[-1]) + 1 if lifted.size else start, way, e))
        ends = [start for start, *_ in starts[1:]]
        for rows, (start, way, e), end in zip(
            found, starts, [*ends, found[-1][-1] + 1 if found else 0], strict=True
        ):
            used = slice(start, max(int(end), int(rows[-1]) + 1))
            angle = run.angle[used] * (run.velocity is not None) + data.grid_angle + way
            if run.velocity is None:
                angle = angle + run.angle[used]
            along = arrays.along_and_across(force[used], angle)[0]
            yield Segment(
                int(data.turn[part][rows[0]]),
                bool(e[0] > 0.0),
                slice(part.start + used.start, part.start + used.stop),
                (place[used] - place[start]) @ e,
                along / np.where(normal[used] > 0.0, normal[used], np.inf),
                float(normal[rows].mean()),
                run.sample_rate,
            )


def _place(data: ProcessedData, at: int) -> Array:
    """Return where the pin is on the surface, along the axes of the sensor, ``(n, 2)``."""
    run = data.raw.recordings[at]
    place = np.zeros((len(run), 2))
    if run.velocity is None:
        place[:, 0] = run.angle * (data.raw.radius or 1.0)
    elif run._position is not None:
        place[:, : run._position.shape[1]] = run._position
    else:
        middle = 0.5 * (run.velocity[1:] + run.velocity[:-1])
        place[1:] = np.cumsum(middle * np.diff(run.time)[:, None], axis=0)
    return place


@dataclass(frozen=True, repr=False)
class DirectionBreakaway(Result):
    """Breakaway in one direction of sliding.

    Attributes:
        direction: φ in rad.
        static: coefficient at which the pin breaks away, along the stroke.
        kinetic: coefficient while it slides.
        ratio: static over kinetic.
        strokes: how many tell the static coefficient.
        untold: how many do not.
    """

    direction: float
    static: Estimate
    kinetic: Estimate
    ratio: Estimate
    strokes: int
    untold: int

    def summary(self, motion: str = "Sliding") -> str:
        """Return the coefficients in a sentence."""
        where = f"{motion} at {math.degrees(self.direction):.0f}°"
        if not self.static.identifiable:
            return f"{where}, the coefficient is {self.kinetic}; the static one is not told."
        return (
            f"{where}, the static coefficient is {self.static}, the kinetic one {self.kinetic}, "
            f"their ratio {self.ratio} ({counted(self.strokes, 'stroke')})."
        )

    def __repr__(self) -> str:
        return f"<DirectionBreakaway: static {self.static}, kinetic {self.kinetic}>"


@dataclass(frozen=True, repr=False)
class Breakaway(TableResult):
    """Static and kinetic coefficients by direction; made by `breakaway`.

    Attributes:
        directions: those of the strokes.
        there_and_back: means of opposite directions, in which the zero of the sensor cancels.
        ratio: static over kinetic coefficient of all strokes.
        compliance: of what holds pin and sensor in m/N; NaN without a radius, or where no stroke
            tells it.
        needed_rate: in Hz, without which most strokes have too few samples while the pin sticks;
            None where they have enough.
        inertia: what the mass of pin and holder adds to the largest force, over its excess, by how
            the force swings after the slip: the largest over groups of strokes of like v/λ_N; NaN
            where it does not swing.
        unseen: excess over the kinetic force, relative to it, that may be inertia of a mass whose
            swing the samples do not show: mean over the strokes that tell the ratio.
        has_zeros: whether the zeros of the sensor are known. If not, their error is in each of
            `directions`.
        confidence: of the intervals.
    """

    directions: tuple[DirectionBreakaway, ...]
    there_and_back: tuple[DirectionBreakaway, ...]
    ratio: Estimate
    compliance: float
    needed_rate: float | None
    inertia: float
    unseen: float
    has_zeros: bool
    confidence: float

    @property
    def has_excess(self) -> bool:
        """Whether the static coefficient exceeds the kinetic one beyond scatter and inertia."""
        return self.ratio.identifiable and self.ratio.low > 1.0 + self.unseen

    def summary(self) -> str:
        """Return what the strokes say, in sentences."""
        lines = [one.summary() for one in self.directions]
        told = [one.ratio.value for one in self.directions if one.ratio.identifiable]
        if len(lines) > _SHOWN:
            lines = [f"Strokes are along {len(lines)} directions."]
            if told:
                lines[0] += (
                    f" Ratios of static and kinetic coefficient are between {min(told):.4g} and "
                    f"{max(told):.4g}."
                )
        if not self.has_zeros:
            lines.append(
                "The zeros of the sensor are not known: an error of 1 % of the normal force "
                "changes coefficients of a direction by 0.01, and of the opposite one by -0.01."
            )
            if len(self.directions) <= _SHOWN:
                lines += [one.summary("Sliding there and back") for one in self.there_and_back]
        if self.needed_rate is not None:
            lines.append(
                "The sampling rate cannot tell the static coefficient: while the pin sticks there "
                f"are fewer than {_FEWEST} samples in most strokes; it takes at least "
                f"{self.needed_rate:.2g} Hz, or slower reversals."
            )
        elif self.inertia > _SMALL:
            lines.append(
                "The force swings after the slip: the stage drags the mass of pin and holder. "
                f"That may be {min(self.inertia, 1.0):.0%} or more of what the largest readings "
                "exceed the kinetic force by; slower reversals tell the static coefficient."
            )
        elif not self.ratio.identifiable:
            lines.append(
                f"Fewer than {_FEWEST} strokes of one load and speed tell no interval of static "
                "friction."
            )
        elif 1.0 < self.ratio.low <= 1.0 + self.unseen:
            lines.append(
                f"Whether static friction exceeds the kinetic one (ratio {self.ratio}) cannot be "
                f"told: a mass of pin and holder whose swing the samples do not show may add up to "
                f"{self.unseen:.2%} to the force; sample faster, or reverse more slowly."
            )
        elif self.ratio.low <= 1.0 and self.ratio.high > 1.0 + _TOLD:
            lines.append(
                "Whether static friction exceeds the kinetic one cannot be told (ratio "
                f"{self.ratio}): sample faster, reverse more slowly, or record more strokes."
            )
        elif self.has_excess:
            lines.append(
                f"Static friction exceeds the kinetic one (ratio {self.ratio}): predictions of "
                "stick and slip need a rate factor, and C of the law is that of sliding."
            )
        else:
            lines.append(f"No excess of static over kinetic friction is found ({self.ratio}).")
        if math.isfinite(self.compliance):
            lines.append(f"Pin and sensor yield by {self.compliance:.3g} m/N.")
        return "\n".join(lines)

    def __repr__(self) -> str:
        return f"<Breakaway: {counted(len(self.directions), 'direction')}, ratio {self.ratio}>"

    def _table(self) -> Table:
        phi = Axis(np.array([one.direction for one in self.directions]), "rad", "direction")
        series = {
            f"{name}_{end}": Series(
                np.array([getattr(getattr(one, name), key) for one in self.directions]),
                ("phi",),
                NO_UNIT,
                f"{name} coefficient" if name != "ratio" else "static over kinetic",
            )
            for name in ("static", "kinetic", "ratio")
            for end, key in (("value", "value"), ("low", "low"), ("high", "high"))
        }
        return Table({"phi": phi}, series, {"confidence": self.confidence})


def breakaway(data: ProcessedData, *, confidence: float = 0.95) -> Breakaway:
    """Return the static coefficient by direction from reversals and starts of strokes.

    While the pin sticks, pin and sensor yield with the stage: −λ·e/λ_N = a + s/(c λ_N) over the way
    s, with one compliance c for strokes of all loads, fitted where the force is below 0.8 of the
    kinetic.
    The pin slips between the samples that part line and kinetic level with the least sum of
    squares; the static coefficient lies between the values of the line there. Strokes are
    independent normal values, of each of which two ends are known. A mass m of pin and holder that
    the stage drags along with v adds up to a = v √(m/c) to the force, which then swings about the
    kinetic one: of a largest mean force that is higher by e, √(e² − a²) is friction, with a from
    the half period of the swing. If a exceeds e/2, the static coefficient is not told. Strokes of
    like v/λ_N, of which a is the same part of the force, are looked at together.
    Forces that a filter of the sensor has changed are taken as they are.

    Args:
        data: strokes of a stage or of a disk that turns back; one channel is enough.
        confidence: of the intervals.

    Raises:
        FitError: where nothing goes back and forth.

    Reference: [WL19] §2.1; least squares for the change from one line to another (Quandt 1958).

    >>> import numpy as np
    >>> from asperity.identify import RawData, Recording, breakaway, process
    >>> t = np.arange(0.0, 8.0, 1e-3)
    >>> place = 1e-3 * np.abs((t + 0.5) % 2.0 - 1.0)  # m, back and forth with 1 mm/s
    >>> speed = np.where((t + 0.5) % 2.0 < 1.0, -1e-3, 1e-3)
    >>> way = np.abs(place - np.where(speed > 0.0, 0.0, 1e-3))  # since the reversal
    >>> stick = -3.0 + way / 1e-5  # N, with a compliance of 1e-5 m/N
    >>> force = np.sign(speed) * np.where(stick < 3.6, stick, 3.0)
    >>> readings = np.stack([force, 0.0 * t, 10.0 + 0.0 * t], axis=-1)
    >>> velocity = np.stack([speed, 0.0 * t], axis=-1)
    >>> run = Recording(t, angle=0.0 * t, readings=readings, velocity=velocity)
    >>> found = breakaway(process(RawData([run])))
    >>> round(found.ratio.value, 2), found.has_excess, round(found.compliance * 1e5, 2)
    (1.2, True, 1.0)
    """
    level = level_of(confidence) or 0.95
    arrays.of_kind(data, "data", ProcessedData, "what process() returns")
    if data.goes_round:
        raise FitError("data: a disk or a stage that goes round does not reverse")
    found = starts_of(data)
    if not found.strokes:
        raise FitError("data: no stroke has a force against the sliding: its sign may be wrong")
    number = np.array([one.number for one in found.strokes], dtype=np.intp)
    kinetic = found.turns.coefficient[number]
    ends = np.array(
        [(math.nan, math.nan) if peak is None else peak.ends for peak in found.peaks]
    ).reshape(-1, 2)
    error = found.error / np.array([one.load for one in found.strokes])
    ends, inertia, unseen = _without_inertia(found, ends, kinetic)
    told = np.isfinite(ends[:, 0])
    directions = tuple(
        _of_direction(data, found.turns, number[at], kinetic[at], ends[at], error[at], level)
        for at in by_direction(found.turns.direction[number])
    )
    both, of_zero = [], np.zeros(kinetic.size)
    for line in by_direction(2.0 * found.turns.direction[number]):
        ways = by_direction(found.turns.direction[number[line]])
        if len(ways) == 2:
            # What the means of both directions differ by, half each.
            off = np.zeros(line.size)
            half = 0.5 * float(np.subtract(*(kinetic[line[way]].mean() for way in ways)))
            off[ways[0]], off[ways[1]] = half, -half
            if data.zero_covariance is None:
                of_zero[line] = off
            mean = kinetic[line] - off, ends[line] - off[:, None], error[line]
            both.append(_of_direction(data, found.turns, number[line], *mean, level))
    has_length = data.raw.radius is not None or data.raw.recordings[0].velocity is not None
    ratio = _NONE
    if _enough(told):
        # The zero of the sensor would enter the ratios there and back with opposite signs.
        level_of_each = kinetic - of_zero
        rises = ((ends - of_zero[:, None]) / level_of_each[:, None])[told]
        ratio = _over_strokes(rises, (error / level_of_each)[told], level)
    share = _largest(inertia[told] if ratio.identifiable else inertia)
    return Breakaway(
        directions,
        tuple(both),
        ratio,
        1.0 / found.stiffness if found.stiffness > 0.0 and has_length else math.nan,
        None if told.mean() > 0.5 or share > _SMALL else _needed_rate(data, found),
        share,
        float(unseen[told].mean()) if told.any() else 0.0,
        data.zero_covariance is not None,
        level,
    )


class Starts(NamedTuple):
    """The strokes in which the pin slips, and what their starts say.

    Attributes:
        turns: coefficients of all strokes while the pin slips.
        strokes: those in which it does.
        peaks: of these; None where too few samples tell one.
        stiffness: slope of the force over the way while the pin sticks in N/m.
        noise: standard deviation of the samples from that line in N.
        error: standard error of the line of a stroke in N.
    """

    turns: Turns
    strokes: list[Segment]
    peaks: list[Peak | None]
    stiffness: float
    noise: float
    error: float


def starts_of(data: ProcessedData) -> Starts:
    """Return where the strokes of all runs change from stick to slip."""
    turns = turns_of(data)
    every = list(segments(data))
    for run in np.unique(turns.run):
        own = [one for one in every if turns.run[one.number] == run]
        if (share := _stuck_share(own, turns.direction)) > _STUCK:
            name = data.raw.recordings[int(np.argmax(runs_of(data) == run))].file
            raise FitError(
                f"data: {name or f'run {run + 1}'}: the pin sticks over {min(share, 1.0):.0%} of "
                "the strokes, the force follows the stage: too short for kinetic friction to be "
                "measured; it takes longer strokes, or leave the run out"
            )
    strokes = [one for one in every if turns.coefficient[one.number] > 0.0]
    stiffness = _slope(
        [_part(one, _inside(one.force, turns.coefficient[one.number])) for one in strokes]
    )
    noise = 0.0
    for _ in range(2):
        peaks = [_peak(one, turns.coefficient[one.number], stiffness, noise) for one in strokes]
        parts = [
            _part(one, peak.stuck)
            for one, peak in zip(strokes, peaks, strict=True)
            if peak is not None
        ]
        stiffness = _slope(parts)
        off = [(force - stiffness * path) for path, force in parts]
        squares = sum(float(((one - one.mean()) ** 2).sum()) for one in off)
        count = sum(one.size - 1 for one in off)
        noise = math.sqrt(squares / count) if count else 0.0
        left_out = [
            slice(one.rows.start, one.rows.start + peak.stuck[1])
            for one, peak in zip(strokes, peaks, strict=True)
            if peak is not None
        ]
        turns = turns_of(data, left_out)
    slips = [turns.coefficient[one.number] > 0.0 for one in strokes]
    peaks = [one for one, held in zip(peaks, slips, strict=True) if held]
    strokes = [one for one, held in zip(strokes, slips, strict=True) if held]
    error = noise / math.sqrt(1.0 + count / max(len(off), 1))
    return Starts(turns, strokes, peaks, stiffness, noise, error)


def sliding(data: ProcessedData) -> NDArray[np.bool_]:
    """Return which samples are of turns, or of strokes while the pin slips, ``(n,)``."""
    return data.turn >= 0 if data.goes_round else starts_of(data).turns.kept


def _stuck_share(strokes: list[Segment], direction: Array) -> float:
    """Return over which part of the way the pin sticks, by a line that goes over into a level.

    The mean of such a force lies below the level by half the rise times that part. Means over both
    directions have no zero of the sensor.
    """
    ways = np.array([direction[one.number] for one in strokes])
    found = []
    for at in by_direction(ways):
        parts = []
        for one in (strokes[k] for k in at):
            s, y = one.path[: int(one.path.argmax()) + 1], one.force[: int(one.path.argmax()) + 1]
            if s.size > 1 and s[-1] > 0.0:
                first, last = y[s <= _END * s[-1]], y[s >= (1.0 - _END) * s[-1]]
                mean = float(np.trapezoid(y, s)) / float(s[-1] - s[0])
                parts.append((float(first.mean()), mean, float(last.mean())))
        if parts:
            found.append(np.median(parts, axis=0))
    if not found:
        return 0.0
    start, mean, level = np.mean(found, axis=0)
    rise = level - start
    return float(2.0 * (level - mean) / rise) if rise > _FLAT * abs(level) else 0.0


def _enough(told: NDArray[np.bool_]) -> bool:
    """Return whether most strokes tell the static coefficient, and so many that they scatter."""
    return bool(told.sum() >= _FEWEST and told.mean() > 0.5)


def _part(one: Segment, ends: tuple[int, int]) -> tuple[Array, Array]:
    """Return way and force in N of samples of a stroke."""
    return one.path[slice(*ends)], one.load * one.force[slice(*ends)]


def _inside(force: Array, kinetic: float) -> tuple[int, int]:
    """Return the samples before the force first exceeds a part of the kinetic one, either way."""
    above = force >= _STICKS * kinetic
    end = int(above.argmax()) if above.any() else force.size
    below = np.flatnonzero(force[:end] <= -_STICKS * kinetic)
    return (int(below[-1]) + 1 if below.size else 0), end


def _slope(parts: list[tuple[Array, Array]]) -> float:
    """Return the common slope of lines through the samples of all strokes; NaN if none tells it."""
    over, both = 0.0, 0.0
    for path, force in parts:
        if path.size > 1:
            away = path - path.mean()
            over += float(away @ away)
            both += float(away @ force)
    return both / over if over > 0.0 else math.nan


class Peak(NamedTuple):
    """Between which coefficients the pin slips, NaN if it does not, and where it sticks before."""

    ends: tuple[float, float]
    stuck: tuple[int, int]


def _peak(one: Segment, kinetic: float, stiffness: float, noise: float) -> Peak | None:
    """Return the force before the pin slips; None if too few samples tell it.

    Where the force rises by more than the noise from sample to sample, all places are taken
    together that the noise does not tell apart: of ratios near 1 a sample may be of either part.
    """
    slope, noise = stiffness / one.load, noise / one.load
    low, end = _inside(one.force, kinetic)
    if not slope > 0.0 or end - low < _FEWEST - 1 or end >= one.force.size:
        return None
    y, s = one.force, one.path
    stuck = slice(low, end)
    start = float((y[stuck] - slope * s[stuck]).mean())
    line = start + slope * s
    beyond = line[end:] > _HIGHEST * kinetic
    past = end + (int(beyond.argmax()) if beyond.any() else line.size - end)
    sticks = np.cumsum((y[end:past] - line[end:past]) ** 2)
    slides = np.cumsum(((y[end:past] - kinetic) ** 2)[::-1])[::-1]
    cost = np.append(0.0, sticks) + np.append(slides, 0.0)
    # Of the samples from `end` on, so many still stick.
    last = end + int(cost.argmin())
    if last >= past:
        # It does not slip before the record ends.
        return Peak((math.nan, math.nan), (low, past))
    if last - low < _FEWEST:
        return None
    start = float((y[low:last] - slope * s[low:last]).mean())
    step = slope * float(s[last] - s[last - 1])
    near = np.flatnonzero(cost <= cost.min() + (_APART * noise) ** 2)
    if step > _APART * noise:
        earliest, latest = end + int(near[0]), min(end + int(near[-1]), past - 1)
    else:
        earliest = latest = last
    ends = start + slope * s[[earliest - 1, latest]]
    return Peak((float(ends.min()), float(ends.max())), (low, last))


def _without_inertia(found: Starts, ends: Array, kinetic: Array) -> tuple[Array, Array, Array]:
    """Return ends without what inertia adds; of each stroke its share of the excess, and `unseen`.

    Inertia adds v √(m/c) to a kinetic force of μ λ_N: strokes of like v/λ_N swing alike, and are
    taken together where they are sampled alike. Ends that it does not leave, or too few strokes
    do not tell, are NaN.
    """
    ends, share, unseen = ends.copy(), np.full(len(ends), math.nan), np.zeros(len(ends))
    rate = np.array([one.sample_rate for one in found.strokes])
    way = np.array([one.path.max() / one.path.size / one.load for one in found.strokes])
    pace = way * rate
    rest = np.argsort(pace)
    while rest.size:
        alike = pace[rest] <= _ALIKE * pace[rest[0]]
        alike &= np.isclose(rate[rest], rate[rest[0]], rtol=_SAME_RATE)
        at, rest = rest[alike], rest[~alike]
        some = found._replace(
            strokes=[found.strokes[k] for k in at], peaks=[found.peaks[k] for k in at]
        )
        excess, inertia = _swing(some)
        share[at] = inertia / excess
        if inertia > _SMALL * excess or np.isfinite(ends[at, 0]).sum() < _FEWEST:
            ends[at] = math.nan
        elif excess > 0.0:
            # A mass on a spring has the energy of both at the largest force, past the line.
            beyond = float(np.nanmean(ends[at].mean(axis=1) / kinetic[at])) - 1.0
            ends[at] -= kinetic[at, None] * (beyond - math.sqrt(excess**2 - inertia**2))
        if not math.isfinite(inertia):
            unseen[at] = _unseen(some)
    return ends, share, unseen


def _largest(values: Array) -> float:
    """Return the largest of values, NaN if all are."""
    held = values[np.isfinite(values)]
    return float(held.max()) if held.size else math.nan


def _swing(found: Starts) -> tuple[float, float]:
    """Return what the largest mean force exceeds the kinetic one by, and what inertia adds of it.

    Both are relative to the kinetic force, and NaN where the force does not swing after the slip.
    """
    parts = [
        (one.force / found.turns.coefficient[one.number], peak)
        for one, peak in zip(found.strokes, found.peaks, strict=True)
        if peak is not None and math.isfinite(peak.ends[0])
    ]
    lengths = [peak.stuck[1] - peak.stuck[0] for _, peak in parts]
    half = min(int(np.median(lengths)), _LONGEST) if parts else 0
    waves = [
        force[peak.stuck[1] - half : peak.stuck[1] + half]
        for force, peak in parts
        if half <= peak.stuck[1] <= force.size - half
    ]
    if len(waves) < _FEWEST:
        return math.nan, math.nan
    wave = np.mean(waves, axis=0) - 1.0
    kinetic = np.mean([found.turns.coefficient[one.number] for one in found.strokes])
    noise = _noise(found) / float(kinetic) / math.sqrt(len(waves))
    depth = -float(wave[half:].min())
    if depth < _SURE * noise:
        return math.nan, math.nan
    # Half a period after the largest force the mass is farthest below; later swings count less.
    first = half + int((wave[half:] < -0.5 * depth).argmax())
    again = np.flatnonzero(wave[first:] > 0.0)
    until = first + int(again[0]) if again.size else wave.size
    lowest = first + int(wave[first:until].argmin())
    top = int(wave[:lowest].argmax())
    rise = np.mean([np.diff(peak.ends)[0] for _, peak in parts]) / kinetic
    return float(wave[top]), float(rise) * (lowest - top) / math.pi


def _noise(found: Starts) -> float:
    """Return the noise of the samples of all strokes per unit normal force."""
    return found.noise * float(np.mean([1.0 / one.load for one in found.strokes]))


def _unseen(found: Starts) -> float:
    """Return what the mass of a swing that is not found may add to the kinetic force, relative.

    The line goes on to the largest force, a quarter of a period after the slip: of half a period
    of up to three samples the rise over 1.5 of them. Longer ones are seen from a depth of some
    standard errors of the mean stroke on.
    """
    rises, kinetic = [], []
    for one, peak in zip(found.strokes, found.peaks, strict=True):
        if peak is not None and math.isfinite(peak.ends[0]):
            last = peak.stuck[1]
            step = float(one.path[last] - one.path[last - 1])
            rises.append(found.stiffness / one.load * step)
            kinetic.append(float(found.turns.coefficient[one.number]))
    if not rises:
        return math.nan
    noise = _SURE * _noise(found) / math.sqrt(len(rises))
    return max(_UNRESOLVED * float(np.median(rises)), noise) / float(np.mean(kinetic))


def _of_direction(
    data: ProcessedData,
    turns: Turns,
    number: NDArray[np.intp],
    kinetic: Array,
    ends: Array,
    noise: Array,
    level: float,
) -> DirectionBreakaway:
    told = np.isfinite(ends[:, 0])
    zero, gain = shared_variance(data, turns.kept & np.isin(data.turn, number))
    static = ratio = _NONE
    if _enough(told):
        more = float((ends[told].mean() / kinetic.mean()) ** 2)
        static = _over_strokes(ends[told], noise[told], level, known=zero + gain * more)
        ratio = _over_strokes(ends[told] / kinetic[told, None], (noise / kinetic)[told], level)
    return DirectionBreakaway(
        float(turns.direction[number[0]]) % (2.0 * math.pi),
        static,
        interval(kinetic, level, known=zero + gain),
        ratio,
        int(told.sum()),
        int((~told).sum()),
    )


def _over_strokes(ends: Array, noise: Array, level: float, *, known: float = 0.0) -> Estimate:
    """Return the mean of values of which only ends are known, ``(n, 2)``, as normal ones.

    The interval is that of the posterior of the mean with the flat prior of mean and logarithm of
    the standard deviation σ: Student's t where ends are close beside the scatter, and what all
    intervals have in common where the scatter is small.
    """
    from scipy.special import ndtr, ndtri

    middle, n = ends.mean(axis=1), len(ends)
    width = float(np.diff(ends).mean())
    size = float(middle.std(ddof=1)) + width
    least = max(float(noise.mean()), _SMALLEST * size)
    sigma = np.geomspace(least, max(_WIDEST * size, 2.0 * least), _GRID)[:, None, None]
    centre, reach = float(np.median(middle)), _WIDEST * size / math.sqrt(n)
    low, high = centre - reach, centre + reach
    for _ in range(3):
        mean = np.linspace(low, high, _GRID)
        off = (ends - mean[:, None, None]) / sigma[..., None]
        with np.errstate(divide="ignore"):
            inside = np.log(ndtr(off[..., 1]) - ndtr(off[..., 0])).sum(axis=2)
        weight = np.exp(inside - inside.max()).sum(axis=0)
        held = np.flatnonzero(weight > _NEGLIGIBLE * weight.max())
        low = float(mean[max(held[0] - 1, 0)])
        high = float(mean[min(held[-1] + 1, _GRID - 1)])
    tails = 0.5 - 0.5 * level, 0.5, 0.5 + 0.5 * level
    share = np.cumsum(weight) - 0.5 * weight
    first, value, last = np.interp(tails, share / weight.sum(), mean)
    # Strokes in step with the samples have one pair of ends, and may have no scatter at all.
    common = np.array([(ends[:, 0] - noise).max(), (ends[:, 1] + noise).min()])
    if common[0] < common[1]:
        low, high = common[0] + np.array([tails[0], tails[2]]) * (common[1] - common[0])
        first, last = min(first, low), max(last, high)
    variance = float((weight * (mean - value) ** 2).sum() / weight.sum())
    more = float(ndtri(tails[2])) ** 2 * known
    return Estimate(
        float(value),
        float(value - math.sqrt((value - first) ** 2 + more)),
        float(value + math.sqrt((last - value) ** 2 + more)),
        math.sqrt(variance + known),
    )


def _needed_rate(data: ProcessedData, found: Starts) -> float:
    """Return a sampling rate without which most strokes have too few samples of stick."""
    rate = max(run.sample_rate for run in data.raw.recordings)
    counts = [
        end - low
        for low, end in (
            _inside(one.force, found.turns.coefficient[one.number]) for one in found.strokes
        )
    ]
    return rate * (_FEWEST + 1) / max(float(np.median(counts)) if counts else 0.0, 0.5)
