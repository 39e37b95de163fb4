"""What readers and other engines found in problems of many contacts, kept from coming back."""

import os

import asperity as asp
import numpy as np
import pytest
from asperity.errors import NoSolutionError, ParameterError
from children import run_interrupted

LAW = asp.FrictionLaw.isotropic(0.5)


def jaws(sliding, squeeze=1e-3):
    """Two opposite walls and one body between them that slides along."""
    block = np.diag([1.0, 1.0, 1.0])
    operator = np.block([[block, block], [block, block]])
    for i, j in [(0, 3), (3, 0)]:
        operator[i, j] = -1.0
    free = np.array([-squeeze, sliding, 0.0, -squeeze, sliding, 0.0])
    return asp.ContactProblem(operator, free, LAW)


@pytest.mark.parametrize("sliding", [0.0, 1.0, 1e3])
@pytest.mark.parametrize("solver", [asp.Auto(), asp.ProximalPoint()], ids=repr)
def test_squeezed_body_has_no_solution_however_fast_it_slides(solver, sliding):
    problem = jaws(sliding)
    solution = problem.solve(solver, tolerance=1e-8, time_limit=20.0, on_failure="record")
    assert not solution.converged
    assert solution.certificate.penetration_velocity > 1e-4


def test_a_start_that_was_no_solution_does_no_harm():
    lost = jaws(1.0).solve(tolerance=1e-8, on_failure="record")
    feasible = jaws(1.0).replace(free_velocity=[-1e-3, 1.0, 0.0, 1e-3, 1.0, 0.0])
    solution = feasible.solve(start=lost)
    assert np.abs(solution.percussion).max() < 1e-1
    assert np.abs(solution.velocity).max() < 2.0


def test_contact_of_bodies_without_directions():
    directions = np.zeros((6, 6))
    directions[:3, :3] = np.eye(3)
    operator = np.diag([1.0, 1.0, 1.0, 1e-8, 1e-8, 1e-8])
    problem = asp.ContactProblem.from_bodies(
        np.eye(6), directions, [-1.0, 0.2, 0.0, -1e-9, 0.0, 0.0], LAW, delassus=operator
    )
    for solver in (asp.Auto(), asp.ProximalPoint(), asp.InteriorPoint()):
        found = problem.solve(solver, tolerance=1e-6, on_failure="record")
        assert np.isfinite(found.percussion).all()


@pytest.mark.parametrize("coupling", [1.2, 1.3])
def test_sweeps_solve_contacts_that_friction_can_pull_to_the_surface(coupling):
    block = np.array([[1.0, coupling, 0.0], [coupling, 3.0, 0.0], [0.0, 0.0, 3.0]])
    operator = np.kron(np.eye(2), block) + 0.05 * np.ones((6, 6))
    law = asp.FrictionLaw.isotropic(0.8)
    problem = asp.ContactProblem(operator, [-1.0, 0.5, 0.1, -1.0, 0.2, 0.3], law)
    solution = problem.solve()
    assert [stage.method for stage in solution.stages] == ["gauss_seidel"]


@pytest.mark.parametrize("solver", [asp.Exact(), asp.ProxGaussSeidel(), asp.Auto()], ids=repr)
def test_a_loose_tolerance_is_no_paradox(solver):
    problem = asp.problems.wall(5, 5)
    assert problem.solve(solver, tolerance=1e-2).residual <= 1e-2


def test_masses_that_couple_everything_are_refused():
    from scipy.sparse import diags_array

    n = 2000
    mass = diags_array([np.full(n, 2.0), *2 * [np.full(n - 1, -0.5)]], offsets=[0, 1, -1])
    directions = np.zeros((n, 3))
    directions[:3] = np.eye(3)
    with pytest.raises(ParameterError, match="mass: must couple"):
        asp.ContactProblem.from_bodies(mass, directions, [-1.0, 0.0, 0.0], LAW).solve()


@pytest.mark.parametrize("solver", [asp.InteriorPoint(), asp.ADMM()], ids=repr)
def test_asymmetric_intervals_are_no_cones(solver):
    law = asp.FrictionLaw.associated(asp.Interval(-0.1, 0.9))
    problem = asp.ContactProblem(np.eye(4) + 0.1, [-1.0, 3.0, -1.0, -3.0], law)
    with pytest.raises(ParameterError, match="solver"):
        problem.solve(solver)
    assert problem.solve().converged


def test_solutions_with_drilling_are_not_called_none():
    law = asp.FrictionLaw.associated(asp.CoulombContensou(0.3))
    problem = asp.ContactProblem(np.eye(4), [-1.0, 0.1, 0.0, 0.0], law)
    with pytest.raises(ParameterError, match="p = 3"):
        problem.solutions(0)


@pytest.mark.parametrize("solver", [asp.ProxGaussSeidel(), asp.ProxJacobi()], ids=repr)
def test_moving_contacts_are_not_said_to_stick(solver):
    rng = np.random.default_rng(3)
    law = asp.FrictionLaw(asp.Ellipse(0.5, 0.2), asp.Ellipse(0.2, 0.5))
    for _ in range(50):
        root = rng.normal(size=(6, 6))
        problem = asp.ContactProblem(root @ root.T + 0.1 * np.eye(6), rng.normal(size=6), law)
        solution = problem.solve(solver, tolerance=1e-6, on_failure="record")
        slips = np.linalg.norm(solution.velocity.reshape(2, 3)[:, 1:], axis=1)
        sticking = solution.phase == int(asp.Phase.STICK)
        assert not (sticking & (slips > 1e-3)).any()


def test_default_solver_follows_the_rule_of_selection():
    law = asp.FrictionLaw(asp.Ellipse(0.3, 0.1, np.deg2rad(30.0)), asp.Ellipse(3.0, 1.0))
    rng = np.random.default_rng(5)
    ambiguous = different = 0
    for _ in range(300):
        operator = np.eye(4)
        operator[:2, 2:] = operator[2:, :2] = 1e-6 * np.eye(2)
        before = rng.normal(size=4) * 0.4
        problem = asp.ContactProblem(operator, before, law, normal_force=1.0)
        first = problem.solve(asp.Exact())
        then = problem.replace(free_velocity=before + 0.05 * rng.normal(size=4))
        exact, auto = (then.solve(solver, start=first) for solver in (asp.Exact(), asp.Auto()))
        ambiguous += exact.ambiguous
        different += np.abs(exact.percussion - auto.percussion).max() > 1e-6
    assert ambiguous > 0
    assert different == 0


INTERRUPTED = """
import asperity as asp, numpy as np
problem = asp.problems.wall(12, 12)
rng = np.random.default_rng(0)
free = problem.free_velocity * (1 + 1e-2 * rng.normal(size=problem.free_velocity.size))
problem = problem.replace(free_velocity=free)
print("ready", flush=True)
try:
    while True:
        problem.solve({solver}, tolerance=1e-15, on_failure="record")
except KeyboardInterrupt:
    print("interrupted", flush=True)
"""


@pytest.mark.skipif(os.name == "nt", reason="sends SIGINT")
@pytest.mark.parametrize("solver", ["asp.Auto()", "asp.ProximalPoint()", "asp.Exact()"])
def test_ctrl_c_ends_every_phase(solver):
    found = run_interrupted(INTERRUPTED.format(solver=solver), after=1.0)
    assert found.lines == ["interrupted"]
    assert found.code == 0
    assert found.seconds < 5.0


def test_no_solution_error_needs_growth_not_only_an_approach():
    with pytest.raises(NoSolutionError):
        jaws(0.0, squeeze=1.0).solve(tolerance=1e-8)
