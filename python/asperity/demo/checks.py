"""Comparison of computed with expected numbers."""

from dataclasses import dataclass


@dataclass(frozen=True)
class Check:
    """A computed number beside the expected one.

    >>> from asperity.demo import Check
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
