"""Where a fit of paths begins: launches from single paths, a law from all of them."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import Any

import numpy as np

from asperity._base.arrays import Array
from asperity.errors import FitError
from asperity.identify.evidence.paths.launch import DIRECTION, PLACE, SPEED, TIME
from asperity.identify.evidence.paths.misfits import Misfits
from asperity.identify.evidence.paths.motions import Motions
from asperity.identify.evidence.paths.observed import Observed
from asperity.identify.models.directions import DirectionModel
from asperity.identify.models.reservoirs import ReservoirModel
from asperity.law import FrictionLaw
from asperity.sets import Ellipse

# Sizes of C that are tried, per unit normal force, stand in this ratio to each other; this is how
# many of them are tried at most.
_RATIO, _MOST_SIZES = 1.4, 12
# A friction coefficient with which no body tips, to see how much a system decelerates; where that
# has no motions it is taken as one on level ground, with this gravity in m/s².
_SLIPPERY, _GRAVITY = 1e-3, 9.81
# A coefficient of no known surfaces: times, lengths or the system are in other units.
_LARGEST = 1e2
# Directions in which a model is laid through an ellipse.
_THETA = np.arange(72) * (math.pi / 36.0)
# A path begins, and is over, where it has covered this share of its length; its first direction is
# that of the points between these shares.
_BEGUN, _OVER, _EARLY = 0.02, 0.98, (0.05, 0.5)
# A body has moved if it is so many standard errors away.
_MOVED = 3.0
# Decelerations of one body on one surface do not differ by such a factor.
_UNLIKE = 100.0


def first_launches(paths: Sequence[Observed], known: Array) -> Array:
    """Return launches from parabolas through the distances from the start, path by path.

    Raises:
        FitError: if nothing moves farther than its errors.
    """
    result = known.copy()
    for path, launch in zip(paths, result, strict=True):
        if np.isnan(launch[PLACE]).any():
            launch[PLACE] = path.position[0]
        off = path.position - launch[PLACE]
        distance = np.hypot(*off.T)
        length = float(distance.max())
        if not length > _MOVED * float(path.error.max()):
            raise FitError(f"{path.name}: nothing moves farther than errors of its positions")
        early = off[(distance > _EARLY[0] * length) & (distance < _EARLY[1] * length)]
        along = early.sum(axis=0) if len(early) else off[int(distance.argmax())]
        speed, begin = _parabola(path.time, distance, float(launch[TIME]))
        guess = {SPEED: speed, DIRECTION: math.atan2(along[1], along[0]), TIME: begin}
        for quantity, value in guess.items():
            if np.isnan(launch[quantity]):
                launch[quantity] = value
    return result


def _parabola(t: Array, distance: Array, begin: float) -> tuple[float, float]:
    """Return speed and time of a launch with which a body is at these distances until it rests.

    Args:
        t: times in s.
        distance: from the place of the launch in m.
        begin: time of the launch in s, or NaN.
    """
    from scipy.optimize import least_squares

    length = float(distance.max())
    first = float(t[max(int(np.argmax(distance > _BEGUN * length)) - 1, 0)])
    over = float(t[int(np.argmax(distance >= _OVER * length))])
    duration = max(over - first, float(np.diff(t).max()))
    free = math.isnan(begin)

    def off(p: Array) -> Array:
        speed, stop = p[:2]
        tau = np.clip(t - (p[2] if free else begin), 0.0, stop)
        # Relative to the length, so that where the search ends does not depend on its unit.
        away: Array = (speed * (tau - 0.5 * tau**2 / stop) - distance) / length
        return away

    start = np.array([2.0 * length / duration, duration, first])[: 2 + free]
    scale = np.array([start[0], duration, duration])[: 2 + free]
    low = np.array([0.1 * start[0], 0.1 * duration, -np.inf])[: 2 + free]
    found = least_squares(off, start, x_scale=scale, bounds=(low, np.inf)).x
    return float(found[0]), float(found[2]) if free else begin


def best_size(misfits: Misfits, motions: Motions, launches: Array) -> float:
    """Return the logarithm of the radius of round sets with which paths are nearest.

    Sizes are tried outward from the one that stops a point on these distances. Sizes far from it
    are not tried: motions there may be long to compute, such as those of disks that tip.

    Raises:
        FitError: if the distances are those of no surface, or no size has motions.
    """
    measured = [path.position for path in misfits.paths]
    lengths = [
        float(np.hypot(*(one - launch[PLACE]).T).max())
        for one, launch in zip(measured, launches, strict=True)
    ]
    stops = launches[:, SPEED] ** 2 / (2.0 * np.array(lengths))
    for path, share in zip(misfits.paths, stops / np.median(stops), strict=True):
        if not 1.0 / _UNLIKE < share < _UNLIKE:
            raise FitError(
                f"{path.name}: the body decelerates {share:.2g} times as much as those of other "
                "paths: check the units of its times and lengths, and what is stated of its launch"
            )
    first = float(np.median(stops)) / _deceleration(motions, launches)
    if not 0.0 < first <= _LARGEST:
        raise FitError(
            f"the bodies stop as if the coefficient of friction were {first:.2g}: check the units "
            "of times and lengths, those of the system, and what is stated of the launches"
        )
    costs: dict[int, float] = {}

    def cost(step: int) -> float:
        """Return the squares at a size; those without motions are infinitely far."""
        if step in costs:
            return costs[step]
        if len(costs) >= _MOST_SIZES:
            return math.inf
        law = FrictionLaw.isotropic(first * _RATIO**step)
        count = len(launches)
        found = motions.paths([law] * count, launches, range(count))
        costs[step] = math.inf
        if found is not None:
            costs[step] = sum(
                float(np.sum((path.position - one) ** 2)) / float(np.sum(np.ptp(one, axis=0) ** 2))
                for path, one in zip(found, measured, strict=True)
            )
        return costs[step]

    outward = sorted(range(-_MOST_SIZES, _MOST_SIZES + 1), key=abs)
    best = next((step for step in outward if math.isfinite(cost(step))), None)
    if best is None:
        raise FitError(
            "no paths could be simulated: check that the system can be integrated, or give dt"
        )
    # A body goes the less far the larger C is, so that the squares have one valley.
    while True:
        beside = min((best - 1, best + 1), key=cost)
        if not cost(beside) < cost(best):
            return math.log(first) + best * math.log(_RATIO)
        best = beside


def _deceleration(motions: Motions, launches: Array) -> float:
    """Return by how much bodies decelerate per friction coefficient: g of one on level ground.

    It is told by two small coefficients, so that it does not depend on the units of the system.

    Raises:
        FitError: if friction does not decelerate them.
    """
    count, found = len(launches), []
    for part in (1.0, 2.0):
        law = FrictionLaw.isotropic(part * _SLIPPERY)
        paths = motions.paths([law] * count, launches, range(count))
        if paths is None:
            return _GRAVITY
        away = np.array([path.position[-1] for path in paths]) - launches[:, PLACE]
        last = np.array([path.velocity[-1] for path in paths])
        lost = launches[:, SPEED] ** 2 - (last**2).sum(axis=1)
        moved = np.hypot(*away.T)
        found.append(lost[moved > 0.0] / (2.0 * moved[moved > 0.0]))
    result = float(np.median(found[1] - found[0])) / _SLIPPERY if len(found[0]) else 0.0
    if not result > 0.0:
        raise FitError("the bodies of the system are not decelerated by friction: check the system")
    return result


class Ellipses:
    """Laws of two ellipses with coordinates that have a meaning for circles too.

    They are ln √(ab) of C and e cos 2α, e sin 2α of C and of D, where e is half the logarithm of
    the ratio of the semi-axes and α the angle of the first; without those of a set that is a
    circle in the model that the fit begins for, or of an angle that is given.

    Args:
        reservoir: the model of C, and of D.
        direction: likewise.
        angles: of C and D where they are held, else None.
    """

    def __init__(
        self,
        reservoir: ReservoirModel,
        direction: DirectionModel,
        angles: tuple[float | None, float | None],
    ) -> None:
        columns = [np.eye(5)[0]]
        shaped = (len(reservoir.coordinates) > 1, len(direction.coordinates) > 0)
        for at, angle, has_shape in zip((1, 3), angles, shaped, strict=True):
            if not has_shape:
                continue
            if angle is None:
                columns += [np.eye(5)[at], np.eye(5)[at + 1]]
            else:
                column = np.zeros(5)
                column[at : at + 2] = math.cos(2.0 * angle), math.sin(2.0 * angle)
                columns.append(column)
        self._columns = np.stack(columns, axis=1)
        self._models = reservoir, direction

    @property
    def size(self) -> int:
        """Number of coordinates."""
        return self._columns.shape[1]

    def _sets(self, y: Array) -> tuple[Any, Any]:
        level, *shapes = (self._columns @ y).tolist()
        sets = []
        for size, c, s in ((math.exp(level), *shapes[:2]), (1.0, *shapes[2:])):
            e, angle = math.hypot(c, s), 0.5 * math.atan2(s, c)
            sets.append(Ellipse(size * math.exp(e), size * math.exp(-e), angle=angle))
        return sets[0], sets[1]

    def law(self, y: Array) -> FrictionLaw:
        """Return the law of coordinates."""
        return FrictionLaw(*self._sets(y))

    def starts(self, y: Array) -> list[Array]:
        """Return coordinates of the models for sets that are near these ellipses."""
        c, d = self._sets(y)
        cos, sin = np.cos(_THETA), np.sin(_THETA)
        normals = np.stack([cos, sin], axis=-1)
        one = np.ones_like(_THETA)
        support = np.log(d.support(normals))
        points = d.support_point(normals)
        slope = (points[:, 1] * cos - points[:, 0] * sin) / np.exp(support)
        reservoir, direction = self._models
        first = reservoir.start(cos, sin, c.radius(_THETA), one)
        second = direction.start(cos, sin, support, slope)
        return [np.concatenate([p, second[0]]) for p in first]
