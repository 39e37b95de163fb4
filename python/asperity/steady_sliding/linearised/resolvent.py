"""Which numbers may be eigenvalues within errors, by eigenvectors where those decide it."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from asperity._base.arrays import Array
from asperity.steady_sliding.linearised.pencil import Complex, Pencil

# Bounds below this, and above its inverse, decide; what is between asks for an inverse.
_CLEAR = 0.25
# An eigenvalue is isolated if its neighbours are farther than this many times n its uncertainty.
_ISOLATED = 20.0
# Largest number of complex entries of the inverses that are made at once: 64 MB.
_ENTRIES = 2**22


class Resolvent:
    """P(z)⁻¹ = Σ xᵢyᵢᴴ/(z − zᵢ), with yᵢᴴP′(zᵢ)xᵢ = 1, and what errors E of P do to it.

    With S = |Y|ᵀE|X|, ρ(|P⁻¹|E) is at most the largest of the sums of Sᵢⱼ/|z − zⱼ| over j. For z
    beside one isolated eigenvalue it is Sᵢᵢ/|z − zᵢ|. Both take n² operations per number, an
    inverse n³.
    """

    def __init__(
        self, pencil: Pencil, errors: Pencil, values: Complex, right: Complex, left: Complex
    ) -> None:
        """Take eigenvalues and vectors, one column each, and improve the eigenvalues."""
        self.pencil, self.errors = pencil, errors
        n = len(pencil.mass)
        apart = np.abs(values[:, None] - values)
        np.fill_diagonal(apart, np.inf)
        nearest = apart.min(axis=1)
        # yᴴMx, yᴴBx and yᴴKx of each eigenvalue.
        M, B, K = (np.sum(left.conj() * (part @ right), axis=0) for part in pencil)
        tiny = np.finfo(float).tiny
        for _ in range(2):
            slope = 2.0 * values * M + B
            step = ((values * M + B) * values + K) / np.where(slope == 0.0, tiny, slope)
            simple = np.abs(step) * _ISOLATED * n < nearest
            values = values - np.where(simple, step, 0.0)
        self.values = values
        slope = np.maximum(np.abs(2.0 * values * M + B), tiny)
        x, y = np.abs(right), np.abs(left) / slope
        parts = [y.T @ part @ x for part in errors]
        # The bound depends on the lengths of xᵢ and yᵢ; those that balance S are near the best.
        whole = parts[0] * np.abs(values) ** 2 + parts[1] * np.abs(values) + parts[2]
        balance = np.sqrt((whole.sum(axis=1) + tiny) / (whole.sum(axis=0) + tiny))
        self._parts = Pencil(*(part * balance / balance[:, None] for part in parts))
        self.uncertainty = self._own(np.abs(values))
        self.isolated: NDArray[np.bool_] = simple & (self.uncertainty * _ISOLATED * n < nearest)

    def may_be_singular(self, z: Complex) -> NDArray[np.bool_]:
        """Return whether each number may be an eigenvalue, as `Pencil.may_be_singular` does."""
        distance = np.maximum(np.abs(z[:, None] - self.values), np.finfo(float).tiny)
        near = distance.argmin(axis=1)
        size = np.abs(z)
        own = size**2 * np.diag(self._parts.mass)[near] + size * np.diag(self._parts.damping)[near]
        own = own + np.diag(self._parts.stiffness)[near]
        may = self.isolated[near] & (distance.min(axis=1) <= _CLEAR * own)
        left = np.flatnonzero(~may)
        with np.errstate(over="ignore", invalid="ignore"):
            bound = self._bound(size[left], 1.0 / distance[left])
        open_ones = left[~(bound < _CLEAR)]
        step = max(1, _ENTRIES // max(1, len(self.pencil.mass)) ** 2)
        for first in range(0, len(open_ones), step):
            some = open_ones[first : first + step]
            may[some] = self.pencil.may_be_singular(self.errors, z[some])
        return may

    def _bound(self, size: Array, weight: Array) -> Array:
        """Return the largest row sum for each number."""
        M, B, K = self._parts
        rows = (weight @ M.T) * size[:, None] ** 2 + (weight @ B.T) * size[:, None] + weight @ K.T
        return rows.max(axis=1, initial=0.0)

    def _own(self, size: Array) -> Array:
        M, B, K = (np.diag(part) for part in self._parts)
        return size**2 * M + size * B + K
