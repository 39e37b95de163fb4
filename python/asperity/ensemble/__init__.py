"""Many runs in one call: start states and parts of a system, broadcast as NumPy does."""

from asperity.ensemble.cycles import CycleEnsemble, limit_cycle_many
from asperity.ensemble.ends import Ensemble
from asperity.ensemble.event_driven import integrate_many
from asperity.ensemble.result import MemberFailure
from asperity.ensemble.time_stepping import simulate_many

__all__ = [
    "CycleEnsemble",
    "Ensemble",
    "MemberFailure",
    "integrate_many",
    "limit_cycle_many",
    "simulate_many",
]
