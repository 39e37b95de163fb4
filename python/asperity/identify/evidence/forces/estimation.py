"""Least-squares fits of a friction law to measured forces."""

from __future__ import annotations

import numpy as np

from asperity._base.arrays import Array
from asperity._base.log import log
from asperity._base.progress import Progress
from asperity.errors import FitError
from asperity.identify.estimator.covariance import level_of
from asperity.identify.estimator.descent import Descent, Sums, refine
from asperity.identify.estimator.loss import Loss, LossName
from asperity.identify.evidence.forces.bins import grouped
from asperity.identify.evidence.forces.flat_sides import (
    DECISIVE,
    Clear,
    clear_of_axes,
    decided_angle,
    is_singular,
    round_quarters,
    shared_axes,
)
from asperity.identify.evidence.forces.mistakes import sense_explained
from asperity.identify.evidence.forces.normal_equations import Family
from asperity.identify.evidence.forces.outliers import check_sense, without_outliers
from asperity.identify.evidence.forces.result import Fit
from asperity.identify.evidence.forces.samples import Measured, Samples, frozen, inside, samples_of
from asperity.identify.evidence.forces.selection import BEST, compare_models, matching_pairs
from asperity.identify.evidence.forces.starts import check_directions, fit_bins, start
from asperity.identify.models.names import (
    DirectionName,
    ReservoirName,
    direction_model,
    name_of,
    reservoir_model,
)

_COARSE_WIDTH = 5
# A last step so short, in standard errors, is taken without another look at the samples.
_CLOSE = 0.1
_ROUNDS, _SAME_SCALE = 10, 1e-3
_MOST_LENGTHS = 100_000
# The angle and the other coordinates of D hardly depend on each other.
_ANGLE_ROUNDS = 3


def fit_law(
    data: Measured,
    *,
    reservoir: ReservoirName = "superellipse",
    direction: DirectionName = "superellipse",
    joint: bool = True,
    loss: LossName = "linear",
    confidence: float | None = 0.95,
    progress: Progress = None,
) -> Fit:
    """Fit a law's sets C and D to measured forces: min Σ‖−λ − λ_N f(φ)‖² over all samples.

    The model meets the unfiltered samples. Confidence intervals include what differs between
    turns, or runs where there are three or more, and the uncertainty of calibration and zeros,
    which all share. Two runs that differ by more than their turns scatter are two values besides,
    and a warning says by how much. Degrees of freedom are one less than turns or runs, and those of
    the calibration.

    Args:
        data: what `process` returns, or arrays (φ in rad, −λ/λ_N ``(n, 2)``), by turns if φ is
            unwrapped, or (φ, −λ/λ_N, turn) with integers that are negative outside of turns.
        reservoir: model of C: ``"circle"``, ``"ellipse"``, ``"superellipse"``, ``"fourier"``, a
            model such as `FourierReservoir`, or ``"best"`` of those compared, by BIC.
        direction: model of D, likewise; with both ``"best"``, the best pair.
        joint: fit C and D together to the forces; else C to their magnitudes over their
            directions and D to their directions over the sliding directions.
        loss: ``"linear"``, or ``"soft_l1"``, ``"huber"`` or ``"cauchy"`` against outliers.
        confidence: level of the confidence intervals; None for a fit without them, for which one
            turn is enough.

        progress: of the comparison where a model is ``"best"``, as of `compare_models`.

    Raises:
        FitError: if directions are missing, forces do not oppose sliding, or nothing fits.

    Reference: [WL19] §5.2, Table 1, (84), (119), (125).

    >>> import numpy as np
    >>> import asperity as asp
    >>> from asperity.identify import fit_law
    >>> law = asp.FrictionLaw(asp.Superellipse(0.54, 0.46, 2.9), asp.Ellipse(1.5, 1.0))
    >>> phi = np.linspace(0.0, 6.0 * np.pi, 3000, endpoint=False)
    >>> slip = np.stack([np.cos(phi), np.sin(phi)], axis=-1)
    >>> noise = 0.005 * np.random.default_rng(1).normal(size=slip.shape)
    >>> fit = fit_law((phi, -law.force(slip) + noise), direction="ellipse")
    >>> round(fit.parameters["reservoir.exponent"].value, 1)
    2.9
    >>> fit.parameters["direction.scale"].identifiable
    False
    """
    confidence = level_of(confidence)
    measure = Loss(loss)
    comparison = None
    if BEST in (reservoir, direction):
        pairs = matching_pairs(reservoir, direction)
        comparison = compare_models(data, pairs=pairs, loss=loss, progress=progress)
        best = comparison.best
        log.info(
            "fit_law: the best of %d pairs of models is %s, %s",
            len(comparison.candidates),
            best.reservoir,
            best.direction,
        )
        reservoir, direction = best.models
    family = Family(reservoir_model(reservoir), direction_model(direction), joint=bool(joint))
    data = frozen(data)
    samples = samples_of(data)
    # Means do not survive outliers that a robust loss is chosen for.
    sums = grouped(samples if measure.is_linear else without_outliers(samples), 1)
    bins, coarse = sums.bins(), sums.bins(width=_COARSE_WIDTH)
    check_directions(family, bins)
    check_sense(coarse, samples, _COARSE_WIDTH, lambda: sense_explained(family, coarse, data))
    first = fit_bins(family, bins, start(family, coarse)).p
    clear = None
    if is_singular(family, first):
        clear = clear_of_axes(family, bins, first, sums.energy, len(samples))
    descent, measure, held = _fit_samples(family, samples, first, measure, clear)
    if not descent.converged:
        raise FitError(
            f"no minimum of {name_of(family.reservoir)} and {name_of(family.direction)} was found: "
            "try a simpler model"
        )
    return Fit(
        data,
        family,
        descent,
        measure,
        confidence,
        comparison,
        held=held,
        samples=samples,
        bins=bins,
    )


def _fit_samples(
    family: Family, samples: Samples, first: Array, loss: Loss, clear: Clear | None
) -> tuple[Descent, Loss, bool]:
    """Descend on all samples, and say whether those on axes of D hold its angle.

    A robust loss finds its scale in turns with the coordinates.
    """

    def from_here(p: Array, measure: Loss) -> tuple[Descent, bool]:
        descent, held = None, False
        if clear is not None:
            known = clear.p if p is first else p
            descent, held = _descend_about_axes(family, samples, known, measure, clear)
        if descent is None or not descent.converged:
            descent, held = _descend(family, samples, p, measure), False
        shared = _descend_on_shared_axes(family, samples, descent, measure)
        return (descent, held) if shared is None else (shared, True)

    if loss.is_linear:
        descent, held = from_here(first, loss)
        return descent, loss, held
    p, some = first, inside(samples, _MOST_LENGTHS)
    for _ in range(_ROUNDS):
        along, across, *_ = family.residuals(
            samples.phi[some], samples.force[some], samples.normal[some], p
        )
        rescaled = loss.scaled_by(np.hypot(along, across))
        settled = abs(rescaled.scale - loss.scale) <= _SAME_SCALE * rescaled.scale
        loss = rescaled
        descent, held = from_here(p, loss)
        p = descent.p
        if settled:
            break
    return descent, loss, held


def _descend(
    family: Family, samples: Samples, p: Array, loss: Loss, held: dict[int, float] | None = None
) -> Descent:
    """Descend on all samples; with some coordinates held."""
    free = np.ones(family.size)
    if held:
        p, at = p.copy(), list(held)
        p[at], free[at] = list(held.values()), 0.0

    def sums_at(at: Array) -> Sums:
        sums = family.sums(samples, at, loss)
        if not held:
            return sums
        return Sums(sums.cost, sums.gradient * free, sums.matrix * np.outer(free, free))

    return refine(
        sums_at,
        p,
        family.coordinates,
        close=_CLOSE,
        degrees=max(2 * len(samples) - family.size, 1),
    )


def _descend_about_axes(
    family: Family, samples: Samples, p: Array, loss: Loss, clear: Clear
) -> tuple[Descent, bool]:
    """Descend with the angle of D on which samples on its axes decide, if they do."""
    held = None
    for _ in range(_ANGLE_ROUNDS):
        before, held = held, decided_angle(family, samples, p, clear, loss, held)
        if held is None:
            return _descend(family, samples, p, loss), False
        if held == before:
            break
        descent = _descend(family, samples, p, loss, {family.size - 1: held})
        p = descent.p
    # The confidence intervals are those of an angle that is free.
    return descent._replace(sums=family.sums(samples, p, loss)), True


def _descend_on_shared_axes(
    family: Family, samples: Samples, descent: Descent, loss: Loss
) -> Descent | None:
    """Descend with samples on the axes of both sets, where C has cusps there; None if no better."""
    # From a tip, r_C falls with |θ − α|^s: for s < 1 the sum of squares has a cusp where a sample
    # is on a tip, and no step along derivatives leads there. Samples are on several tips at once
    # where axes of C and D and samples fall together, as with the positions of an encoder.
    axes = (family.split - 1, family.size - 1)
    angles = shared_axes(family, samples, descent.p)
    if not angles:
        return None
    # Not that of the descent, whose last step may be continued linearly, across a cusp.
    best, cost = None, float(family.sums(samples, descent.p, loss).cost.sum())
    least = DECISIVE * cost / max(2 * len(samples) - family.size, 1) if descent.converged else 0.0
    for angle in angles:
        held = {axis: angle + round_quarters(descent.p[axis] - angle) for axis in axes}
        trial = _descend(family, samples, descent.p, loss, held)
        if trial.converged and trial.cost < cost - least:
            best, cost = trial, trial.cost
    if best is None:
        return None
    # The confidence intervals are those of angles that are free.
    return best._replace(sums=family.sums(samples, best.p, loss))
