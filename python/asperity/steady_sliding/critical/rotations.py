"""The rotations of C against D for which some sliding directions are critical."""

from __future__ import annotations

import math

import numpy as np

from asperity._base.arrays import Array, unit_vectors
from asperity.errors import DimensionError, ParameterError
from asperity.sets import StarSet
from asperity.steady_sliding.critical.directions import angle_of, destabilising
from asperity.steady_sliding.critical.intervals import CriticalIntervals
from asperity.steady_sliding.critical.scan import NARROW, TURN, Interval, least, negative, refined

_ROTATIONS, _POINTS = 360, 360
# Minima over the sliding direction that are followed to the end.
_FOLLOWED = 6
# Margins that the outlines' samples give are right to this angle; nearer to 0 they are followed.
_BAND = 0.15
# Least distance of samples of an outline; around jumps they would be without number.
_NEAR, _REACH = 3e-11, 1e-9
# δ of a set that is round.
_ROUND = 1e-9
# Gaps between intervals in which single rotations are left out, or margins are mere rounding.
_GAP = 1e-4
_ANGLE = "rotation of C against D"


def critical_rotation(reservoir: StarSet, direction: StarSet) -> CriticalIntervals:
    """Return the rotations of C against D for which some sliding directions are critical.

    With δ(θ), the angle from a boundary point to the normal there, C turned by ζ has critical
    directions where |δ_C(θ − ζ) − δ_D(θ)| > π/2 for some θ at which D has no corner.

    Args:
        reservoir: planar C, which is turned counter-clockwise by ζ.
        direction: convex planar D of any scale, which is not turned.

    Returns:
        (ζ₀, ζ₁) in rad with 0 ≤ ζ₀ < ζ₁; ζ₁ is above the period if the interval holds 0. The period
        is π if both sets are symmetric, else 2π; (0, period) is returned if all rotations are
        critical. Gaps of less than 1e-4 rad are closed: at single rotations, at which corners of
        C and D are aligned, there may be no critical direction inside an interval. They are a
        sequence of pairs with `summary` and `to_pandas`.

    Raises:
        DimensionError: if a set is not planar.
        ParameterError: if D is not convex.

    Reference: [WL19] Thm. 2, (115)–(118).

    >>> import math
    >>> from asperity import Ellipse, critical_rotation
    >>> ellipse = Ellipse(3.0, 1.0)
    >>> [round(math.degrees(zeta), 4) for zeta in critical_rotation(ellipse, ellipse)[0]]
    [17.1144, 72.8856]
    """
    for name, one in (("reservoir", reservoir), ("direction", direction)):
        if not isinstance(one, StarSet):
            raise ParameterError(name, f"must be a set such as Ellipse, got {one!r}")
        if one.dimension != 2:
            raise DimensionError(name, f"must be planar, has dimension {one.dimension}")
    direction._convex("critical_rotation", "direction")
    least_margin = _LeastMargin(reservoir, direction)
    period = math.pi if reservoir.is_symmetric and direction.is_symmetric else TURN
    if least_margin.is_round:
        return CriticalIntervals([], angle=_ANGLE, period=period)
    found = negative(least_margin, 0.1 + period * np.arange(_ROTATIONS + 1) / _ROTATIONS)
    return CriticalIntervals(_without_gaps(found, period), angle=_ANGLE, period=period)


class _LeastMargin:
    """The least margin over all sliding directions as a function of the rotation of C.

    Samples of δ_C and δ_D shifted against each other tell it roughly and where to look.
    """

    def __init__(self, C: StarSet, D: StarSet) -> None:
        self.C, self.D = C, D
        phi = _thinned(
            refined(lambda x: angle_of(D.support_point(unit_vectors(x)))[:, None], _POINTS)
        )
        theta = phi + _wrapped(angle_of(D.support_point(unit_vectors(phi))) - phi)
        self.phi, self.theta = phi, np.maximum.accumulate(theta)
        turn = refined(lambda x: angle_of(C.gauge_gradient(unit_vectors(x)))[:, None], _POINTS)
        self.turn = turn = _thinned(turn)
        self.delta = _wrapped(angle_of(C.gauge_gradient(unit_vectors(turn))) - turn)
        # At corners of D the force does not turn with the direction.
        self.corner = ~D.support_hessian(unit_vectors(phi)).any(axis=(1, 2))
        # Where D is flat its points have one direction in common, which is no interval.
        self.flat = (np.diff(phi) < 10.0 * _NEAR) & (np.diff(self.theta) > 2.0 * TURN / _POINTS)

    @property
    def is_round(self) -> bool:
        """Whether δ of one set vanishes; that of the other is at most π/2."""
        return bool(
            np.abs(self.delta).max() <= _ROUND or np.abs(self.phi - self.theta).max() <= _ROUND
        )

    def __call__(self, zeta: Array) -> Array:
        lowest: Array = self.sampled(zeta)[1].min(axis=1)
        near = np.flatnonzero(np.abs(lowest) < _BAND)
        if len(near):
            lowest[near] = self.followed(zeta[near])
        return lowest

    def sampled(self, zeta: Array, *, exact: bool = False) -> tuple[Array, Array]:
        """Return directions and their margins from the samples of both outlines.

        Those of C are where D has exactly, or about, the samples of the turned C.
        """
        there = self.turn[0] + np.mod(self.theta - zeta[:, None] - self.turn[0], TURN)
        of_d = np.abs(np.interp(there, self.turn, self.delta) - (self.phi - self.theta))
        of_d[:, self.corner] = 0.0
        at = self.theta[0] + np.mod(self.turn + zeta[:, None] - self.theta[0], TURN)
        phi = np.interp(at, self.theta, self.phi)
        if exact:
            phi += _wrapped(angle_of(self.D.gauge_gradient(unit_vectors(at))) - phi)
        of_c = np.abs(self.delta - (phi - at))
        cell = np.clip(np.searchsorted(self.theta, at, side="right") - 1, 0, len(self.flat) - 1)
        of_c[self.flat[cell]] = 0.0
        phi = np.hstack([np.broadcast_to(self.phi, of_d.shape), phi])
        order = phi.argsort(axis=1)
        rough = 0.5 * math.pi - np.hstack([of_d, of_c])
        return np.take_along_axis(phi, order, axis=1), np.take_along_axis(rough, order, axis=1)

    def followed(self, zeta: Array) -> Array:
        """Return the least of the lowest minima."""
        phi, rough = self.sampled(zeta, exact=True)
        minima = np.full(rough.shape, np.inf)
        lower = (rough[:, 1:-1] <= rough[:, :-2]) & (rough[:, 1:-1] <= rough[:, 2:])
        minima[:, 1:-1][lower] = rough[:, 1:-1][lower]
        chosen = np.argpartition(minima, _FOLLOWED, axis=1)[:, :_FOLLOWED]
        chosen = np.clip(chosen, 1, phi.shape[1] - 2)
        low, middle, high = (np.take_along_axis(phi, chosen + side, axis=1) for side in (-1, 0, 1))
        low, high = np.minimum(low, middle - _REACH), np.maximum(high, middle + _REACH)
        found = least(lambda x: self.margin(x, zeta[:, None, None]), low, high)[1]
        return np.minimum(found, self.margin(middle, zeta[:, None])).min(axis=1)

    def margin(self, phi: Array, zeta: Array) -> Array:
        """Return the larger margin of two neighbours: what holds in one direction only is none."""
        sides = np.stack([phi - NARROW, phi + NARROW])
        angles = np.broadcast_to(zeta, sides.shape).ravel()
        both = destabilising(self.C, self.D, unit_vectors(sides.ravel()), angles)
        return both.reshape(sides.shape).max(axis=0)


def _without_gaps(found: list[Interval], period: float) -> list[Interval]:
    """Join intervals that are next to each other, around the end of the period too."""
    joined: list[Interval] = []
    for low, high in found:
        if joined and low - joined[-1][1] <= _GAP:
            joined[-1] = (joined[-1][0], max(high, joined[-1][1]))
        else:
            joined.append((low, high))
    if joined and joined[0][0] + period - joined[-1][1] <= _GAP:
        if len(joined) == 1:
            return [(0.0, period)]
        joined = [*joined[1:-1], (joined[-1][0], joined[0][1] + period)]
    return joined


def _thinned(x: Array) -> Array:
    """Leave out samples that are too near to the last one that stays."""
    cells = np.floor((x - x[0]) / _NEAR)
    return x[np.append(True, np.diff(cells) > 0.0)]


def _wrapped(angle: Array) -> Array:
    return np.mod(angle + math.pi, TURN) - math.pi
