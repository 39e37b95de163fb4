"""The law of PVC on ground steel, identified from synthetic measurements: Table 1 and Fig. 26."""

from dataclasses import dataclass
from functools import cache

import asperity as asp
from asperity.demo import table1
from asperity.identify import Fit, ProcessedData, fit_law
from paper.measurements.pairings import PVC, processed


@dataclass(frozen=True)
class Identified:
    """What the measurement of PVC tells."""

    data: ProcessedData
    ellipse: asp.Ellipse
    """C through the friction coefficients across and along the grooves."""
    fit: Fit
    """C and D as superellipses."""

    @property
    def laws(self) -> dict[str, asp.FrictionLaw]:
        """The four laws of Fig. 27 by the names that `table1.laws` uses."""
        reservoir = self.fit.law.reservoir
        four = (
            asp.FrictionLaw.associated(self.ellipse),
            asp.FrictionLaw.associated(reservoir),
            asp.FrictionLaw.collinear(reservoir),
            self.fit.law,
        )
        return dict(zip(table1.LAWS, four, strict=True))


@cache
def identified() -> Identified:
    """Identify the law once."""
    data = processed(PVC)
    return Identified(data, asp.Ellipse(*data.sets.radii_on_axes), fit_law(data))
