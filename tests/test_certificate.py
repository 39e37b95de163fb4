"""Certificates against hand calculations, and what they say at solutions."""

import asperity as asp
import numpy as np
import pytest
from asperity import Certificate, Status
from samples import LAWS, random_problem

LAW = asp.FrictionLaw.isotropic(0.5)
DEFECTS = [
    "natural_map",
    "penetration_velocity",
    "complementarity",
    "tension",
    "cone_violation",
    "direction_violation",
]


def contact(free=(-1.0, 0.2, 0.0), **options):
    return asp.ContactProblem(np.eye(3), free, LAW, **options)


@pytest.mark.parametrize(
    ("free", "percussion", "defect", "value"),
    [
        # ξ_N = −1 + 0.9
        ((-1.0, 0.2, 0.0), (0.9, -0.2, 0.0), "penetration_velocity", 0.1),
        # P_N = 2, ξ_N = 1
        ((-1.0, 0.2, 0.0), (2.0, -0.2, 0.0), "complementarity", 2.0),
        ((1.0, 0.0, 0.0), (-0.3, 0.0, 0.0), "tension", 0.3),
        # ‖P‖/μ − P_N = 1.6 − 1, times μ in the measure of C: k_C = 0.8/0.5
        ((-1.0, 0.8, 0.0), (1.0, -0.8, 0.0), "cone_violation", 0.6),
    ],
)
def test_defects_by_hand(free, percussion, defect, value):
    certificate = contact(free).certificate(percussion)
    assert getattr(certificate, defect) == pytest.approx(value)


def test_friction_in_the_wrong_direction():
    # Slip along e₂, friction along e₁: it has to turn by a right angle.
    problem = contact((-1.0, 0.5, 3.0))
    wrong = problem.certificate([1.0, -0.5, 0.0])
    assert 0.1 < wrong.direction_violation <= 1.0
    assert wrong.cone_violation < 1e-12
    right = problem.certificate(problem.solve().percussion)
    assert right.direction_violation < 1e-12


def test_restitution_belongs_to_the_velocity():
    problem = contact((-2.0, 0.0, 0.0), normal_restitution=0.5, initial_velocity=[-2.0, 0.0, 0.0])
    # ξ_N = −2 + 3 − 1
    assert problem.certificate([3.0, 0.0, 0.0]).penetration_velocity == pytest.approx(0.0)
    assert problem.certificate([2.5, 0.0, 0.0]).penetration_velocity == pytest.approx(0.5)


def test_prescribed_forces_have_no_normal_defects():
    problem = asp.ContactProblem(np.eye(2), [3.0, 4.0], LAW, normal_force=1.0)
    certificate = problem.certificate([-0.6, -0.8])
    assert certificate.cone_violation == pytest.approx(1.0)
    assert certificate.penetration_velocity == certificate.tension == 0.0
    assert certificate.complementarity == 0.0


def test_counts():
    free = [1.0, 0.0, 0.0, -1.0, 0.1, 0.0, -1.0, 3.0, 4.0]
    solution = asp.ContactProblem(np.eye(9), free, LAW).solve()
    certificate = solution.certificate
    assert (certificate.open, certificate.stick, certificate.slip) == (1, 1, 1)
    for name in DEFECTS:
        assert getattr(certificate, name) < 1e-12


def test_all_defects_vanish_at_solutions():
    rng = np.random.default_rng(17)
    for _ in range(200):
        contacts = int(rng.integers(1, 10))
        problem = random_problem(rng, LAWS, contacts, rng.random(contacts) < 0.7)
        solution = problem.solve(tolerance=1e-12, on_failure="record")
        if not solution.converged:
            continue
        size = max(1.0, np.abs(solution.percussion).max(), np.abs(solution.velocity).max())
        for name in DEFECTS:
            assert getattr(solution.certificate, name) <= 1e-9 * size**2, name
        assert solution.certificate == problem.certificate(solution.percussion)
        counted = (solution.certificate.stick, solution.certificate.slip, solution.certificate.open)
        assert sum(counted) == contacts


def test_certificate_is_that_of_the_percussions():
    problem = contact()
    solution = problem.solve()
    assert solution.certificate == problem.certificate(solution.percussion)
    assert solution.natural_map == problem.natural_map(solution.percussion)
    assert solution.certificate.natural_map == solution.natural_map
    assert solution.certificate.worst_contact == solution.worst_contact


def test_the_table_names_every_defect_with_its_unit():
    table = str(contact().certificate([0.9, -0.2, 0.0])).splitlines()
    assert len(table) == len(DEFECTS) + 1
    assert table[1].split() == ["penetration", "velocity", "1.00e-01", "m/s"]
    assert table[-1].endswith("worst 0")


def test_stages_tell_what_was_done():
    solution = contact().solve()
    assert sum(stage.iterations for stage in solution.stages) == solution.iterations
    assert all(isinstance(stage, asp.Stage) for stage in solution.stages)
    assert solution.stages is solution.stages


def test_infeasible_problems_end_with_status_and_certificate():
    """Painlevé's paradox, and a weight that nothing can carry: no percussion solves them."""
    paradox = asp.ContactProblem(
        [[1.0, 2.0], [2.0, 3.0]], [-1.0, 5.0], asp.FrictionLaw.isotropic(1.0, dimension=1)
    )
    solution = paradox.solve(on_failure="record")
    assert solution.status is Status.NO_SOLUTION
    assert isinstance(solution.certificate, Certificate)
    # Two contacts that press against each other through a body: opening velocities −1, −1 and
    # G = [[1, −1], [−1, 1]] cannot both be made positive.
    normals = np.array([[1.0, -1.0], [-1.0, 1.0]])
    squeezed = np.kron(normals, np.diag([1.0, 0.0])) + np.diag([0.0, 1.0, 0.0, 1.0])
    jammed = asp.ContactProblem(
        squeezed, [-1.0, 0.0, -1.0, 0.0], asp.FrictionLaw.isotropic(0.3, dimension=1)
    )
    solution = jammed.solve(on_failure="record", time_limit=2.0)
    assert solution.status not in (Status.CONVERGED,)
    assert solution.certificate.penetration_velocity > 0.1
    with pytest.raises(asp.ConvergenceError):
        jammed.solve(time_limit=2.0)


def test_a_failed_solve_reports_the_measure_it_was_asked_for():
    problem = random_problem(np.random.default_rng(3), [LAW], 6, [True] * 6)
    with pytest.raises(asp.ConvergenceError) as caught:
        problem.solve(asp.Exact(max_sweeps=1), measure="global", tolerance=1e-13)
    solution = problem.solve(
        asp.Exact(max_sweeps=1), measure="global", tolerance=1e-13, on_failure="record"
    )
    assert caught.value.residual == solution.natural_map


@pytest.mark.parametrize("wrong", [{"stages": ["exact"]}, {"certificate": None}])
def test_solutions_check_what_they_hold(wrong):
    with pytest.raises(asp.ParameterError) as caught:
        contact().solve().replace(**wrong)
    assert caught.value.argument in wrong
