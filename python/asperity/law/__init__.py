"""Friction laws: pairs of a force reservoir C and a direction set D ([WL19] §3)."""

from asperity.law.flow import FlowReport
from asperity.law.friction import FrictionLaw

__all__ = ["FlowReport", "FrictionLaw"]
