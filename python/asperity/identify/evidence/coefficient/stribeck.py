"""A Stribeck factor from friction coefficients at several speeds."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike

from asperity._base import arrays
from asperity._base.arrays import Array
from asperity._base.quantiles import student
from asperity._base.result import Result
from asperity.errors import FitError
from asperity.identify.estimator.covariance import level_of
from asperity.identify.models.coordinates import Estimate
from asperity.law.rate import Stribeck

# Speeds within this factor are one.
_SAME = 1.05
# Three parameters leave one value of four for their scatter.
_FEWEST = 4
# Values of v₀ that are tried, from this part of the least speed to as many times the largest one.
_TRIED, _BEYOND = 400, 10.0
# Of squares of relative differences, what is rounding.
_ROUNDING = 1e-28
_NOT_TOLD = (
    "speeds: the drop of friction lies at their end, or is too small beside the scatter, to tell "
    "v0: record more speeds where the coefficient changes"
)


@dataclass(frozen=True, repr=False)
class StribeckFit(Result):
    """The coefficient μ(v) = μ₀ (ρ + (1 − ρ) exp(−v/v₀)); made by `fit_stribeck`.

    Attributes:
        static: μ₀, the coefficient that the curve has at rest.
        ratio: ρ, of the coefficients at high speed and at rest.
        speed: v₀ in m/s.
        rms: of the relative differences from the curve.
        confidence: of the intervals.
    """

    static: Estimate
    ratio: Estimate
    speed: Estimate
    rms: float
    confidence: float

    @property
    def rate(self) -> Stribeck:
        """The factor, for ``law.replace(rate=…)`` of a law whose C is that at rest."""
        return Stribeck(self.speed.value, ratio=self.ratio.value)

    def summary(self) -> str:
        """Return the parameters with their intervals."""
        return (
            f"The coefficient falls from {self.static} at rest to the part {self.ratio} of it at "
            f"high speed, with v0 = {self.speed} m/s (intervals of {self.confidence:.0%}); the "
            f"curve misses the coefficients by {self.rms:.2%}."
        )

    def __repr__(self) -> str:
        return f"<StribeckFit: {self.rate}>"


def fit_stribeck(
    speeds: ArrayLike, *, coefficients: ArrayLike, confidence: float = 0.95
) -> StribeckFit:
    """Fit a `Stribeck` factor to friction coefficients at several speeds, by least squares.

    μ(v) = μ₀ (ρ + (1 − ρ) exp(−v/v₀)) is linear in μ₀ and μ₀ρ; v₀ is that of the least sum of
    squares of relative differences. Intervals are those of the profile likelihood: all values with
    a sum of squares within 1 + t²/(m − 3) of the least one, with Student's t.

    Args:
        speeds: v in m/s, ``(m,)``, each of a run of its own.
        coefficients: μ, ``(m,)``.
        confidence: level of the intervals.

    Raises:
        FitError: where the speeds are fewer than four, or do not tell such a curve.

    Reference: [WL19] §4.1; [Stribeck1902].

    >>> import numpy as np
    >>> from asperity import Stribeck
    >>> from asperity.identify import fit_stribeck
    >>> v = np.geomspace(0.001, 0.5, 8)
    >>> mu = 0.4 * Stribeck(0.05, ratio=0.6)(v) * (1.0 + 0.002 * np.cos(9.0 * np.arange(8)))
    >>> found = fit_stribeck(v, coefficients=mu)
    >>> round(found.speed.value, 3), found.ratio.covers(0.6)
    (0.05, True)
    """
    from scipy.special import fdtrc

    v = arrays.array(speeds, "speeds", (None,))
    y = arrays.array(coefficients, "coefficients", v.shape)
    level = level_of(confidence) or 0.95
    for name, values in (("speeds", v), ("coefficients", y)):
        if values.min(initial=1.0) <= 0.0:
            arrays.positive(float(values.min()), name)
    ordered = np.sort(v)
    apart = min(v.size, 1) + int(np.count_nonzero(np.diff(np.log(ordered)) > math.log(_SAME)))
    if v.size < _FEWEST or apart < _FEWEST:
        raise FitError(
            f"speeds: {apart} speeds that differ by 5 %, a Stribeck curve needs {_FEWEST}"
        )
    ends = ordered[0] / _BEYOND, ordered[-1] * _BEYOND
    tried = _tried(v, y, y, np.geomspace(*ends, _TRIED))
    # Differences relative to the curve, as those relative to noisy values are biased.
    best = int(tried.cost.argmin())
    drop = np.exp(-v / tried.speed[best])
    model = tried.static[best] * drop + tried.kinetic[best] * (1.0 - drop)
    if not model.min() > 0.0:
        raise FitError("speeds: no Stribeck curve with positive coefficients goes through these")
    degrees = v.size - 3
    factor = 1.0 + student(level, degrees) ** 2 / degrees
    for refined in range(3):
        tried = _tried(v, y, model, np.geomspace(*ends, _TRIED))
        least = max(float(tried.cost.min()), _ROUNDING)
        inside = np.flatnonzero(tried.cost <= factor * least)
        first, last = max(inside[0] - 1, 0), min(inside[-1] + 1, _TRIED - 1)
        if not refined and (inside[0] == 0 or inside[-1] == _TRIED - 1):
            raise FitError(_NOT_TOLD)
        ends = float(tried.speed[first]), float(tried.speed[last])
    best = int(tried.cost.argmin())
    flat = float(((y / y.mean() - 1.0) ** 2).sum())
    if fdtrc(2, degrees, max(flat - least, 0.0) / 2.0 / (least / degrees)) > 1.0 - level:
        raise FitError("speeds: the coefficients do not depend on them beyond their scatter")
    if tried.kinetic[best] >= tried.static[best]:
        raise FitError("speeds: friction rises with the speed, and a Stribeck factor falls")
    room = np.sqrt(np.maximum(factor * least - tried.cost, 0.0))
    within = tried.cost <= factor * least
    ratio = tried.kinetic / tried.static
    quantile = math.sqrt((factor - 1.0) * degrees)

    def estimate(values: Array, slope: Array, most: float = math.inf) -> Estimate:
        half = room * slope
        low = float((values - half)[within].min())
        high = min(float((values + half)[within].max()), most)
        return Estimate(float(values[best]), low, high, 0.5 * (high - low) / quantile)

    by_ratio = tried.spread_of(-ratio / tried.static, 1.0 / tried.static)
    none = np.zeros(_TRIED)
    return StribeckFit(
        estimate(tried.static, tried.spread_of(none + 1.0, none)),
        estimate(ratio, by_ratio, 1.0),
        estimate(tried.speed, none),
        math.sqrt(least / v.size),
        level,
    )


class _Tried(NamedTuple):
    """Linear fits of both ends of the curve for values of v₀, each of shape ``(k,)``.

    `inverse` holds the entries 00, 01 and 11 of the inverse of their normal equations.
    """

    speed: Array
    static: Array
    kinetic: Array
    cost: Array
    inverse: Array

    def spread_of(self, a: Array, b: Array) -> Array:
        """Return the square root of what a·static + b·kinetic has in the inverse."""
        first, mixed, second = self.inverse
        return np.asarray(np.sqrt(a * a * first + 2.0 * a * b * mixed + b * b * second))


def _tried(v: Array, y: Array, scale: Array, speed: Array) -> _Tried:
    """Return the fits; differences are relative to `scale`."""
    s = np.exp(-v / speed[:, None])
    first, second, target = s / scale, (1.0 - s) / scale, y / scale
    a, b, c = (first**2).sum(1), (first * second).sum(1), (second**2).sum(1)
    p, q = first @ target, second @ target
    determinant = np.maximum(a * c - b * b, 1e-300)
    static, kinetic = (c * p - b * q) / determinant, (a * q - b * p) / determinant
    left = first * static[:, None] + second * kinetic[:, None] - target
    inverse = np.stack([c, -b, a]) / determinant
    return _Tried(speed, static, kinetic, (left**2).sum(1), inverse)
