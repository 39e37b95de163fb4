"""From measured forces to a friction law with its uncertainty.

>>> import numpy as np
>>> import asperity as asp
>>> phi = np.linspace(0.0, 4.0 * np.pi, 1000, endpoint=False)
>>> force = 0.3 * np.stack([np.cos(phi), np.sin(phi)], axis=-1)
>>> fit = asp.identify.fit_law((phi, force), "circle", "circle")
>>> fit.law
FrictionLaw(Disk(0.3), Disk(0.3))
"""

from asperity.identify.coordinates import Estimate
from asperity.identify.direction_models import (
    CircleDirection,
    FourierDirection,
    SuperellipseDirection,
)
from asperity.identify.fit import Bands, Fit, fit_law
from asperity.identify.reservoir_models import (
    CircleReservoir,
    FourierReservoir,
    SuperellipseReservoir,
)

__all__ = [
    "Bands",
    "CircleDirection",
    "CircleReservoir",
    "Estimate",
    "Fit",
    "FourierDirection",
    "FourierReservoir",
    "SuperellipseDirection",
    "SuperellipseReservoir",
    "fit_law",
]
