"""Contacts without friction beside others: KKT conditions, least squares, the stepper."""

import copy

import numpy as np
import pytest
from asperity import (
    ADMM,
    ContactProblem,
    ContactStepper,
    DimensionError,
    Ellipse,
    Exact,
    FrictionLaw,
    InteriorPoint,
    NoSolutionError,
    ParameterError,
    Phase,
    ProxGaussSeidel,
    ProximalPoint,
    ProxJacobi,
    SemismoothNewton,
)
from asperity.contact.grading import natural_map, proves_no_solution
from profiles import counts
from scipy.optimize import nnls

LAWS = (
    None,
    FrictionLaw.isotropic(0.4, dimension=1),
    FrictionLaw(Ellipse(0.6, 0.4), Ellipse(0.3, 0.5)),
    FrictionLaw.isotropic(0.3, dimension=3),
    FrictionLaw.isotropic(0.5),
)
CONIC = (InteriorPoint(), ADMM(), ProximalPoint())
SOLVERS = (
    None,
    *CONIC,
    Exact(),
    ProxGaussSeidel(),
    ProxJacobi(),
    SemismoothNewton(),
)


def mixed(rng, most=6):
    """Contacts of all dimensions, one without friction, and a few more velocities than rows."""
    laws = [None, *(LAWS[k] for k in rng.integers(0, len(LAWS), rng.integers(0, most)))]
    rng.shuffle(laws)
    rows = sum(1 + (0 if law is None else law.dimension) for law in laws)
    directions = rng.normal(size=(rows + 8, rows))
    speed = rng.normal(size=rows + 8)
    return laws, directions, speed


@counts(40, 2000)
def test_every_solver_meets_the_conditions(count):
    rng = np.random.default_rng(0)
    for seed in range(count):
        laws, directions, speed = mixed(rng)
        problem = ContactProblem.from_bodies(
            np.eye(len(speed)), directions=directions, free_velocity=directions.T @ speed, laws=laws
        )
        first = [rows.start for rows, law in zip(problem.row_slices, laws, strict=True) if not law]
        for solver in SOLVERS:
            found = problem.solve(solver, tolerance=1e-9)
            xi = directions.T @ (speed + directions @ found.percussion)
            size = np.abs(found.percussion).max() + np.abs(speed).max()
            for row in first:
                push, gap = found.percussion[row], xi[row]
                assert push >= -1e-10 * size
                assert gap >= -1e-7 * size
                assert push * gap <= 1e-7 * size**2, (seed, solver)
            assert natural_map(problem, found.percussion) == pytest.approx(
                found.natural_map, abs=1e-12
            )
            assert found.natural_map < 1e-8
            assert found.certificate == problem.certificate(found.percussion)


@counts(30, 1000)
def test_contacts_without_friction_alone_are_least_squares(count):
    """The velocities with ξ ≥ 0 that are nearest to those without percussions."""
    rng = np.random.default_rng(1)
    for _ in range(count):
        contacts = int(rng.integers(1, 9))
        directions, speed = rng.normal(size=(contacts + 8, contacts)), rng.normal(size=contacts + 8)
        problem = ContactProblem(
            directions.T @ directions, free_velocity=directions.T @ speed, laws=None
        )
        expected = nnls(directions, -speed)[0]
        assert problem.laws == (None,) * contacts
        for solver in SOLVERS:
            found = problem.solve(solver).percussion
            np.testing.assert_allclose(found, expected, atol=1e-7 * (1.0 + expected.max()))


@counts(30, 1000)
def test_they_are_those_of_the_stepper(count):
    rng = np.random.default_rng(2)
    stepper = ContactStepper(LAWS[1:])
    for _ in range(count):
        laws, directions, speed = mixed(rng, 4)
        rail = rng.normal(size=(len(speed), 1))
        rows = np.hstack([directions, rail])
        items = [LAWS.index(law) - 1 for law in laws]
        assert ContactStepper.FRICTIONLESS == -1
        stepper.forget()
        step = stepper.solve(
            rows.T @ rows, free_velocity=rows.T @ speed, items=[*items, ContactStepper.BILATERAL]
        )
        problem = ContactProblem.from_bodies(
            np.eye(len(speed)),
            directions=directions,
            free_velocity=directions.T @ speed,
            laws=laws,
            bilateral=rail,
            bilateral_velocity=rail.T @ speed,
        )
        found = problem.solve()
        own = np.append(found.percussion, problem.bilateral_percussion(found.percussion))
        if not step.ambiguous_items.any():
            np.testing.assert_allclose(own, step.percussion, atol=1e-7 * np.abs(own).max())
        again, _ = stepper.contact_problem()
        assert again.laws == problem.laws
        np.testing.assert_allclose(again.delassus, problem.delassus.toarray(), atol=1e-10)


@pytest.mark.parametrize("suffix", [".npz", ".hdf5"])
def test_files_and_copies_keep_them(tmp_path, suffix):
    if suffix == ".hdf5":
        pytest.importorskip("h5py")
    rng = np.random.default_rng(3)
    for laws in ([None, LAWS[1], LAWS[2], None, LAWS[1]], [None, None]):
        rows = sum(1 + (0 if law is None else law.dimension) for law in laws)
        directions = rng.normal(size=(rows, rows))
        problem = ContactProblem.from_bodies(
            np.eye(rows), directions=directions, free_velocity=rng.normal(size=rows), laws=laws
        )
        problem.save(tmp_path / f"mixed{suffix}")
        again = ContactProblem.load(tmp_path / f"mixed{suffix}")
        assert again == problem == copy.deepcopy(problem)
        assert again.laws == tuple(laws)
        assert np.array_equal(again.solve().percussion, problem.solve().percussion)


def test_a_number_of_no_law_is_refused(tmp_path):
    problem = ContactProblem(np.eye(2), free_velocity=[-1.0, 1.0], laws=[None, None])
    problem.save(tmp_path / "two.npz")
    with np.load(tmp_path / "two.npz") as source:
        parts = dict(source)
    for number in (-2, 0):
        np.savez(tmp_path / "wrong.npz", **{**parts, "law": np.array([-1, number])})
        with pytest.raises(ParameterError, match=r"law: must lie in -1\.\.-1"):
            ContactProblem.load(tmp_path / "wrong.npz")


def test_one_contact_opens_or_stops():
    """0 ≤ P ⊥ 2 P + b ≥ 0, with restitution b + e γ_B."""
    for b, percussion, phase in [(-3.0, 1.5, Phase.STICK), (3.0, 0.0, Phase.OPEN)]:
        problem = ContactProblem([[2.0]], free_velocity=[b], laws=None)
        found = problem.solve()
        assert found.percussion.tolist() == [percussion]
        assert found.phase.tolist() == [phase]
        assert [one.percussion.tolist() for one in problem.solutions(0)] == [[percussion]]
        assert problem.residual([percussion + 0.1]) > 0.01
        certificate = problem.certificate([-0.5])
        assert certificate.tension == 0.5
        assert certificate.penetration_velocity == max(0.0, 1.0 - b)
        assert certificate.cone_violation == certificate.direction_violation == 0.0
    bounced = ContactProblem(
        [[2.0]], free_velocity=[-3.0], laws=None, normal_restitution=0.5, initial_velocity=[-3.0]
    )
    assert bounced.solve().percussion.tolist() == [2.25]
    assert bounced.solve().velocity.tolist() == [1.5]


def test_what_squeezes_is_proved():
    jaws = ContactProblem([[1.0, -1.0], [-1.0, 1.0]], free_velocity=[-1.0, 0.2], laws=None)
    with pytest.raises(NoSolutionError) as caught:
        jaws.solve()
    proof = caught.value.infeasibility
    assert proof.direction.tolist() == [0.5, 0.5]
    assert proof.closing_velocity == pytest.approx(0.4)
    assert proves_no_solution(jaws, proof)


def test_cases_are_proved_with_them():
    """A hinge that friction pulls to the surface, beside a stop that it leaves or runs into."""
    hinge = np.array([0.5, 1.0])
    for stop, apart in [(1.0, 3.0), (-1.0, 9.0)]:
        w = np.append(hinge, stop)
        problem = ContactProblem(
            np.outer(w, w) + np.diag([0.0, 0.0, 0.1]),
            free_velocity=[-0.5, -1.0, apart],
            laws=[FrictionLaw.isotropic(0.6, dimension=1), None],
            normal_restitution=[0.8, 0.0],
            initial_velocity=[-0.5, -1.0, 0.0],
        )
        with pytest.raises(NoSolutionError) as caught:
            problem.solve()
        proof = caught.value.infeasibility
        assert proof.kind == "cases"
        assert proves_no_solution(problem, proof)
        weaker = problem.replace(normal_restitution=0.0)
        assert weaker.solve().converged
        assert not proves_no_solution(weaker, proof)


@pytest.mark.parametrize(
    ("options", "error", "message"),
    [
        ({"laws": [None, None], "normal_force": [None, 1.0]}, ParameterError, "normal row is all"),
        ({"laws": None, "normal_force": 1.0}, ParameterError, "normal row is all"),
        ({"laws": [None, 0.5]}, ParameterError, "or None without friction"),
        ({"laws": [None]}, DimensionError, "free_velocity"),
        ({"laws": [None, LAWS[1]]}, DimensionError, "free_velocity"),
    ],
)
def test_what_is_wrong_is_named(options, error, message):
    with pytest.raises(error, match=message):
        ContactProblem(np.eye(2), free_velocity=[-1.0, 1.0], **options)


def test_a_stepper_has_contacts_of_their_normal_row_alone():
    """Nothing moves a contact sideways: its problem is one without friction."""
    stepper = ContactStepper(LAWS[1:])
    step = stepper.solve(np.diag([2.0, 0.0, 0.0]), free_velocity=[-3.0, 0.0, 0.0], items=[1])
    problem, items = stepper.contact_problem()
    assert items.tolist() == [0]
    assert problem.laws == (None,)
    assert problem.solve().percussion.tolist() == [1.5] == step.percussion[:1].tolist()


def test_a_stepper_shares_the_load_with_them():
    """Feet of equal compliance carry a quarter each, and two of them rub: 0.3 of the half."""
    foot = np.array([[0.0, 1.0, 0.0], [0.0, 0.0, 1.0], [1.0, 0.0, 0.0]])
    rows = np.hstack([foot[:, :1], foot, foot[:, :1], foot])
    free = ContactStepper.FRICTIONLESS
    step = ContactStepper(FrictionLaw.isotropic(0.3)).solve(
        rows.T @ rows / 2.0, free_velocity=rows.T @ [0.5, 0.0, -0.1], items=[free, 0, free, 0]
    )
    quarter = 0.05
    own = [quarter, -0.3 * quarter, 0.0]
    np.testing.assert_allclose(step.percussion, [quarter, *own, quarter, *own], atol=1e-12)
    assert step.velocity[2] == pytest.approx(0.5 - 0.3 * 0.1 / 2.0)
