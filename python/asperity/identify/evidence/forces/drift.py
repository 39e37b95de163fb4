"""Whether forces grow or fade from turn to turn: by a gain, a zero, or the friction itself."""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from asperity._base.arrays import Array
from asperity._base.quantiles import student
from asperity.identify.evidence.forces.samples import Samples

# With fewer turns in a run, a trend is not told from scatter.
_FEWEST = 4
_LEVEL = 1e-3
# Drifts below this part of the forces over a run hardly matter beside calibrations.
_LEAST = 0.002


class Drift(NamedTuple):
    """A trend of the forces over the turns of a run.

    Attributes:
        size: change from the first turn of a run to its last, relative to the force: the mean over
            runs if they have one trend in common, else that of the run that drifts most.
        matters: whether it is neither scatter nor too small.
    """

    size: float
    matters: bool


class _Trend(NamedTuple):
    """The straight line through the factors of a run, turn by turn.

    Attributes:
        slope: per turn.
        spread: sum of the squares of the turns' numbers about their mean.
        left: sum of the squares of what is left of the factors.
        turns: number of turns.
    """

    slope: float
    spread: float
    left: float
    turns: int


def drift(samples: Samples, model: Array, run: NDArray[np.intp]) -> Drift:
    """Return the trend of the factor between measured and model forces, turn by turn.

    Runs may drift in opposite senses, as while a machine warms up and cools down: each has a trend
    of its own. One that all have in common is told from less.

    Args:
        samples: all of them.
        model: forces of the model at these, in N, ``(n, 2)``.
        run: number of the run of each turn, ``(turns,)``.
    """
    product, square = np.zeros(samples.turns), np.zeros(samples.turns)
    for part, turn in samples.chunks():
        product[turn] += np.einsum("ij,ij->", samples.force[part], model[part])
        square[turn] += np.einsum("ij,ij->", model[part], model[part])
    factor = product / square
    trends = [_trend(factor[run == one]) for one in np.unique(run)]
    long = [trend for trend in trends if trend.turns >= _FEWEST]
    if not long:
        return Drift(0.0, False)
    # Bonferroni: of all these trends, one is taken for a drift by scatter at the level.
    level = _LEVEL / (len(long) + (len(trends) > 1))
    own = max((_of_run(trend, trends, level) for trend in long), key=_weight)
    return max(_in_common(trends, level), own, key=_weight)


def _weight(drift: Drift) -> tuple[bool, float]:
    return drift.matters, abs(drift.size)


def _trend(factor: Array) -> _Trend:
    # Between runs the pin is set down anew: each has a level of its own.
    number = np.arange(factor.size) - 0.5 * (factor.size - 1)
    offset = factor - factor.mean()
    spread = float(number @ number)
    slope = float(number @ offset) / spread if spread else 0.0
    left = offset - slope * number
    return _Trend(slope, spread, float(left @ left), factor.size)


def _in_common(trends: list[_Trend], level: float) -> Drift:
    """Return the mean drift, judged by the scatter of all turns about one slope."""
    spread = sum(trend.spread for trend in trends)
    slope = sum(trend.slope * trend.spread for trend in trends) / spread
    left = sum(trend.left + (trend.slope - slope) ** 2 * trend.spread for trend in trends)
    turns = sum(trend.turns for trend in trends)
    degrees = turns - len(trends) - 1
    return _judged(slope, turns / len(trends), left / degrees / spread, degrees, level)


def _of_run(trend: _Trend, trends: list[_Trend], level: float) -> Drift:
    """Return the drift of a run, judged by the scatter of all turns about their own lines.

    A run alone has few turns to tell its scatter from; but one that scatters more than the others
    is judged by what it does itself.
    """
    degrees = sum(max(one.turns - 2, 0) for one in trends)
    variance = max(sum(one.left for one in trends) / degrees, trend.left / (trend.turns - 2))
    return _judged(trend.slope, trend.turns, variance / trend.spread, degrees, level)


def _judged(slope: float, turns: float, variance: float, degrees: int, level: float) -> Drift:
    size = slope * (turns - 1.0)
    sure = abs(slope) > student(1.0 - level, degrees) * math.sqrt(variance)
    return Drift(size, bool(sure and abs(size) > _LEAST))
