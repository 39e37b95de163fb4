"""Motions of systems: time stepping, event-driven integration, what is kept of both."""

from asperity.runs.comparison import PathComparison, compare_path
from asperity.runs.event import Event, EventKind
from asperity.runs.event_driven import integrate
from asperity.runs.motion import Motion
from asperity.runs.origin import EventDriven, Origin, TimeStepping
from asperity.runs.section import Section
from asperity.runs.state import State
from asperity.runs.time_stepping import simulate
from asperity.runs.trajectory import Trajectory

__all__ = [
    "Event",
    "EventDriven",
    "EventKind",
    "Motion",
    "Origin",
    "PathComparison",
    "Section",
    "State",
    "TimeStepping",
    "Trajectory",
    "compare_path",
    "integrate",
    "simulate",
]
