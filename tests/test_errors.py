"""Bad input: the exception's type, the argument's name, what is allowed; pickling."""

import copy
import pickle

import asperity as asp
import numpy as np
import pytest
from asperity import DimensionError, ParameterError
from asperity.plot import plot_set, save_figure
from scipy.sparse import csr_array

DISK = asp.Disk(0.5)
LAW = asp.FrictionLaw.isotropic(0.5)
SQUARE = asp.FrictionLaw.associated(asp.Rectangle(0.5, 0.5))
LINE = asp.FrictionLaw.isotropic(0.5, dimension=1)
BLOCK = asp.SlidingPoint(1.0, law=LAW)
PROBLEM = asp.ContactProblem(np.eye(2), free_velocity=[1.0, 0.0], laws=LAW, normal_force=1.0)
PHI = np.arange(12) * np.pi / 6
UNIT = np.stack([np.cos(PHI), np.sin(PHI)], axis=-1)
from_samples = asp.FrictionLaw.from_samples


def linear(mass=1.0, **arguments):
    contact = asp.Contact(LAW, direction=np.eye(2), normal_force=1.0)
    return asp.LinearSystem(mass, contacts=[contact], **arguments)


def bodies(mass=1.0, directions=1.0, **options):
    """One contact of a point mass, with arguments to spoil."""
    mass = np.eye(3) if isinstance(mass, float) else mass
    directions = np.eye(3) if isinstance(directions, float) else directions
    return asp.ContactProblem.from_bodies(
        mass, directions=directions, free_velocity=[-1.0, 0.1, 0.0], laws=LAW, **options
    )


def broken_csr():
    """SciPy does not look at the indices of a matrix that changes under its hands."""
    matrix = csr_array(np.eye(2))
    matrix.indices[1] = 7
    return matrix


def run(**arguments):
    return asp.simulate(BLOCK, **{"dt": 0.1, "t_end": 1.0, **arguments})


BAD_INPUT = [
    # sets
    ("radius", ParameterError, lambda: asp.Disk(0.0)),
    ("radius", ParameterError, lambda: asp.Ball(-1.0)),
    ("radius", DimensionError, lambda: asp.Disk([1.0, 2.0])),
    ("dimension", DimensionError, lambda: asp.Ball(1.0, dimension=4)),
    ("dimension", ParameterError, lambda: asp.Ball(1.0, dimension=1.5)),
    ("b", ParameterError, lambda: asp.Ellipse(1.0, -1.0)),
    ("b", ParameterError, lambda: asp.Rectangle(1.0, 0.0)),
    ("a", ParameterError, lambda: asp.Ellipse("wide", 1.0)),
    ("a", ParameterError, lambda: asp.Ellipse(None, 1.0)),
    ("exponent", ParameterError, lambda: asp.Superellipse(1.0, 1.0, 0.0)),
    ("nu", ParameterError, lambda: asp.Ellipse.from_intercepts(1.0, 1.0, 2.0)),
    ("lower", ParameterError, lambda: asp.Interval(0.0, 1.0)),
    ("upper", ParameterError, lambda: asp.Interval(-1.0, -0.5)),
    ("half_widths", ParameterError, lambda: asp.Box([1.0, 0.0])),
    ("half_widths", DimensionError, lambda: asp.Box([])),
    ("half_widths", DimensionError, lambda: asp.Box([1.0] * 4)),
    ("half_widths", DimensionError, lambda: asp.Box([[1.0], [1.0, 2.0]])),
    ("matrix", ParameterError, lambda: DISK.mapped([[1.0, 1.0], [1.0, 1.0]])),
    ("matrix", DimensionError, lambda: DISK.mapped([1.0, 2.0])),
    ("set", ParameterError, lambda: asp.sets.Mapped(1.0, np.eye(2))),
    ("factor", ParameterError, lambda: DISK.scaled(0.0)),
    ("x", DimensionError, lambda: DISK.gauge([1.0, 2.0, 3.0])),
    ("x", DimensionError, lambda: DISK.gauge(1.0)),
    ("x", ParameterError, lambda: DISK.gauge_gradient([0.0, 0.0])),
    ("y", ParameterError, lambda: DISK.support_hessian([0.0, 0.0])),
    ("set", DimensionError, lambda: asp.Ball(1.0).radius(0.0)),
    ("set", DimensionError, lambda: asp.Interval(-1.0, 1.0).rotated(0.1)),
    ("set", ParameterError, lambda: asp.Superellipse(1.0, 1.0, 0.5).normal_cone([1.0, 0.0])),
    ("set", ParameterError, lambda: asp.Superellipse(1, 1, 0.5).fenchel_gap([0, 0], [1, 0])),
    ("y", DimensionError, lambda: DISK.fenchel_gap(np.ones((3, 2)), np.ones((4, 2)))),
    ("x", DimensionError, lambda: DISK.normal_cone([[1.0, 0.0]])),
    ("x", DimensionError, lambda: DISK.tangent_cone([1.0])),
    ("tolerance", ParameterError, lambda: DISK.tangent_cone([1.0, 0.0], tolerance=-1.0)),
    ("matrix", ParameterError, lambda: DISK.preimage([[1.0, 1.0], [1.0, 1.0]])),
    ("outer", DimensionError, lambda: DISK.scale_inside(asp.Ball(1.0))),
    ("outer", ParameterError, lambda: DISK.margin_inside(0.3)),
    ("n", ParameterError, lambda: DISK.boundary(0)),
    ("semi_axes", ParameterError, lambda: asp.Ellipsoid([1.0, -1.0])),
    ("semi_axes", DimensionError, lambda: asp.Ellipsoid(np.ones(4))),
    ("axes", ParameterError, lambda: asp.Ellipsoid([1.0, 2.0], axes=[[1.0, 0.0], [0.1, 1.0]])),
    ("axes", DimensionError, lambda: asp.Ellipsoid([1.0, 2.0], axes=np.eye(3))),
    ("semi_axes", ParameterError, lambda: asp.Superellipsoid([1.0, 0.0], exponent=2.0)),
    ("exponent", ParameterError, lambda: asp.Superellipsoid([1.0, 1.0], exponent=-1.0)),
    ("half_widths", ParameterError, lambda: asp.Box()),
    ("half_widths", ParameterError, lambda: asp.Box(lower=[-1.0])),
    ("half_widths", ParameterError, lambda: asp.Box([1.0], lower=[-1.0], upper=[1.0])),
    ("lower", ParameterError, lambda: asp.Box(lower=[0.0, -1.0], upper=[1.0, 1.0])),
    ("lower", DimensionError, lambda: asp.Box(lower=[-1.0], upper=[1.0, 1.0])),
    ("upper", ParameterError, lambda: asp.Box(lower=[-1.0], upper=[-0.5])),
    ("cap", ParameterError, lambda: asp.CappedRectangle(1.0, 1.0, cap=0.0)),
    ("mu", ParameterError, lambda: asp.WedgeAsperity(0.0, beta=0.3)),
    ("beta", ParameterError, lambda: asp.WedgeAsperity(0.3, beta=-0.1)),
    ("beta", ParameterError, lambda: asp.WedgeAsperity(1.2, beta=0.7)),
    ("beta", ParameterError, lambda: asp.WedgeAsperity(0.3, beta=1.6)),
    ("mu", ParameterError, lambda: asp.CoulombContensou(-0.3)),
    ("pressure", ParameterError, lambda: asp.CoulombContensou(0.3, pressure="parabolic")),
    ("vertices", DimensionError, lambda: asp.Polygon([[1.0, 0.0, 0.0]])),
    ("vertices", ParameterError, lambda: asp.Polygon([[1.0, -1.0], [0.0, 1.0]])),
    ("vertices", DimensionError, lambda: asp.star_shape([1.0, 2.0])),
    ("sets", ParameterError, lambda: asp.sets.Union([1.0])),
    ("sets", ParameterError, lambda: asp.sets.Intersection(DISK)),
    ("sets", ParameterError, lambda: asp.sets.MinkowskiSum(DISK)),
    ("parts", ParameterError, lambda: asp.sets.Cone(1.0, dimension=2)),
    ("radius", ParameterError, lambda: asp.PolarCurve(PHI, np.zeros(12))),
    ("radius", ParameterError, lambda: asp.PolarCurve(PHI, np.cos(PHI))),
    ("radius", ParameterError, lambda: asp.PolarCurve(PHI, np.ones(11))),
    ("angle", ParameterError, lambda: asp.PolarCurve([*PHI[:-1], PHI[0]], np.ones(12))),
    ("angle", ParameterError, lambda: asp.PolarCurve([*PHI[:-1], 2 * np.pi], np.ones(12))),
    ("angle", ParameterError, lambda: asp.PolarCurve(PHI[:6], np.ones(6))),
    ("angle", ParameterError, lambda: asp.PolarCurve(PHI[::4], np.ones(3))),
    ("angle", ParameterError, lambda: asp.PolarCurve(np.ones((2, 6)), np.ones(12))),
    ("support", ParameterError, lambda: asp.SupportCurve(PHI, 1.0 + 0.4 * np.cos(2 * PHI))),
    ("support", ParameterError, lambda: asp.SupportCurve(PHI, np.cos(PHI))),
    # cones and rates
    ("dimension", DimensionError, lambda: asp.sets.Cone([])),
    ("dimension", DimensionError, lambda: asp.sets.Cone([np.eye(4)])),
    ("parts", DimensionError, lambda: asp.sets.Cone([np.eye(2), np.eye(3)])),
    ("y", DimensionError, lambda: asp.sets.Cone([np.eye(2)]).distance([1.0])),
    ("cone", ParameterError, lambda: asp.sets.Cone([], dimension=2).project([1.0, 0.0])),
    ("cone", ParameterError, lambda: asp.sets.Cone([], dimension=2).polar()),
    ("speed", ParameterError, lambda: asp.Stribeck(0.0)),
    ("ratio", ParameterError, lambda: asp.Stribeck(0.1, ratio=1.2)),
    ("shape", ParameterError, lambda: asp.Stribeck(0.1, shape="linear")),
    ("exponent", ParameterError, lambda: asp.Stribeck(0.1, exponent=0.0)),
    ("viscous", ParameterError, lambda: asp.Stribeck(0.1, viscous=-1.0)),
    ("tolerance", ParameterError, lambda: DISK.contains([0.0, 0.0], tolerance=-1.0)),
    # laws
    ("mu", ParameterError, lambda: asp.FrictionLaw.isotropic(-0.3)),
    ("dimension", DimensionError, lambda: asp.FrictionLaw.isotropic(0.3, dimension=4)),
    ("reservoir", ParameterError, lambda: asp.FrictionLaw(0.3, DISK)),
    ("direction", ParameterError, lambda: asp.FrictionLaw(DISK, 0.3)),
    ("direction", DimensionError, lambda: asp.FrictionLaw(DISK, asp.Ball(1.0))),
    ("direction", ParameterError, lambda: asp.FrictionLaw(DISK, asp.Superellipse(1, 1, 0.5))),
    ("rate", ParameterError, lambda: LAW.replace(rate=0.1)),
    ("report", ParameterError, lambda: LAW.replace(report="good")),
    ("law", DimensionError, lambda: LINE.resistance(0.1)),
    ("slip", ParameterError, lambda: LAW.force([0.0, 0.0])),
    ("slip", ParameterError, lambda: LAW.jacobian([[1.0, 0.0], [0.0, 0.0]])),
    ("slip", DimensionError, lambda: LAW.force([1.0, 0.0, 0.0])),
    ("normal_force", ParameterError, lambda: LAW.force([1.0, 0.0], normal_force=-1.0)),
    ("normal_force", DimensionError, lambda: LAW.force(np.ones((3, 2)), normal_force=np.ones(4))),
    ("force", ParameterError, lambda: LAW.slip_direction([1.0, 0.0])),
    # laws from flow rules
    ("phi", ParameterError, lambda: from_samples([[0.0]], [[1.0, 0.0]])),
    ("phi", ParameterError, lambda: from_samples(["a"], [[1.0, 0.0]])),
    ("force", ParameterError, lambda: from_samples(PHI, UNIT[:-1])),
    ("force", ParameterError, lambda: from_samples(PHI, -UNIT)),
    ("force", ParameterError, lambda: from_samples(PHI, np.zeros((12, 2)))),
    ("phi", ParameterError, lambda: from_samples(np.zeros(12), UNIT)),
    ("phi", ParameterError, lambda: from_samples(PHI[:9], UNIT[:9])),
    ("f", ParameterError, lambda: asp.FrictionLaw.from_flow_rule(lambda phi: phi)),
    ("n", ParameterError, lambda: asp.FrictionLaw.from_flow_rule(np.cos, n=3)),
    ("tensor", ParameterError, lambda: asp.FrictionLaw.tensor_function(np.eye(2))),
    ("tensor", ParameterError, lambda: asp.FrictionLaw.tensor_function(lambda phi: np.eye(2))),
    (
        "fourth_order",
        ParameterError,
        lambda: asp.FrictionLaw.tensor(np.eye(2), fourth_order=np.eye(2)),
    ),
    ("second_order", ParameterError, lambda: asp.FrictionLaw.tensor(np.eye(3))),
    (
        "weights",
        ParameterError,
        lambda: asp.FrictionLaw.asperity(0.3, beta=(0.2, 0.3), weights=(-1.0, 1.0)),
    ),
    (
        "weights",
        ParameterError,
        lambda: asp.FrictionLaw.asperity(0.3, beta=(0.2, 0.3), weights=(0.0, 0.0)),
    ),
    ("beta", ParameterError, lambda: asp.FrictionLaw.asperity(0.3, beta=(0.2, -0.3))),
    ("beta", ParameterError, lambda: asp.FrictionLaw.asperity(0.3, beta=(0.2, 0.3, 0.4))),
    ("mu", ParameterError, lambda: asp.FrictionLaw.asperity(0.0, beta=(0.2, 0.3))),
    # contact problems
    (
        "delassus",
        DimensionError,
        lambda: asp.ContactProblem(np.eye(3), free_velocity=[1, 2], laws=LAW, normal_force=1),
    ),
    (
        "free_velocity",
        DimensionError,
        lambda: asp.ContactProblem(np.eye(4), free_velocity=np.ones(4), laws=LAW),
    ),
    ("free_velocity", DimensionError, lambda: PROBLEM.replace(free_velocity=np.ones(3))),
    ("laws", ParameterError, lambda: PROBLEM.replace(laws=[0.3])),
    ("laws", DimensionError, lambda: PROBLEM.replace(laws=[], normal_force=None)),
    ("normal_force", DimensionError, lambda: PROBLEM.replace(normal_force=[1.0, 1.0])),
    ("normal_force", ParameterError, lambda: PROBLEM.replace(normal_force=-1.0)),
    ("normal_restitution", ParameterError, lambda: PROBLEM.replace(normal_restitution=1.5)),
    (
        "tangential_restitution",
        DimensionError,
        lambda: PROBLEM.replace(tangential_restitution=[0, 0]),
    ),
    ("initial_velocity", DimensionError, lambda: PROBLEM.replace(initial_velocity=[1.0])),
    ("tolerance", ParameterError, lambda: PROBLEM.solve(tolerance=0.0)),
    ("time_limit", ParameterError, lambda: PROBLEM.solve(time_limit=-1.0)),
    ("on_failure", ParameterError, lambda: PROBLEM.solve(on_failure="ignore")),
    ("measure", ParameterError, lambda: PROBLEM.solve(measure="local")),
    ("percussion", DimensionError, lambda: PROBLEM.natural_map([1.0])),
    ("delassus", ParameterError, lambda: PROBLEM.replace(delassus=-np.eye(2))),
    ("delassus", ParameterError, lambda: PROBLEM.replace(delassus=csr_array(-np.eye(2)))),
    ("delassus", DimensionError, lambda: PROBLEM.replace(delassus=np.ones((2, 3)))),
    ("delassus", DimensionError, lambda: PROBLEM.replace(delassus=csr_array(np.ones((2, 3))))),
    ("delassus", DimensionError, lambda: PROBLEM.replace(delassus=csr_array(np.eye(3)))),
    ("delassus", DimensionError, lambda: PROBLEM.replace(delassus=np.ones(4))),
    ("delassus", ParameterError, lambda: PROBLEM.replace(delassus=broken_csr())),
    ("delassus", ParameterError, lambda: PROBLEM.replace(delassus="csr")),
    ("delassus", ParameterError, lambda: PROBLEM.replace(delassus=None)),
    ("laws", ParameterError, lambda: PROBLEM.replace(laws=[LAW.replace(rate=asp.Stribeck(0.1))])),
    (
        "normal_force",
        DimensionError,
        lambda: asp.ContactProblem(
            np.eye(6), free_velocity=np.ones(6), laws=[LAW] * 2, normal_force=[None]
        ),
    ),
    (
        "free_velocity",
        DimensionError,
        lambda: asp.ContactProblem(
            np.eye(6), free_velocity=np.ones(6), laws=[LAW] * 2, normal_force=[None, 1.0]
        ),
    ),
    ("mass", ParameterError, lambda: bodies(mass=np.diag([1.0, -1.0, 1.0]))),
    ("mass", ParameterError, lambda: bodies(mass=np.eye(3) + np.eye(3, k=1))),
    ("mass", ParameterError, lambda: bodies(mass=np.eye(3) + 2.0 * (np.ones(3) - np.eye(3)))),
    ("mass", DimensionError, lambda: bodies(mass=np.ones((3, 2)))),
    ("mass", ParameterError, lambda: bodies(mass=None)),
    ("directions", ParameterError, lambda: bodies(directions=None)),
    ("directions", DimensionError, lambda: bodies(directions=np.eye(2, 3))),
    ("directions", DimensionError, lambda: bodies(directions=np.eye(3, 4))),
    ("delassus", ParameterError, lambda: bodies(delassus=2.0 * np.eye(3))),
    ("threads", ParameterError, lambda: asp.Auto(threads=0)),
    ("max_iterations", ParameterError, lambda: asp.SemismoothNewton(max_iterations=0)),
    ("max_iterations", ParameterError, lambda: asp.ProximalPoint(max_iterations=1.5)),
    ("max_iterations", ParameterError, lambda: asp.ADMM(max_iterations=-1)),
    ("max_iterations", ParameterError, lambda: asp.InteriorPoint(max_iterations="many")),
    ("solver", ParameterError, lambda: bodies().replace(laws=SQUARE).solve(asp.InteriorPoint())),
    ("solver", ParameterError, lambda: bodies().replace(laws=SQUARE).solve(asp.ADMM())),
    ("solver", ParameterError, lambda: PROBLEM.replace(laws=SQUARE).solve(asp.ADMM())),
    ("solver", ParameterError, lambda: PROBLEM.solve("exact")),
    ("start", DimensionError, lambda: PROBLEM.solve(start=[0.0])),
    ("percussion", DimensionError, lambda: PROBLEM.residual([0.0])),
    ("contact", ParameterError, lambda: PROBLEM.solutions(1)),
    ("contact", ParameterError, lambda: PROBLEM.solutions(-1)),
    ("max_sweeps", ParameterError, lambda: asp.Exact(max_sweeps=0)),
    ("r", ParameterError, lambda: asp.ProxJacobi(r=-1.0)),
    ("r", ParameterError, lambda: asp.ProxGaussSeidel(r="fast")),
    ("max_iterations", ParameterError, lambda: asp.ProxJacobi(max_iterations=1.5)),
    # systems
    ("mass", ParameterError, lambda: linear(-1.0)),
    ("mass", ParameterError, lambda: linear([[1.0, 2.0], [2.0, 1.0]])),
    ("mass", ParameterError, lambda: linear([[1.0, 1.0], [1.0, 1.0]])),
    ("mass", ParameterError, lambda: linear([[1.0, 0.5], [0.0, 1.0]])),
    ("mass", DimensionError, lambda: linear(np.ones((2, 3)))),
    ("mass", DimensionError, lambda: asp.LinearSystem([])),
    ("stiffness", DimensionError, lambda: linear(stiffness=np.eye(3))),
    ("force", DimensionError, lambda: linear(force=[1.0])),
    ("direction", DimensionError, lambda: linear([1.0, 1.0, 1.0])),
    ("contacts", ParameterError, lambda: asp.LinearSystem(1.0, contacts=[LAW])),
    ("law", ParameterError, lambda: asp.Contact(0.3, direction=np.eye(2), normal_force=1.0)),
    ("direction", DimensionError, lambda: asp.Contact(LAW, direction=[1.0, 0.0], normal_force=1.0)),
    ("normal_force", ParameterError, lambda: asp.Contact(LAW, direction=np.eye(2))),
    (
        "normal_force",
        ParameterError,
        lambda: asp.Contact(LAW, direction=np.eye(2), normal_force=-1.0),
    ),
    ("normal", DimensionError, lambda: asp.Contact(LAW, direction=np.eye(2), normal=[1.0])),
    (
        "gap",
        ParameterError,
        lambda: asp.Contact(LAW, direction=np.eye(2), normal_force=1.0, gap=0.1),
    ),
    (
        "velocity",
        DimensionError,
        lambda: asp.Contact(LAW, direction=np.eye(2), normal_force=1, velocity=[1]),
    ),
    ("mass", ParameterError, lambda: asp.SlidingPoint(0.0, law=LAW)),
    ("gravity", ParameterError, lambda: asp.SlidingPoint(1.0, law=LAW, gravity=-9.81)),
    (
        "belt_velocity",
        DimensionError,
        lambda: asp.MassOnBelt(1.0, stiffness=1.0, law=LAW, normal_force=1.0, belt_velocity=1.0),
    ),
    (
        "stiffness",
        DimensionError,
        lambda: asp.MassOnBelt(
            1.0, stiffness=np.eye(3), law=LAW, normal_force=1.0, belt_velocity=[1.0, 0.0]
        ),
    ),
    (
        "stiffness",
        ParameterError,
        lambda: (
            asp.MassOnBelt(
                1, stiffness=0, law=LAW, normal_force=1.0, belt_velocity=[1.0, 0.0]
            ).equilibrium
        ),
    ),
    # simulation
    ("dt", ParameterError, lambda: run(dt=0.0)),
    ("dt", ParameterError, lambda: run(dt=-0.1)),
    ("dt", ParameterError, lambda: run(dt=1e-320, t_end=1e10)),
    ("t_end", ParameterError, lambda: run(t_end=0.0)),
    ("q0", DimensionError, lambda: run(q0=[1.0])),
    ("sample_every", ParameterError, lambda: run(sample_every=0.0)),
    ("tolerance", ParameterError, lambda: run(tolerance=-1.0)),
    ("on_failure", ParameterError, lambda: run(on_failure="warn")),
    ("solver", ParameterError, lambda: run(solver="exact")),
    ("progress", ParameterError, lambda: run(progress=3)),
    ("system", ParameterError, lambda: asp.simulate(LAW, dt=0.1, t_end=1.0)),
    # plots
    ("set", DimensionError, lambda: plot_set(asp.Ball(1.0))),
    ("path", ParameterError, lambda: save_figure(plot_set(DISK).figure, "plot.xyz")),
]


@pytest.mark.parametrize(
    ("argument", "kind", "call"),
    BAD_INPUT,
    ids=[f"{i}-{case[0]}" for i, case in enumerate(BAD_INPUT)],
)
def test_bad_input_is_refused_by_name(argument, kind, call):
    with pytest.raises(kind) as caught:
        call()
    error = caught.value
    assert error.argument == argument
    assert str(error).startswith(f"{argument}: ")
    assert len(error.message) > 8
    assert isinstance(error, asp.AsperityError)
    assert isinstance(error, ValueError)


def test_masked_arrays_without_masked_entries_are_arrays():
    assert DISK.gauge(np.ma.array([0.3, 0.4], mask=False)) == DISK.gauge([0.3, 0.4])


MOTION = run()
EXCEPTIONS = [
    asp.AsperityError("something"),
    asp.ParameterError("dt", "must be positive, got -1.0"),
    asp.DimensionError("q0", "must have shape (2,), got (3,)"),
    asp.ConvergenceError("not solved", 3, 0.3, 1, 1e-3, "Try less"),
    asp.ConvergenceError("not solved", 3, 0.3, 1, 1e-3, "Try less", MOTION),
    asp.DivergenceError("no longer finite"),
    asp.DivergenceError("no longer finite", MOTION),
    asp.NoSolutionError("no solution", contact=0, residual=1.0),
    asp.errors.SimulationInterrupted(MOTION),
    asp.SweepError("workers have died"),
    asp.SweepError("ValueError: bad", {"phi": 0.1, "law": "wood"}, "Traceback ..."),
]


@pytest.mark.parametrize("error", EXCEPTIONS, ids=lambda error: type(error).__name__)
def test_exceptions_keep_their_state_through_pickle_and_copy(error):
    for twin in (pickle.loads(pickle.dumps(error)), copy.copy(error)):
        assert type(twin) is type(error)
        assert twin.args == error.args
        assert vars(twin) == vars(error)
        assert str(twin) == str(error)


def test_exception_hierarchy():
    assert issubclass(asp.ParameterError, ValueError)
    assert issubclass(asp.DimensionError, asp.ParameterError)
    assert issubclass(asp.ConvergenceError, RuntimeError)
    assert issubclass(asp.NoSolutionError, asp.ConvergenceError)
    assert issubclass(asp.errors.SimulationInterrupted, KeyboardInterrupt)
    assert not issubclass(asp.errors.SimulationInterrupted, Exception)


ISO = asp.FrictionLaw.isotropic(0.3)


def test_numbers_beyond_all_reason_are_named():
    problem = asp.ContactProblem(np.eye(2), free_velocity=[0.1, 0.0], laws=ISO, normal_force=1.0)
    assert problem.solve(time_limit=1e30).converged
    with pytest.raises(asp.ParameterError, match="max_sweeps"):
        asp.Exact(max_sweeps=2**70)
    block = asp.SlidingPoint(1.0, law=ISO)
    with pytest.raises(asp.ParameterError, match="sample_every"):
        asp.simulate(block, dt=0.1, t_end=1.0, sample_every=2.0**70)
    with pytest.raises(asp.ParameterError, match="dt"):
        asp.simulate(block, dt=1e-300, t_end=1.0)


LONG = asp.Polygon(asp.Disk(1.0).boundary(2000))


STAR = asp.Superellipse(1.0, 1.0, 0.5) | LONG


QUOTES = {
    "support": lambda: STAR.support([1.0, 0.0]),
    "direction": lambda: asp.FrictionLaw(LONG, STAR),
    "sum": lambda: LONG + STAR,
    "dimension of D": lambda: asp.FrictionLaw(asp.Ball(1.0), LONG),
    "dimension of &": lambda: asp.Ball(1.0) & LONG,
    "dimension of outer": lambda: asp.Ball(1.0).scale_inside(LONG),
    "number": lambda: asp.Disk(LONG),
    "point": lambda: LONG.gauge(LONG),
    "f": lambda: asp.FrictionLaw.from_flow_rule(LONG),
    "rate": lambda: asp.FrictionLaw(LONG, LONG, rate=LONG),
    "report": lambda: asp.FrictionLaw(LONG, LONG, report=LONG),
    "other": lambda: LAW.dissipates_at_least(LONG),
    "contact": lambda: asp.Contact(LONG, direction=np.eye(2), normal_force=1.0),
    "problem": lambda: asp.ContactProblem(
        np.eye(2), free_velocity=[1.0, 0.0], laws=LONG, normal_force=1.0
    ),
    "system": lambda: asp.simulate(LONG, dt=0.1, t_end=1.0),
    "solver": lambda: asp.simulate(
        asp.SlidingPoint(1.0, law=LAW), dt=0.1, t_end=1.0, u0=[1.0, 0.0], solver=LONG
    ),
}


@pytest.mark.parametrize("mistake", QUOTES.values(), ids=QUOTES.keys())
def test_messages_that_quote_a_set_are_short(mistake):
    with pytest.raises((asp.ParameterError, asp.DimensionError)) as caught:
        mistake()
    # Not in the assertion itself: pytest would quote the message.
    length = len(str(caught.value))
    assert length < 300
