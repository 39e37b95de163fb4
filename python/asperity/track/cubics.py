"""Local cubics: velocity and acceleration of positions with errors."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from asperity._base.arrays import Array
from asperity.errors import ParameterError

_DEGREE = 3
FEWEST = _DEGREE + 2
"""Frames that a window must hold."""
# Residuals of a window this many standard deviations above the usual are no noise.
_MISFIT = 5.0


def local_cubics(t: Array, x: Array, bandwidth: float, bounds: Array) -> dict[str, Array]:
    """Fit a cubic around every frame with the frames near it that are in the same section.

    Args:
        t: ascending times in s, shape ``(n,)``.
        x: positions in m, shape ``(n, 2)``; NaN where not known.
        bandwidth: half width of the windows in s.
        bounds: first frames of the second, third, … section; no window reaches over them.

    Raises:
        ParameterError: if no window holds enough frames.
    """
    count = len(t)
    seen = np.flatnonzero(~np.isnan(x).any(axis=1))
    times, places = t[seen], x[seen]
    inside = np.searchsorted(bounds, seen, side="right")
    low = np.maximum(
        np.searchsorted(times, times - bandwidth, side="right"), np.searchsorted(inside, inside)
    )
    high = np.minimum(
        np.searchsorted(times, times + bandwidth, side="left"),
        np.searchsorted(inside, inside, side="right"),
    )
    fitted = np.flatnonzero(high - low >= FEWEST)
    if not len(fitted):
        raise ParameterError(
            "bandwidth",
            f"must be wider: no window of ± {bandwidth:.3g} s holds {FEWEST} frames, which are "
            f"{float(np.median(np.diff(times))):.3g} s apart",
        )
    slopes, gains = np.full((count, 2, 2), np.nan), np.full((count, 2), np.nan)
    variances, freedom = np.full((count, 2), np.nan), np.full(count, np.nan)
    for i in fitted:
        near = slice(low[i], high[i])
        k = seen[i]
        slopes[k], gains[k], variances[k], freedom[k] = _cubic(
            (times[near] - times[i]) / bandwidth, places[near]
        )
    scale = np.array([1.0 / bandwidth, 2.0 / bandwidth**2])
    # Not the mean: cubics do not fit where the acceleration jumps.
    scatter = np.sqrt(np.nanmedian(variances, axis=0))
    errors = (gains * scale)[:, :, None] * scatter
    limit = (1.0 + _MISFIT * np.sqrt(2.0 / freedom))[:, None] * scatter**2
    slopes = slopes * scale[:, None]
    return {
        "velocity": slopes[:, 0],
        "velocity_error": errors[:, 0],
        "acceleration": slopes[:, 1],
        "acceleration_error": errors[:, 1],
        "scatter": scatter,
        "misfit": (variances > limit).any(axis=1),
    }


def _cubic(offset: Array, places: Array) -> tuple[Array, Array, Array, float]:
    """Return first and second coefficient, their gains, variance and degrees of freedom."""
    weight = 1.0 - offset**2
    powers = offset[:, None] ** np.arange(_DEGREE + 1)
    orthogonal, triangle = np.linalg.qr(powers * weight[:, None])
    # Coefficients = smoother @ positions.
    smoother = np.linalg.solve(triangle, orthogonal.T) * weight
    coefficients = smoother @ places
    residual = places - powers @ coefficients
    # E Σ w² r² / σ² is the trace of W² (I − P S)(I − P S)ᵀ, here row by row of P.
    own = np.einsum("ij,ji->i", powers, smoother)
    others = np.einsum("ij,jk,ik->i", powers, smoother @ smoother.T, powers)
    share = float(weight**2 @ (1.0 - 2.0 * own + others))
    freedom = max(float(len(offset) - FEWEST + 1), 1.0)
    gains = np.sqrt((smoother[1:3] ** 2).sum(axis=1))
    return coefficients[1:3], gains, weight**2 @ residual**2 / share, freedom


def noise(x: Array) -> Array:
    """Return the standard deviation of positions, shape ``(2,)``, from their third differences."""
    third = np.abs(np.diff(x, n=3, axis=0))
    return np.median(third, axis=0) / (0.6745 * np.sqrt(20.0))


def resting(x: Array, limit: float) -> tuple[int, Array]:
    """Return from which frame on positions cannot be told apart, and their mean.

    Args:
        x: positions in m without gaps, shape ``(n, 2)``.
        limit: distance in m from which they can.
    """
    found = [_resting(x[: len(x) - skip], limit) for skip in range(min(3, len(x)))]
    # The last frames may be off themselves.
    lengths = [len(x) - skip - first for skip, (first, _) in enumerate(found)]
    best = next((k for k, length in enumerate(lengths) if length >= 3), 0)
    return found[best]


def _resting(x: Array, limit: float) -> tuple[int, Array]:
    place, first = x[-1], len(x) - 1
    for _ in range(2):
        away: NDArray[np.bool_] = np.hypot(*(x - place).T) > limit
        # One frame alone may be a reflection.
        moving = np.flatnonzero(away & np.concatenate([[True], away[:-1]]))
        first = int(moving[-1]) + 1 if len(moving) else 0
        near = x[first:][~away[first:]]
        if not len(near):
            break
        place = near.mean(axis=0)
    return min(first, len(x) - 1), place
