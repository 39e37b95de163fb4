"""Every public object: repr, pickle, copy, equality, hash, immutability, replace."""

import contextlib
import copy
import dataclasses
import functools
import inspect
import pickle
import sys
from collections.abc import Mapping, MutableMapping

import asperity as asp
import numpy as np
import pytest
import scipy.sparse
from asperity._base.value import Value, _check_of
from asperity.identify import Configuration, fit_law
from numpy.typing import NDArray
from samples import ALL_SETS, LAWS, PLANE_LAWS, identify, public_of
from scipy.sparse import coo_array, csc_array, csr_array, csr_matrix

LAW = PLANE_LAWS[3]
PROBLEM = asp.ContactProblem(
    np.eye(3), free_velocity=[-1.0, 0.2, 3.0], laws=LAW, normal_restitution=0.5
)
MESH = asp.MeshContacts(LAW, coordinates=[[0, 1, 2]], velocity=[1.0, 2.0, 0.0], gap=0.1)
REDUCED = asp.reduce(
    asp.LinearSystem(
        scipy.sparse.identity(3),
        stiffness=scipy.sparse.diags_array([4.0, 5.0, 6.0]),
        force=[0.0, 0.0, -1.0],
        contacts=MESH.replace(gap=0.0),
    ),
    band=(0.0, 5.0),
)
CONTACT = asp.Contact(LAW, direction=np.eye(2), normal_force=1.0, velocity=[0.0, -1.0])
MOTION = asp.simulate(asp.SlidingPoint(1.0, law=LAW), dt=0.01, t_end=0.1, u0=[1.0, 0.0])
BELT = asp.MassOnBelt(
    1.0,
    stiffness=1.0,
    law=asp.FrictionLaw.isotropic(1.0).replace(rate=asp.Stribeck(0.1)),
    normal_force=1.0,
    belt_velocity=[0.1, 0.2],
)
CYCLE = asp.limit_cycle(BELT)
ENSEMBLE = asp.simulate_many(BELT, dt=0.1, t_end=1.0, u0=[[0.0, 0.0], [0.1, 0.0]], keep="extent")
CYCLES = asp.limit_cycle_many([BELT])
SIGNAL = asp.Signal([0.0, 1.0, 2.0], [0.5, 1.0, 0.5], interpolation="cubic", periodic=True)
SHAKER = asp.Sine([0.0, 1e-3, 0.0], frequency=50.0, phase=[0.1, 0.0, 0.0], offset=0.1)
SUMMARISED = (
    asp.runs.PathComparison,
    asp.Trajectory,
    asp.Motion,
    asp.LimitCycle,
    asp.ensemble.Ensemble,
    asp.ensemble.CycleEnsemble,
    asp.BifurcationDiagram,
    asp.steady_sliding.CriticalIntervals,
    asp.steady_sliding.GrowthChart,
    asp.contact.ContactSolution,
)

VALUES = [
    *ALL_SETS,
    *LAWS,
    LAW.replace(rate=asp.Stribeck(0.1)),
    asp.law.FlowReport(1.001, 0.0, 0.1, 1e-3, misfit=0.02, samples=36, order=7, noise=0.01),
    asp.law.EngineReport(
        "bullet",
        "3.25",
        axes="x",
        deviation="none",
        source="run",
        angle=0.1,
        creep=0.01,
        end_error=0.0,
    ),
    asp.FrictionLaw.like("exudyn", dryFriction=(0.5, 0.4), dryFrictionAngle=0.3),
    asp.Stribeck(0.1, ratio=0.5, shape="hyperbolic", exponent=2.0, viscous=0.1),
    asp.LawFile(LAW, provenance=asp.Provenance(note="dry")),
    asp.Provenance(
        asperity="0.2.0",
        date="2026-11-22",
        made_by="asperity identify",
        files=[("run.csv", "0f")],
        configuration={"file": {"header": 2}},
    ),
    asp.sets.Cone([[[1.0, 0.0], [0.0, 1.0]]]),
    asp.sets.Cone([[]], dimension=2),
    asp.sets.Cone([], dimension=2),
    asp.sets.Verdict(True, exact=True, tolerance=0.0, defect=0.0, witness=None),
    asp.sets.Verdict(False, exact=False, tolerance=1e-9, defect=0.1, witness=[[1.0, 0.0]]),
    PROBLEM,
    asp.ContactProblem(np.eye(4), free_velocity=np.ones(4), laws=LAW, normal_force=[1.0, 2.0]),
    PROBLEM.replace(delassus=csc_array(np.eye(3))),
    asp.ContactProblem.from_bodies(
        2.0 * np.eye(3), directions=csr_matrix(np.eye(3)), free_velocity=[-1.0, 0.2, 3.0], laws=LAW
    ),
    PROBLEM.solve(),
    PROBLEM.solve().certificate,
    asp.contact.Stage("newton", 7, 6, 1e-9),
    asp.contact.Island((0, 2), asp.Status.CONVERGED, 1e-12, 3),
    asp.contact.Infeasibility(
        kind="closing",
        contact=1,
        direction=[0.4, 0.0, 0.6, 0.0],
        closing_velocity=0.2,
        residual=1e-16,
    ),
    asp.contact.Infeasibility(
        kind="cases",
        contact=0,
        direction=[1.0, 0.0],
        closing_velocity=0.2,
        residual=0.0,
        cases=[0, [-1.0, 0.0], [1.0, 0.5]],
    ),
    *PROBLEM.solutions(0),
    asp.Exact(),
    asp.Exact(max_sweeps=5),
    asp.ProxJacobi(r=0.1),
    asp.ProxGaussSeidel(),
    asp.Auto(),
    asp.Auto(without="admm", threads=2),
    asp.SemismoothNewton(),
    asp.ProximalPoint(max_iterations=3),
    asp.InteriorPoint(),
    asp.ADMM(),
    CONTACT,
    asp.Contact(LAW, direction=np.eye(2), normal=[0.0, 1.0], gap=0.2, normal_restitution=0.4),
    asp.ContactLaw(LAW),
    asp.LinearSystem(
        2.0,
        stiffness=[1.0, 2.0],
        force=[0.0, 1.0],
        contacts=[CONTACT],
        constraint_rows=[[1.0, 0.0]],
        constraint=[0.5],
    ),
    MESH,
    asp.LinearSystem(csc_array(np.eye(3)), stiffness=[1.0, 2.0, 3.0], contacts=[MESH]),
    asp.SlidingPoint(0.018, law=LAW),
    asp.SlidingDisk(LAW, velocity=(1.0, 0.5), spin=2.0),
    asp.MassOnBelt(1.0, stiffness=2.0, law=LAW, normal_force=1.0, belt_velocity=[1.0, 0.0]),
    MOTION,
    asp.State([0.1], [0.2], t0=1.0, steps=3, dt=0.1, contacts=np.ones((1, 16))),
    asp.Section([1.0, 0.0], 0.5, after=1.0),
    asp.runs.Event(0.5, "stick", 0, asp.Phase.STICK, ambiguous=True),
    CYCLE.motion,
    MOTION.labels,
    MOTION.origin,
    MOTION.options,
    CYCLE.motion.options,
    CYCLE,
    ENSEMBLE,
    CYCLES,
    asp.ensemble.MemberFailure((1, 2), 0.5, ValueError("no")),
    asp.equilibrium(BELT),
    REDUCED,
    asp.BifurcationDiagram(
        "speed", [0.1, 0.2], [asp.stability(BELT), None], [CYCLE, None], ["", "stuck"]
    ),
    asp.Body(
        1.3, inertia=(1.0, 2.0, 2.9), orientation=(0.5, 0.1, -0.7, 0.2), torque=(0.0, 0.1, 0.0)
    ),
    asp.Body.ball(1.0, radius=0.1),
    asp.PlanarBody(1.0, inertia=0.1, angle=0.3),
    asp.Plane(),
    asp.Plane(normal=(0.3, -0.2, 0.7), axis=(1.0, 0.1, 0.3), spin=1.0, body=1),
    asp.Line(velocity=0.2),
    asp.BodyAxis((0.3, 0.1, 0.7)),
    asp.PointPlane(
        0, point=(0.0, 0.1, 0.0), plane=asp.Plane(), law=LAW, frame=asp.BodyAxis((1.0, 1.0, 0.0))
    ),
    asp.PointPlane(
        0,
        point=(0.0, 0.0, 0.0),
        plane=asp.Plane(),
        law=asp.FrictionLaw.associated(asp.CoulombContensou(0.3)),
        frame="polar",
        patch_radius=0.1,
    ),
    asp.SpherePlane(
        0, radius=0.1, plane=asp.Line(), law=asp.FrictionLaw.isotropic(0.3, dimension=1)
    ),
    asp.BoxPlane(0, half_sizes=(0.1, 0.2, 0.3), plane=asp.Plane(), law=LAW, normal_restitution=0.3),
    asp.SphereSphere(0, radius=0.1, other=1, other_radius=0.2, law=LAW, center=(0.1, 0.0, 0.0)),
    asp.Spring(0, point=(0.1, 0.0), stiffness=2.0),
    SIGNAL,
    SHAKER,
    asp.Sine(1.0, frequency=2.0),
    asp.PlaneMotion(displacement=SHAKER, rotation=SHAKER),
    asp.FrictionRegions([([(0.0, 0.0), (1.0, 0.0), (1.0, 1.0)], 0.5)], elsewhere=0.8),
    asp.FrictionRaster([[1.0, 0.5], [0.3, 0.2]], x1=[0.0, 1.0], x2=[0.0, 2.0]),
    asp.Plane(velocity=asp.Sine([1.0, 0.0], frequency=2.0), spin=SIGNAL, motion=asp.PlaneMotion()),
    asp.Line(motion=asp.PlaneMotion(rotation=SIGNAL)),
    asp.Body.ball(1.0, radius=0.1, force=SHAKER),
    asp.Spring(0, point=(0.1, 0.0), stiffness=2.0, length=asp.Sine(0.1, frequency=1.0, offset=0.2)),
    asp.compare_path(MOTION, MOTION),
    asp.critical_directions(
        asp.FrictionLaw(asp.Ellipse(3.0, 1.0, angle=0.5), asp.Ellipse(3.0, 1.0))
    ),
    asp.growth_chart(BELT, phi=[0.0, 0.1, 0.2], zeta=[0.0, 0.5]),
    asp.RigidBodies(
        [asp.Body.ball(1.0, radius=0.1), asp.Body.ball(2.0, radius=0.2)],
        pairs=[asp.SphereSphere(0, radius=0.1, other=1, other_radius=0.2, law=LAW)],
        springs=[asp.Spring(0, point=(0.1, 0.0, 0.0), other=1, stiffness=2.0)],
        joints=[asp.Weld(0, other=1), asp.Weld(1)],
    ),
    asp.Hinge(0, other=1, anchor=(0.1, 0.0, 0.0), axis=(0.0, 3.0, 4.0)),
    asp.Hinge(0, anchor=(0.1, 0.0)),
    asp.Slider(0, anchor=(0.1, 0.0), axis=(0.0, 1.0)),
    asp.Weld(0, other=1),
]
NAMES = public_of(asp)

every_value = pytest.mark.parametrize("value", VALUES, ids=identify)


def test_every_public_class_is_among_the_values():
    classes = {
        kind
        for kind in NAMES.values()
        if inspect.isclass(kind)
        and issubclass(kind, Value)
        and kind not in (asp.StarSet, asp.solvers.Solver)
    }
    assert classes == {type(value) for value in VALUES}


@every_value
def test_repr_is_the_constructor_call(value):
    if isinstance(value, SUMMARISED):
        assert repr(value).startswith(f"<{type(value).__name__}: ")
    else:
        assert eval(repr(value), {**NAMES, "csr_array": csr_array, "csc_array": csc_array}) == value


def test_long_curves_are_not_printed():
    theta = np.linspace(0.0, 2.0 * np.pi, 180, endpoint=False)
    law = asp.FrictionLaw(asp.PolarCurve(theta, np.full(180, 0.3)), asp.Disk(0.3))
    assert str(law).startswith("FrictionLaw(PolarCurve(<180 numbers>, <180 numbers>), ")
    assert str(asp.Ellipse(0.3, 0.2)) == repr(asp.Ellipse(0.3, 0.2))
    assert str(MOTION) == repr(MOTION)


def test_sizes_of_sets_are_numbers():
    for disk, axis in ((asp.Disk(0.3), 0.3), (asp.Ball(2.0), 2.0)):
        assert isinstance(disk.radius, float)
        assert disk.radius == axis
        assert type(pickle.loads(pickle.dumps(disk.radius))) is float
    assert asp.Disk(0.3).radius(np.zeros(2)).tolist() == [0.3, 0.3]
    assert asp.Ellipse(0.4, 0.3).a == 0.4


@every_value
def test_pickle_and_copies_are_equal(value):
    for protocol in range(pickle.HIGHEST_PROTOCOL + 1):
        assert pickle.loads(pickle.dumps(value, protocol)) == value
    assert copy.copy(value) == copy.deepcopy(value) == value


@every_value
def test_equal_objects_have_equal_hashes_and_others_differ(value):
    twin = pickle.loads(pickle.dumps(value))
    assert twin is not value
    assert hash(twin) == hash(value)
    assert {value: 1}[twin] == 1
    assert value != object()
    assert sum(value == other for other in VALUES) == 1


@every_value
def test_values_cannot_be_changed(value):
    name = next(iter(inspect.signature(type(value)).parameters))
    with pytest.raises(AttributeError, match="immutable"):
        setattr(value, name, 1.0)
    with pytest.raises(AttributeError, match="immutable"):
        delattr(value, name)
    for array in value._parameters.values():
        if isinstance(array, np.ndarray):
            assert not array.flags.writeable


def fitted():
    """Values of `identify` and others that hold mappings."""
    phi = np.linspace(0.0, 6.0 * np.pi, 400, endpoint=False)
    ray = np.stack([np.cos(phi), np.sin(phi)], axis=-1)
    noise = 1e-3 * np.random.default_rng(1).normal(size=ray.shape)
    fit = fit_law((phi, 0.3 * ray + noise), reservoir="ellipse", direction="circle")
    sections = {"units": {"angle": "deg"}, "no_load": {"files": ["a.csv", "b.csv"]}}
    return [
        fit,
        Configuration(sections),
        asp.stability(BELT),
        asp.Provenance(configuration=sections),
    ]


def test_no_mapping_of_a_value_can_be_changed():
    """What it holds and what it answers, and what these hold, are views."""
    seen, met = set(), 0

    def walk(part, name):
        nonlocal met
        if id(part) in seen:
            return
        seen.add(id(part))
        assert not isinstance(part, MutableMapping), name
        if isinstance(part, Mapping):
            met += 1
            with pytest.raises(TypeError):
                part[next(iter(part), "")] = None
            with pytest.raises(AttributeError):
                part.pop(next(iter(part), ""))
            for key, one in part.items():
                walk(one, f"{name}[{key!r}]")
        elif isinstance(part, tuple):
            for k, one in enumerate(part):
                walk(one, f"{name}[{k}]")
        elif isinstance(part, Value) or dataclasses.is_dataclass(part):
            kind = type(part)
            for attribute in {*dir(kind), *vars(part)} - {"_abc_impl"}:
                if not attribute.startswith("_") and not isinstance(part, type):
                    found = inspect.getattr_static(part, attribute)
                    answers = isinstance(found, property | functools.cached_property)
                    if answers or attribute in vars(part):
                        # Some questions have no answer for some values.
                        with contextlib.suppress(asp.AsperityError):
                            walk(getattr(part, attribute), f"{name}.{attribute}")

    for value in (*VALUES, *fitted()):
        walk(value, type(value).__name__)
    assert met > 20
    fit, configuration = fitted()[:2]
    assert pickle.loads(pickle.dumps(fit.parameters)) == copy.deepcopy(fit.parameters)
    assert configuration.replace() == configuration == pickle.loads(pickle.dumps(configuration))
    assert repr(configuration.sections["units"]) == "{'angle': 'deg'}"


def test_arrays_made_of_those_of_a_result_may_be_written_into():
    motion = asp.integrate(asp.LinearSystem(1.0, stiffness=1.0), t_end=1.0, q0=[1.0])
    moved = motion.q.copy()
    moved += 1.0
    np.multiply(moved, 2.0, out=moved)
    assert moved.tolist() == (2.0 * (np.array(motion.q) + 1.0)).tolist()
    with pytest.raises(ValueError, match="read-only"):
        np.multiply(moved, 2.0, out=motion.q)


@every_value
def test_parameters_are_those_of_the_signature(value):
    assert set(value._parameters) == set(inspect.signature(type(value)).parameters)
    assert value.replace() == value


@pytest.mark.parametrize("kind", [csr_array, csc_array, coo_array, csr_matrix])
def test_sparse_operators_of_one_content_are_one_value(kind):
    dense = np.array([[2.0, 0.5, 0.0], [0.5, 1.0, 0.1], [0.0, 0.1, 1.0]])
    problem = PROBLEM.replace(delassus=kind(dense))
    assert problem == PROBLEM.replace(delassus=csr_array(dense))
    assert hash(problem) == hash(PROBLEM.replace(delassus=csr_array(dense)))
    assert problem != PROBLEM.replace(delassus=csr_array(dense + np.eye(3)))
    assert problem.delassus.has_canonical_format
    with pytest.raises(ValueError, match="read-only"):
        problem.delassus.data[0] = 1.0


def test_duplicates_are_summed_and_the_original_stays():
    twice = coo_array(([0.5, 1.5, 1.0, 1.0], ([0, 0, 1, 2], [0, 0, 1, 2])), shape=(3, 3))
    problem = PROBLEM.replace(delassus=twice)
    assert problem.delassus.toarray().tolist() == [
        [2.0, 0.0, 0.0],
        [0.0, 1.0, 0.0],
        [0.0, 0.0, 1.0],
    ]
    assert twice.nnz == 4
    original = csr_array(np.eye(3))
    kept = PROBLEM.replace(delassus=original)
    original.data[:] = 7.0
    assert kept.delassus.data.tolist() == [1.0, 1.0, 1.0]


def test_new_operators_forget_bodies_and_new_bodies_old_operators():
    free = [-1.0, 0.2, 3.0]
    bodies = asp.ContactProblem.from_bodies(
        2.0 * np.eye(3), directions=np.eye(3), free_velocity=free, laws=LAW
    )
    assert bodies.delassus.toarray().tolist() == (0.5 * np.eye(3)).tolist()
    known = bodies.replace(delassus=None, mass=bodies.mass, directions=bodies.directions)
    assert known == bodies
    assert bodies.replace(delassus=np.eye(3)).mass is None
    assert bodies.replace(mass=np.eye(3)).delassus.toarray().tolist() == np.eye(3).tolist()
    assert bodies.replace(free_velocity=np.zeros(3)).mass is not None


def test_replace_makes_a_variant():
    ellipse = asp.Ellipse(3.0, 1.0)
    assert ellipse.replace(angle=0.5) == asp.Ellipse(3.0, 1.0, angle=0.5)
    assert ellipse.angle == 0.0
    with pytest.raises(TypeError, match="axis"):
        ellipse.replace(axis=1.0)


def test_copies_of_what_is_not_known_are_equal():
    unknown = asp.contact.Stage("newton", 7, 6, float("nan"))
    again = pickle.loads(pickle.dumps(unknown))
    assert again == unknown
    assert hash(again) == hash(unknown)
    assert unknown != asp.contact.Stage("newton", 7, 6, 1.0)


def test_negative_zero_does_not_split_equal_objects():
    assert asp.Ellipse(1.0, 2.0, angle=-0.0) == asp.Ellipse(1.0, 2.0)
    assert hash(asp.sets.Mapped(asp.Disk(1.0), [[1.0, -0.0], [0.0, 1.0]])) == hash(
        asp.sets.Mapped(asp.Disk(1.0), np.eye(2))
    )


@pytest.mark.parametrize("member", [*asp.Phase, *asp.Status], ids=repr)
def test_enumerations(member):
    assert eval(repr(member), dict(NAMES)) is member
    assert pickle.loads(pickle.dumps(member)) is member


@pytest.mark.parametrize("status", asp.Status, ids=str)
def test_every_failure_has_advice(status):
    assert bool(status.advice) == (status is not asp.Status.CONVERGED)
    assert status.message


class Alias:
    """An alias as Python 3.12 and newer have them."""

    __value__ = NDArray[np.float64]


@pytest.mark.parametrize("hint", [NDArray[np.float64], Alias()], ids=["array", "alias"])
def test_fields_with_arrays_are_known_by_every_name(hint):
    """NumPy 2.5 has made its name for arrays such an alias: loaded lists stayed lists."""
    found = _check_of(hint)([1.0, 2.0], "name")
    assert isinstance(found, np.ndarray)


@pytest.mark.skipif(sys.version_info < (3, 12), reason="Python 3.11 has no such aliases")
def test_fields_with_aliases_that_take_types_are_known():
    names = {"np": np}
    exec("type Row[Kind: np.generic] = np.ndarray[tuple[int], np.dtype[Kind]]", names)
    found = _check_of(names["Row"][np.float64] | None)([1.0, 2.0], "name")
    assert isinstance(found, np.ndarray)


def test_what_belongs_to_a_class_is_no_field():
    assert "rest" in asp.Auto.STEPS
    assert list(inspect.signature(asp.Auto).parameters) == ["without", "threads"]
