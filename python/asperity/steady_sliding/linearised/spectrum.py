"""Eigenvalues of small motions, and what errors leave of their signs."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from asperity.steady_sliding.linearised.pencil import Complex, Pencil

# Real part, relative to the eigenvalue, that errors should not hide.
_FINE = 1e-6


@dataclass(frozen=True)
class Spectrum:
    """Eigenvalues of M q̈ + B q̇ + K q = 0, [WL19] (113), and what is certain of them."""

    values: Complex
    """In 1/s, by falling real part."""
    modes: Complex
    """Displacements, one column each, of length 1."""
    on_axis: NDArray[np.bool_]
    """Whether the errors of the matrices may have moved them off the imaginary axis."""
    defective: bool
    """Whether an eigenvalue with real part 0 has fewer modes than its multiplicity."""
    hidden: float
    """Growth rate in 1/s that errors may hide, 0 if it is below 1e-6 of the eigenvalue."""

    @property
    def growth_rate(self) -> float:
        """Largest real part; 0 where it is within the error of the eigenvalue."""
        if not self.values.size:
            return 0.0
        # An uncertain eigenvalue right of certain ones must not hide them.
        certain = self.values.real[~self.on_axis]
        return float(max([*certain, *([0.0] if self.on_axis.any() else [])]))


def spectrum(pencil: Pencil, errors: Pencil) -> Spectrum:
    """Return the spectrum of n equations whose matrices are known to `errors`, entry by entry."""
    import scipy.linalg

    n = len(pencil.mass)
    if not n:
        none = np.zeros(0, dtype=np.complex128)
        return Spectrum(none, none.reshape(0, 0), np.zeros(0, dtype=np.bool_), False, 0.0)
    root = np.linalg.cholesky(pencil.mass)
    K, B = (
        np.linalg.solve(root, np.linalg.solve(root, part).T).T
        for part in (pencil.stiffness, pencil.damping)
    )
    rate = max(np.sqrt(np.linalg.norm(K, 2)), np.linalg.norm(B, 2)) or 1.0
    # Time in units of the fastest motion, so that the entries have one unit.
    A = np.block([[np.zeros((n, n)), np.eye(n)], [-K / rate**2, -B / rate]])
    values, right = scipy.linalg.eig(A)
    values = pencil.polished(rate * values)
    order = np.lexsort((values.imag, -values.real))
    values, modes = values[order], np.linalg.solve(root.T, right[:n, order])
    lengths = np.linalg.norm(modes, axis=0)
    on_axis = pencil.on_axis(errors, values)
    return Spectrum(
        values,
        (modes / np.where(lengths > 0.0, lengths, 1.0)).astype(np.complex128),
        on_axis,
        _lacks_modes(pencil, errors, values[on_axis & (values.imag >= 0.0)]),
        _hidden(pencil, errors, values[on_axis & (values.imag > 0.0)]),
    )


def _lacks_modes(pencil: Pencil, errors: Pencil, left: Complex) -> bool:
    """Compare multiplicity and number of modes of the eigenvalues with real part 0.

    Those are one if between them no point is certain to be none. The members of a multiple
    eigenvalue scatter, their mean does not. Those below the real axis are the conjugates of those
    above.
    """
    while len(left):
        same = pencil.may_be_singular(errors, 0.5 * (left[0] + left))
        same[0] = True
        cluster, left = left[same], left[~same]
        # Of a double eigenvalue 0 that is scattered along the axis only one half is here.
        above: Complex = cluster[cluster.imag > 0.0]
        towards: Complex = above.real + 0.5j * above.imag
        size = len(cluster) + int(pencil.may_be_singular(errors, towards).sum())
        if size > 1 and pencil.modes_at(errors, complex(cluster.mean())) < size:
            return True
    return False


def _hidden(pencil: Pencil, errors: Pencil, values: Complex) -> float:
    """Return the largest real part that eigenvalues on the axis may have."""
    real = _FINE * np.abs(values)
    beside: Complex = real + 1j * values.imag
    doubtful = pencil.may_be_singular(errors, beside)
    values, real, found = values[doubtful], real[doubtful], 0.0
    while len(values):
        found, real = float(real.max()), 10.0 * real
        further: Complex = real + 1j * values.imag
        doubtful = (real < np.abs(values)) & pencil.may_be_singular(errors, further)
        values, real = values[doubtful], real[doubtful]
    return 10.0 * found
