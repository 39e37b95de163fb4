"""The matrices of M q̈ + B q̇ + K q = 0 and which numbers may be eigenvalues within their errors."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from asperity._base.arrays import Array

Complex = NDArray[np.complex128]

_EPS = float(np.finfo(np.float64).eps)
# Rounding in matrices of n equations and their inverses, relative to the entries and to n.
ROUNDING = 50.0 * _EPS
# Factor for estimated errors.
SAFETY = 4.0
# Change of an eigenvalue that ends the polishing.
_STILL = 1e-13
_SQUARINGS = 4


class Pencil(NamedTuple):
    """P(z) = z² M + z B + K, or bounds of the errors of the three; matrices may be stacked.

    Numbers z have the shape of the stack and one axis more.
    """

    mass: Array
    damping: Array
    stiffness: Array

    def at(self, z: NDArray[np.inexact]) -> NDArray[np.inexact]:
        """Return P(z)."""
        M, B, K = (part[..., None, :, :] for part in self)
        z = z[..., None, None]
        return (z * M + B) * z + K

    def may_be_singular(self, errors: Pencil, z: Complex) -> NDArray[np.bool_]:
        """Return whether z may be an eigenvalue: false if no matrices within `errors` have it.

        P + F with |F| ≤ E, entry by entry, is regular if ρ(|P⁻¹| E) < 1. That is sharp for simple
        eigenvalues and near multiple ones alike, and independent of units: soft directions are
        not judged by the errors of stiff ones. ρ is bounded by ‖X¹⁶‖^(1/16).
        """
        inverse, regular = _inverse(self.at(z))
        X: Array = np.abs(inverse) @ errors.at(np.abs(z))
        size = np.maximum(np.abs(X).max(axis=(-1, -2), initial=0.0), 1e-300)
        finite = regular & np.isfinite(size)
        X = np.where(finite[..., None, None], X / size[..., None, None], 0.0)
        log = np.log(size)
        for level in range(1, _SQUARINGS + 1):
            X = X @ X
            peak = np.maximum(X.max(axis=(-1, -2), initial=0.0), 1e-300)
            X /= peak[..., None, None]
            log = log + np.log(peak) / 2.0**level
        norm = np.maximum(X.sum(axis=-1).max(axis=-1, initial=0.0), 1e-300)
        log += np.log(norm) / 2.0**_SQUARINGS
        return ~finite | (log >= 0.0)

    def on_axis(self, errors: Pencil, values: Complex) -> NDArray[np.bool_]:
        """Return whether eigenvalues may in truth be on the imaginary axis.

        They may if half-way between them and the axis eigenvalues are possible. Those that are
        none themselves are multiple ones that could not be polished: they are known to the
        rounding errors of the whole matrix only.
        """
        half: Complex = 0.5 * values.real + 1j * values.imag
        rough = ROUNDING * np.abs(values).max(axis=-1, initial=0.0)[..., None]
        unpolished = (np.abs(values.real) <= rough) & ~self.may_be_singular(errors, values)
        return self.may_be_singular(errors, half) | unpolished

    def polished(self, values: Complex, rounds: int = 3) -> Complex:
        """Improve simple eigenvalues by Newton's method for det P(z) = 0.

        Of matrices with large and small entries they come with errors of the largest.
        """
        n = self.mass.shape[-1]
        apart = np.abs(values[..., None] - values[..., None, :])
        apart += np.where(np.eye(values.shape[-1], dtype=bool), np.inf, 0.0)
        inverse, regular = _inverse(self.at(values))
        slope = 2.0 * values[..., None, None] * self.mass[..., None, :, :]
        slope = slope + self.damping[..., None, :, :]
        trace = (inverse * np.swapaxes(slope, -1, -2)).sum(axis=(-1, -2))
        taken = regular & (np.abs(trace) * apart.min(axis=-1) > 20.0 * n)
        step = np.where(taken, 1.0 / np.where(taken, trace, 1.0), 0.0)
        values = values - step
        moving = (np.abs(step) > _STILL * np.abs(values)).any(axis=-1)
        if rounds > 1 and moving.any():
            stack = values.shape[:-1]
            rest = Pencil(*(np.broadcast_to(part, (*stack, n, n))[moving] for part in self))
            values[moving] = rest.polished(values[moving], rounds - 1)
        return values

    def modes_at(self, errors: Pencil, z: complex) -> int:
        """Return the number of modes of one eigenvalue, the corank of P(z) within errors."""
        matrix, error = self.at(np.array([z]))[0], errors.at(np.array([abs(z)]))[0]
        size = Pencil(*(np.abs(part) for part in self)).at(np.array([abs(z)]))[0]
        left, right = _scales(size)
        values = np.linalg.svd(left[:, None] * matrix * right, compute_uv=False)
        worst = float((left[:, None] * error * right).max())
        return int((values <= np.sqrt(worst)).sum())


def _inverse(
    matrices: NDArray[np.inexact],
) -> tuple[NDArray[np.inexact], NDArray[np.bool_]]:
    """Invert what is regular, with rows and columns scaled to entries of size one."""
    left, right = _scales(np.abs(matrices))
    scaled = left[..., :, None] * matrices * right[..., None, :]
    regular: NDArray[np.bool_] = np.asarray(np.linalg.slogdet(scaled)[0] != 0.0)
    safe = np.where(regular[..., None, None], scaled, np.eye(matrices.shape[-1]))
    return right[..., :, None] * np.linalg.inv(safe) * left[..., None, :], regular


def _scales(size: Array) -> tuple[Array, Array]:
    """Return factors of rows and columns, powers of two, that make the largest entries about 1."""
    left = _power(size.max(axis=-1))
    return left, _power((left[..., :, None] * size).max(axis=-2))


def _power(size: Array) -> Array:
    return np.exp2(-np.round(np.log2(np.where(size > 0.0, size, 1.0))))
