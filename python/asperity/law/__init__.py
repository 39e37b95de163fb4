"""Friction laws: pairs of a force reservoir C and a direction set D ([WL19] §3)."""

from asperity._base.storage.provenance import Provenance
from asperity.law.engine_report import EngineReport as EngineReport
from asperity.law.file import LawFile
from asperity.law.flow import FlowReport as FlowReport
from asperity.law.friction import FrictionLaw
from asperity.law.rate import Stribeck

__all__ = ["FrictionLaw", "LawFile", "Provenance", "Stribeck"]
