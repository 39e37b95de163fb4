"""Limit cycles of systems with friction, and how they depend on a parameter ([WL19] §4.3)."""

from asperity.cycle.bifurcation import BifurcationDiagram, bifurcation_diagram
from asperity.cycle.limit_cycle import limit_cycle
from asperity.cycle.orbit import LimitCycle

__all__ = ["BifurcationDiagram", "LimitCycle", "bifurcation_diagram", "limit_cycle"]
