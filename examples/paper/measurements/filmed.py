"""The film of the disk of Fig. 27, which obeys the law of PVC on ground steel."""

from functools import cache

from asperity.demo.film import Film, film, slide
from paper.measurements.pairings import PVC

SYNTHETIC = "synthetic data: virtual camera"
"""What a figure with such data says of them."""

SPEED, ANGLE = 1.52, 58.0
"""Initial speed in m/s and its angle to the grooves in degrees, of Fig. 27."""


@cache
def filmed() -> Film:
    """Film and track the disk once."""
    disk, run = slide(PVC.law, SPEED, ANGLE)
    return film(disk, run, fps=500.0, size=(640, 560), seed=27)
