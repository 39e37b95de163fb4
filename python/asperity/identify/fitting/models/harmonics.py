"""Trigonometric polynomials at directions given as unit vectors; linear least squares."""

from __future__ import annotations

import numpy as np

from asperity._base.arrays import Array


def harmonics_of(order: int, odd: bool) -> tuple[int, ...]:
    """Return the harmonics 1, 2, 3, … or 2, 4, 6, … up to an order."""
    return tuple(range(1, order + 1) if odd else range(2, order + 1, 2))


def series(c: Array, s: Array, harmonics: tuple[int, ...]) -> tuple[Array, Array]:
    """Return cos kφ, sin kφ for all k in turn and their derivatives by φ, both ``(2k, n)``."""
    waves, slopes = np.empty((2, 2 * len(harmonics), c.size))
    # Powers of e^{iφ}: cheaper than sines, and free of angles.
    first = c + 1j * s
    power, exponent = np.ones_like(first), 0
    for row, k in enumerate(harmonics):
        while exponent < k:
            power, exponent = power * first, exponent + 1
        waves[2 * row], waves[2 * row + 1] = power.real, power.imag
        slopes[2 * row], slopes[2 * row + 1] = -k * power.imag, k * power.real
    return waves, slopes


def least_squares(matrix: Array, values: Array) -> Array:
    """Return x of the smallest ‖A x − values‖."""
    return np.asarray(np.linalg.lstsq(matrix, values, rcond=None)[0], dtype=np.float64)
