"""Many runs in one call: start states and parts of a system, broadcast as NumPy does."""

from asperity.ensemble.cycles import CycleEnsemble as CycleEnsemble
from asperity.ensemble.cycles import limit_cycle_many
from asperity.ensemble.ends import Ensemble as Ensemble
from asperity.ensemble.event_driven import integrate_many
from asperity.ensemble.result import MemberFailure as MemberFailure
from asperity.ensemble.time_stepping import simulate_many

__all__ = [
    "integrate_many",
    "limit_cycle_many",
    "simulate_many",
]
