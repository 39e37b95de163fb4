"""What one frame shows of the mark."""

from __future__ import annotations

from dataclasses import dataclass
from enum import IntFlag

import numpy as np

from asperity._base.arrays import Array


class Sight(IntFlag):
    """Whether and how well a frame shows the mark; several may hold, none is a good frame."""

    GOOD = 0
    """The mark is whole and sharp."""
    BLURRED = 1
    """Its edges are wider than the limit; the position is that of the middle of the exposure."""
    REFLECTION = 2
    """A reflection, or something in front, breaks its colour or its outline; the rest is used."""
    CLIPPED = 4
    """It reaches the border of the image; there is no position."""
    LOST = 8
    """There is no such mark where it can be; there is no position."""
    AMBIGUOUS = 16
    """Another one like it was as possible, here or in a frame before: it may be the wrong one."""
    REPEATED = 32
    """The image is the one of the frame before, as players fill gaps: there is no position."""
    STILL = 64
    """The mark stands still between two steps of a motion: it rests, or the frame before is shown
    again, which the images, being without noise, do not tell. There is a position."""

    def __str__(self) -> str:
        return "+".join((one.name or "").lower() for one in Sight if one & self) or "good"


@dataclass(frozen=True)
class Sighting:
    """The mark in one frame; NaN where it is not known."""

    pixel: Array
    position: Array
    position_error: Array
    diameter: float
    blur: float
    filling: float
    coverage: float
    status: Sight

    @classmethod
    def none(cls, status: Sight) -> Sighting:
        """Return what is known of a mark without position."""
        nothing, nowhere = float("nan"), np.full(2, np.nan)
        return cls(nowhere, nowhere, nowhere, nothing, nothing, nothing, nothing, status)
