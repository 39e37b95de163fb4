"""Limit cycles of systems with friction, and how they depend on a parameter ([WL19] §4.3)."""

from asperity.cycles.bifurcation import BifurcationDiagram, bifurcation_diagram
from asperity.cycles.orbit import LimitCycle
from asperity.cycles.search import limit_cycle

__all__ = ["BifurcationDiagram", "LimitCycle", "bifurcation_diagram", "limit_cycle"]
