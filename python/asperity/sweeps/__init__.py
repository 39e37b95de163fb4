"""Sweeps: a function at all points of a grid, on any executor, in a store that survives."""

from asperity.sweeps.labelled_sweep import sweep
from asperity.sweeps.standing import SweepStatus as SweepStatus
from asperity.sweeps.standing import sweep_status

__all__ = ["sweep", "sweep_status"]
