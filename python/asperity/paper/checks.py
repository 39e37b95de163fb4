"""Comparison of computed with expected numbers."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

from asperity._base.tables import aligned


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
    quantity   expected   computed     error  tolerance
    period    28.703000  28.600000  -1.0e-01    2.0e-02  s  OFF
    """
    rows = [
        (
            check.quantity,
            f"{check.expected:.6f}",
            f"{check.computed:.6f}",
            f"{check.error:.1e}",
            f"{check.tolerance:.1e}",
            check.unit,
            "ok" if check.ok else "OFF",
        )
        for check in checks
    ]
    header = ("quantity", "expected", "computed", "error", "tolerance")
    return aligned([header, *rows], right=range(1, 5))
