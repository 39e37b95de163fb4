"""Whether forces grow or fade from turn to turn: by a gain, a zero, or the friction itself."""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from asperity._arrays import Array
from asperity.identify.samples import Samples

# With fewer turns in a run, a trend is not told from scatter.
_FEWEST = 4
_LEVEL = 1e-3
# Drifts below this part of the forces over a run hardly matter beside calibrations.
_LEAST = 0.002


class Drift(NamedTuple):
    """A trend of the forces over the turns of a run.

    Attributes:
        size: change from the first turn of a run to its last, in parts of the force; the mean over
            runs.
        matters: whether it is neither scatter nor too small.
    """

    size: float
    matters: bool


def drift(samples: Samples, model: Array, run: NDArray[np.intp]) -> Drift:
    """Return the trend of the factor between measured and model forces, turn by turn.

    Args:
        samples: all of them.
        model: forces of the model at these, in N, ``(n, 2)``.
        run: number of the run of each turn, ``(turns,)``.
    """
    from scipy.stats import t

    product, square = np.zeros(samples.turns), np.zeros(samples.turns)
    for part, turn in samples.chunks():
        product[turn] += np.einsum("ij,ij->", samples.force[part], model[part])
        square[turn] += np.einsum("ij,ij->", model[part], model[part])
    factor = product / square
    number = np.empty(samples.turns)
    length = []
    for one in np.unique(run):
        turns = np.flatnonzero(run == one)
        # Between runs the pin is set down anew: each has a level of its own.
        number[turns] = np.arange(turns.size) - 0.5 * (turns.size - 1)
        factor[turns] -= factor[turns].mean()
        length.append(turns.size)
    degrees = samples.turns - len(length) - 1
    if max(length) < _FEWEST or degrees < 1:
        return Drift(0.0, False)
    spread = float(number @ number)
    slope = float(number @ factor) / spread
    left = factor - slope * number
    error = math.sqrt(float(left @ left) / degrees / spread)
    size = slope * (float(np.mean(length)) - 1.0)
    sure = abs(slope) > float(t.ppf(1.0 - 0.5 * _LEVEL, degrees)) * error
    return Drift(size, bool(sure and abs(size) > _LEAST))
