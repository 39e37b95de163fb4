"""Eigenvalues of small motions, and what errors leave of their signs."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from asperity._base.arrays import Array
from asperity.steady_sliding.linearised.pencil import ROUNDING, Complex, Pencil
from asperity.steady_sliding.linearised.resolvent import Resolvent

# Real part, relative to the eigenvalue, that errors should not hide.
_FINE = 1e-6
# Places between two eigenvalues that are one: none is between equidistant ones.
_BETWEEN = (0.5, 1.0 / math.e, 1.0 / math.pi)


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
    root, rate, A = _first_order(pencil)
    # Of any type, as the stubs of SciPy know two results where there are three.
    eig: Any = scipy.linalg.eig
    values, left, right = eig(A, left=True)
    near = Resolvent(
        pencil,
        errors,
        rate * values,
        np.linalg.solve(root.T, right[:n]),
        np.linalg.solve(root.T, left[n:]),
    )
    order = np.lexsort((near.values.imag, -near.values.real))
    values, modes = near.values[order], np.linalg.solve(root.T, right[:n, order])
    isolated = near.isolated[order]
    lengths = np.linalg.norm(modes, axis=0)
    on_axis = _on_axis(near, values)
    return Spectrum(
        values,
        (modes / np.where(lengths > 0.0, lengths, 1.0)).astype(np.complex128),
        on_axis,
        _lacks_modes(near, values[on_axis & ~isolated & (values.imag >= 0.0)]),
        _hidden(near, values[on_axis & (values.imag > 0.0)]),
    )


def growth_rate(pencil: Pencil, errors: Pencil) -> float:
    """Return `Spectrum.growth_rate`, from the rightmost eigenvalue alone where it is certain."""
    if len(pencil.mass):
        _, rate, A = _first_order(pencil)
        values = (rate * np.linalg.eigvals(A)).astype(np.complex128)
        # The others are the conjugates of these.
        above: Complex = values[values.imag >= 0.0]
        first = above[np.argsort(-above.real)[:2]]
        best = pencil.polished(first, rounds=2)
        rightmost: Complex = best[[int(best.real.argmax())]]
        rough = ROUNDING * np.abs(values).max()
        half: Complex = 0.5 * rightmost.real + 1j * rightmost.imag
        if rightmost[0].real > rough and not pencil.may_be_singular(errors, half)[0]:
            return float(rightmost[0].real)
    return spectrum(pencil, errors).growth_rate


def _first_order(pencil: Pencil) -> tuple[Array, float, Array]:
    """Return the Cholesky factor of M, a unit of rates, and [[0, I], [−K, −B]] for M = I."""
    n = len(pencil.mass)
    root = np.linalg.cholesky(pencil.mass)
    K, B = (
        np.linalg.solve(root, np.linalg.solve(root, part).T).T
        for part in (pencil.stiffness, pencil.damping)
    )
    rate = max(np.sqrt(_size(K)), _size(B)) or 1.0
    # Time in units of the fastest motion, so that the entries have one unit.
    A = np.block([[np.zeros((n, n)), np.eye(n)], [-K / rate**2, -B / rate]])
    return np.asarray(root, dtype=np.float64), float(rate), A


def _size(matrix: Array) -> float:
    """Return a bound of the largest singular value, √(‖A‖₁‖A‖∞)."""
    size = np.abs(matrix)
    return float(np.sqrt(size.sum(axis=0).max() * size.sum(axis=1).max()))


def _on_axis(near: Resolvent, values: Complex) -> NDArray[np.bool_]:
    """Return whether eigenvalues may in truth be on the imaginary axis, as `Pencil.on_axis`."""
    half: Complex = 0.5 * values.real + 1j * values.imag
    rough = ROUNDING * np.abs(values).max(initial=0.0)
    on_axis = near.may_be_singular(half)
    doubtful = np.flatnonzero(~on_axis & (np.abs(values.real) <= rough))
    on_axis[doubtful] = ~near.may_be_singular(values[doubtful])
    return on_axis


def _lacks_modes(near: Resolvent, left: Complex) -> bool:
    """Compare multiplicity and number of modes of the eigenvalues with real part 0.

    Those are one if points between them may all be eigenvalues. The members of a multiple
    eigenvalue scatter, their mean does not. Those below the real axis are the conjugates of those
    above.
    """
    while len(left):
        same = np.ones(len(left), dtype=bool)
        # At one point another eigenvalue may happen to be.
        for share in _BETWEEN:
            same[same] = near.may_be_singular((1.0 - share) * left[0] + share * left[same])
        same[0] = True
        cluster, left = left[same], left[~same]
        # Of a double eigenvalue 0 that is scattered along the axis only one half is here.
        above: Complex = cluster[cluster.imag > 0.0]
        towards: Complex = above.real + 0.5j * above.imag
        size = len(cluster) + int(near.may_be_singular(towards).sum())
        if size > 1 and near.pencil.modes_at(near.errors, complex(cluster.mean())) < size:
            return True
    return False


def _hidden(near: Resolvent, values: Complex) -> float:
    """Return the largest real part that eigenvalues on the axis may have."""
    real = _FINE * np.abs(values)
    beside: Complex = real + 1j * values.imag
    doubtful = near.may_be_singular(beside)
    values, real, found = values[doubtful], real[doubtful], 0.0
    while len(values):
        found, real = float(real.max()), 10.0 * real
        further: Complex = real + 1j * values.imag
        doubtful = (real < np.abs(values)) & near.may_be_singular(further)
        values, real = values[doubtful], real[doubtful]
    return 10.0 * found
