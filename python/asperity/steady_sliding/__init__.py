"""Stability of steady sliding: equilibria, linearisation, critical directions ([WL19] §4)."""

from asperity.steady_sliding.analysis import Stability, stability
from asperity.steady_sliding.chart import GrowthChart, growth_chart
from asperity.steady_sliding.critical.directions import (
    critical_directions,
    ellipses_can_be_unstable,
)
from asperity.steady_sliding.critical.intervals import CriticalIntervals
from asperity.steady_sliding.critical.rotations import critical_rotation
from asperity.steady_sliding.incremental import incremental_distance
from asperity.steady_sliding.steady_state import Equilibrium, equilibrium

__all__ = [
    "CriticalIntervals",
    "Equilibrium",
    "GrowthChart",
    "Stability",
    "critical_directions",
    "critical_rotation",
    "ellipses_can_be_unstable",
    "equilibrium",
    "growth_chart",
    "incremental_distance",
    "stability",
]
