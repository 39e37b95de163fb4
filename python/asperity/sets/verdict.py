"""The answer to a yes-or-no question about a set or a law, with its certainty and a witness."""

from __future__ import annotations

from dataclasses import KW_ONLY
from typing import Annotated, TypeAlias

from numpy.typing import ArrayLike

from asperity._base.arrays import Array
from asperity._base.value import Given, NonNegative, Record, Truth, optional, shaped

Answer: TypeAlias = tuple[bool, bool, float, float, Array | None]


class Verdict(Record):
    """Whether a property holds; true in a condition if it does.

    Args:
        holds: the answer.
        exact: whether it was decided by a closed form; otherwise numerically, up to `tolerance`.
        tolerance: largest defect that still counts as none, dimensionless; 0 if `exact`.
        defect: how badly the property fails, dimensionless; 0 if it holds exactly.
        witness: points that show the failure, shape ``(k, p)``; ``None`` if there are none. The
            property that returns the verdict says what they are.

    >>> from asperity import Rectangle, Superellipse
    >>> Rectangle(2.0, 1.0).is_convex
    Verdict(True, exact=True, tolerance=0.0, defect=0.0, witness=None)
    >>> bool(Superellipse(2.0, 1.0, 0.5).is_convex)
    False
    """

    holds: Truth
    _: KW_ONLY
    exact: Truth
    tolerance: NonNegative
    defect: NonNegative
    witness: Annotated[Given[ArrayLike | None, Array | None], optional(shaped(None, None))]

    def __bool__(self) -> bool:
        return self.holds


def verdict(answer: Answer) -> Verdict:
    """Return the verdict that the core answers as a tuple."""
    holds, exact, tolerance, defect, witness = answer
    return Verdict(holds, exact=exact, tolerance=tolerance, defect=defect, witness=witness)
