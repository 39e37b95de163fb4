"""Set-valued anisotropic dry friction: laws, solvers, motions, stability, identification.

Theory: S. V. Walker, R. I. Leine, *Set-valued anisotropic dry friction laws: formulation,
experimental verification and instability phenomenon*, Nonlinear Dynamics (2019), cited as [WL19].

>>> import asperity as asp
>>> law = asp.FrictionLaw(reservoir=asp.Ellipse(0.6, 0.3), direction=asp.Ellipse(0.5, 0.3))
>>> path = asp.simulate(
...     asp.SlidingPoint(0.1, law), dt=1e-3, t_end=1.0, u0=[1.0, 1.0], until_rest=True
... )
>>> path.status
Outcome.AT_REST
"""

from importlib import import_module as _import_module
from types import ModuleType as _ModuleType
from typing import TYPE_CHECKING as _TYPE_CHECKING

from asperity._core import __version__
from asperity.contact import (
    Certificate,
    ContactProblem,
    ContactSolution,
    Infeasibility,
    InfeasibleCase,
    LocalSolution,
    Stage,
)
from asperity.cycles import BifurcationDiagram, LimitCycle, bifurcation_diagram, limit_cycle
from asperity.errors import (
    AsperityError,
    ConfigurationError,
    ConvergenceError,
    DimensionError,
    DivergenceError,
    FitError,
    NoCycleError,
    NoSolutionError,
    ParameterError,
    RecordError,
    SimulationInterrupted,
)
from asperity.law import FlowReport, FrictionLaw, Stribeck
from asperity.runs import (
    Event,
    EventKind,
    Motion,
    PathComparison,
    Section,
    State,
    Trajectory,
    compare_path,
    integrate,
    simulate,
)
from asperity.sets import (
    Ball,
    Box,
    CappedRectangle,
    Cone,
    CoulombContensou,
    Disk,
    Ellipse,
    Ellipsoid,
    Intersection,
    Interval,
    Mapped,
    MinkowskiSum,
    PolarCurve,
    Polygon,
    Rectangle,
    StarSet,
    Superellipse,
    SupportCurve,
    Union,
    Verdict,
    WedgeAsperity,
    star_shape,
)
from asperity.solvers import (
    ADMM,
    Auto,
    Exact,
    InteriorPoint,
    ProxGaussSeidel,
    ProximalPoint,
    ProxJacobi,
    SemismoothNewton,
    Solver,
)
from asperity.status import Outcome, Phase, Status
from asperity.steady_sliding import (
    Equilibrium,
    Stability,
    critical_directions,
    critical_rotation,
    ellipses_can_be_unstable,
    equilibrium,
    growth_chart,
    incremental_distance,
    stability,
)
from asperity.system import (
    Body,
    BodyAxis,
    BoxPlane,
    Contact,
    ContactLaw,
    Line,
    LinearSystem,
    MassOnBelt,
    PlanarBody,
    Plane,
    PlaneMotion,
    PointPlane,
    RigidBodies,
    Signal,
    Sine,
    SlidingDisk,
    SlidingPoint,
    SpherePlane,
    SphereSphere,
    Spring,
    System,
)

if _TYPE_CHECKING:
    from asperity import identify as identify
    from asperity import mechanisms as mechanisms
    from asperity import plot as plot
    from asperity import problems as problems
    from asperity import track as track

__all__ = [
    "ADMM",
    "AsperityError",
    "Auto",
    "Ball",
    "BifurcationDiagram",
    "Body",
    "BodyAxis",
    "Box",
    "BoxPlane",
    "CappedRectangle",
    "Certificate",
    "Cone",
    "ConfigurationError",
    "Contact",
    "ContactLaw",
    "ContactProblem",
    "ContactSolution",
    "ConvergenceError",
    "CoulombContensou",
    "DimensionError",
    "Disk",
    "DivergenceError",
    "Ellipse",
    "Ellipsoid",
    "Equilibrium",
    "Event",
    "EventKind",
    "Exact",
    "FitError",
    "FlowReport",
    "FrictionLaw",
    "Infeasibility",
    "InfeasibleCase",
    "InteriorPoint",
    "Intersection",
    "Interval",
    "LimitCycle",
    "Line",
    "LinearSystem",
    "LocalSolution",
    "Mapped",
    "MassOnBelt",
    "MinkowskiSum",
    "Motion",
    "NoCycleError",
    "NoSolutionError",
    "Outcome",
    "ParameterError",
    "PathComparison",
    "Phase",
    "PlanarBody",
    "Plane",
    "PlaneMotion",
    "PointPlane",
    "PolarCurve",
    "Polygon",
    "ProxGaussSeidel",
    "ProxJacobi",
    "ProximalPoint",
    "RecordError",
    "Rectangle",
    "RigidBodies",
    "Section",
    "SemismoothNewton",
    "Signal",
    "SimulationInterrupted",
    "Sine",
    "SlidingDisk",
    "SlidingPoint",
    "Solver",
    "SpherePlane",
    "SphereSphere",
    "Spring",
    "Stability",
    "Stage",
    "StarSet",
    "State",
    "Status",
    "Stribeck",
    "Superellipse",
    "SupportCurve",
    "System",
    "Trajectory",
    "Union",
    "Verdict",
    "WedgeAsperity",
    "__version__",
    "bifurcation_diagram",
    "compare_path",
    "critical_directions",
    "critical_rotation",
    "ellipses_can_be_unstable",
    "equilibrium",
    "growth_chart",
    "incremental_distance",
    "integrate",
    "limit_cycle",
    "simulate",
    "stability",
    "star_shape",
]


# Matplotlib and SciPy are imported by the first use of these rooms, not before.
_ROOMS = ("identify", "mechanisms", "plot", "problems", "track")


def __getattr__(name: str) -> _ModuleType:
    if name in _ROOMS:
        return _import_module(f"asperity.{name}")
    raise AttributeError(f"module 'asperity' has no attribute {name!r}")


def __dir__() -> list[str]:
    return sorted({*__all__, *_ROOMS})
