"""The angle of a D with flat sides: the force turns infinitely fast where sliding is along an axis.

From an axis of D, |tan θ| = K |tan φ|^(1/(s−1)): for s > 2 the force's direction is continuous
there, but its derivative by the angle of D is not bounded. The sum of squares over the angle then
has a cusp wherever a sample lies on an axis, and no step along derivatives finds its minimum: the
samples nearest to the axes pull all other coordinates off their values. What they tell is the angle
alone. It follows from the inverse, |tan φ| = (|tan θ|/K)^(s−1), which is smooth: each sample says
at which angle of D it has the direction that was measured. The minimum is at one of these angles,
or next to it, unless the samples away from the axes know the angle better than those on them.

What error such an angle has is no question of derivatives either: it may be far smaller than that
of the samples away from the axes. Its confidence interval is as wide as that of the latter,
which is safe.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from asperity._base.arrays import Array
from asperity.identify.estimator.descent import damped_step
from asperity.identify.estimator.loss import Loss
from asperity.identify.evidence.forces.bins import Bins
from asperity.identify.evidence.forces.normal_equations import Family
from asperity.identify.evidence.forces.samples import Samples, chosen, inside
from asperity.identify.evidence.forces.starts import fit_bins
from asperity.identify.models.coordinates import TINY

# Means within this angle of an axis have no part in the angle that the others know. It is wide
# beside bins of 0.1°, whose means are then those of the model at their middle to 10⁻⁵.
_CLEAR = 0.02
_ROUNDS = 3
# Samples are looked at whose distance from an axis is not large beside the angle's standard error.
_NEAR = 20.0
_SMALLEST = 1e-9
# Samples on an axis decide where they are farther from the direction of the model at the angle that
# all others know than their noise explains: by so many squared standard deviations in all.
DECISIVE = 9.0
# Angles that differ by less than this in the sum of squares, in variances, are equally good.
_SAME = 0.01
_MOST_CANDIDATES = 256
# Axes of C and D are common to both, and to samples, up to this angle, to which C is known without
# the samples on its tips; so many angles of samples are tried, which differ by more than rounding.
_SHARED, _MOST_SHARED, _ROUNDING = 1e-3, 4, 1e-12


@dataclass(frozen=True, eq=False)
class Clear:
    """What the samples away from the axes of D know.

    Attributes:
        p: coordinates.
        curvature: of half the sum of squares over the angle, the last coordinate.
        spread: standard error of the angle.
        variance: of a component of a sample.
    """

    p: Array
    curvature: float
    spread: float
    variance: float


def is_singular(family: Family, p: Array) -> bool:
    """Return whether forces turn infinitely fast on the axes of D."""
    return 0.0 < family.direction.flow(p[family.split :]) < 1.0


def clear_of_axes(family: Family, bins: Bins, p: Array, energy: float, count: int) -> Clear | None:
    """Return the fit to means away from the axes of D; None if too few are left.

    Args:
        family: models.
        bins: means over fine bins.
        p: coordinates nearby.
        energy: sum of squares of the forces of all samples.
        count: number of samples.
    """
    for _ in range(_ROUNDS):
        before = p[-1]
        kept = means_away_from_axes(bins, before)
        if 2 * kept.phi.size <= family.size:
            return None
        descent = fit_bins(family, kept, p)
        p = descent.p
        if not is_singular(family, p):
            return None
        if abs(p[-1] - before) < 0.1 * _CLEAR:
            break
    matrix = descent.sums.matrix[0]
    within = max(energy - float((bins.squares[:, None] * bins.force**2).sum()), 0.0)
    variance = (descent.cost + within) / max(2 * count - family.size, 1)
    unit = np.eye(family.size)[-1]
    spread = float(np.sqrt(max(variance * damped_step(matrix, unit)[-1], 0.0)))
    return Clear(p, float(matrix[-1, -1]), spread, variance)


def means_away_from_axes(bins: Bins, angle: float) -> Bins:
    """Return the means away from the axes of a D of this angle."""
    away = _is_away(bins.phi, angle)
    return Bins(bins.phi[away], bins.squares[away], bins.normal[away], bins.product[away])


def away_from_axes(samples: Samples, angle: float) -> Samples:
    """Return the samples away from the axes of a D of this angle."""
    rows = inside(samples)
    return chosen(samples, rows, _is_away(samples.phi[rows], angle))


def decided_angle(
    family: Family, samples: Samples, p: Array, clear: Clear, loss: Loss, now: float | None = None
) -> float | None:
    """Return the angle of D that samples on its axes decide on; None where they do not decide.

    Args:
        family: models.
        samples: all of them.
        p: coordinates, of which all but the angle are near their minimum.
        clear: what the other samples know.
        loss: of the residuals.
        now: angle they decided on for other coordinates; it is kept if it is still as good.
    """
    known = float(clear.p[-1])
    near = _near(samples, known, min(max(_NEAR * clear.spread, _SMALLEST), _CLEAR))
    if not near.phi.size:
        return None
    angles = np.unique(np.append(_candidates(family, near, p, known), known))

    def cost(angle: float) -> float:
        at = p.copy()
        at[-1] = angle
        along, across, *_ = family.residuals(near.phi, near.force, near.normal, at)
        value = float(loss.at(along * along + across * across)[0].sum())
        return value + clear.curvature * (angle - known) ** 2

    costs = np.array([cost(angle) for angle in angles.tolist()])
    best = int(costs.argmin())
    if costs[np.searchsorted(angles, known)] - costs[best] <= DECISIVE * clear.variance:
        return None
    angle, least = _between(cost, angles, best, float(costs[best]))
    return now if now is not None and cost(now) - least <= _SAME * clear.variance else angle


def shared_axes(family: Family, samples: Samples, p: Array) -> list[float]:
    """Return angles of D with samples on an axis, where C has cusps on the same axes."""
    c = p[: family.split]
    apart = float(c[-1] - p[-1])
    if not (
        family.joint
        and family.reservoir.is_cusped(c)
        and family.direction.flow(p[family.split :]) > 0.0
    ):
        return []
    if abs(apart - round_quarters(apart)) > _SHARED:
        return []
    near = _near(samples, float(p[-1]), _SHARED).phi
    cos, sin = np.cos(near), np.sin(near)
    off, quarter = _off_axis(cos, sin, float(p[-1]))
    # On an axis of a D with flat sides rounding decides where a force is: the angles are those of
    # the samples themselves, of equal ones that which has been turned least.
    order = np.lexsort((np.abs(near), np.rint(np.abs(off) / _ROUNDING)))
    own = _angle_back(cos, sin, quarter)[order]
    angles: list[float] = []
    for angle in own[:_MOST_CANDIDATES].tolist():
        if len(angles) < _MOST_SHARED and all(abs(angle - a) > _ROUNDING for a in angles):
            angles.append(angle)
    return angles


def round_quarters(angle: float) -> float:
    """Return the multiple of a quarter turn that is nearest to an angle."""
    return round(angle / (0.5 * np.pi)) * 0.5 * np.pi


def _between(
    cost: Callable[[float], float], angles: Array, best: int, least: float
) -> tuple[float, float]:
    """Return the best angle between the neighbours of the best candidate, and its cost."""
    from scipy.optimize import minimize_scalar

    middle = float(angles[best])
    for other in angles[max(best - 1, 0) : best + 2].tolist():
        if other == middle:
            continue
        low, high = min(middle, other), max(middle, other)
        found = minimize_scalar(
            cost, bounds=(low, high), method="bounded", options={"xatol": 1e-3 * (high - low)}
        )
        if found.fun < least:
            middle, least = float(found.x), float(found.fun)
    return middle, least


def _candidates(family: Family, near: Samples, p: Array, known: float) -> Array:
    """Return the angles at which samples are on an axis, or have their measured directions."""
    some = slice(None, None, 1 + near.phi.size // _MOST_CANDIDATES)
    cos, sin = np.cos(near.phi[some]), np.sin(near.phi[some])
    x, y = near.force[some].T
    quarter = _off_axis(cos, sin, known)[1]
    on_axis = _angle_back(cos, sin, quarter)
    direction = _angle_back(x, y, quarter)
    flow = family.direction.flow(p[family.split :])
    # ln p₁/p₂, seen from the axis at hand.
    ratio = np.where(quarter % 2 == 0, 1.0, -1.0) * p[family.split]
    angles = on_axis
    # The angle that is looked for is small in the direction from the axis.
    for _ in range(2):
        tan = np.tan(direction - angles)
        log_size = (np.log(np.maximum(np.abs(tan), TINY)) + (1.0 + flow) * ratio) / flow
        angles = on_axis - np.copysign(np.arctan(np.exp(np.minimum(log_size, 0.0))), tan)
    return np.concatenate([on_axis, angles])


def _near(samples: Samples, angle: float, width: float) -> Samples:
    """Return the samples within an angle of the axes, as one turn."""
    parts = []
    for part, _ in samples.chunks():
        phi = samples.phi[part]
        close = np.abs(_off_axis(np.cos(phi), np.sin(phi), angle)[0]) <= width
        parts.append(part.start + np.flatnonzero(close))
    rows = np.concatenate(parts)
    runs = np.array([[0, rows.size, 0]], dtype=np.intp)
    return Samples(samples.phi[rows], samples.force[rows], samples.normal[rows], runs, 1)


def _is_away(phi: Array, angle: float) -> NDArray[np.bool_]:
    return np.abs(_off_axis(np.cos(phi), np.sin(phi), angle)[0]) > _CLEAR


def _off_axis(c: Array, s: Array, angle: float) -> tuple[Array, NDArray[np.intp]]:
    """Return the angles from the nearest axis, and its number in quarters of a turn."""
    cos, sin = np.cos(angle), np.sin(angle)
    from_first = np.arctan2(s * cos - c * sin, c * cos + s * sin)
    quarter = np.rint(from_first / (0.5 * np.pi))
    return from_first - quarter * (0.5 * np.pi), quarter.astype(np.intp) % 4


def _angle_back(x: Array, y: Array, quarter: NDArray[np.intp]) -> Array:
    """Return the angles of vectors after so many quarter turns back, without rounding in these."""
    turned = [np.stack(v) for v in ((x, y), (y, -x), (-x, -y), (-y, x))]
    u, v = np.choose(quarter, turned)
    return np.arctan2(v, u)
