"""The law of a contact with one direction of sliding."""

from __future__ import annotations

from asperity._base import arrays
from asperity.errors import DimensionError
from asperity.law import FrictionLaw


def line_law(mu: float, law: FrictionLaw | None) -> FrictionLaw:
    """Return the law given, which must be of dimension 1, else that of a friction coefficient."""
    coulomb = FrictionLaw.isotropic(mu, dimension=1)
    if law is None:
        return coulomb
    arrays.of_kind(law, "law", FrictionLaw, "a FrictionLaw or None")
    if law.dimension != 1:
        raise DimensionError("law", f"must have the dimension 1, has {law.dimension}")
    return law
