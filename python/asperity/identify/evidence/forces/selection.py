"""Comparison of models: Bayesian information criterion and leave-one-turn-out cross-validation."""

from __future__ import annotations

from collections.abc import Iterable

import numpy as np

from asperity._base.arrays import Array
from asperity._base.log import log
from asperity._base.progress import Count, Progress, Report, reporter
from asperity.errors import FitError
from asperity.identify.estimator.comparison import Comparison, compared, inflation
from asperity.identify.estimator.descent import Sums
from asperity.identify.estimator.leverage import leverage_of
from asperity.identify.estimator.loss import Loss, LossName
from asperity.identify.evidence.forces.bins import GroupedBins, grouped
from asperity.identify.evidence.forces.defects import MOST_GROUPS, asymmetry, means_of
from asperity.identify.evidence.forces.errors import Distortion
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
from asperity.identify.models.names import (
    DIRECTIONS,
    RESERVOIRS,
    DirectionName,
    ReservoirName,
    direction_model,
    name_of,
    reservoir_model,
)

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


def compare_models(
    data: Measured,
    *,
    pairs: Iterable[tuple[ReservoirName, DirectionName]] | None = None,
    loss: LossName = "linear",
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
    loss: LossName,
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
    groups = _sums_of_groups(families[at], sums, fits[at].p)
    kappa = inflation(
        leverage_of(groups.total()[2], groups.matrix).inverse,
        groups.gradient,
        families[at].size * squares[at] / components,
    )
    # What an error of the calibration may be is not for a model to follow.
    distortion = Distortion(given, data, loss=loss)
    variance = kappa * squares[at] / components
    explained = [
        distortion.explained(family, fit.p, variance)
        for family, fit in zip(families, fits, strict=True)
    ]
    errors = []
    for number, (family, fit) in enumerate(zip(families, fits, strict=True)):
        count.add(len(families) + number)
        errors.append(_left_out(family, sums, fit.p))
    count.finish()
    return compared(
        [
            (
                f"{name_of(family.reservoir)}, {name_of(family.direction)}",
                (family.reservoir, family.direction),
            )
            for family in families
        ],
        [family.size for family in families],
        rms=np.sqrt(squares / components).tolist(),
        costs=squares - explained,
        errors=np.stack(errors) / sums.energy,
        components=components,
        inflation=kappa,
    )


def _sums_of_groups(family: Family, sums: GroupedBins, p: Array) -> Sums:
    """Return the normal equations of each group of turns."""
    parts = [
        family.sums(sums.only(group, _WIDTH).samples, p, Loss())
        for group in range(len(sums.squares))
    ]
    series = zip(*((one.cost, one.gradient, one.matrix) for one in parts), strict=True)
    return Sums(*map(np.concatenate, series))


def _left_out(family: Family, sums: GroupedBins, p: Array) -> Array:
    """Return the sum of squared errors of each group of turns, predicted from the others."""
    errors = []
    for group in range(len(sums.squares)):
        rest = fit_bins(family, sums.bins(group, _WIDTH), p)
        errors.append(family.sums(sums.only(group, _WIDTH).samples, rest.p, Loss()).cost[0])
    return np.array(errors)
