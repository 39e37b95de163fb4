"""What may have gone wrong with data that no law fits: a wrong sign or unit, swapped channels."""

from __future__ import annotations

import math
from collections.abc import Iterable
from typing import NamedTuple


class Mistake(NamedTuple):
    """What may have gone wrong, and how far mean forces are from the model without it.

    Attributes:
        words: to follow "with".
        misfit: root mean square relative to the force.
    """

    words: str
    misfit: float


def explaining(cases: Iterable[Mistake], *, most: float, as_good: float) -> list[Mistake]:
    """Return the mistakes that explain a misfit; none if the best of them leaves too much.

    Args:
        cases: the likely ones first.
        most: misfit up to which the best one explains.
        as_good: up to this factor of the least misfit, none can be told from the best.
    """
    found = list(cases)
    least = min((one.misfit for one in found), default=math.inf)
    return [one for one in found if least <= most and one.misfit <= as_good * least]
