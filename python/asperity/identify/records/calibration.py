"""Crosstalk: from readings of the channels to forces."""

from __future__ import annotations

from dataclasses import KW_ONLY
from typing import Annotated, Any, TypeAlias

import numpy as np
from numpy.typing import ArrayLike

from asperity._base import arrays
from asperity._base.arrays import Array
from asperity._base.value import AnyArray, Given, Record, field, optional, shaped
from asperity.errors import DimensionError, ParameterError

# Beyond this condition number the digits of the readings are lost.
_WORST_CONDITION = 1e6


def by_channel(error: ArrayLike, name: str) -> Array:
    """Return the errors of the three channels from one number for all, or from three."""
    values = arrays.array(error, name)
    if values.ndim == 0:
        values = np.full(3, values)
    if values.shape != (3,):
        raise DimensionError(name, f"must be one number or three, got {values.shape}")
    if values.min() < 0.0:
        raise ParameterError(name, f"must not be negative, got {values.tolist()}")
    return arrays.read_only(values)


ByChannel: TypeAlias = Annotated[Given[ArrayLike | None, Array | None], optional(by_channel)]
"""Errors of the three channels, given as one number for all or as three; None if not known."""


class Calibration(Record):
    """The matrix T of λ = T (F − zero), from readings F under known loads.

    The readings are fitted as F = X λ by least squares over all loads, and T = X⁻¹; three loads
    along the axes give the inverse of the matrix of readings.

    Args:
        loads: tangential, radial and normal load of each weighing in N, shape ``(m, 3)``.
        readings: what the channels read, shape ``(m, 3)``.
        reading_error: standard error of one reading, a number or one per channel, in the unit of
            the readings; by default it is estimated from what the fit leaves.
        fit_zero: whether the readings are not tared and a zero is fitted as well.

    Attributes:
        matrix: T, shape ``(3, 3)``.
        condition: condition number of X with its columns scaled to length one.
        covariance: of the entries of T row by row, shape ``(9, 9)``; NaN if there is neither a
            reading error nor a redundant load.
        residuals: F − Xλ, shape ``(m, 3)``.

    Raises:
        ParameterError: if the loads do not determine the matrix.

    Reference: [WL19] §5.2.

    >>> import numpy as np
    >>> from asperity.identify import Calibration
    >>> crosstalk = np.array([[1.0, 0.03, 0.0], [-0.02, 1.1, 0.0], [0.0, 0.05, 0.9]])
    >>> loads = 5.0 * np.eye(3)
    >>> calibration = Calibration(loads, loads @ crosstalk.T, reading_error=1e-3)
    >>> bool(abs(calibration.matrix @ crosstalk - np.eye(3)).max() < 1e-12)
    True
    """

    loads: Annotated[Given[ArrayLike, Array], shaped(None, 3)]
    readings: AnyArray
    _: KW_ONLY
    reading_error: ByChannel = field(default=None)
    fit_zero: bool = False
    matrix: Array = field(init=False)
    condition: float = field(init=False)
    covariance: Array = field(init=False)
    residuals: Array = field(init=False)

    def _complete(self, given: dict[str, Any]) -> None:
        given["readings"] = arrays.array(given["readings"], "readings", (len(given["loads"]), 3))

    def _derive(self) -> None:
        given, read, fit_zero = self.loads, self.readings, self.fit_zero
        design = np.hstack([given, np.ones((len(given), 1))]) if fit_zero else given
        if np.linalg.matrix_rank(design) < design.shape[1]:
            raise ParameterError(
                "loads", f"must act along all three axes{' and at two levels' * bool(fit_zero)}"
            )
        gains = np.linalg.lstsq(design, read, rcond=None)[0]
        crosstalk = gains[:3].T
        columns = np.linalg.norm(crosstalk, axis=0)
        condition = float(np.linalg.cond(crosstalk / columns)) if columns.all() else np.inf
        if not condition < _WORST_CONDITION:
            raise ParameterError(
                "readings", f"must tell the axes apart, condition number {condition:.3g}"
            )
        matrix = np.linalg.inv(crosstalk)
        residuals = read - design @ gains
        variance = _variance(residuals, design.shape[1])
        if self.reading_error is not None:
            variance = self.reading_error**2
        spread = np.linalg.inv(design.T @ design)[:3, :3]
        # dT = −T dX T, entries row by row.
        sensitivity = np.kron(matrix, matrix.T)
        covariance = sensitivity @ np.kron(np.diag(variance), spread) @ sensitivity.T
        self._keep(
            matrix=matrix,
            condition=condition,
            covariance=covariance,
            residuals=residuals,
        )

    def known_covariance(self, *, is_load_given: bool) -> Array | None:
        """Return the covariance as far as it matters and is known; None if it is NaN.

        Args:
            is_load_given: whether λ_N is known otherwise, so that the third row of T is not used.
        """
        if not np.isfinite(self.covariance).all():
            return None
        used = np.repeat([1.0, 1.0, 0.0 if is_load_given else 1.0], 3)
        return arrays.read_only(np.outer(used, used) * self.covariance)


def _variance(residuals: Array, parameters: int) -> Array:
    redundant = len(residuals) - parameters
    if redundant == 0:
        return np.full(3, np.nan)
    return (residuals**2).sum(axis=0) / redundant
