"""How the friction coefficient depends on the normal load and on the speed."""

from __future__ import annotations

import math
from collections.abc import Iterable
from dataclasses import KW_ONLY
from typing import Any

import numpy as np

from asperity._base import arrays
from asperity._base.arrays import Array
from asperity._base.quantiles import student
from asperity._base.value import AnyArray, Fraction, Record, Vector, field
from asperity.errors import ParameterError
from asperity.identify.evidence.coefficient.static import sliding
from asperity.identify.forces.processing import ProcessedData

# Runs whose loads or speeds differ by less than this factor tell nothing.
LEAST_RATIO = 1.05


class Dependence(Record):
    """The exponent n of μ ∝ xⁿ over runs at different normal loads or speeds x.

    Args:
        values: λ_N in N or ‖γ‖ in m/s of each run, shape ``(m,)``.
        coefficients: mean of ‖λ‖/λ_N over the complete turns of each run, shape ``(m,)``.
        confidence: level of the confidence interval of n.

    Attributes:
        exponent: n; 0 where μ does not depend on x, for the load Amontons' law.
        low, high: confidence interval of n from the scatter of the runs about the power,
            Student's t.

    Raises:
        ParameterError: with fewer than two runs, or if they hardly differ. The interval of two
            runs is infinite: nothing is known of their scatter.

    >>> from asperity.identify import Dependence
    >>> found = Dependence([5.0, 10.0, 20.0, 40.0], [0.31, 0.30, 0.31, 0.30])
    >>> found.is_independent, abs(found.exponent) < 0.02
    (True, True)
    """

    values: Vector
    coefficients: AnyArray
    _: KW_ONLY
    confidence: Fraction = 0.95
    exponent: float = field(init=False)
    low: float = field(init=False)
    high: float = field(init=False)

    def _complete(self, given: dict[str, Any]) -> None:
        x = given["values"]
        y = arrays.array(given["coefficients"], "coefficients", (x.size,))
        given["coefficients"] = y
        if x.size < 2:
            raise ParameterError("values", f"must be those of two runs or more, got {x.size}")
        for name, one in (("values", x), ("coefficients", y)):
            if one.min() <= 0.0:
                raise ParameterError(name, f"must be positive, got {one.min()}")
        if x.max() < LEAST_RATIO * x.min():
            raise ParameterError(
                "values", f"must differ by 5 % or more, lie in {x.min():.4g}..{x.max():.4g}"
            )

    def _derive(self) -> None:
        x, y = self.values, self.coefficients
        away = np.log(x) - np.log(x).mean()
        spread = float(away @ away)
        exponent = float(away @ np.log(y)) / spread
        left = np.log(y) - np.log(y).mean() - exponent * away
        half = math.inf
        if x.size > 2:
            error = math.sqrt(float(left @ left) / (x.size - 2) / spread)
            half = student(self.confidence, x.size - 2) * error
        self._keep(exponent=exponent, low=exponent - half, high=exponent + half)

    @property
    def is_independent(self) -> bool:
        """Whether the confidence interval of the exponent holds 0."""
        return self.low <= 0.0 <= self.high


def several_loads(data: Any) -> tuple[float, ...]:
    """Return the mean λ_N in N of each run if these differ by 5 % or more, else nothing."""
    loads = data.loads if isinstance(data, ProcessedData) else ()
    return loads if loads and max(loads) >= LEAST_RATIO * min(loads) else ()


def load_dependence(
    data: ProcessedData | Iterable[ProcessedData], *, confidence: float = 0.95
) -> Dependence:
    """Test Amontons' law: how ‖λ‖/λ_N depends on λ_N over runs at different loads.

    Args:
        data: processed runs, of one pairing and similar speed.
        confidence: level of the confidence interval of the exponent.

    Reference: [WL19] §3.
    """
    runs = [run for one in _several(data) for run in _means(one, one.normal_force)]
    return Dependence(*zip(*runs, strict=True), confidence=confidence)


def speed_dependence(
    data: ProcessedData | Iterable[ProcessedData], *, confidence: float = 0.95
) -> Dependence:
    """Test whether ‖λ‖/λ_N depends on the sliding speed over runs at different speeds.

    Args:
        data: processed runs of raw data with `radius`, of one pairing and similar load.
        confidence: level of the confidence interval of the exponent.

    Reference: [WL19] Def. 10.
    """
    runs = [run for one in _several(data) for run in _means(one, one.speed)]
    return Dependence(*zip(*runs, strict=True), confidence=confidence)


def _several(data: ProcessedData | Iterable[ProcessedData]) -> tuple[ProcessedData, ...]:
    runs = (data,) if isinstance(data, ProcessedData) else arrays.several(data, "data")
    for one in runs:
        arrays.of_kind(one, "data", ProcessedData, "what process() returns, or several of it")
    return runs


def _means(data: ProcessedData, values: Array) -> list[tuple[float, float]]:
    """Return the mean of `values` and of ‖λ‖/λ_N over the turns of each run, or while it slips."""
    found, slides = [], sliding(data)
    for start, stop in zip(data.run, data.run[1:], strict=False):
        used = slides[start:stop]
        if used.any():
            friction = np.hypot(*data.force[start:stop][used].T)
            coefficient = friction.mean() / data.normal_force[start:stop][used].mean()
            found.append((float(values[start:stop][used].mean()), float(coefficient)))
    return found
