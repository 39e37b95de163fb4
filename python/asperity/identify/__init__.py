"""From measured forces to a friction law, and a virtual tribometer ([WL19] §5.2)."""

from asperity.identify.averaged import Averaged
from asperity.identify.calibration import Calibration
from asperity.identify.dependence import Dependence, load_dependence, speed_dependence
from asperity.identify.files import Configuration, read_raw, write_raw
from asperity.identify.process import ProcessedData, process
from asperity.identify.reading import read_csv
from asperity.identify.record import RawData, Recording
from asperity.identify.sets import ConvexDirection, MeasuredSets
from asperity.identify.signals import low_pass
from asperity.identify.tribometer import VirtualTribometer
from asperity.identify.turns import TurnAverage, average_turns

__all__ = [
    "Averaged",
    "Calibration",
    "Configuration",
    "ConvexDirection",
    "Dependence",
    "MeasuredSets",
    "ProcessedData",
    "RawData",
    "Recording",
    "TurnAverage",
    "VirtualTribometer",
    "average_turns",
    "load_dependence",
    "low_pass",
    "process",
    "read_csv",
    "read_raw",
    "speed_dependence",
    "write_raw",
]
