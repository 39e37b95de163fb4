"""Least squares of wrenches, their covariance from the scatter of blocks, and blocks left out."""

from __future__ import annotations

import math
from contextlib import suppress
from typing import TypeAlias

import numpy as np
from numpy.typing import NDArray

from asperity._base.arrays import Array
from asperity.errors import FitError, ParameterError
from asperity.identify.estimator.descent import Found, Sums, search
from asperity.identify.estimator.loss import Loss, LossName
from asperity.identify.evidence.wrenches.pairs import Pairs
from asperity.identify.models.patches import (
    EllipsoidPatch,
    ExtendedPatch,
    ExtendedPoints,
    PatchModel,
    PointsPatch,
)

Labels: TypeAlias = NDArray[np.intp]

# A first scale of a robust loss, relative to the size of the wrenches, and when it has settled.
_FIRST_SCALE, _SETTLED, _ROUNDS = 0.15, 0.05, 4
# Steps of the searches from several starts, of which the best is followed to its end.
_TRIAL, _SHORT, _MOST = 10, 30, 200
# Relative changes of the cost at which a search ends: on the way, and at its end, where steps that
# change less move coordinates by a small part of their errors. In valleys of points that nearly
# coincide, searches would go on for hundreds of such steps.
_ROUGH, _FINE = 1e-3, 1e-6
# Radii and phases of the rings of points from which searches start.
_RINGS = ((0.9, 0.0), (0.9, 1.0 / 3.0), (0.9, 2.0 / 3.0), (0.5, 0.5))
# Wrenches of which squares can be summed.
_LARGEST = 1e140


def descend(
    model: PatchModel,
    pairs: Pairs,
    first: Array,
    loss: LossName,
    scale: float,
    most: int,
    tolerance: float,
) -> Found:
    """Descend from given coordinates with a loss of given scale."""
    last: list[tuple[Array, Array, Array]] = []

    def both(p: Array) -> tuple[Array, Array]:
        # Residuals and derivatives are asked for one after the other at the same place.
        if not last or not np.array_equal(last[0][0], p):
            f, by = np.full_like(pairs.wrench, np.nan), np.empty((len(pairs), 3, model.size))
            # Where no set has these coordinates, or one beyond the range of numbers, residuals that
            # are no numbers make the search take a shorter step.
            refused = ParameterError, np.linalg.LinAlgError, ArithmeticError
            with suppress(*refused), np.errstate(over="raise", divide="raise", invalid="raise"):
                found, slopes = model.both(p, pairs)
                if np.abs(found).max() < _LARGEST and np.isfinite(slopes).all():
                    f, by = found, slopes
            last[:] = [(p.copy(), (f - pairs.wrench).ravel(), by.reshape(-1, model.size))]
        return last[0][1], last[0][2]

    with np.errstate(over="ignore", invalid="ignore", divide="ignore"):
        try:
            return search(
                lambda p: both(p)[0],
                lambda p: both(p)[1],
                first,
                loss=Loss(loss, scale or 1.0, components=1),
                close=tolerance,
                most=most,
            ).replace(scale=scale)
        except (ValueError, np.linalg.LinAlgError):
            raise FitError(
                "wrench: the fit has left the range of numbers: try a simpler model"
            ) from None


def fitted(
    model: PatchModel,
    pairs: Pairs,
    starts: list[Array],
    loss: LossName,
    scale: float | None = None,
    *,
    roughly: bool = False,
) -> Found:
    """Return the best fit from several starts; a robust loss finds its scale on the way.

    The search is followed to its end once, where the scale has settled; `roughly` not at all.
    """
    size = float(np.sqrt((pairs.wrench**2).mean()))
    given = scale is not None or loss == "linear"
    first = (scale or 0.0) if given else _FIRST_SCALE * size
    best, spent = Found(starts[0], math.inf, 0, False, first), 0
    for start in starts if len(starts) > 1 else ():
        try:
            trial = descend(model, pairs, start, loss, first, _TRIAL, _ROUGH)
        except FitError:
            # There is no law to begin with; another start has one.
            continue
        best = min(best, trial, key=lambda one: one.cost)
        spent += trial.evaluations
    for _ in range(0 if given else _ROUNDS):
        best = descend(model, pairs, best.p, loss, best.scale, _SHORT, _ROUGH)
        spent += best.evaluations
        residuals = model.both(best.p, pairs)[0] - pairs.wrench
        now = Loss(loss, best.scale, components=1).scaled_by(np.abs(residuals)).scale
        if now <= 1e-12 * size or abs(now - best.scale) <= _SETTLED * now:
            break
        best = best.replace(scale=now)
    most, tolerance = (_SHORT, _ROUGH) if roughly else (_MOST, _FINE)
    best = descend(model, pairs, best.p, loss, best.scale, most, tolerance)
    return best.replace(evaluations=spent + best.evaluations)


def starts_of(
    model: PatchModel, pairs: Pairs, loss: LossName, scale: float | None = None
) -> list[Array]:
    """Return coordinates to start from, the simpler models of which follow from the data."""

    def roughly(simpler: PatchModel) -> Array:
        starts = starts_of(simpler, pairs, loss, scale)
        return fitted(simpler, pairs, starts, loss, scale, roughly=True).p

    if isinstance(model, EllipsoidPatch):
        return [model.start(pairs)]
    if isinstance(model, ExtendedPoints):
        p = roughly(PointsPatch(pairs.points, radius=0.0, known=True))
        return [
            np.concatenate([p, [0.02, 0.0, 0.02, 0.0]]),
            np.concatenate([p, [0, 0.02, 0, 0.02]]),
        ]
    if isinstance(model, ExtendedPatch):
        ellipsoid = roughly(EllipsoidPatch(frame=model.frame))
        own = ellipsoid if isinstance(model.of, EllipsoidPatch) else roughly(model.of)
        return [model.start(own, ellipsoid)]
    assert isinstance(model, PointsPatch)
    if model.known:
        assert pairs.loads is not None
        sizes = np.linalg.norm(pairs.wrench[:, :2], axis=1) / pairs.loads.sum(axis=1)
        p = np.zeros(model.size)
        p[0] = math.log(max(float(np.median(sizes)), np.finfo(float).tiny))
        return [p]
    if model.friction == "ellipse":
        # Isotropic friction first: its best places are where ellipses begin.
        return [np.concatenate([roughly(model.replace(friction="isotropic")), [0.0, 0.0]])]
    # The ellipsoid of the second moments knows size, centre and radius of the patch.
    upright = EllipsoidPatch().start(pairs)
    extents = EllipsoidPatch().reservoir(upright).support(np.eye(3))
    C = _square(upright)
    centre = np.array([C[2, 1] / C[1, 1], -C[2, 0] / C[0, 0]])
    load = float(np.sqrt(extents[0] * extents[1]))
    radius = float(extents[2]) / load
    if model.radius is None:
        return [model.start(np.array([load]), centre[None], 1.5 * radius)]
    starts = []
    for ring, phase in _RINGS if model.places is None else _RINGS[:1]:
        phi = 2.0 * np.pi * (np.arange(model.count) + phase) / model.count
        around = ring * radius * np.stack([np.cos(phi), np.sin(phi)], axis=-1)
        starts.append(
            model.start(np.full(model.count, load / model.count), centre + around, radius)
        )
    return starts


def _square(p: Array) -> Array:
    A = np.zeros((3, 3))
    A[np.tril_indices(3)] = p
    A[np.diag_indices(3)] = np.exp(np.diag(A))
    return A @ A.T


def sums(
    model: PatchModel, pairs: Pairs, found: Found, loss: Loss, blocks: Labels
) -> tuple[Sums, Array]:
    """Return the normal equations of each block, and Σ g gᵀ over single components."""
    f, by = model.both(found.p, pairs)
    residuals = f - pairs.wrench
    value, weight, bend = loss.at(residuals**2)
    each = by * (weight * residuals)[:, :, None]
    count, size = int(blocks.max()) + 1, model.size
    cost: Array = np.bincount(blocks, value.sum(axis=1)).astype(np.float64)
    gradient, matrix = np.zeros((count, size)), np.zeros((count, size, size))
    np.add.at(gradient, blocks, each.sum(axis=1))
    np.add.at(matrix, blocks, np.einsum("nck,nc,ncl->nkl", by, bend, by, optimize=True))
    single = np.einsum("nck,ncl->kl", each, each, optimize=True)
    return Sums(cost, gradient, matrix), single


def left_out(model: PatchModel, pairs: Pairs, found: Found, folds: Labels, loss: LossName) -> Array:
    """Return the squared error of each wrench, predicted from the blocks without it."""
    errors = np.empty(len(pairs))
    for fold in range(int(folds.max()) + 1):
        out = folds == fold
        rest = pairs[~out]
        starts = [found.p, *starts_of(model, rest, loss, found.scale or None)]
        p = fitted(model, rest, starts, loss, found.scale or None).p
        test = pairs[out]
        errors[out] = ((model.both(p, test)[0] - test.wrench) ** 2).sum(axis=1)
    return errors
