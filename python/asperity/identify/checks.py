"""What a fit cannot tell: parameters at their bounds, directions without forces."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from asperity._arrays import Array
from asperity.identify.coordinates import Coordinate

_AT_BOUND = 1e-6
# Between forces farther apart than this, the shape of C is a guess of its model.
_WIDEST_GAP = np.deg2rad(30.0)


def at_bounds(p: Array, coordinates: Sequence[Coordinate]) -> Array:
    """Return which coordinates ended at a bound."""
    low, high = np.array([(c.low, c.high) for c in coordinates]).reshape(-1, 2).T
    bound: Array = (p <= low + _AT_BOUND) | (p >= high - _AT_BOUND)
    return bound


def gaps(force: Array) -> list[tuple[float, float]]:
    """Return the arcs of the force's direction, in rad, that hold none of the mean forces but one.

    A mean over a jump of the force lies anywhere.
    """
    theta = np.sort(np.arctan2(force[:, 1], force[:, 0]))
    ends = np.append(theta, theta[:2] + 2.0 * np.pi)[2:]
    return [(float(a), float(b)) for a, b in zip(theta, ends, strict=True) if b - a > _WIDEST_GAP]
