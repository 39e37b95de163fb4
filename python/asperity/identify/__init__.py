"""From measured forces to a friction law with its uncertainty, and a virtual tribometer.

>>> import asperity as asp
>>> law = asp.FrictionLaw(asp.Ellipse(0.5, 0.4), asp.Ellipse(3.0, 2.0))
>>> raw = asp.identify.VirtualTribometer(law, normal_force=9.3, turns=4, sample_rate=200.0).record()
>>> fit = asp.identify.fit_law(asp.identify.process(raw), "ellipse", "ellipse")
>>> fit.parameters["direction.ratio"].covers(1.5)
True

Reference: [WL19] §5.2.
"""

from asperity.identify.averaged import Averaged
from asperity.identify.bands import Bands
from asperity.identify.calibration import Calibration
from asperity.identify.coordinates import Estimate
from asperity.identify.dependence import Dependence, load_dependence, speed_dependence
from asperity.identify.direction_models import (
    CircleDirection,
    FourierDirection,
    SuperellipseDirection,
)
from asperity.identify.files import Configuration, read_raw, write_raw
from asperity.identify.fit import Fit
from asperity.identify.fitting import fit_law
from asperity.identify.process import ProcessedData, process
from asperity.identify.reading import read_csv
from asperity.identify.record import Processing, RawData, Recording
from asperity.identify.reservoir_models import (
    CircleReservoir,
    FourierReservoir,
    SuperellipseReservoir,
)
from asperity.identify.selection import Candidate, Comparison, compare_models
from asperity.identify.sets import ConvexDirection, MeasuredSets
from asperity.identify.signals import low_pass
from asperity.identify.tribometer import VirtualTribometer
from asperity.identify.turns import TurnAverage, average_turns

__all__ = [
    "Averaged",
    "Bands",
    "Calibration",
    "Candidate",
    "CircleDirection",
    "CircleReservoir",
    "Comparison",
    "Configuration",
    "ConvexDirection",
    "Dependence",
    "Estimate",
    "Fit",
    "FourierDirection",
    "FourierReservoir",
    "MeasuredSets",
    "ProcessedData",
    "Processing",
    "RawData",
    "Recording",
    "SuperellipseDirection",
    "SuperellipseReservoir",
    "TurnAverage",
    "VirtualTribometer",
    "average_turns",
    "compare_models",
    "fit_law",
    "load_dependence",
    "low_pass",
    "process",
    "read_csv",
    "read_raw",
    "speed_dependence",
    "write_raw",
]
