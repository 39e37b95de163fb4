"""From the file of a law to predictions: scenarios, stability, what a law is.

>>> import tempfile
>>> from asperity.predict import simulate_scenario, write_example
>>> scenario, law = write_example("sliding point", tempfile.mkdtemp())
>>> result = simulate_scenario(scenario)
>>> [(one.name, round(one.value, 4)) for one in result.quantities[:2]]
[('end point e1', 0.1652), ('end point e2', 0.1409)]
"""

from asperity.predict.bands import PredictionBands as PredictionBands
from asperity.predict.bands import Region as Region
from asperity.predict.bands import propagate
from asperity.predict.examples import write_example
from asperity.predict.law_sheet import LawSheet as LawSheet
from asperity.predict.law_sheet import describe_law
from asperity.predict.scenario import Scenario
from asperity.predict.simulation import Simulation as Simulation
from asperity.predict.simulation import simulate_scenario
from asperity.predict.squeal_sheet import SquealSheet as SquealSheet
from asperity.predict.squeal_sheet import describe_squeal
from asperity.predict.stability_sheet import Belt, describe_stability
from asperity.predict.stability_sheet import StabilitySheet as StabilitySheet

__all__ = [
    "Belt",
    "Scenario",
    "describe_law",
    "describe_squeal",
    "describe_stability",
    "propagate",
    "simulate_scenario",
    "write_example",
]
