"""Which sliding directions hold forces, and whether these are enough for a model."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from asperity._base.arrays import Array
from asperity.identify.evidence.forces.bins import Bins

# Strokes along one direction differ by less than this.
_SAME = np.deg2rad(2.0)
# Directions without forces over more than this are spoken of.
_WIDE = np.deg2rad(15.0)
_TURN = 2.0 * np.pi


class Coverage(NamedTuple):
    """The sliding directions that hold forces; for symmetric models with the opposite ones.

    Attributes:
        phi: one for each group of directions within 2° in rad, rising from 0, ``(n,)``.
        gaps: arcs of more than 15° between them, as pairs of ends in rad.
        is_symmetric: whether opposite directions count, because they have opposite forces.
    """

    phi: Array
    gaps: tuple[tuple[float, float], ...]
    is_symmetric: bool

    @property
    def widest_gap(self) -> float:
        """Largest angle between neighbouring directions in rad."""
        return float(np.diff(self.phi, append=self.phi[0] + _TURN).max())

    def __str__(self) -> str:
        count = f"{len(self.phi)} sliding directions"
        if self.is_symmetric:
            count += " (with opposite ones)"
        return f"{count}, at most {np.rad2deg(self.widest_gap):.0f}° apart"


def coverage(phi: Array, *, is_symmetric: bool) -> Coverage:
    """Return which directions hold forces; of symmetric models the opposite ones do as well."""
    period = np.pi if is_symmetric else _TURN
    ordered = np.sort(phi % period)
    # From the widest gap on, no group is cut.
    steps = np.diff(ordered, append=ordered[0] + period)
    first = int(steps.argmax()) + 1
    ordered = np.concatenate([ordered[first:], ordered[:first] + period])
    groups, start = [], 0
    for at in range(1, ordered.size + 1):
        if at == ordered.size or ordered[at] - ordered[start] > _SAME:
            groups.append(float(ordered[start:at].mean()))
            start = at
    half = np.array(groups)
    found = np.sort((np.concatenate([half, half + np.pi]) if is_symmetric else half) % _TURN)
    ends = np.append(found[1:], found[0] + _TURN)
    wide = ends - found > _WIDE
    return Coverage(found, tuple(zip(found[wide], ends[wide], strict=True)), is_symmetric)


def with_opposites(bins: Bins) -> Bins:
    """Return the means with those that a symmetric law has in the opposite directions."""
    phi = np.concatenate([bins.phi, bins.phi + np.pi]) % _TURN
    order = np.argsort(phi)
    return Bins(
        phi[order],
        np.tile(bins.squares, 2)[order],
        np.tile(bins.normal, 2)[order],
        np.concatenate([bins.product, -bins.product])[order],
    )
