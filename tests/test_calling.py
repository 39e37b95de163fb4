"""One manner of calling: what a call is about comes first, everything else is given by name."""

import enum
import inspect

import asperity as asp
import pytest
from asperity import identify, mechanisms, mujoco, plot, problems, track
from asperity.contact import files, grading
from asperity.sets import StarSet
from samples import public_of

MODULES = (
    asp,
    identify,
    track,
    mujoco,
    problems,
    problems.scenes,
    mechanisms,
    plot,
    grading,
    files,
)

PAIRS = {
    "identify.compare_laws": "a law beside another one",
    "FrictionLaw": "a law is the pair (C, D)",
    "FrictionLaw.from_samples": "forces over directions: two columns of one table",
    "critical_rotation": "the pair (C, D)",
    "Section": "the hyperplane n·x = c",
    "State": "the state (q, u)",
    "incremental_distance": "the distance between two runs",
    "compare_path": "a path beside another one",
    "Signal": "values over times: two columns of one table",
    "Signal.breaks": "from a begin to an end",
    "Signal.integral": "from a begin to an end",
    "Sine.breaks": "from a begin to an end",
    "Sine.integral": "from a begin to an end",
    "Trajectory.slice": "from a begin to an end",
    "Motion.slice": "from a begin to an end",
    "ellipses_can_be_unstable": "the five numbers of one formula, in its order",
    "Ellipse.from_intercepts": "the three numbers of one formula, in its order",
    "identify.Calibration": "readings over loads: two columns of one table",
    "identify.MeasuredSets": "forces over directions: two columns of one table",
    "identify.TurnAverage": "turns over directions: two columns of one table",
    "track.MeasuredPath": "positions and their errors over time: columns of one table",
    "track.Circle": "the size of a figure, as of a set",
    "track.PlaneView.from_points": "points and where they are: two columns of one table",
    "track.PlaneView.mismatch": "points and where they are: two columns of one table",
    "identify.load": "what is read, by what configuration",
    "identify.fit_patch": "wrenches over twists: two columns of one table",
    "identify.compare_patches": "wrenches over twists: two columns of one table",
    "identify.fit_supports": "pushes, and the points of the body that was pushed",
    "identify.read_raw": "what is read, by what configuration",
    "identify.write_raw": "what is written, and where",
    "track.write_video": "what is written, and where",
    "plot.save_figure": "what is written, and where",
    "plot.save_animation": "what is written, and where",
    "contact.files.save": "what is written, and where",
    "contact.grading.natural_map": "a problem and what is said to solve it",
    "contact.grading.proves_no_solution": "a problem and the proof about it",
    "contact.files.Percussions": "the parts of a file that belong together",
    "Provenance.of_table": "a table and its name in the file",
    "sweep": "a function and where it is called",
    "mujoco.Scene": "a model, and the laws of its surfaces",
    "problems.Scene": "columns of one table of bodies and contacts",
}
"""Callables with several arguments by position, and why: none of these is more the subject."""

RESULTS = {
    "BifurcationDiagram", "ComplexModes", "ContactSolution", "CriticalIntervals",
    "CycleEnsemble", "EngineReport", "Ensemble", "Equilibrium", "Event", "FiniteElementModel",
    "FlowReport", "GrowthChart", "Island",
    "Labels", "LimitCycle", "LocalSolution", "MemberFailure", "Motion", "Origin", "PathComparison",
    "ReducedSystem", "SquealMap", "Stability", "Stage", "SweepStatus", "Trajectory",
    "identify.Associativity", "identify.Averaged", "identify.Bands", "identify.Candidate",
    "identify.Dependence", "identify.Estimate", "identify.Fit", "identify.FittedPath",
    "identify.IdentifiedLaw",
    "mujoco.Projection", "mujoco.SceneContact", "mujoco.SceneProblem", "mujoco.SceneRun",
    "mujoco.SceneStep",
    "identify.PatchFit", "identify.PathFit", "identify.SupportsFit", "track.Track",
    "track.TrackConfig",
}  # fmt: skip
"""What the library makes itself."""

ANSWERS = {
    "System", "mechanisms.FollowerPendulum", "mechanisms.FrictionalImpactOscillator",
    "identify.CircleDirection", "identify.CircleReservoir", "identify.FourierDirection",
    "identify.FourierReservoir", "identify.SuperellipseDirection", "identify.SuperellipseReservoir",
}  # fmt: skip
"""Classes whose methods the library calls itself, in the order of its own protocols."""


def positional(function, *, bound):
    """Names of the parameters that may be given by position, but for `self`."""
    places = (inspect.Parameter.POSITIONAL_ONLY, inspect.Parameter.POSITIONAL_OR_KEYWORD)
    names = [
        name for name, one in inspect.signature(function).parameters.items() if one.kind in places
    ]
    return names if bound else names[1:]


def public_callables():
    """Yield key and names of the positional parameters of all that is public."""
    seen = set()
    for module in MODULES:
        prefix = module.__name__.removeprefix("asperity").lstrip(".")
        for name, kind in public_of(module).items():
            if not (inspect.isclass(kind) or inspect.isfunction(kind)) or kind in seen:
                continue
            if not kind.__module__.startswith("asperity"):
                continue
            seen.add(kind)
            key = f"{prefix}.{name}".lstrip(".")
            if inspect.isfunction(kind):
                yield key, positional(kind, bound=True)
                continue
            if issubclass(kind, BaseException | enum.Enum):
                continue
            # Sets are known by their sizes, as in a table of figures: Ellipse(a, b).
            if key not in RESULTS and not issubclass(kind, StarSet):
                yield key, positional(kind, bound=True)
            for method in dir(kind) if key not in ANSWERS else ():
                if method.startswith("_"):
                    continue
                member, stored = getattr(kind, method), inspect.getattr_static(kind, method)
                if not (inspect.isfunction(member) or inspect.ismethod(member)):
                    continue
                original = getattr(member, "__func__", member)
                if original in seen:
                    continue
                seen.add(original)
                bound = inspect.ismethod(member) or isinstance(stored, staticmethod)
                yield f"{key}.{method}", positional(member, bound=bound)


CALLABLES = dict(public_callables())


def test_everything_but_the_subject_is_given_by_name():
    several = {key: names for key, names in CALLABLES.items() if len(names) > 1}
    methods_of_sets = {key for key in several if key.endswith(".fenchel_gap")}
    assert {key for key in several if key not in PAIRS} == methods_of_sets


def test_every_exception_is_one():
    once = {key: len(CALLABLES.get(key, ())) > 1 for key in PAIRS}
    # Of methods that two classes share the first one is walked.
    shared = {"Motion.slice", "Trajectory.slice", "Sine.breaks", "Sine.integral"}
    assert {key for key, is_one in once.items() if not is_one} <= shared


@pytest.mark.parametrize(
    "kind", [asp.Ellipse, asp.Rectangle, asp.CappedRectangle, asp.WedgeAsperity]
)
def test_sets_are_turned_by_name(kind):
    assert "angle" not in positional(kind, bound=True)


def test_the_number_of_callables_is_not_small_by_a_mistake():
    assert len(CALLABLES) > 250
