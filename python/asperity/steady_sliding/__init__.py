"""Stability of steady sliding: equilibria, linearisation, critical directions ([WL19] §4)."""

from asperity.steady_sliding.analysis import Stability as Stability
from asperity.steady_sliding.analysis import stability
from asperity.steady_sliding.chart import GrowthChart as GrowthChart
from asperity.steady_sliding.chart import growth_chart
from asperity.steady_sliding.critical.directions import (
    critical_directions,
    ellipses_can_be_unstable,
)
from asperity.steady_sliding.critical.intervals import CriticalIntervals as CriticalIntervals
from asperity.steady_sliding.critical.rotations import critical_rotation
from asperity.steady_sliding.incremental import incremental_distance
from asperity.steady_sliding.sparse.maps import SquealMap as SquealMap
from asperity.steady_sliding.sparse.maps import squeal_map
from asperity.steady_sliding.sparse.modes import ComplexModes as ComplexModes
from asperity.steady_sliding.sparse.reduced_system import ReducedSystem as ReducedSystem
from asperity.steady_sliding.sparse.reduction import reduce
from asperity.steady_sliding.steady_state import Equilibrium as Equilibrium
from asperity.steady_sliding.steady_state import equilibrium

__all__ = [
    "critical_directions",
    "critical_rotation",
    "ellipses_can_be_unstable",
    "equilibrium",
    "growth_chart",
    "incremental_distance",
    "reduce",
    "squeal_map",
    "stability",
]
