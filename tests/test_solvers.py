"""All solvers on the same problems."""

from collections import Counter

import asperity as asp
import numpy as np
import pytest
from asperity import (
    Auto,
    Exact,
    ProxGaussSeidel,
    ProximalPoint,
    ProxJacobi,
    SemismoothNewton,
    Status,
)
from profiles import counts
from samples import PLANE_LAWS, TILTED_ELLIPSES, identify, random_problem

SOLVERS = [
    Exact(),
    ProxGaussSeidel(),
    ProxJacobi(),
    Auto(),
    Auto(without=("admm", "interior_point")),
    ProximalPoint(),
    SemismoothNewton(),
]
LAWS = [*PLANE_LAWS, asp.FrictionLaw.isotropic(0.4, dimension=1)]

every_solver = pytest.mark.parametrize("solver", SOLVERS, ids=identify)


def problems(seed, count):
    rng = np.random.default_rng(seed)
    for _ in range(count):
        contacts = int(rng.integers(1, 6))
        yield random_problem(rng, LAWS, contacts, rng.random(contacts) < 0.5)


@counts(2500, 10_000)
def test_solvers_agree_where_the_solution_is_unique(count):
    """Problems of one to five contacts, unilateral and prescribed, p = 1 and 2."""
    compared = different = ambiguous = 0
    unsolved = Counter()
    for problem in problems(2019, count):
        solutions = [
            problem.solve(solver, tolerance=1e-12, on_failure="record") for solver in SOLVERS
        ]
        for solution in solutions:
            assert solution.converged == (problem.residual(solution.percussion) <= 1e-12)
            check_ambiguity(problem, solution)
        unsolved.update(
            solver for solver, one in zip(SOLVERS, solutions, strict=True) if not one.converged
        )
        if any(one.ambiguous for one in solutions):
            ambiguous += 1
        elif all(one.converged for one in solutions):
            first = solutions[0].percussion
            # The residual is relative: so is what is left of the error.
            size = max(1.0, np.abs(first).max())
            off = max(np.abs(one.percussion - first).max() for one in solutions[1:])
            if off > 1e-9 * size and len({tuple(one.phase) for one in solutions}) > 1:
                # Contacts together may have several solutions though each of them alone has one.
                different += 1
                continue
            compared += 1
            assert off <= 1e-9 * size
    assert compared >= 0.99 * count
    assert ambiguous > 0
    assert max(unsolved.values()) <= 2e-3 * count
    assert unsolved[Auto()] == 0
    assert different <= 5e-4 * count


def check_ambiguity(problem, solution):
    """What is reported of a contact is what the list of its solutions says."""
    if not solution.converged:
        return
    for contact in np.flatnonzero(solution.ambiguous_contacts):
        listed = problem.solutions(contact, percussion=solution.percussion)
        assert len(listed) > 1 or listed[0].degenerate
        rows = problem.row_slices[contact]
        distances = [np.abs(one.percussion - solution.percussion[rows]).max() for one in listed]
        # Next to a double root the tolerance of an iteration counts with its square root.
        assert min(distances) < 1e-7


@every_solver
def test_every_solver_meets_the_tolerance_it_reports(solver):
    for problem in problems(7, 50):
        solution = problem.solve(solver, on_failure="record")
        if solution.status is Status.CONVERGED:
            assert problem.residual(solution.percussion) <= 1e-10


@every_solver
def test_warm_start_from_the_solution_takes_few_iterations(solver):
    problem = next(problems(3, 1))
    cold = problem.solve(solver)
    warm = problem.solve(solver, start=cold)
    # The prox solvers look at the residual every ten iterations.
    assert warm.iterations <= 10
    assert warm.iterations <= cold.iterations
    np.testing.assert_allclose(warm.percussion, cold.percussion, atol=1e-9)


def test_constant_step_fails_where_the_adaptive_one_converges():
    # r λ_max(G) = 1 exceeds 2 α where D is thin within C, so that stick cannot be reached there.
    law = TILTED_ELLIPSES
    assert 2 * law.alpha_min < 1.0
    theta = np.linspace(0.0, np.pi, 1000)
    thin = theta[np.argmin(law.direction.radius(theta) / law.reservoir.radius(theta))]
    load = 0.95 * law.reservoir.radius(thin) * np.array([np.cos(thin), np.sin(thin)])
    problem = asp.ContactProblem(np.eye(2), free_velocity=load, laws=law, normal_force=1.0)
    adaptive = problem.solve(ProxJacobi())
    assert adaptive.phase.tolist() == [asp.Phase.STICK]
    constant = problem.solve(ProxJacobi(r=1.0, max_iterations=20_000), on_failure="record")
    assert constant.status is Status.MAX_ITERATIONS
    assert constant.residual > 1e-3
    with pytest.raises(asp.ConvergenceError, match="iteration limit") as caught:
        problem.solve(ProxJacobi(r=1.0, max_iterations=20_000))
    assert caught.value.residual == constant.residual
    assert caught.value.contact == 0


def test_time_limit_is_reported():
    problem = next(
        problem for problem in problems(11, 50) if problem.solve(ProxJacobi()).iterations > 200
    )
    solution = problem.solve(
        ProxJacobi(max_iterations=10**9), tolerance=1e-300, time_limit=0.05, on_failure="record"
    )
    assert solution.status is Status.TIME_LIMIT


@every_solver
def test_same_input_same_bits(solver):
    for problem in problems(5, 10):
        first, second = (problem.solve(solver, on_failure="record") for _ in range(2))
        assert first == second


def test_thin_reservoirs_say_that_rounding_limits_them():
    law = asp.FrictionLaw.associated(asp.Ellipse(1.0, 1e-8, angle=0.3))
    rng = np.random.default_rng(1)
    for _ in range(200):
        problem = asp.ContactProblem(
            np.eye(2), free_velocity=rng.normal(size=2), laws=law, normal_force=1.0
        )
        solution = problem.solve(on_failure="record")
        assert solution.status in (asp.Status.CONVERGED, asp.Status.INEXACT)
        assert solution.residual < 1e-7
