"""Stability of steady sliding: equilibria, linearisation, critical directions ([WL19] §4)."""

from asperity.stability.chart import growth_chart
from asperity.stability.directions import critical_directions, ellipses_can_be_unstable
from asperity.stability.equilibrium import Equilibrium, equilibrium
from asperity.stability.incremental import incremental_distance
from asperity.stability.rotations import critical_rotation
from asperity.stability.stability import Stability, stability

__all__ = [
    "Equilibrium",
    "Stability",
    "critical_directions",
    "critical_rotation",
    "ellipses_can_be_unstable",
    "equilibrium",
    "growth_chart",
    "incremental_distance",
    "stability",
]
