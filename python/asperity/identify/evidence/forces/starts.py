"""Fits to means over directions: where the fit to all samples starts."""

from __future__ import annotations

import numpy as np

from asperity._base.arrays import Array
from asperity.errors import FitError
from asperity.identify.estimator.descent import Descent, descend
from asperity.identify.estimator.loss import Loss
from asperity.identify.evidence.forces.bins import Bins, support
from asperity.identify.evidence.forces.coverage import coverage, with_opposites
from asperity.identify.evidence.forces.normal_equations import Family
from asperity.identify.models.directions import CircleDirection
from asperity.identify.models.names import name_of
from asperity.identify.models.reservoirs import CircleReservoir

_DAMPING = 1e-3
_CLOSE = 1e-3


def has_directions(family: Family, bins: Bins) -> bool:
    """Return whether there are as many sliding directions as the models have parameters."""
    return len(coverage(bins.phi, is_symmetric=family.is_symmetric).phi) >= family.size


def check_directions(family: Family, bins: Bins) -> None:
    """Refuse models that have more parameters than there are sliding directions."""
    if has_directions(family, bins):
        return
    found = coverage(bins.phi, is_symmetric=family.is_symmetric)
    opposite = ", opposite ones included," if family.is_symmetric else ""
    raise FitError(
        f"data: forces in {len(found.phi)} sliding directions{opposite} do not tell the "
        f"{family.size} parameters of {name_of(family.reservoir)!r} for C and "
        f"{name_of(family.direction)!r} for D: choose models with fewer parameters, or record "
        f"{family.size} directions or more"
    )


def start(family: Family, bins: Bins) -> Array:
    """Return coordinates near the means: those of C and D, fitted apart from several starts."""
    if family.is_symmetric and coverage(bins.phi, is_symmetric=False).gaps:
        bins = with_opposites(bins)
    x, y = bins.force.T
    radius = np.hypot(x, y)
    log_support, slope = support(bins)
    c_starts = family.reservoir.start(x / radius, y / radius, radius, bins.squares)
    d_starts = family.direction.start(np.cos(bins.phi), np.sin(bins.phi), log_support, slope)
    alone = Family(family.reservoir, CircleDirection(), joint=False)
    c = _best(alone, bins, c_starts)
    alone = Family(CircleReservoir(), family.direction, joint=False)
    d = _best(alone, bins, [np.append(np.log(radius.mean()), at) for at in d_starts])[1:]
    return np.concatenate([c, d])


def fit_bins(family: Family, bins: Bins, p: Array) -> Descent:
    """Return the descent from a start, angles within ±45°."""
    return _descend(family, bins, folded(family, _descend(family, bins, p).p))


def folded(family: Family, p: Array) -> Array:
    """Return the coordinates of the same sets with angles within ±45°."""
    c, d = p[: family.split], p[family.split :]
    return np.concatenate([family.reservoir.folded(c), family.direction.folded(d)])


def _best(family: Family, bins: Bins, starts: list[Array]) -> Array:
    if len(starts) == 1:
        return starts[0]
    return min((_descend(family, bins, p) for p in starts), key=lambda descent: descent.cost).p


def _descend(family: Family, bins: Bins, p: Array) -> Descent:
    squares = Loss()
    return descend(
        lambda at: family.sums(bins.samples, at, squares),
        p,
        family.coordinates,
        damping=_DAMPING,
        close=_CLOSE,
        degrees=max(2 * bins.phi.size - family.size, 1),
    )
