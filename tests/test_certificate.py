"""Certificates against hand calculations, and what they say at solutions."""

import asperity as asp
import numpy as np
import pytest
from asperity import Status, problems
from asperity.contact import Certificate
from asperity.contact.grading import natural_map, proves_no_solution
from profiles import every
from samples import LAWS, random_problem
from scipy.optimize import linprog
from scipy.sparse import csc_array, hstack, vstack

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
    return asp.ContactProblem(np.eye(3), free_velocity=free, laws=LAW, **options)


@pytest.mark.parametrize(
    ("free", "percussion", "defect", "value"),
    [
        # ξ_N = −1 + 0.9
        ((-1.0, 0.2, 0.0), (0.9, -0.2, 0.0), "penetration_velocity", 0.1),
        # P_N = 2, ξ_N = 1
        ((-1.0, 0.2, 0.0), (2.0, -0.2, 0.0), "complementarity", 2.0),
        ((1.0, 0.0, 0.0), (-0.3, 0.0, 0.0), "tension", 0.3),
        # ‖P‖ − μP_N = 0.8 − 0.5
        ((-1.0, 0.8, 0.0), (1.0, -0.8, 0.0), "cone_violation", 0.3),
    ],
)
def test_defects_by_hand(free, percussion, defect, value):
    certificate = contact(free).certificate(percussion)
    assert getattr(certificate, defect) == pytest.approx(value)


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
    """Against NumPy, where the solver has not ended: it is asked of the percussions alone."""
    rng = np.random.default_rng(5)
    root = rng.normal(size=(9, 12))
    delassus, free = root @ root.T, rng.normal(size=9) - np.tile([2.0, 0.0, 0.0], 3)
    problem = asp.ContactProblem(delassus, free_velocity=free, laws=LAW)
    solution = problem.solve(asp.ProxJacobi(max_iterations=7), on_failure="record")
    percussion, certificate = solution.percussion, solution.certificate
    normal, approach = percussion[::3], (delassus @ percussion + free)[::3]
    friction = np.hypot(percussion[1::3], percussion[2::3])
    assert certificate.penetration_velocity == pytest.approx(max(0.0, -approach.min()), abs=1e-12)
    assert certificate.complementarity == pytest.approx(np.abs(normal * approach).max())
    assert certificate.tension == max(0.0, -normal.min())
    assert certificate.cone_violation == pytest.approx(
        max(0.0, (friction - 0.5 * normal).max()), abs=1e-12
    )
    assert certificate.natural_map > 1e-6
    assert certificate.natural_map == pytest.approx(natural_map(problem, percussion))
    assert certificate.worst_contact == solution.worst_contact


def test_the_table_names_every_defect_with_its_unit():
    table = str(contact().certificate([0.9, -0.2, 0.0])).splitlines()
    assert len(table) == len(DEFECTS) + 1
    assert table[1].split() == ["penetration", "velocity", "1.00e-01", "m/s"]
    assert table[-1].endswith("worst 0")


def test_stages_tell_what_was_done():
    solution = contact().solve()
    assert sum(stage.iterations for stage in solution.stages) == solution.iterations
    assert all(isinstance(stage, asp.contact.Stage) for stage in solution.stages)
    assert solution.stages is solution.stages


PARADOX = asp.ContactProblem(
    [[1.0, 2.0], [2.0, 3.0]],
    free_velocity=[-1.0, 5.0],
    laws=asp.FrictionLaw.isotropic(1.0, dimension=1),
)
"""Painlevé's paradox."""


def jaws(squeeze, sliding, law=LAW):
    """Two opposite walls and one body between them that slides along."""
    operator = np.block([[np.eye(3), np.diag([-1.0, 1.0, 1.0])]] * 2)
    operator[3:] = np.block([np.diag([-1.0, 1.0, 1.0]), np.eye(3)])
    free = np.array([-squeeze, sliding, 0.0, 0.0, sliding, 0.0])
    return asp.ContactProblem(operator, free_velocity=free, laws=law)


def test_infeasible_problems_end_with_status_and_proof():
    """Painlevé's paradox, and a body that two walls squeeze: no percussion solves them."""
    solution = PARADOX.solve(on_failure="record")
    assert solution.status is Status.NO_SOLUTION
    assert isinstance(solution.certificate, Certificate)
    assert solution.infeasibility.kind == "one_contact"
    assert solution.infeasibility.contact == 0
    squeezed = jaws(0.2, 0.0)
    solution = squeezed.solve(on_failure="record")
    assert solution.status is Status.NO_SOLUTION
    proof = solution.infeasibility
    # Each half of the approach, whatever the percussions.
    assert proof.kind == "closing"
    np.testing.assert_allclose(proof.direction, [0.5, 0, 0, 0.5, 0, 0], atol=1e-15)
    assert proof.closing_velocity == pytest.approx(0.1)
    with pytest.raises(asp.NoSolutionError) as caught:
        squeezed.solve()
    assert caught.value.infeasibility == proof
    assert PARADOX.replace(free_velocity=[1.0, 5.0]).solve().infeasibility is None


RANDOM_SYSTEMS = 200


def random_system(seed):
    """Contacts of few degrees of freedom; now and then a normal opposes a mixture of others."""
    rng = np.random.default_rng(seed)
    contacts, p, dof = (int(rng.integers(*limits)) for limits in ((2, 7), (1, 3), (2, 8)))
    directions = rng.normal(size=(dof, contacts * (1 + p)))
    if rng.random() < 0.7:
        k = int(rng.integers(1, contacts))
        mixture = directions[:, 0 : (1 + p) * k : 1 + p] @ rng.dirichlet(np.ones(k))
        directions[:, (1 + p) * k] = -mixture * rng.uniform(0.5, 2.0)
    directions *= np.exp(rng.normal(size=(dof, 1)))
    free = directions.T @ rng.normal(size=dof)
    if rng.random() < 0.5:
        free[:: 1 + p] -= rng.exponential(size=contacts) * rng.choice([1e-3, 1.0])
    law = (asp.FrictionLaw.isotropic(0.4, dimension=1), LAW)[p - 1]
    return directions, asp.ContactProblem(directions.T @ directions, free_velocity=free, laws=law)


def closes(directions, problem):
    """Whether contacts close on each other whatever the percussions, by linear programming.

    The least d·b over d ≥ 0 with W_N d = 0, Σ d = 1 (Farkas).
    """
    rows = [rows.start for rows in problem.row_slices]
    normals = directions[:, rows] / np.abs(directions).max()
    found = linprog(
        problem.free_velocity[rows],
        A_eq=np.vstack([normals, np.ones(len(rows))]),
        b_eq=np.r_[np.zeros(len(directions)), 1.0],
    )
    return found.status == 0 and found.fun < -1e-9


JAMMED = (Status.STALLED, Status.UNBOUNDED, Status.INEXACT)


def check_random_systems(seeds):
    """Return how many systems converged, are proven to close, or ended without either.

    Friction may leave problems without a solution whose normal rows alone have one.
    """
    counts = {"converged": 0, "closing": 0, "jammed": 0}
    for seed in seeds:
        directions, problem = random_system(seed)
        solution = problem.solve(tolerance=1e-9, time_limit=20.0, on_failure="record")
        closing = closes(directions, problem)
        if solution.status is Status.NO_SOLUTION:
            assert proves_no_solution(problem, solution.infeasibility), seed
            assert closing, seed
            counts["closing"] += 1
        else:
            assert not closing, seed
            # What friction jams ends without a proof.
            assert solution.converged or solution.status in JAMMED, seed
            counts["converged" if solution.converged else "jammed"] += 1
    return counts


def test_verdicts_are_those_of_linear_programming():
    counts = check_random_systems(range(RANDOM_SYSTEMS))
    assert counts["converged"] > 0.5 * RANDOM_SYSTEMS
    assert counts["closing"] > 0.3 * RANDOM_SYSTEMS
    assert 0 < counts["jammed"] < 0.05 * RANDOM_SYSTEMS


@pytest.mark.parametrize("seed", range(40))
def test_bodies_of_any_mass_with_a_solution_are_not_denied_it(seed):
    """G loses heavy bodies beside light ones: what seems to vanish in it need not vanish."""
    rng = np.random.default_rng(seed)
    contacts, dof = (int(rng.integers(*limits)) for limits in ((2, 7), (2, 8)))
    directions = rng.normal(size=(dof, 2 * contacts)) * (rng.random((dof, 2 * contacts)) < 0.6)
    directions[rng.integers(dof, size=2 * contacts), np.arange(2 * contacts)] = 1.0
    directions[:, 0] = -directions[:, 2]
    mass = np.diag(10.0 ** rng.uniform(0.0, 18.0, size=dof))
    percussion, velocity = np.zeros((contacts, 2)), np.zeros((contacts, 2))
    for p, v in zip(percussion, velocity, strict=True):
        push, slip = 10.0 ** rng.uniform(-2.0, 2.0, size=2)
        match rng.integers(3):
            case 0:
                v[:] = push, slip
            case 1:
                p[:] = push, 0.4 * push * rng.uniform(-0.98, 0.98)
            case _:
                p[:], v[1] = (push, -0.4 * push), slip
    free = velocity.ravel() - directions.T @ np.linalg.solve(mass, directions @ percussion.ravel())
    law = asp.FrictionLaw.isotropic(0.4, dimension=1)
    problem = asp.ContactProblem.from_bodies(
        mass, directions=directions, free_velocity=free, laws=law
    )
    assert problem.solve(on_failure="record", time_limit=20.0).status is not Status.NO_SOLUTION


@pytest.mark.long
@pytest.mark.parametrize("first", range(0, 10_000, 500))
def test_ten_thousand_verdicts_are_those_of_linear_programming(first):
    assert check_random_systems(range(first, first + 500))["converged"] > 250


def test_the_checker_refuses_what_proves_nothing():
    problem = jaws(0.2, 0.0)
    proof = problem.solve(on_failure="record").infeasibility
    assert proves_no_solution(problem, proof)
    d = proof.direction
    for wrong in ([1, 0, 0, 0, 0, 0], [0.5, 0.1, 0, 0.5, 0, 0], -d, 0.0 * d, d[:3]):
        assert not proves_no_solution(problem, proof.replace(direction=wrong))
    opening = problem.replace(free_velocity=-problem.free_velocity)
    assert not proves_no_solution(opening, proof)
    heavier = problem.delassus + 1e-9 * np.diag([1.0, 0, 0, 0, 0, 0])
    assert not proves_no_solution(problem.replace(delassus=heavier), proof)
    assert not proves_no_solution(problem, proof.replace(kind="one_contact"))


def test_a_failed_solve_reports_the_measure_it_was_asked_for():
    problem = random_problem(np.random.default_rng(3), [LAW], 6, [True] * 6)
    with pytest.raises(asp.ConvergenceError) as caught:
        problem.solve(asp.Exact(max_sweeps=1), measure="global", tolerance=1e-13)
    solution = problem.solve(
        asp.Exact(max_sweeps=1), measure="global", tolerance=1e-13, on_failure="record"
    )
    assert caught.value.residual == solution.natural_map


@pytest.mark.parametrize(
    "wrong", [{"stages": ["exact"]}, {"certificate": None}, {"infeasibility": "squeezed"}]
)
def test_solutions_check_what_they_hold(wrong):
    with pytest.raises(asp.ParameterError) as caught:
        contact().solve().replace(**wrong)
    assert caught.value.argument in wrong


@pytest.mark.parametrize(
    ("argument", "value"),
    [
        ("kind", "open"),
        ("contact", -1),
        ("contact", 0.7),
        ("direction", [[1.0]]),
        ("direction", [np.nan, 0.0]),
        ("closing_velocity", np.nan),
        ("closing_velocity", -0.1),
        ("residual", np.nan),
        ("residual", -1.0),
    ],
)
def test_proofs_hold_what_they_can_hold(argument, value):
    given = {"kind": "closing", "contact": 0, "direction": [1.0], "residual": 0.0}
    with pytest.raises(asp.ParameterError) as caught:
        asp.contact.Infeasibility(**{"closing_velocity": 0.1, **given, argument: value})
    assert caught.value.argument == argument


@pytest.mark.parametrize(
    "percussion",
    [np.ones(2), np.ones((3, 1)), np.ma.masked_array(np.ones(3), [1, 0, 0]), [1.0, 1.0j, 0.0]],
    ids=["short", "column", "masked", "complex"],
)
def test_second_opinions_are_asked_about_percussions(percussion):
    with pytest.raises(asp.ParameterError, match="percussion: must"):
        natural_map(contact(), percussion)
    assert natural_map(contact(), [0.9, -0.2, 0.0]) > 0.0
    with pytest.raises(asp.ParameterError, match="problem: must be of ContactProblem"):
        natural_map(np.eye(3), [0.9, -0.2, 0.0])
    with pytest.raises(asp.ParameterError, match="proof: must be of Infeasibility"):
        proves_no_solution(contact(), None)


def normals(entries, loads):
    """Contacts that meet in their normal rows, each with friction of its own."""
    count = len(loads)
    line = np.diag([0.0, 1.0])
    operator = np.kron(np.asarray(entries), np.diag([1.0, 0.0])) + np.kron(np.eye(count), line)
    free = np.zeros(2 * count)
    free[::2] = loads
    return asp.ContactProblem(
        operator, free_velocity=free, laws=asp.FrictionLaw.isotropic(0.3, dimension=1)
    )


@pytest.mark.parametrize("gap", [5e-14, 1e-13, 1e-11])
@pytest.mark.parametrize("closing", [2e-12, 1e-9, 1e-3])
def test_nearly_singular_problems_that_have_a_solution_are_not_refuted(gap, closing):
    """Both percussions are positive in rational arithmetic: they are about closing/gap."""
    problem = normals([[1.0, -1.0 + gap], [-1.0 + gap, 1.0]], [-1.0, 1.0 - closing])
    claim = asp.contact.Infeasibility(
        kind="closing",
        contact=0,
        direction=[0.5, 0.0, 0.5, 0.0],
        closing_velocity=0.5 * closing,
        residual=0.5 * gap,
    )
    assert not proves_no_solution(problem, claim)
    for solver in (asp.Auto(), asp.Exact(), asp.ProximalPoint(), asp.InteriorPoint()):
        solution = problem.solve(solver, on_failure="record", time_limit=20.0)
        assert solution.status is not Status.NO_SOLUTION


def pile_of_unequal_spheres(decades, seed):
    """Return a pile of 30 spheres whose masses lie between 10^-decades kg and 10^decades kg."""
    pile = problems.pile(4, speed=0.1, seed=seed)
    factors = 10.0 ** np.random.default_rng(seed).uniform(
        -decades, decades, pile.mass.shape[0] // 6
    )
    return asp.ContactProblem.from_bodies(
        pile.mass * np.repeat(factors, 6),
        directions=pile.directions,
        free_velocity=pile.free_velocity,
        laws=pile.laws,
    )


def takes_apart(problem, mu):
    """Whether velocities of bodies open all contacts faster than these slip, by linear programming.

    Then there is a solution, whatever the masses. The disk is replaced by a square around it.
    """
    normal, first, second = (csc_array(problem.directions)[:, row::3].T for row in range(3))
    b = problem.free_velocity.reshape(-1, 3)
    rows, right = [], []
    for one in (-1.0, 1.0):
        for two in (-1.0, 1.0):
            slip = mu * (one * first + two * second)
            rows.append(hstack([slip - normal, np.ones((len(b), 1))]))
            right.append(b[:, 0] - mu * (one * b[:, 1] + two * b[:, 2]))
    cost = np.zeros(normal.shape[1] + 1)
    cost[-1] = -1.0
    bounds = [(None, None)] * normal.shape[1] + [(None, 1.0)]
    found = linprog(cost, A_ub=vstack(rows), b_ub=np.concatenate(right), bounds=bounds)
    return found.status == 0 and found.fun < -0.5


def approaches(problem, solution):
    """Return the power of approaching contacts relative to that of the loads."""
    normal = solution.percussion[::3]
    approach = np.maximum(0.0, -solution.velocity[::3])
    return normal @ approach / (normal @ np.abs(problem.free_velocity[::3]))


@pytest.mark.parametrize(
    ("decades", "seed", "tolerance"), every(3, [(4, 9, 1e-8), (3, 1, 1e-8), (6, 2, 1e-10)])
)
def test_percussions_that_grow_are_not_without_a_solution_where_one_exists(
    decades, seed, tolerance
):
    """Heavy spheres lie on light ones. The measure does not see what is left of the third."""
    problem = pile_of_unequal_spheres(decades, seed)
    assert takes_apart(problem, 0.5)
    solution = problem.solve(tolerance=tolerance, measure="global", on_failure="record")
    assert solution.status in (Status.CONVERGED, Status.STALLED)
    assert solution.infeasibility is None
    if solution.converged:
        assert approaches(problem, solution) <= 0.01
