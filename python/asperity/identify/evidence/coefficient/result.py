"""The friction coefficient of a campaign: by runs, grouped by load and speed, over turns."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np

from asperity._base import arrays
from asperity._base.arrays import Array
from asperity._base.quantiles import student
from asperity._base.result import NO_UNIT, Axis, Series, Table, TableResult, counted
from asperity._base.tables import aligned
from asperity.errors import FitError, ParameterError
from asperity.identify.estimator.covariance import level_of
from asperity.identify.estimator.identified_law import IdentifiedLaw
from asperity.identify.evidence.coefficient.dependence import LEAST_RATIO, Dependence
from asperity.identify.evidence.coefficient.static import (
    Breakaway,
    breakaway,
    segments,
    starts_of,
)
from asperity.identify.evidence.coefficient.stribeck import StribeckFit, fit_stribeck
from asperity.identify.evidence.coefficient.turns import (
    Turns,
    Values,
    by_direction,
    independent,
    interval,
    runs_of,
    shared_variance,
    turns_of,
)
from asperity.identify.forces.processing import ProcessedData
from asperity.identify.forces.strokes import turns_together
from asperity.identify.forces.turns import bin_numbers, full_bins
from asperity.identify.models.coordinates import Estimate
from asperity.law import FrictionLaw

# An isotropic law is refused where the coefficient changes by more than this over the directions
# (root mean square, without its noise), in so many bins.
_ISOTROPIC, _BINS = 0.02, 24
# More groups of one run each are not spoken of one by one.
_SHOWN = 4
# An interval that allows more change at twice the load or speed does not tell that there is none.
_TOLD = 0.05
# Coefficients beyond are rather those of wrong units.
_LIKELY = 1e-3, 10.0
# Loads and speeds of a run are those of its turns without this part of them at either end.
_ENDS = 0.1


@dataclass(frozen=True)
class Run:
    """A run: a file, or a window of one.

    Attributes:
        name: of the file, with the window.
        load: mean λ_N in N.
        speed: mean ‖γ‖ in m/s; NaN where it is not known.
        rate: mean turns of the disk per second; NaN of a stage.
        line: along which its strokes are, φ in rad from 0 to π; NaN of turns.
        turns: number of its turns or strokes.
        coefficient: mean of l_t/λ_N, with its interval from the scatter of turns or strokes.
        change: of the coefficient from the first to the last turn, relative, by a straight line.
            Its interval is one of those that hold for all runs together.
    """

    name: str
    load: float
    speed: float
    rate: float
    line: float
    turns: int
    coefficient: Estimate
    change: Estimate


@dataclass(frozen=True)
class Group:
    """Runs at one load and one speed, or turn rate where no radius gives the speed.

    Attributes:
        load, speed, rate: means over the runs.
        runs: their numbers.
        coefficient: mean of the runs. Its interval comes from the scatter of two runs or more, for
            each of which the pin was set down anew; of a single run from that of its turns.
        within: standard deviation of turns or strokes within runs, relative. Of several runs it is
            that of the first turns, as many as all have, without their common running-in.
        between: standard deviation of the runs, relative, beyond what turns explain; NaN for one.
        next: interval of the coefficient of one more mounting; NaN for one run.
    """

    load: float
    speed: float
    rate: float
    runs: tuple[int, ...]
    coefficient: Estimate
    within: float
    between: float
    next: tuple[float, float]


@dataclass(frozen=True)
class Loop:
    """The hysteresis loop of strokes: mean force per unit normal force over the place.

    Attributes:
        position: of the stage, or of the pin on the disk, from the middle of strokes in m (in rad
            for a disk without a radius), ``(k,)``.
        forwards: −λ/λ_N along the axis while it moves forwards, ``(k,)``.
        backwards: likewise backwards.
    """

    position: Array
    forwards: Array
    backwards: Array

    @property
    def offset(self) -> float:
        """Mean of both branches: what the zero of the sensor or a slope of the surface adds."""
        return float(0.5 * np.mean(self.forwards + self.backwards))

    @property
    def work(self) -> float:
        """Area of the loop: work of friction in a cycle per unit normal force, in m."""
        return float(np.trapezoid(self.forwards - self.backwards, self.position))


@dataclass(frozen=True, repr=False)
class FrictionCoefficient(TableResult):
    """Coefficients of friction along the sliding; made by `friction_coefficient`.

    Attributes:
        processed: data.
        confidence: of all intervals.
        names: of the runs by their numbers in `over_turns`.
        over_turns: coefficient, load and speed of every turn or stroke: the running-in curve.
        runs: with their means.
        groups: of runs at one load and one speed.
    """

    processed: ProcessedData
    confidence: float
    names: tuple[str, ...]
    over_turns: Turns
    runs: tuple[Run, ...]
    groups: tuple[Group, ...]

    @property
    def mean(self) -> Estimate:
        """The coefficient, where all runs have one load and one speed.

        Raises:
            ParameterError: where they do not: `groups` has one for each.
        """
        if len(self.groups) > 1:
            raise ParameterError("data", "has runs at several loads or speeds: see `groups`")
        return self.groups[0].coefficient

    @property
    def mountings_differ(self) -> bool:
        """Whether runs of a group differ by more than their turns scatter."""
        return any(group.between > group.within for group in self.groups)

    @cached_property
    def load_dependence(self) -> Dependence | None:
        """μ ∝ λ_Nⁿ over the runs at the speed that most have; None at one load."""
        return self._dependence("load", _pace)

    @cached_property
    def speed_dependence(self) -> Dependence | None:
        """μ ∝ ‖γ‖ⁿ over the runs at the load that most have; None at one speed."""
        return self._dependence("speed", _load)

    @cached_property
    def stribeck(self) -> StribeckFit | str:
        """The Stribeck factor over the runs at the load that most have, or why there is none."""
        one = self._dependence("speed", _load)
        if one is None:
            return "speeds do not vary"
        try:
            return fit_stribeck(
                one.values, coefficients=one.coefficients, confidence=self.confidence
            )
        except FitError as error:
            return str(error).removeprefix("speeds: ")

    @cached_property
    def breakaway(self) -> Breakaway | None:
        """Static coefficients of strokes; None for turns and for forces along the sliding."""
        if self.processed.goes_round or not np.any(self.over_turns.coefficient > 0.0):
            return None
        return breakaway(self.processed, confidence=self.confidence)

    @property
    def goes_back(self) -> bool:
        """Whether strokes go there and back along each line, so that the sensor's zero cancels."""
        way = self.over_turns.direction
        return not self.processed.goes_round and all(
            len(by_direction(way[line])) == 2 for line in by_direction(2.0 * way)
        )

    @property
    def has_length(self) -> bool:
        """Whether the way of the sliding is known in m, and not as an angle of a disk alone."""
        raw = self.processed.raw
        return raw.radius is not None or raw.recordings[0].velocity is not None

    def _dependence(self, name: str, other: Callable[[Run], float]) -> Dependence | None:
        """Return how coefficients depend on one quantity over the runs at one value of another."""
        chosen = self._chosen(name, other)
        values = [getattr(run, name) for run in chosen]
        lines = np.nan_to_num([2.0 * run.line for run in chosen])
        if len(_alike(values)) < 2 or len(by_direction(lines)) > 1:
            return None
        coefficients = [run.coefficient.value for run in chosen]
        return Dependence(values, coefficients, confidence=self.confidence)

    def _chosen(self, name: str, other: Callable[[Run], float]) -> list[Run]:
        """Return the runs at one value of a quantity at which another one has most values."""
        return max(
            ([self.runs[k] for k in part] for part in _alike([other(run) for run in self.runs])),
            key=lambda runs: (len(_alike([getattr(run, name) for run in runs])), len(runs)),
        )

    def loop(self, bins: int = 100) -> Loop:
        """Return the hysteresis loop: means of all strokes in equal bins of the place.

        Args:
            bins: number k of bins.

        Raises:
            FitError: for turns, or strokes along several lines.
        """
        count = arrays.count(bins, "bins")
        if self.processed.goes_round or len(by_direction(2.0 * self.over_turns.direction)) > 1:
            raise FitError("data: a hysteresis loop needs strokes there and back along one line")
        strokes = list(segments(self.processed))
        half = 0.5 * float(np.median([one.path.max() for one in strokes]))
        sums = np.zeros((2, 2, count))
        for one in strokes:
            sign = 1.0 if one.forwards else -1.0
            at = np.floor((sign * (one.path - half) / half + 1.0) * 0.5 * count).astype(np.intp)
            inside = (at >= 0) & (at < count)
            branch = 0 if one.forwards else 1
            sums[branch, 0] += np.bincount(at[inside], minlength=count)
            sums[branch, 1] += np.bincount(at[inside], sign * one.force[inside], count)
        held = (sums[:, 0] > 0.0).all(axis=0)
        position = half * ((np.arange(count) + 0.5) * 2.0 / count - 1.0)
        forces = sums[:, 1, held] / sums[:, 0, held]
        return Loop(position[held], forces[0], forces[1])

    def isotropic_law(self) -> IdentifiedLaw:
        """Return the isotropic law with this coefficient and its uncertainty.

        A friction force along the sliding tells no direction set: D is the disk that C is.

        Raises:
            FitError: where not all directions are recorded, the coefficient depends on them, or
                runs have several loads or speeds.
        """
        if len(self.groups) > 1:
            raise FitError(
                "data: runs at several loads or speeds: identify a law from those of one at a time"
            )
        self.check_isotropic()
        mean = self.mean
        if mean.value <= 0.0:
            raise FitError(
                f"data: the coefficient is {mean.value:.4g}: a minus before the unit turns the sign"
            )
        zero, gain = shared_variance(self.processed, self.over_turns.kept)
        scatter = max(mean.standard_error**2 - zero - gain, 0.0)
        known = self.processed.zero_covariance, self.processed.calibration_covariance
        own = len(self.groups[0].runs)
        freedom = own - 1 if own > 1 else self._values(0).degrees

        def part(variance: float) -> list[list[float]]:
            return [[variance / mean.value**2]]

        return IdentifiedLaw(
            FrictionLaw.isotropic(mean.value),
            reservoir_model="circle",
            direction_model="circle",
            values=[mean.value],
            turns=None if math.isnan(mean.standard_error) else part(scatter),
            calibration=None if known[1] is None else part(gain),
            zeros=None if known[0] is None else part(zero),
            degrees_of_freedom=(max(freedom, 1.0), math.inf, math.inf),
        )

    def check_isotropic(self) -> None:
        """Refuse strokes along some lines, and a coefficient that depends on the direction.

        Raises:
            FitError: for these.
        """
        if not self.processed.goes_round:
            raise FitError(
                "data: strokes along some lines do not tell whether friction is the same in all "
                "directions; FrictionLaw.isotropic takes it for granted"
            )
        spread = self.anisotropy
        if spread > _ISOTROPIC:
            raise FitError(
                f"data: the coefficient changes by {spread:.1%} (root mean square) over the "
                "directions of sliding: a law of such a surface needs the radial channel"
            )

    @cached_property
    def anisotropy(self) -> float:
        """Root mean square change of the coefficient over the directions of turns, relative.

        What the scatter of the turns makes of it is taken off.

        Raises:
            FitError: where turns have too few samples.
        """
        data, turns = self.processed, self.over_turns
        phi, number = data.phi[turns.kept], data.turn[turns.kept]
        bins = full_bins(phi, number, _BINS, each_turn=True)
        cell = number * bins + bin_numbers(phi, bins)
        y = arrays.along_and_across(data.force[turns.kept], phi)[0]
        sums, counts = (
            np.bincount(cell, one, data.turns * bins).reshape(-1, bins)
            for one in (y / data.normal_force[turns.kept], None)
        )
        if not counts.all():
            raise FitError(
                f"data: of {bins} directions of sliding, some have no sample in a turn, which does "
                "not tell whether friction is the same in all of them: sample faster; "
                "FrictionLaw.isotropic takes it for granted"
            )
        means = sums / counts
        means = means / means.mean(axis=1)[:, None]
        noise = means.var(axis=0, ddof=1).mean() / len(means) if len(means) > 1 else 0.0
        return math.sqrt(max(float(means.mean(axis=0).var(ddof=1)) - float(noise), 0.0))

    @property
    def wrong_signs(self) -> tuple[str, ...]:
        """Sentences on runs whose force goes with the sliding; `sentences` has them, too."""
        return tuple(
            f"In {run.name} the force goes with the sliding: a minus before its unit turns its "
            "sign."
            for run in self.runs
            if run.coefficient.value < 0.0
        )

    @property
    def _together(self) -> list[int]:
        """How many turns count as one, by run: the most of its pieces, 1 where it turns back."""
        data = self.processed
        known = {name: 1 for name in self.names}
        for number, one, turned in zip(
            runs_of(data).tolist(), data.raw.recordings, data._turned, strict=True
        ):
            if isinstance(turned, float):
                name = self.names[number]
                known[name] = max(known[name], turns_together(one))
        return [known[run.name] for run in self.runs]

    @property
    def unlikely(self) -> tuple[str, ...]:
        """A sentence on runs with coefficients as of wrong units; `sentences` has it, too."""
        least, most = _LIKELY
        found = [run for run in self.runs if not least <= abs(run.coefficient.value) <= most]
        if not found:
            return ()
        values = [run.coefficient.value for run in found]
        return (
            f"In {_listed(found)} the coefficient is {_span(values, '.3g')}, which is unlikely: "
            "look at the units of friction and normal force, at the calibration, and at the arm of "
            "a torque, which is in m.",
        )

    @property
    def unsteady(self) -> tuple[str, ...]:
        """Sentences on runs whose load or speed varies; `sentences` has them, too."""
        found = []
        for run in self.runs:
            for name, part in self._varying(run).items():
                span = f"{part.min():.4g} to {part.max():.4g}"
                unit = {"load": "N", "speed": "m/s", "turn rate": "turns/s"}[name]
                found.append(
                    f"In {run.name} the {name} varies from {span} {unit}: one coefficient is a "
                    "mean over all of it; give its parts as runs, by from and to in [run]."
                )
        return tuple(found)

    def _varying(self, run: Run) -> dict[str, Array]:
        """Return load and speed over the turns of a run, if they vary."""
        turns = self.over_turns
        own = (turns.run == self.names.index(run.name)) & np.isfinite(turns.coefficient)
        pace = ("turn rate", turns.rate) if math.isnan(run.speed) else ("speed", turns.speed)
        found = {}
        for name, values in (("load", turns.load[own]), (pace[0], pace[1][own])):
            low, high = np.quantile(values, [_ENDS, 1.0 - _ENDS], method="nearest")
            if high > LEAST_RATIO * low:
                found[name] = values
        return found

    def _values(self, number: int) -> Values:
        turns = self.over_turns
        own = (turns.run == number) & np.isfinite(turns.coefficient)
        return independent(turns.coefficient[own], turns.direction[own])

    def sentences(self) -> tuple[str, ...]:
        """Return what the runs mean for predictions with their coefficient or law."""
        word = "turns" if self.processed.goes_round else "strokes"
        found = [f"warning: {one}" for one in (*self.wrong_signs, *self.unlikely)]
        found += self.unsteady
        sparse = [run for run, one in zip(self.runs, self._together, strict=True) if one > 1]
        if sparse:
            found.append(
                f"In {_listed(sparse)} there are hardly any samples per turn: up to "
                f"{max(self._together)} turns are taken together, and counted as one."
            )
        for group in self.groups:
            where = f" at {_words(group)}" if len(self.groups) > 1 else ""
            if len(group.runs) > 1:
                low, high = group.next
                found.append(
                    f"Mountings{where} differ by {group.between:.2%} (standard deviation), beside "
                    f"{group.within:.2%} of {word} within runs: the coefficient of the next "
                    f"mounting is expected within {max(low, 0.0):.4g} … {high:.4g}."
                )
        if all(len(group.runs) < 2 for group in self.groups):
            found.append(
                "No load and speed was recorded twice: intervals leave out what setting down the "
                "pin anew changes."
            )
        pace_unit = "turns/s" if any(math.isnan(run.speed) for run in self.runs) else "m/s"
        for one, what, unit, other, its in (
            (self.load_dependence, "load", "N", _pace, pace_unit),
            (self.speed_dependence, "speed", "m/s", _load, "N"),
        ):
            if one is not None:
                values = [other(run) for run in self._chosen(what, other)]
                several = len(_alike([other(run) for run in self.runs])) > 1
                at = f" at {np.mean(values):.4g} {its}" if several else ""
                found.append(_of_power(one, what, unit, at))
        unknown = [run.rate for run in self.runs if math.isnan(run.speed)]
        if len(_alike(unknown)) > 1:
            found.append(
                f"Runs turn at {min(unknown):.4g} … {max(unknown):.4g} turns/s: with radius in "
                "[tribometer] these are speeds, and tell whether the coefficient depends on them."
            )
        if self.speed_dependence is not None:
            fit = self.stribeck
            found.append(
                f"No Stribeck factor is fitted: {fit}."
                if isinstance(fit, str)
                else fit.summary() + f" For predictions: law.replace(rate={fit.rate!r}), with C at "
                "rest."
            )
        drift = [
            run
            for run in self.runs
            if (run.change.low > 0.0 or run.change.high < 0.0) and not self._varying(run)
        ]
        for some in [drift] if len(drift) > _SHOWN else [[run] for run in drift]:
            changes = [run.change.value for run in some]
            found.append(
                f"In {_listed(some)} the coefficient changes by {_span(changes, '+.2%')} from the "
                f"first to the last {word[:-1]}: predictions hold for their mean, not for a "
                "surface that is new or run in."
            )
        return tuple(found)

    def summary(self) -> str:
        """Return the coefficients of runs or groups, and what they mean, in sentences."""
        level = f"{self.confidence:.0%} intervals"
        shown = self.groups
        if len(shown) > _SHOWN:
            # The table of the runs has them too.
            shown = tuple(group for group in shown if len(group.runs) > 1)
        lines = [
            f"The friction coefficient along the sliding is {group.coefficient} at "
            f"{_words(group)} ({counted(len(group.runs), 'run')}, {level})."
            for group in shown
        ]
        return "\n".join([*lines, *self.sentences()])

    def __repr__(self) -> str:
        means = ", ".join(f"{group.coefficient.value:.4g}" for group in self.groups)
        return f"<FrictionCoefficient: {means}, {counted(len(self.runs), 'run')}>"

    def rows(self) -> list[tuple[str, ...]]:
        """Return the table of the runs as texts, with its heading."""
        word = "turns" if self.processed.goes_round else "strokes"
        rows: list[tuple[str, ...]] = [
            ("run", "load N", "speed m/s", word, "coefficient", "from", "to", "change")
        ]
        if all(math.isnan(run.speed) for run in self.runs):
            rows = [("run", "load N", "turns/s", *rows[0][3:])]
        for run in self.runs:
            one = run.coefficient
            numbers = (run.load, _pace(run), run.turns, one.value, one.low, one.high)
            cells = ("–" if math.isnan(x) else f"{x:.4g}" for x in numbers)
            change = "–" if math.isnan(run.change.value) else f"{run.change.value:+.2%}"
            rows.append((run.name, *cells, change))
        return rows

    def text(self) -> str:
        """Return the table of the runs, and what they mean."""
        table = aligned(self.rows(), right=range(1, 8))
        static = [] if self.breakaway is None else [self.breakaway.summary()]
        return "\n\n".join([table, self.summary(), *static])

    def data(self) -> dict[str, Any]:
        """Return the same as numbers and texts, for ``--json``."""
        fit, static = self.stribeck, self.breakaway
        return {
            "confidence": self.confidence,
            "runs": [
                {**vars(run), "coefficient": _json(run.coefficient), "change": _json(run.change)}
                for run in self.runs
            ],
            "groups": [{**vars(one), "coefficient": _json(one.coefficient)} for one in self.groups],
            "turns": {
                name: getattr(self.over_turns, name).tolist()
                for name in ("coefficient", "load", "speed", "run")
            },
            **{
                f"{name}_exponent": None if one is None else [one.exponent, one.low, one.high]
                for name, one in (("load", self.load_dependence), ("speed", self.speed_dependence))
            },
            "stribeck": fit
            if isinstance(fit, str)
            else {name: _json(getattr(fit, name)) for name in ("static", "ratio", "speed")},
            "breakaway": None
            if static is None
            else {
                "compliance": static.compliance,
                "has_excess": static.has_excess,
                "ratio": _json(static.ratio),
                "needed_rate": static.needed_rate,
                "inertia": static.inertia,
                "unseen": static.unseen,
                "has_zeros": static.has_zeros,
                **{
                    name: [
                        {
                            "direction": one.direction,
                            **{n: _json(getattr(one, n)) for n in ("static", "kinetic", "ratio")},
                        }
                        for one in getattr(static, name)
                    ]
                    for name in ("directions", "there_and_back")
                },
            },
            "sentences": list(self.sentences()),
        }

    def _table(self) -> Table:
        turns = self.over_turns
        number = Axis(np.arange(turns.coefficient.size), "", "number of the turn or stroke")
        columns = (
            ("run", turns.run, "", "number of the run"),
            ("coefficient", turns.coefficient, NO_UNIT, "friction along the sliding over load"),
            ("load", turns.load, "N", "mean normal force"),
            ("speed", turns.speed, "m/s", "mean speed of sliding"),
        )
        series = {name: Series(v, ("turn",), unit, words) for name, v, unit, words in columns}
        return Table({"turn": number}, series, {"confidence": self.confidence})


def _json(one: Estimate) -> dict[str, float]:
    return {"value": one.value, "low": one.low, "high": one.high}


def _load(run: Run) -> float:
    return run.load


def _pace(run: Run | Group) -> float:
    """Return the speed, or the turn rate where it is not known."""
    return run.rate if math.isnan(run.speed) else run.speed


def _listed(runs: Sequence[Run]) -> str:
    """Return the name of a run, or how many there are and the first one."""
    more = len(runs) - 1
    return runs[0].name + (f" and {more} more run{'s' * (more > 1)}" if more else "")


def _span(values: Sequence[float], form: str) -> str:
    """Return a value, or the least and the largest one."""
    ends = [format(one, form) for one in (min(values), max(values))]
    return " … ".join(dict.fromkeys(ends))


def _words(group: Group) -> str:
    """Return load and speed of a group in words."""
    pace, unit = _pace(group), "turns/s" if math.isnan(group.speed) else "m/s"
    return f"{group.load:.4g} N" + (f" and {pace:.4g} {unit}" if math.isfinite(pace) else "")


def _of_power(one: Dependence, what: str, unit: str, at: str) -> str:
    """Return what a power of the load or the speed means for predictions."""
    span = f"{one.values.min():.4g} … {one.values.max():.4g} {unit}{at}"
    twice = 2.0**one.exponent - 1.0
    if not math.isfinite(one.low):
        return (
            f"Over {span} the coefficient goes with {what}^{one.exponent:.3g}, by two runs: "
            "whether that is the mounting they do not tell; record one of them again."
        )
    power = f"{what}^{one.exponent:.3g} ({one.low:.3g} … {one.high:.3g})"
    if one.is_independent:
        most = max(abs(2.0**one.low - 1.0), abs(2.0**one.high - 1.0))
        if most > _TOLD:
            return (
                f"Whether the coefficient depends on the {what} over {span} cannot be told, "
                f"{power}: at twice the {what} it may change by {most:.1%}; record more runs."
            )
        return (
            f"No dependence on the {what} is found over {span}, {power}: one law serves all, to "
            f"{most:.1%} for twice the {what}."
        )
    return (
        f"Over {span} the coefficient goes with {power}: at twice the {what} forces per unit load "
        f"change by {twice:+.1%}; identify the law at the {what} that is predicted."
    )


def _alike(values: Sequence[float]) -> list[list[int]]:
    """Return numbers of values that are within 5 %, in the order of the values; NaN is one."""
    groups: list[list[int]] = []
    for k in sorted(range(len(values)), key=lambda k: (math.isnan(values[k]), values[k])):
        first = values[groups[-1][0]] if groups else math.inf
        same = math.isnan(values[k]) if math.isnan(first) else values[k] < LEAST_RATIO * first
        if groups and same:
            groups[-1].append(k)
        else:
            groups.append([k])
    return groups


def friction_coefficient(data: ProcessedData, *, confidence: float = 0.95) -> FrictionCoefficient:
    """Return friction coefficients along the sliding, over turns, runs, loads and speeds.

    μ = mean of l_t/λ_N, friction against the sliding over the normal force, of each turn, or of
    each stroke while the pin slips. One channel is enough. Turns are independent values, of many
    their means over 20 groups, and strokes count in pairs, there and back, in which the zero of
    the sensor cancels, and scatter about the mean of their line. Runs at one load and one speed
    (turn rate, if no radius is given), both within 5 %, are mountings of one pairing: the interval
    of their mean comes from what differs between them, Student's t. Runs of strokes along different
    lines are groups of their own. Errors of calibration and zeros are included where they are
    known.

    Args:
        data: processed runs.
        confidence: of all intervals.

    Reference: [WL19] §3, Def. 10; DerSimonian & Laird 1986 for the variance between runs.

    >>> from asperity import FrictionLaw
    >>> from asperity.identify import VirtualTribometer, friction_coefficient, process
    >>> virtual = VirtualTribometer(FrictionLaw.isotropic(0.2), normal_force=10.0, turns=4, seed=1)
    >>> found = friction_coefficient(process(virtual.record()))
    >>> found.mean.covers(0.2), len(found.over_turns.coefficient)
    (True, 4)
    """
    level = level_of(confidence) or 0.95
    arrays.of_kind(data, "data", ProcessedData, "what process() returns")
    turns = turns_of(data) if data.goes_round else starts_of(data).turns
    zero, gain = shared_variance(data, turns.kept)
    known = zero + gain
    held = np.isfinite(turns.coefficient)
    names = _names(data)
    runs, values, series = [], [], []
    for number in np.unique(turns.run[held]).tolist():
        at = held & (turns.run == number)
        own = turns.coefficient[at]
        series.append((own, turns.direction[at]))
        values.append(independent(*series[-1]))
        if not values[-1].values.any():
            raise FitError(
                f"data: {names[number]}: the force is zero, or does not turn with the sliding: is "
                "the sensor connected?"
            )
        runs.append(
            Run(
                names[number],
                float(turns.load[at].mean()),
                float(turns.speed[at].mean()),
                float(turns.rate[at].mean()),
                float(turns.direction[at][0]) % math.pi,
                int(at.sum()),
                interval(values[-1].values, level, known=known, degrees=values[-1].degrees),
                _change(values[-1], level ** (1.0 / np.unique(turns.run[held]).size)),
            )
        )
    if not runs:
        raise FitError("data: the pin does not slip in any stroke")
    alike = [
        [part[k] for k in same]
        for part in _alike([run.load for run in runs])
        for same in _alike([_pace(runs[k]) for k in part])
    ]
    lines = np.nan_to_num([2.0 * run.line for run in runs])
    groups = tuple(
        _group([part[k] for k in one], runs, values, series, level, known)
        for part in alike
        for one in by_direction(lines[part])
    )
    return FrictionCoefficient(data, level, names, turns, tuple(runs), groups)


def _names(data: ProcessedData) -> tuple[str, ...]:
    """Return the names of the runs by their numbers, those without one by these."""
    numbers = runs_of(data).tolist()
    found = dict(zip(numbers, data.raw.recordings, strict=True))
    paths = [found[k].file.replace("\\", "/") for k in sorted(found)]
    files = [path.rpartition("/")[2] for path in paths]
    # Files of one name in several folders are told apart by these, windows by their numbers.
    for one in (paths, [f"{path} ({k + 1})" for k, path in enumerate(paths)]):
        files = [b if files.count(a) > 1 else a for a, b in zip(files, one, strict=True)]
    return tuple(
        name if path else f"run {k + 1}"
        for k, (name, path) in enumerate(zip(files, paths, strict=True))
    )


def _change(run: Values, level: float) -> Estimate:
    """Return the relative change from first to last value of a straight line through them.

    Each line of strokes has a level of its own.
    """
    if run.degrees < 3:
        return Estimate(math.nan, math.nan, math.nan, math.nan)
    at, mean = run.place, float(run.values.mean())
    slope = float(at @ run.values) / float(at @ at)
    left = run.values - mean - slope * at
    error = math.sqrt(float(left @ left) / (run.degrees - 1) / float(at @ at))
    half = student(level, run.degrees - 1) * error
    return Estimate(slope / mean, (slope - half) / mean, (slope + half) / mean, error / mean)


def _group(
    part: list[int],
    runs: Sequence[Run],
    values: Sequence[Values],
    series: Sequence[tuple[Array, Array]],
    level: float,
    known: float,
) -> Group:
    own = [runs[k] for k in part]
    load, speed, rate = (
        float(np.mean([getattr(one, name) for one in own])) for name in ("load", "speed", "rate")
    )
    some = [values[k] for k in part]
    means = np.array([one.values.mean() for one in some])
    scatter = _scatter([series[k] for k in part if values[k].degrees])
    mean, between, ahead = own[0].coefficient, math.nan, (math.nan, math.nan)
    if len(part) > 1:
        mean = interval(means, level, known=known)
        variance = float(means.var(ddof=1))
        own_part = scatter * float(np.mean([1.0 / one.values.size for one in some]))
        explained = 0.0 if math.isnan(own_part) else own_part
        between = math.sqrt(max(variance - explained, 0.0)) / mean.value
        half = student(level, len(part) - 1) * math.sqrt(variance * (1.0 + 1.0 / len(part)) + known)
        ahead = mean.value - half, mean.value + half
    return Group(
        load, speed, rate, tuple(part), mean, math.sqrt(scatter) / abs(mean.value), between, ahead
    )


def _scatter(series: Sequence[tuple[Array, Array]]) -> float:
    """Return the variance of turns or strokes within runs, of coefficients and directions each."""
    if not series:
        return math.nan
    count = min(own.size for own, _ in series)
    some = [independent(own[:count], direction[:count]) for own, direction in series]
    shared = len(some) > 1 and len({(one.values.size, one.degrees) for one in some}) == 1
    if not shared or not some[0].degrees:
        some = [independent(*one) for one in series]
        shared = False
    left = [one.values - one.values.mean() for one in some]
    degrees = sum(one.degrees for one in some)
    if shared:
        # The running-in that all mountings have in common is no scatter.
        left = [one - np.mean(left, axis=0) for one in left]
        degrees -= some[0].degrees
    return sum(float((one**2).sum()) for one in left) / degrees
