"""From measured forces to a friction law with its uncertainty, and a virtual tribometer.

>>> import asperity as asp
>>> law = asp.FrictionLaw(asp.Ellipse(0.5, 0.4), asp.Ellipse(3.0, 2.0))
>>> raw = asp.identify.VirtualTribometer(law, normal_force=9.3, turns=4, sample_rate=200.0).record()
>>> fit = asp.identify.fit_law(asp.identify.process(raw), reservoir="ellipse", direction="ellipse")
>>> fit.parameters["direction.ratio"].covers(1.5)
True

Reference: [WL19] §5.2.
"""

from asperity.identify.estimator.associativity import Associativity as Associativity
from asperity.identify.estimator.comparison import Candidate as Candidate
from asperity.identify.estimator.comparison import Comparison as Comparison
from asperity.identify.estimator.covariance import Bands as Bands
from asperity.identify.estimator.identified_law import IdentifiedLaw
from asperity.identify.estimator.law_comparison import CurveDifference as CurveDifference
from asperity.identify.estimator.law_comparison import LawComparison as LawComparison
from asperity.identify.estimator.law_comparison import compare_laws
from asperity.identify.evidence.coefficient.dependence import Dependence as Dependence
from asperity.identify.evidence.coefficient.dependence import load_dependence, speed_dependence
from asperity.identify.evidence.coefficient.result import friction_coefficient
from asperity.identify.evidence.coefficient.static import breakaway
from asperity.identify.evidence.coefficient.stribeck import fit_stribeck
from asperity.identify.evidence.forces.estimation import fit_law
from asperity.identify.evidence.forces.result import Fit
from asperity.identify.evidence.forces.selection import compare_models
from asperity.identify.evidence.paths.estimation import fit_paths
from asperity.identify.evidence.paths.launch import Launch
from asperity.identify.evidence.paths.result import FittedPath as FittedPath
from asperity.identify.evidence.paths.result import PathFit
from asperity.identify.evidence.wrenches.estimation import compare_patches, fit_patch, fit_supports
from asperity.identify.evidence.wrenches.result import PatchFit, SupportsFit
from asperity.identify.forces.averaged import Averaged as Averaged
from asperity.identify.forces.filters import low_pass
from asperity.identify.forces.measured_sets import ConvexDirection as ConvexDirection
from asperity.identify.forces.measured_sets import MeasuredSets
from asperity.identify.forces.processing import ProcessedData as ProcessedData
from asperity.identify.forces.processing import process
from asperity.identify.forces.turns import TurnAverage as TurnAverage
from asperity.identify.forces.turns import average_turns
from asperity.identify.loading import load
from asperity.identify.models.coordinates import Estimate as Estimate
from asperity.identify.models.directions import (
    CircleDirection,
    FourierDirection,
    SuperellipseDirection,
)
from asperity.identify.models.reservoirs import (
    CircleReservoir,
    FourierReservoir,
    SuperellipseReservoir,
)
from asperity.identify.records.calibration import Calibration
from asperity.identify.records.configuration import Configuration, read_raw
from asperity.identify.records.inspection import Column as Column
from asperity.identify.records.inspection import Inspection as Inspection
from asperity.identify.records.inspection import inspect_file
from asperity.identify.records.reading import read_csv
from asperity.identify.records.record import Processing, RawData, Recording
from asperity.identify.records.writing import write_raw
from asperity.identify.tribometer import VirtualTribometer

__all__ = [
    "Calibration",
    "CircleDirection",
    "CircleReservoir",
    "Configuration",
    "Fit",
    "FourierDirection",
    "FourierReservoir",
    "IdentifiedLaw",
    "Launch",
    "MeasuredSets",
    "PatchFit",
    "PathFit",
    "Processing",
    "RawData",
    "Recording",
    "SuperellipseDirection",
    "SuperellipseReservoir",
    "SupportsFit",
    "VirtualTribometer",
    "average_turns",
    "breakaway",
    "compare_laws",
    "compare_models",
    "compare_patches",
    "fit_law",
    "fit_patch",
    "fit_paths",
    "fit_stribeck",
    "fit_supports",
    "friction_coefficient",
    "inspect_file",
    "load",
    "load_dependence",
    "low_pass",
    "process",
    "read_csv",
    "read_raw",
    "speed_dependence",
    "write_raw",
]
