"""Errors of gains and zeros that no record tells but the user states, as covariances."""

from __future__ import annotations

import numpy as np

from asperity._base.arrays import Array
from asperity.identify.records.record import RawData


def of_gains(raw: RawData, matrix: Array) -> Array | None:
    """Return the covariance of the entries of T, row by row, that `gain_error` makes.

    Gains err independently: each multiplies its row of T. A given normal force owes nothing to the
    third row. None if nothing is stated.
    """
    if raw.gain_error is None:
        return None
    result = np.zeros((9, 9))
    for row, error in enumerate(raw.gain_error.tolist()):
        if row < 2 or raw.normal_load is None:
            part = slice(3 * row, 3 * row + 3)
            result[part, part] = error**2 * np.outer(matrix[row], matrix[row])
    return result


def of_zeros(raw: RawData, matrix: Array) -> Array | None:
    """Return the covariance of the readings' zeros that `zero_error` makes; None if not stated."""
    if raw.zero_error is None:
        return None
    mixing = np.linalg.inv(matrix) * raw.zero_error
    return np.asarray(mixing @ mixing.T)


def added(known: Array | None, stated: Array | None) -> Array | None:
    """Return the covariance of two independent errors of which one may not be known."""
    if known is None or stated is None:
        return stated if known is None else known
    return known + stated
