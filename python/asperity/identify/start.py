"""Fits to means over directions: where the fit to all samples starts."""

from __future__ import annotations

import itertools

import numpy as np

from asperity._arrays import Array
from asperity.identify.bins import Bins, support
from asperity.identify.descent import Descent, descend
from asperity.identify.loss import Loss
from asperity.identify.sums import Family

_DAMPING = 1e-3
_CLOSE = 1e-3


def starts(family: Family, bins: Bins) -> list[Array]:
    """Return coordinates of sets of the family near the means.

    Superellipses start as ellipses, upright on their axes and turned by 45°: a minimum that is
    not the lowest one looks like the set turned by 45°.
    """
    x, y = bins.force.T
    radius = np.hypot(x, y)
    log_support, slope = support(bins)
    c_starts = family.reservoir.start(x / radius, y / radius, radius, bins.squares)
    d_starts = family.direction.start(np.cos(bins.phi), np.sin(bins.phi), log_support, slope)
    return [np.concatenate(pair) for pair in itertools.product(c_starts, d_starts)]


def fit_bins(family: Family, bins: Bins, candidates: list[Array]) -> Descent:
    """Return the best of the descents from several starts, angles within ±45°."""
    best = min((_descend(family, bins, p) for p in candidates), key=lambda descent: descent.cost)
    return _descend(family, bins, folded(family, best.p))


def folded(family: Family, p: Array) -> Array:
    """Return the coordinates of the same sets with angles within ±45°."""
    c, d = p[: family.split], p[family.split :]
    return np.concatenate([family.reservoir.folded(c), family.direction.folded(d)])


def _descend(family: Family, bins: Bins, p: Array) -> Descent:
    least_squares = Loss()
    return descend(
        lambda at: family.sums(bins.samples, at, least_squares),
        p,
        family.coordinates,
        damping=_DAMPING,
        close=_CLOSE,
        degrees=max(2 * bins.phi.size - family.size, 1),
    )
