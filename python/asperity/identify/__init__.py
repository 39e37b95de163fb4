"""From measured forces to a friction law, and a virtual tribometer ([WL19] §5.2)."""

from asperity.identify.averaged import Averaged
from asperity.identify.calibration import Calibration
from asperity.identify.process import ProcessedData, process
from asperity.identify.record import RawData, Recording
from asperity.identify.signals import low_pass
from asperity.identify.tribometer import VirtualTribometer
from asperity.identify.turns import TurnAverage, average_turns

__all__ = [
    "Averaged",
    "Calibration",
    "ProcessedData",
    "RawData",
    "Recording",
    "TurnAverage",
    "VirtualTribometer",
    "average_turns",
    "low_pass",
    "process",
]
