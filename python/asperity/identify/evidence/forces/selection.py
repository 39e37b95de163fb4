"""Comparison of models: Bayesian information criterion and leave-one-turn-out cross-validation."""

from __future__ import annotations

import math
from collections.abc import Iterable

import numpy as np

from asperity._base import arrays
from asperity._base.arrays import Array
from asperity._base.log import log
from asperity._base.progress import Count, Progress, Report, reporter
from asperity._base.value import Value
from asperity.errors import FitError
from asperity.identify.estimator.descent import damped_step
from asperity.identify.estimator.loss import Loss
from asperity.identify.evidence.forces.bins import GroupedBins, grouped
from asperity.identify.evidence.forces.defects import MOST_GROUPS, asymmetry, means_of
from asperity.identify.evidence.forces.distortion import Distortion
from asperity.identify.evidence.forces.mistakes import sense_explained
from asperity.identify.evidence.forces.normal_equations import Family
from asperity.identify.evidence.forces.outliers import check_sense, without_outliers
from asperity.identify.evidence.forces.samples import Measured, samples_of
from asperity.identify.evidence.forces.starts import (
    check_directions,
    fit_bins,
    has_directions,
    start,
)
from asperity.identify.models.directions import DirectionModel
from asperity.identify.models.names import (
    DIRECTIONS,
    RESERVOIRS,
    DirectionName,
    ReservoirName,
    direction_model,
    name_of,
    reservoir_model,
    short,
)
from asperity.identify.models.reservoirs import ReservoirModel

PAIRS: tuple[tuple[ReservoirName, DirectionName], ...] = (
    ("circle", "circle"),
    ("ellipse", "circle"),
    ("ellipse", "ellipse"),
    ("superellipse", "circle"),
    ("superellipse", "ellipse"),
    ("superellipse", "superellipse"),
    ("fourier", "superellipse"),
    ("fourier", "fourier"),
)
"""Models that are compared if none are named; circles, ellipses and superellipses are nested."""

ODD_PAIRS: tuple[tuple[ReservoirName, DirectionName], ...] = (
    ("odd fourier", "superellipse"),
    ("odd fourier", "odd fourier"),
)
"""Compared as well where the forces are not symmetric to the origin."""

BEST = "best"

# Fits are compared on means over half a degree; more groups of turns than this tell no more.
_WIDTH = 5


def matching_pairs(
    reservoir: ReservoirName, direction: DirectionName
) -> list[tuple[ReservoirName, DirectionName]] | None:
    """Return the pairs to choose from where one model or both are to be the best; None for all."""
    if reservoir == direction == BEST:
        return None
    if reservoir == BEST:
        return [(name, direction) for name in RESERVOIRS]
    return [(reservoir, name) for name in DIRECTIONS]


class Candidate(Value):
    """One pair of models in a comparison.

    Args:
        reservoir: name of the model of C; `reservoir_model` is the model.
        direction: name of the model of D; `direction_model` is the model.
        parameters: how many are fitted.
        rms: root mean square of a component of the residuals in N.
        bic: Bayesian information criterion relative to the smallest one.
        left_out: by how much the mean square error of −λ/λ_N, where turns that were left out are
            predicted, exceeds that of the best prediction.
        left_out_error: standard error of that difference, over turns.
    """

    parameters: int
    rms: float
    bic: float
    left_out: float
    left_out_error: float
    reservoir_model: ReservoirModel
    direction_model: DirectionModel

    def __init__(
        self,
        reservoir: ReservoirName,
        direction: DirectionName,
        *,
        parameters: int,
        rms: float,
        bic: float,
        left_out: float,
        left_out_error: float,
    ) -> None:
        models = reservoir_model(reservoir), direction_model(direction)
        self._keep(reservoir_model=models[0], direction_model=models[1])
        self._set(
            reservoir=short(models[0]),
            direction=short(models[1]),
            parameters=arrays.count(parameters, "parameters"),
            rms=arrays.non_negative(rms, "rms"),
            bic=float(bic),
            left_out=float(left_out),
            left_out_error=float(left_out_error),
        )

    @property
    def reservoir(self) -> str:
        """Name of the model of C."""
        return name_of(self.reservoir_model)

    @property
    def direction(self) -> str:
        """Name of the model of D."""
        return name_of(self.direction_model)


class Comparison(Value):
    """Pairs of models that were fitted to the same data.

    Args:
        candidates: in the order in which they were named.
        effective_samples: number of independent components of forces among the samples.
    """

    candidates: tuple[Candidate, ...]
    effective_samples: float

    def __init__(self, candidates: Iterable[Candidate], *, effective_samples: float) -> None:
        self._set(
            candidates=tuple(candidates),
            effective_samples=arrays.positive(effective_samples, "effective_samples"),
        )

    @property
    def best(self) -> Candidate:
        """The candidate of the smallest BIC."""
        return min(self.candidates, key=lambda candidate: candidate.bic)

    @property
    def best_predicting(self) -> Candidate:
        """The smallest candidate that predicts left-out turns as well as the best one.

        As well means within one standard error.
        """
        good = [c for c in self.candidates if c.left_out <= c.left_out_error]
        return min(good, key=lambda candidate: candidate.parameters)


def compare_models(
    data: Measured,
    *,
    pairs: Iterable[tuple[ReservoirName, DirectionName]] | None = None,
    loss: str = "linear",
    progress: Progress = None,
) -> Comparison:
    """Fit several pairs of models of C and D to the same data.

    Noise is correlated: n samples are worth n/κ independent ones, where κ is the ratio of the
    variances of the coordinates by the scatter of turns and by JᵀJ, on the average over the
    coordinates of the pair that fits best. Then BIC = (n/κ) ln(RSS/n) + k ln(n/κ), where the sum of
    squares RSS leaves out what errors of calibration and zeros within their covariance explain.
    Left-out turns have these errors in common with the others: there, models may follow them.

    Args:
        data: as for `fit_law`, with at least two turns.
        pairs: models of C and D; by default `PAIRS`, and `ODD_PAIRS` where even harmonics of the
            forces are significant.
        loss: of the fits that are compared; with a robust one, gross outliers are left out.

        progress: ``True`` for a bar of tqdm, or a function of (fits done, all fits): every pair is
            fitted to all turns, and then without those that are left out.

    Raises:
        FitError: with less than two turns.

    >>> import numpy as np
    >>> import asperity as asp
    >>> from asperity.identify import compare_models
    >>> law = asp.FrictionLaw.collinear(asp.Ellipse(0.5, 0.4))
    >>> phi = np.linspace(0.0, 12.0 * np.pi, 3000, endpoint=False)
    >>> slip = np.stack([np.cos(phi), np.sin(phi)], axis=-1)
    >>> noise = 0.005 * np.random.default_rng(0).normal(size=slip.shape)
    >>> best = compare_models((phi, -law.force(slip) + noise)).best
    >>> best.reservoir, best.direction
    ('ellipse', 'circle')
    """
    with reporter(progress, "fit") as report:
        found = _compared(data, pairs, loss, report)
    for one in found.candidates:
        log.debug(
            "compare_models: %s, %s: BIC %.6g above the best",
            one.reservoir,
            one.direction,
            one.bic,
        )
    return found


def _compared(
    data: Measured,
    pairs: Iterable[tuple[ReservoirName, DirectionName]] | None,
    loss: str,
    report: Report | None,
) -> Comparison:
    given = samples_of(data)
    samples = given if Loss(loss).is_linear else without_outliers(given)
    if samples.turns < 2:
        raise FitError(
            "data: one turn cannot be left out: models are compared over 2 turns or more"
        )
    sums = grouped(samples, min(samples.turns, MOST_GROUPS))
    named = pairs is not None
    if pairs is None:
        means = means_of(sums)
        odd = means is not None and asymmetry(*means).matters
        pairs = (*PAIRS, *ODD_PAIRS) if odd else PAIRS
    families = [Family(reservoir_model(c), direction_model(d), joint=True) for c, d in pairs]
    if not families:
        raise FitError("pairs: no models to compare")
    # What varies within a bin is the same for all models.
    bins = sums.bins(width=_WIDTH)
    for family in families if named else families[:1]:
        check_directions(family, bins)
    families = [family for family in families if has_directions(family, bins)]
    check_sense(bins, samples, _WIDTH, lambda: sense_explained(families[-1], bins, data))
    within = max(sums.energy - float((bins.squares[:, None] * bins.force**2).sum()), 0.0)
    count = Count(2 * len(families), report)
    fits = []
    for number, family in enumerate(families):
        count.add(number)
        fits.append(fit_bins(family, bins, start(family, bins)))
    squares = np.array([fit.cost for fit in fits]) + within
    components = 2.0 * len(samples)
    at = int(squares.argmin())
    kappa = _inflation(families[at], sums, fits[at].p, squares[at] / components)
    effective = components / kappa
    # What an error of the calibration may be is not for a model to follow.
    distortion = Distortion(given, data, loss=loss)
    variance = kappa * squares[at] / components
    explained = [
        distortion.explained(family, fit.p, variance)
        for family, fit in zip(families, fits, strict=True)
    ]
    clean = np.maximum(squares - explained, np.finfo(float).tiny)
    sizes = np.array([family.size for family in families])
    bic = effective * np.log(clean / components) + sizes * math.log(effective)
    left_out = []
    for number, (family, fit) in enumerate(zip(families, fits, strict=True)):
        count.add(len(families) + number)
        left_out.append(_left_out(family, sums, fit.p))
    count.finish()
    errors = np.stack(left_out)
    worse = errors - errors[errors.mean(axis=1).argmin()]
    spread = worse.std(axis=1, ddof=1) / math.sqrt(worse.shape[1])
    return Comparison(
        [
            Candidate(
                family.reservoir,
                family.direction,
                parameters=family.size,
                rms=math.sqrt(squares[row] / components),
                bic=bic[row] - bic.min(),
                left_out=worse[row].mean(),
                left_out_error=spread[row],
            )
            for row, family in enumerate(families)
        ],
        effective_samples=effective,
    )


def _inflation(family: Family, sums: GroupedBins, p: Array, variance: float) -> float:
    """Return κ, at least 1: how much more coordinates scatter than with uncorrelated noise."""
    if variance <= 0.0:
        return 1.0
    groups = len(sums.squares)
    parts = [
        family.sums(sums.only(group, _WIDTH).samples, p, Loss()).total() for group in range(groups)
    ]
    matrix = np.sum([part[2] for part in parts], axis=0)
    gradient = np.stack([part[1] for part in parts])
    gradient = gradient - gradient.mean(axis=0)
    scatter = sum(float(g @ damped_step(matrix, g)) for g in gradient) * groups / (groups - 1.0)
    return max(scatter / (family.size * variance), 1.0)


def _left_out(family: Family, sums: GroupedBins, p: Array) -> Array:
    """Return the mean square error of each group of turns, predicted from the others."""
    errors = []
    for group in range(len(sums.squares)):
        rest = fit_bins(family, sums.bins(group, _WIDTH), p)
        bins = sums.only(group, _WIDTH)
        cost = family.sums(bins.samples, rest.p, Loss()).cost[0]
        errors.append(cost / max(float(bins.squares.sum()), 1e-300))
    return np.array(errors)
