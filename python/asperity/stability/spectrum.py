"""Eigenvalues of small motions, and what rounding leaves of their signs."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from asperity._arrays import Array

Complex = NDArray[np.complex128]


@dataclass(frozen=True)
class Spectrum:
    """Eigenvalues of M q̈ + B q̇ + K q = 0 with bounds of their errors, [WL19] (113)."""

    values: Complex
    """In 1/s, by falling real part."""
    modes: Complex
    """Displacements, one column each, of length 1."""
    bounds: Array
    """Errors of the eigenvalues that have to be reckoned with."""
    defective: bool
    """Whether an eigenvalue with real part 0 has fewer modes than its multiplicity."""

    @property
    def growth_rate(self) -> float:
        """Largest real part; 0 where it is within the error of the eigenvalue."""
        if not self.values.size:
            return 0.0
        # An uncertain eigenvalue right of certain ones must not hide them.
        certain = self.values.real[np.abs(self.values.real) > self.bounds]
        uncertain = certain.size < self.values.size
        return float(max([*certain, *([0.0] if uncertain else [])]))


def spectrum(mass: Array, damping: Array, stiffness: Array, relative_error: float) -> Spectrum:
    """Return the spectrum of n equations with matrices known to `relative_error`.

    The first-order matrix is that of M^½ q and of time in units of the fastest motion, so that its
    entries have one unit and the error of an eigenvalue is its condition number times
    `relative_error` ‖A‖, at a multiple eigenvalue without all its modes √`relative_error` ‖A‖.
    """
    import scipy.linalg

    n = len(mass)
    if not n:
        none = np.zeros(0, dtype=np.complex128)
        return Spectrum(none, none.reshape(0, 0), np.zeros(0), False)
    root = np.linalg.cholesky(mass)
    K, B = (np.linalg.solve(root, np.linalg.solve(root, part).T).T for part in (stiffness, damping))
    rate = max(np.sqrt(np.linalg.norm(K, 2)), np.linalg.norm(B, 2)) or 1.0
    A = np.block([[np.zeros((n, n)), np.eye(n)], [-K / rate**2, -B / rate]])
    values, left, right = scipy.linalg.eig(A, left=True, right=True)
    size = float(np.linalg.norm(A, 2))
    overlap = np.abs((left.conj() * right).sum(axis=0))
    worst = np.sqrt(relative_error)
    bounds = size * np.minimum(relative_error / np.maximum(overlap, relative_error), worst)
    defective = _lacks_modes(A, values, bounds, size * worst)
    order = np.lexsort((values.imag, -values.real))
    modes = np.linalg.solve(root.T, right[:n, order])
    lengths = np.linalg.norm(modes, axis=0)
    return Spectrum(
        rate * values[order],
        (modes / np.where(lengths > 0.0, lengths, 1.0)).astype(np.complex128),
        rate * bounds[order],
        defective,
    )


def _lacks_modes(A: Array, values: Complex, bounds: Array, width: float) -> bool:
    """Compare multiplicity and number of modes of the eigenvalues with real part 0.

    The members of a multiple eigenvalue scatter by the square root of the error, their mean does
    not. Those below the real axis are the conjugates of those above.
    """
    left = values[(np.abs(values.real) <= bounds) & (values.imag >= 0.0)]
    while len(left):
        cluster = values[np.abs(values - left[0]) <= 2.0 * width]
        left = left[np.abs(left - left[0]) > 2.0 * width]
        if len(cluster) == 1:
            continue
        shifted = A - cluster.mean() * np.eye(len(A))
        modes = int((np.linalg.svd(shifted, compute_uv=False) <= width).sum())
        if modes < len(cluster):
            return True
    return False
