"""Model forces with confidence bands."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike

from asperity._base.arrays import Array
from asperity._base.value import Value


class Bands(Value):
    """Model forces per unit normal force with confidence bands, pointwise.

    Args:
        phi: sliding directions in rad, ``(n,)``.
        force: −λ/λ_N, ``(n, 2)``.
        half_width: of the bands of its components.
        resistance: l_t and l_p, the parts against the sliding and across it, ``(n, 2)``.
        resistance_half_width: of their bands.
    """

    phi: Array
    force: Array
    half_width: Array
    resistance: Array
    resistance_half_width: Array

    def __init__(
        self,
        phi: ArrayLike,
        force: ArrayLike,
        half_width: ArrayLike,
        resistance: ArrayLike,
        resistance_half_width: ArrayLike,
    ) -> None:
        self._set(
            phi=np.asarray(phi),
            force=np.asarray(force),
            half_width=np.asarray(half_width),
            resistance=np.asarray(resistance),
            resistance_half_width=np.asarray(resistance_half_width),
        )
