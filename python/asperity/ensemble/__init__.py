"""Many runs in one call: start states and parts of a system, broadcast as NumPy does."""

from asperity.ensemble.event_driven import integrate_many
from asperity.ensemble.result import Ensemble, MemberFailure
from asperity.ensemble.time_stepping import simulate_many

__all__ = [
    "Ensemble",
    "MemberFailure",
    "integrate_many",
    "simulate_many",
]
