"""Measured forces over the sliding direction: ordered, and smoothed where they are noisy."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from asperity._base import arrays
from asperity._base.arrays import Array
from asperity.errors import ParameterError

# Forces with less noise than this, relative to their size, are interpolated.
_QUIET = 5e-4
# A series that is farther from the samples than this times their noise misses the shape.
_BIAS = 1.5
_HIGHEST_ORDER = 60
_FEWEST = 8
_NEIGHBOURS = 6
_FITTED = 720
# Samples whose waves are in memory at a time.
_BLOCK = 4096


@dataclass(frozen=True)
class Samples:
    """Forces −λ/λ_N at rising sliding directions, and how they were smoothed."""

    phi: Array
    force: Array
    order: int | None
    noise: float


def prepared(phi: Array, force: Array, smoothing: str | int | None) -> Samples:
    """Order samples, join repeated directions, smooth by a trigonometric series if asked to."""
    angles, forces = _ordered(phi, force)
    if len(angles) < _FEWEST:
        raise ParameterError("phi", f"must hold {_FEWEST} different directions, has {len(angles)}")
    gap = np.diff(angles, append=angles[0] + 2.0 * math.pi)
    if gap.max() > 0.5 * math.pi:
        at = angles[gap.argmax()]
        raise ParameterError("phi", f"must leave no gap above π/2, has one after {at} rad")
    if smoothing == "auto":
        return _chosen(angles, forces)
    if smoothing is None:
        return Samples(angles, forces, None, 0.0)
    if isinstance(smoothing, str):
        raise ParameterError("smoothing", f"must be 'auto', an order or None, got {smoothing!r}")
    order = arrays.count(smoothing, "smoothing")
    if 2 * order + 1 >= len(angles):
        raise ParameterError(
            "smoothing", f"must be below half the number of directions, got {order}"
        )
    return _smooth(angles, forces, order)


def _chosen(phi: Array, force: Array) -> Samples:
    """Smooth noisy samples, unless the series misses more of them than their noise."""
    kept, expected = Samples(phi, force, None, 0.0), noise(phi, force)
    if expected <= _QUIET * float(np.hypot(*force.T).mean()):
        return kept
    smooth = _smooth(phi, force, _best_order(phi, force))
    fits = smooth.noise <= _BIAS * expected and (np.diff(smooth.phi) > 0.0).all()
    return smooth if fits else kept


def _smooth(phi: Array, force: Array, order: int) -> Samples:
    walk, shape = _walk(phi, force)
    coefficients = np.linalg.lstsq(_waves(walk, order), shape, rcond=None)[0]
    even = 2.0 * math.pi * np.arange(_FITTED) / _FITTED
    fitted = _forces(even, _waves(even, order) @ coefficients)
    # The forces of the series at the samples' own places along the walk.
    residual = force - _forces(walk, _waves(walk, order) @ coefficients)[1]
    rms = math.sqrt((residual**2).sum() / (2.0 * (len(phi) - 2 * order - 1)))
    return Samples(*fitted, order, rms)


def _walk(phi: Array, force: Array) -> tuple[Array, Array]:
    """Return (φ + θ)/2 with the deflection ψ = θ − φ and ln r, which are smooth functions of it.

    Over φ alone the force jumps where D is nearly flat, over θ it does where D has a corner.
    """
    along, across = arrays.along_and_across(force, phi)
    if along.min() <= 0.0:
        at = phi[along.argmin()]
        raise ParameterError("force", f"must oppose sliding, does not in the direction {at} rad")
    deflection = np.arctan2(across, along)
    shape = np.stack([deflection, np.log(np.hypot(*force.T))], axis=-1)
    return phi + 0.5 * deflection, shape


def _forces(walk: Array, shape: Array) -> tuple[Array, Array]:
    """Return sliding directions, rising, and forces of deflection and ln r along the walk."""
    half = 0.5 * shape[:, 0]
    return walk - half, np.exp(shape[:, 1])[:, None] * arrays.unit_vectors(walk + half)


def noise(phi: Array, force: Array) -> float:
    """Return the noise of a component, from what its neighbours do not predict.

    Each sample is compared with the polynomial through six neighbours; the median over all samples
    does not feel corners.
    """
    n = len(phi)
    if n <= _NEIGHBOURS:
        return 0.0
    half = _NEIGHBOURS // 2
    shifts = np.concatenate([np.arange(-half, 0), np.arange(1, half + 1)])
    place = np.arange(n)[:, None] + shifts
    x = phi[place % n] + 2.0 * math.pi * (place // n)
    away, apart = phi[:, None] - x, x[:, :, None] - x[:, None, :]
    apart[:, range(_NEIGHBOURS), range(_NEIGHBOURS)] = 1.0
    others = np.repeat(away[:, None, :], _NEIGHBOURS, axis=1)
    others[:, range(_NEIGHBOURS), range(_NEIGHBOURS)] = 1.0
    weights = (others / apart).prod(axis=2)
    error = force - np.einsum("nk,nkc->nc", weights, force[place % n])
    normal = error / np.sqrt(1.0 + (weights**2).sum(axis=1))[:, None]
    return float(np.median(np.abs(normal)) / 0.6745)


def _ordered(phi: Array, force: Array) -> tuple[Array, Array]:
    """Sort by direction within one turn; mean of the forces at repeated directions."""
    turn = 2.0 * math.pi
    wrapped = np.mod(phi, turn)
    # Directions that differ by rounding count as one, also across the end of the turn.
    key = np.round(wrapped / turn * 1e8).astype(np.int64) % 100_000_000
    unique, first, inverse = np.unique(key, return_index=True, return_inverse=True)
    count = np.bincount(inverse, minlength=len(unique))
    means = [np.bincount(inverse, column, len(unique)) / count for column in force.T]
    angles = np.where(unique == 0, 0.0, wrapped[first])
    return angles, np.ascontiguousarray(np.stack(means, axis=-1))


def _waves(phi: Array, order: int) -> Array:
    angles = np.multiply.outer(phi, np.arange(1, order + 1))
    return np.hstack([np.ones((len(phi), 1)), np.cos(angles), np.sin(angles)])


def _best_order(phi: Array, force: Array) -> int:
    """Return the order with the least generalised cross-validation error.

    Each coefficient counts 1.4 times, which keeps the criterion from following noise.
    """
    walk, shape = _walk(phi, force)
    n = len(phi)
    orders = np.arange(1, max(2, min(_HIGHEST_ORDER, (n - 1) // 3) + 1))
    squares = _residual_squares(walk, shape, int(orders[-1]))
    return int(orders[np.argmin(squares / (n - 1.4 * (2 * orders + 1)) ** 2)])


def _residual_squares(walk: Array, shape: Array, highest: int) -> Array:
    """Return the sums of squared residuals of the series of the orders 1 to `highest`.

    With the waves by rising order each series is the first columns of the next, and one QR
    factorisation of waves and values serves them all: an order leaves of the values what R holds
    of them below the rows of its waves. Blocks of samples are joined one after another, as many
    numbers as that.
    """
    count = 2 * highest + 1
    rising = [0, *np.arange(1, count).reshape(2, highest).T.ravel()]
    triangle = np.empty((0, count + shape.shape[1]))
    for start in range(0, len(walk), _BLOCK):
        block = slice(start, start + _BLOCK)
        rows = np.hstack([_waves(walk[block], highest)[:, rising], shape[block]])
        triangle = np.asarray(np.linalg.qr(np.vstack([triangle, rows]), mode="r"))
    rows = (triangle[:, count:] ** 2).sum(axis=1)
    left = np.append(np.cumsum(rows[::-1])[::-1], 0.0)
    return left[np.minimum(2 * np.arange(1, highest + 1) + 1, len(rows))]
