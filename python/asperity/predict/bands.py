"""What the uncertainty of a law means for a motion: the law is drawn again and again."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from asperity._base import arrays
from asperity._base.arrays import Array
from asperity.errors import AsperityError, ParameterError
from asperity.identify import IdentifiedLaw
from asperity.law import FrictionLaw
from asperity.predict.kinds import Quantity
from asperity.predict.scenario import Scenario

# Draws that end without a result may be so many, relative to all, before the bands are doubtful.
FAILED_AT_MOST = 0.05


@dataclass(frozen=True)
class Region:
    """An ellipse of the plane that holds the end point with the confidence of the bands.

    Attributes:
        centre: mean of the end points of the draws in m, shape ``(2,)``.
        covariance: of these end points in m², shape ``(2, 2)``.
        radius: Mahalanobis distance from the centre to the outline, the quantile of the draws.
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
        outline: Array = self.centre + self.radius * (axes @ scaled).T
        return outline


@dataclass(frozen=True)
class Bands:
    """Intervals and end points over laws that were drawn.

    Attributes:
        confidence: level of the intervals.
        draws: the quantities of every draw that has a result, ``(n, k)``.
        low: lower ends of the intervals, shape ``(k,)``.
        high: upper ends.
        ends: end points of the draws in m, ``(n, 2)``; None for scenarios without an end point.
        region: of the end points; likewise.
        failed: why draws have no result, one sentence each.
    """

    confidence: float
    draws: Array
    low: Array
    high: Array
    ends: Array | None
    region: Region | None
    failed: tuple[str, ...]

    @property
    def doubtful(self) -> bool:
        """Whether more than a twentieth of the draws have no result."""
        return len(self.failed) > FAILED_AT_MOST * (len(self.failed) + len(self.draws))


def propagate(scenario: Scenario, *, progress: Callable[[int, int], object] | None = None) -> Bands:
    """Draw the laws of a scenario from their uncertainty, compute every motion, and make bands.

    Intervals are between quantiles of the draws; the region of end points is the ellipse of their
    covariance about their mean that holds the share `confidence` of them. A law without covariance
    is kept as it is.

    Args:
        scenario: at least one of whose laws was identified.
        progress: called with the number of draws done and of all.

    Raises:
        ParameterError: if no law has a covariance.
        FitError: if hardly any draw is a law, or none has a result.
    """
    options = scenario.bands
    drawn: dict[str, Sequence[FrictionLaw]] = {}
    for i, (name, file) in enumerate(scenario.laws.items()):
        if isinstance(file, IdentifiedLaw) and file.turns is not None:
            # Laws of different files were measured independently of each other.
            drawn[name] = file.sample(options.samples, seed=options.seed + i)
        else:
            drawn[name] = [file.law] * options.samples
    if not any(
        isinstance(file, IdentifiedLaw) and file.turns is not None
        for file in scenario.laws.values()
    ):
        raise ParameterError(
            "bands",
            "need a law with the covariance of its parameters, as `asperity identify` writes it",
        )
    rows: list[list[Quantity]] = []
    failed: list[str] = []
    for i in range(options.samples):
        try:
            run = scenario.run({name: laws[i] for name, laws in drawn.items()})
            rows.append(scenario.quantities(run))
        except AsperityError as error:
            failed.append(str(error))
        if progress is not None:
            progress(i + 1, options.samples)
    if not rows:
        raise AsperityError(f"no motion of a drawn law could be computed: {failed[0]}")
    draws = np.array([[one.value for one in row] for row in rows])
    tail = 0.5 * (1.0 - options.confidence)
    low, high = np.quantile(draws, [tail, 1.0 - tail], axis=0)
    ends = draws[:, :2].copy() if scenario.kind.has_end else None
    region = None if ends is None else _region(ends, options.confidence)
    return Bands(options.confidence, draws, low, high, ends, region, tuple(failed))


def _region(ends: Array, confidence: float) -> Region:
    centre = ends.mean(axis=0)
    covariance = np.cov(ends.T)
    distances = _distances(ends - centre, covariance)
    return Region(centre, covariance, float(np.quantile(distances, confidence)))


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
    distances: Array = np.sqrt((parts**2).sum(axis=1))
    return distances
