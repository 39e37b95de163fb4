"""Model forces with confidence bands."""

from __future__ import annotations

from asperity._base.arrays import Array
from asperity._base.value import Record


class Bands(Record):
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
