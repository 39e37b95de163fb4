"""Motions of systems: time stepping, event-driven integration, what is kept of both."""

from asperity.runs.comparison import PathComparison, compare_path
from asperity.runs.event_driven import integrate
from asperity.runs.motion import Event, EventKind, Motion, Section
from asperity.runs.state import State
from asperity.runs.time_stepping import simulate
from asperity.runs.trajectory import Trajectory

__all__ = [
    "Event",
    "EventKind",
    "Motion",
    "PathComparison",
    "Section",
    "State",
    "Trajectory",
    "compare_path",
    "integrate",
    "simulate",
]
