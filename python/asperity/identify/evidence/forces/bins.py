"""Means over sliding directions: from them fits start, and what is linear in the forces follows."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from asperity._base import arrays
from asperity._base.arrays import Array
from asperity.identify.evidence.forces.samples import Samples, bin_of

FINE = 3600


@dataclass(frozen=True, eq=False)
class Bins:
    """Directions that hold samples, with ΣN², ΣN and ΣNF of these.

    With forces F/√(ΣN²), normal forces √(ΣN²) they are samples themselves, of the same sum of
    squares up to what varies within the bins.
    """

    phi: Array
    squares: Array
    normal: Array
    product: Array

    @cached_property
    def force(self) -> Array:
        """Mean force per unit normal force, ``(n, 2)``."""
        return self.product / self.squares[:, None]

    @cached_property
    def samples(self) -> Samples:
        """One sample for each bin."""
        root = np.sqrt(self.squares)
        runs = np.array([[0, self.phi.size, 0]], dtype=np.intp)
        return Samples(self.phi, self.product / root[:, None], root, runs, 1)


@dataclass(frozen=True, eq=False)
class GroupedBins:
    """Sums over fine bins, for each of several groups of turns: ``(groups, FINE)`` each.

    `energy` is the sum of squares of all forces.
    """

    squares: Array
    normal: Array
    product: Array
    offset: Array
    energy: float

    def bins(self, without: int | None = None, width: int = 1) -> Bins:
        """Return bins of all groups, or of all but one; `width` neighbours are joined."""
        chosen = np.arange(len(self.squares)) != (-1 if without is None else without)
        return self._of(chosen, width)

    def only(self, group: int, width: int = 1) -> Bins:
        """Return the bins of one group."""
        return self._of(np.arange(len(self.squares)) == group, width)

    def _of(self, chosen: Array, width: int) -> Bins:
        def joined(values: Array) -> Array:
            total: Array = values[chosen].sum(axis=0)
            cells = total.reshape(FINE // width, width, *total.shape[1:])
            return np.asarray(cells.sum(axis=1), dtype=np.float64)

        squares, normal = joined(self.squares), joined(self.normal)
        product, offset = joined(self.product), joined(self.offset)
        filled = squares > 0.0
        # Taken at the mean direction, forces err by the second order of the width.
        phi = offset[filled] / squares[filled]
        return Bins(phi, squares[filled], normal[filled], product[filled])


def grouped(samples: Samples, groups: int) -> GroupedBins:
    """Return the sums over fine bins; turns are dealt out to the groups in order."""
    size = groups * FINE
    squares, normal, x, y, offset = np.zeros((5, size))
    energy = 0.0
    for part, turn in samples.chunks():
        phi, force, load = samples.phi[part], samples.force[part], samples.normal[part]
        first = turn % groups * FINE
        at = bin_of(phi, FINE)
        weight = load * load
        energy += float(np.einsum("ij,ij->", force, force))
        place = phi - np.floor(phi * (0.5 / np.pi)) * (2.0 * np.pi)
        window = slice(first, first + FINE)
        for total, values in (
            (squares, weight),
            (normal, load),
            (x, load * force[:, 0]),
            (y, load * force[:, 1]),
            (offset, weight * place),
        ):
            total[window] += np.bincount(at, values, FINE)
    shape = (groups, FINE)
    product = np.stack([x, y], axis=-1).reshape(*shape, 2)
    squares, normal, offset = (total.reshape(shape) for total in (squares, normal, offset))
    return GroupedBins(squares, normal, product, offset, energy)


def along_sliding(bins: Bins) -> tuple[float, float] | None:
    """Return the direction in degrees where the mean force opposes sliding least, if not at all.

    With it comes the share of directions where it does not.
    """
    against, _ = arrays.along_and_across(bins.force, bins.phi)
    at = int(against.argmin())
    wrong = against <= 0.0
    return (float(np.rad2deg(bins.phi[at])), float(wrong.mean())) if wrong.any() else None


def support(bins: Bins) -> tuple[Array, Array]:
    """Return ln h_D, up to a constant, and its derivative l_p/l_t at the bins' directions.

    The forces there must oppose sliding, l_t > 0.

    Reference: [WL19] (125), in the form h_D(φ) = h_D(0) exp∫l_p/l_t dφ.
    """
    against, across = arrays.along_and_across(bins.force, bins.phi)
    slope = across / against
    width = np.diff(bins.phi, append=bins.phi[0] + 2.0 * np.pi)
    slope = slope - 0.5 * (slope + np.roll(slope, -1)) @ width / (2.0 * np.pi)
    steps = 0.5 * (slope + np.roll(slope, -1)) * width
    log_support = np.concatenate([[0.0], np.cumsum(steps[:-1])])
    return log_support - log_support.mean(), slope
