"""Motions of systems: time stepping, event-driven integration, what is kept of both."""

from asperity.runs.comparison import PathComparison as PathComparison
from asperity.runs.comparison import compare_path
from asperity.runs.event import Event as Event
from asperity.runs.event import EventKind
from asperity.runs.event_driven import integrate
from asperity.runs.motion import Motion
from asperity.runs.origin import EventDriven as EventDriven
from asperity.runs.origin import Origin as Origin
from asperity.runs.origin import TimeStepping as TimeStepping
from asperity.runs.section import Section
from asperity.runs.state import State
from asperity.runs.time_stepping import simulate
from asperity.runs.trajectory import Trajectory

__all__ = [
    "EventKind",
    "Motion",
    "Section",
    "State",
    "Trajectory",
    "compare_path",
    "integrate",
    "simulate",
]
