"""What may have gone wrong with data that no law fits: a wrong sign or unit, swapped channels."""

from __future__ import annotations

from typing import NamedTuple


class Mistake(NamedTuple):
    """What may have gone wrong, and how far mean forces are from the model without it.

    Attributes:
        words: to follow "with".
        misfit: root mean square relative to the force.
    """

    words: str
    misfit: float
