"""Comparison of computed with expected numbers."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass


@dataclass(frozen=True)
class Check:
    """A computed number beside the expected one.

    >>> from asperity.paper.checks import Check
    >>> Check("period", 28.703, 28.7, 0.02, "s").ok
    True
    """

    quantity: str
    expected: float
    computed: float
    tolerance: float
    unit: str = ""

    @property
    def error(self) -> float:
        """Computed minus expected."""
        return self.computed - self.expected

    @property
    def ok(self) -> bool:
        """Whether the error is within the tolerance; NaN never is."""
        return abs(self.error) <= self.tolerance


def table(checks: Sequence[Check]) -> str:
    """Return a text table: quantity, expected, computed, error, tolerance, unit, verdict.

    >>> from asperity.paper.checks import Check, table
    >>> print(table([Check("period", 28.703, 28.6, 0.02, "s")]))
    quantity    expected    computed    error  tolerance
    period     28.703000   28.600000 -1.0e-01    2.0e-02  s  OFF
    """
    width = max(len("quantity"), *(len(check.quantity) for check in checks))
    units = max(len(check.unit) for check in checks)
    lines = [f"{'quantity':<{width}}  {'expected':>10}  {'computed':>10}    error  tolerance"]
    for check in checks:
        numbers = f"{check.expected:>10.6f}  {check.computed:>10.6f} {check.error:>8.1e}"
        verdict = "ok" if check.ok else "OFF"
        lines.append(
            f"{check.quantity:<{width}}  {numbers}  {check.tolerance:>9.1e}  "
            f"{check.unit:<{units}}  {verdict}"
        )
    return "\n".join(lines)
