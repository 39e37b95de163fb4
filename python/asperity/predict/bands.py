"""What the uncertainty of a law means for a motion: the law is drawn again and again."""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from asperity._base import arrays
from asperity._base.arrays import Array
from asperity._base.progress import Progress, Report, part_of, reporter
from asperity.ensemble import Ensemble, integrate_many, simulate_many
from asperity.errors import AsperityError, ParameterError
from asperity.identify import IdentifiedLaw
from asperity.law import FrictionLaw
from asperity.predict.kinds import REST, Course, Quantity
from asperity.predict.scenario import RunOptions, Scenario
from asperity.status import Outcome
from asperity.system import RigidBodies

# Ellipses settle within a few rounds; this many end the search if two of them take turns.
_ROUNDS = 50
# So many numbers of samples are in memory at a time.
_NUMBERS = 2e7
# Times the time until rest with the laws of the files.
_LONGER = 1.3


@dataclass(frozen=True)
class Region:
    """An ellipse of the plane that holds the end point with the confidence of the bands.

    Attributes:
        centre: mean of the end points within the ellipse in m, shape ``(2,)``.
        covariance: of these end points in m², shape ``(2, 2)``.
        radius: Mahalanobis distance from the centre to the outline, the quantile of all draws.
    """

    centre: Array
    covariance: Array
    radius: float

    def __post_init__(self) -> None:
        arrays.array(self.centre, "centre", (2,))
        arrays.array(self.covariance, "covariance", (2, 2))
        arrays.number(self.radius, "radius")

    def contains(self, x: ArrayLike) -> bool:
        """Return whether a point in m, shape ``(2,)``, lies within."""
        away = arrays.array(x, "x", (2,)) - self.centre
        return bool(_distances(away[None], self.covariance)[0] <= self.radius)

    def outline(self, points: int = 100) -> Array:
        """Return points of the outline in m, shape ``(points, 2)``."""
        count = arrays.count(points, "points", 3)
        angle = np.linspace(0.0, 2.0 * math.pi, count)
        sizes, axes = np.linalg.eigh(self.covariance)
        circle = np.stack([np.cos(angle), np.sin(angle)])
        scaled = np.sqrt(np.maximum(sizes, 0.0))[:, None] * circle
        return self.centre + self.radius * (axes @ scaled).T


@dataclass(frozen=True)
class PredictionBands:
    """Intervals and end points over laws that were drawn.

    Attributes:
        confidence: level of the intervals.
        draws: the quantities of every draw that has a result, ``(n, k)``.
        low: lower ends of the intervals, shape ``(k,)``.
        high: upper ends.
        ends: end points of the draws in m, ``(n, 2)``; None for scenarios without an end point.
        region: of the end points; likewise.
        failed: why draws have no result, one sentence each.
        doubts: what makes results of draws doubtful, one sentence for each such draw.
    """

    confidence: float
    draws: Array
    low: Array
    high: Array
    ends: Array | None
    region: Region | None
    failed: tuple[str, ...]
    doubts: tuple[str, ...]


def propagate(
    scenario: Scenario,
    *,
    nominal: Sequence[Quantity],
    progress: Progress = None,
) -> PredictionBands:
    """Draw the laws of a scenario from their uncertainty, compute every motion, and make bands.

    Intervals are between quantiles of the draws, those of angles between quantiles of what they
    differ by from the angle with the laws of the files. The region of end points is an ellipse that
    holds the share `confidence` of them, with the shape of the end points within it: laws of few
    turns are drawn from distributions with long tails, and a single stray draw must not give the
    ellipse its shape. A law without covariance is kept as it is.

    Args:
        scenario: at least one of whose laws was identified.
        nominal: the quantities of the motion with the laws of the files.
        progress: ``True`` for a bar of tqdm, or a function of (draws done, all).

    Raises:
        ParameterError: if no law has a covariance.
        FitError: if hardly any draw is a law.
        AsperityError: if none has a result.

    Reference: [RousseeuwVanDriessen1999] §3, the concentration steps of the ellipse.
    """
    options = scenario.bands
    drawn: dict[str, Sequence[FrictionLaw]] = {}
    known = {
        name: file
        for name, file in scenario.laws.items()
        if isinstance(file, IdentifiedLaw) and file.turns is not None
    }
    if not known:
        raise ParameterError(
            "bands",
            "need a law with the covariance of its parameters, as `asperity identify` and "
            "Fit.save_law write it from two turns or more; FrictionLaw.save writes the law alone",
        )
    for i, (name, file) in enumerate(scenario.laws.items()):
        # Laws of different files were measured independently of each other.
        drawn[name] = (
            known[name].sample(options.samples, seed=options.seed + i)
            if name in known
            else [file.law] * options.samples
        )
    rows: list[Sequence[Quantity]] = []
    failed: list[str] = []
    doubts: list[str] = []
    with reporter(progress, "draw") as report:
        system = scenario.setup()[0]
        for outcome, course in _courses(scenario, drawn, nominal, report):
            if isinstance(course, str):
                failed.append(course)
                continue
            rows.append(scenario.kind.quantities(system, course))
            doubts += scenario.doubtful(outcome, course)[:1]
    if not rows:
        raise AsperityError(f"no motion of a drawn law could be computed: {failed[0]}")
    draws = np.array([[one.value for one in row] for row in rows])
    low, high = _intervals(draws, nominal, options.confidence)
    ends = draws[:, :2].copy() if scenario.kind.has_end else None
    region = None if ends is None else _region(ends, options.confidence)
    return PredictionBands(
        options.confidence, draws, low, high, ends, region, tuple(failed), tuple(doubts)
    )


def _courses(
    scenario: Scenario,
    drawn: Mapping[str, Sequence[FrictionLaw]],
    nominal: Sequence[Quantity],
    report: Report | None,
) -> Iterator[tuple[Outcome, Course | str]]:
    """Yield outcome and course of the motion with every law, or why there is none."""
    options, kind, done = scenario.options, scenario.kind, 0
    count, (first, start) = scenario.bands.samples, scenario.setup()
    kept: Any = {"samples": 0, "rest": "rest_time", "end": "end"}[kind.needs]
    chunk, t_end = count, options.duration
    if kind.needs == "samples":
        kept = options.output if options.event_driven else options.steps_per_sample
        if options.until_rest:
            # There is memory for samples until then: few motions take longer than this.
            rest = [one.value for one in nominal if one.name == REST]
            t_end = min([t_end, *(_LONGER * one for one in rest)])
        width = 2 * first.dof + 6 * len(first.contacts)
        chunk = max(1, int(_NUMBERS * options.output / (t_end * width)))
    while done < count:
        numbers = range(done, min(done + chunk, count))
        some = [{name: laws[i] for name, laws in drawn.items()} for i in numbers]
        # The core itself puts laws into systems of one contact.
        systems: Any = first
        changes: Any = {"replace": {"law": [law for laws in some for law in laws.values()]}}
        if isinstance(first, RigidBodies):
            systems, changes = [scenario.setup(laws)[0] for laws in some], {}
        with scenario.blamed():
            part = part_of(report, done, count)
            if options.event_driven:
                many = integrate_many(
                    systems, t_end=t_end, keep=kept, progress=part, **changes, **start
                )
            else:
                many = simulate_many(
                    systems,
                    dt=options.step,
                    t_end=t_end,
                    until_rest=options.until_rest,
                    keep=kept,
                    lanes=True,
                    progress=part,
                    **changes,
                    **start,
                )
        failures = {one.index[0]: str(one.error) for one in many.failures}
        for i, laws in enumerate(some):
            outcome = Outcome(many.status[i])
            if t_end < options.duration and outcome is Outcome.FINISHED:
                run = scenario.run(laws)
                yield run.status, Course.of_run(run, by_events=kind.needs != "samples")
                continue
            yield outcome, failures.get(i) or _course(many, i, start, options)
        done += len(numbers)


def _course(many: Ensemble, i: int, start: Mapping[str, Array], options: RunOptions) -> Course:
    """Return samples of a run, or its start and end."""
    if many.samples:
        t = many.samples["t"][i]
        there = ~np.isnan(t)
        return Course.of(t[there], many.samples["q"][i][there], many.samples["phase"][i][there])
    rest = np.nan if many.rest_time is None else many.rest_time[i]
    slipped = None
    if not options.event_driven and not np.isnan(rest):
        # As of the run with the laws of the files, which rests since a sample.
        steps, every = round(rest / options.step), options.steps_per_sample
        slipped, rest = steps - 1, min(-(-steps // every) * every * options.step, many.t[i])
    q = np.stack([start.get("q0", many.q[i]), many.q[i]])
    t = np.array([0.0, many.t[i]])
    return Course(t, q, many.phase[[i, i]], None if np.isnan(rest) else float(rest), slipped)


def _quantile(values: Array, share: float | list[float]) -> Array:
    """Return quantiles below which the next draw lies with this probability, along axis 0.

    The k-th of n sorted draws is taken for the quantile k/(n + 1), which is the expected share of
    the distribution below it, whatever the distribution is.
    """
    return np.quantile(values, share, axis=0, method="weibull")


def _intervals(draws: Array, nominal: Sequence[Quantity], confidence: float) -> tuple[Array, Array]:
    """Return the ends of the intervals; turn angles so that none is half a turn off the nominal."""
    for i, one in enumerate(nominal):
        if one.unit == "deg":
            draws[:, i] = one.value + (draws[:, i] - one.value + 180.0) % 360.0 - 180.0
    tail = 0.5 * (1.0 - confidence)
    low, high = _quantile(draws, [tail, 1.0 - tail])
    return low, high


def _region(ends: Array, confidence: float) -> Region:
    """Return the ellipse that holds a share of the end points, of the shape of those it holds.

    Each round takes the centre and the covariance of the end points that were nearest in the round
    before; the area of the ellipse shrinks until these stay the same.
    """
    count = math.ceil(confidence * len(ends))
    held = np.arange(len(ends))
    for _ in range(_ROUNDS):
        centre, covariance = ends[held].mean(axis=0), np.cov(ends[held].T)
        distances = _distances(ends - centre, covariance)
        nearest = np.sort(np.argsort(distances, kind="stable")[:count])
        if np.array_equal(nearest, held):
            break
        held = nearest
    return Region(centre, covariance, float(_quantile(distances, confidence)))


def _distances(away: Array, covariance: Array) -> Array:
    """Return Mahalanobis distances; infinite across a direction in which nothing varies."""
    sizes, axes = np.linalg.eigh(covariance)
    along = np.abs(away @ axes)
    # Rounding of the end points themselves counts as no variation.
    rounding = 1e-12 * max(float(sizes[-1]), 1e-300)
    with np.errstate(divide="ignore", invalid="ignore"):
        parts = np.where(
            sizes > rounding,
            along / np.sqrt(np.maximum(sizes, rounding)),
            np.where(along > 1e-6 * math.sqrt(max(float(sizes[-1]), 0.0)), np.inf, 0.0),
        )
    return np.sqrt((parts**2).sum(axis=1))
