"""Trigonometric polynomials at directions given as unit vectors; linear least squares."""

from __future__ import annotations

from typing import ClassVar

import numpy as np

from asperity._base import arrays
from asperity._base.arrays import Array
from asperity.identify.models.coordinates import Coordinate, CurveModel, Scale


class FourierModel(CurveModel):
    """A model whose coordinates are the coefficients of a trigonometric polynomial.

    Args:
        order: highest harmonic.
        odd: whether odd harmonics are there, for sets that are not symmetric to the origin.
    """

    order: int
    odd: bool
    _harmonics: tuple[int, ...]
    # Coordinates before those of the waves.
    _level: ClassVar[tuple[Coordinate, ...]] = ()

    def __init__(self, order: int = 8, *, odd: bool = False) -> None:
        self._set(order=arrays.count(order, "order"), odd=bool(odd))
        harmonics = tuple(range(1, self.order + 1) if odd else range(2, self.order + 1, 2))
        waves = (Coordinate(f"{f}{k}", Scale.PLAIN) for k in harmonics for f in ("cos", "sin"))
        self._keep(_harmonics=harmonics, coordinates=(*self._level, *waves))

    @property
    def is_symmetric(self) -> bool:
        """Whether all curves are symmetric to the origin: without odd harmonics."""
        return not self.odd


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
