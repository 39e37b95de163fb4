"""Certificates against hand calculations, and what they say at solutions."""

import copy
import itertools
import pickle

import asperity as asp
import numpy as np
import pytest
from asperity import Status, problems
from asperity.contact import Certificate, grading
from asperity.contact.grading import natural_map, proves_no_solution
from asperity.errors import NoSolutionError
from random_problems import chain
from samples import BEAN, LAWS, identify, random_problem
from scipy.linalg import block_diag
from scipy.optimize import linprog
from scipy.sparse import csc_array, hstack, vstack
from scipy.sparse.linalg import lsqr

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
    problem = asp.ContactProblem(np.eye(2), free_velocity=[3.0, 4.0], laws=LAW, normal_force=1.0)
    certificate = problem.certificate([-0.6, -0.8])
    assert certificate.cone_violation == pytest.approx(0.5)
    assert certificate.penetration_velocity == certificate.tension == 0.0
    assert certificate.complementarity == 0.0


def test_a_contact_without_friction_force_is_graded_under_every_law():
    # The gauge of a reservoir with cusps has no gradient at a force of zero.
    cusped = asp.FrictionLaw.associated(asp.Disk(0.5)).replace(reservoir=BEAN)
    resting = asp.ContactProblem(np.eye(3), free_velocity=[-1.0, 0.0, 0.0], laws=cusped)
    assert natural_map(resting, [1.0, 0.0, 0.0]) == 0.0
    creeping = resting.replace(free_velocity=[-1.0, 0.1, 0.0])
    assert np.isclose(natural_map(creeping, [1.0, 0.0, 0.0]), creeping.natural_map([1.0, 0.0, 0.0]))


def test_counts():
    free = [1.0, 0.0, 0.0, -1.0, 0.1, 0.0, -1.0, 3.0, 4.0]
    solution = asp.ContactProblem(np.eye(9), free_velocity=free, laws=LAW).solve()
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


def test_certificates_of_copies_are_those_of_the_solution():
    for copied in (copy.copy, copy.deepcopy, lambda value: pickle.loads(pickle.dumps(value))):
        solution = contact().solve()
        again = copied(solution)
        assert again == solution
        assert again.certificate == solution.certificate


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


SQUEEZERS = [asp.Auto(), asp.ProximalPoint(), asp.InteriorPoint(), asp.Exact(), asp.ProxJacobi()]


@pytest.mark.parametrize("sliding", [0.0, 1.0, 1e3])
@pytest.mark.parametrize("squeeze", [1e-3, 1.0])
@pytest.mark.parametrize("solver", SQUEEZERS, ids=identify)
def test_every_solver_that_runs_away_ends_with_a_proof(solver, squeeze, sliding):
    problem = jaws(squeeze, sliding)
    solution = problem.solve(solver, tolerance=1e-8, time_limit=20.0, on_failure="record")
    assert solution.status is Status.NO_SOLUTION
    assert proves_no_solution(problem, solution.infeasibility)
    assert solution.infeasibility.closing_velocity == pytest.approx(0.5 * squeeze)


def squeezed_boxes(rng):
    """Boxes of random masses in a row between two walls that close, four contacts at every face."""
    boxes = int(rng.integers(1, 4))
    turn = np.linalg.qr(rng.normal(size=(3, 3)))[0]
    mass = 10.0 ** rng.uniform(-3, 3, size=boxes)
    size = rng.uniform(0.1, 1.0)
    inertia = [m * size**2 * np.diag(rng.uniform(0.2, 0.5, size=3)) for m in mass]
    blocks = [
        [np.diag([m] * 3) if i == j else np.zeros((3, 3)) for j in range(boxes)]
        for i, m in enumerate(mass)
    ]
    matrix = np.zeros((6 * boxes, 6 * boxes))
    for i in range(boxes):
        matrix[6 * i : 6 * i + 3, 6 * i : 6 * i + 3] = blocks[i][i]
        matrix[6 * i + 3 : 6 * i + 6, 6 * i + 3 : 6 * i + 6] = turn @ inertia[i] @ turn.T
    rows = []
    for face in range(boxes + 1):
        for y, z in [(1, 1), (1, -1), (-1, 1), (-1, -1)]:
            row = np.zeros((3, 6 * boxes))
            for box, sign, side in ((face, 1.0, -1.0), (face - 1, -1.0, 1.0)):
                if 0 <= box < boxes:
                    lever = turn @ (size * np.array([side, y, z]))
                    for k, axis in enumerate(turn.T):
                        row[k, 6 * box : 6 * box + 6] = sign * np.r_[axis, np.cross(lever, axis)]
            rows.append(row)
    directions = np.vstack(rows).T
    free = directions.T @ rng.normal(size=6 * boxes)
    # The walls close faster than any of that.
    gap = rng.uniform(0.0, 1.0)
    free[0:12:3] -= gap
    free[-12::3] -= 1.0 - gap
    return matrix, directions, free


@pytest.mark.parametrize("seed", range(20))
def test_squeezed_boxes_are_proven_to_be(seed):
    mass, directions, free = squeezed_boxes(np.random.default_rng(seed))
    dense = directions.T @ np.linalg.inv(mass) @ directions
    for problem in (
        asp.ContactProblem.from_bodies(mass, directions=directions, free_velocity=free, laws=LAW),
        asp.ContactProblem(dense, free_velocity=free, laws=LAW),
    ):
        solution = problem.solve(tolerance=1e-8, time_limit=20.0, on_failure="record")
        # Every face closes by its share of the walls' unit speed.
        assert solution.status is Status.NO_SOLUTION
        assert proves_no_solution(problem, solution.infeasibility)
        assert solution.infeasibility.direction.sum() == pytest.approx(1.0)
        wider = problem.replace(free_velocity=free + 2.0 * (np.arange(free.size) % 3 == 0))
        solved = wider.solve(tolerance=1e-8, time_limit=20.0)
        assert not proves_no_solution(wider, solution.infeasibility)
        assert solved.infeasibility is None


@pytest.mark.parametrize("tolerance", [1e-4, 1e-8, 1e-12])
def test_the_verdict_does_not_depend_on_the_tolerance(tolerance):
    for problem in (jaws(1e-3, 1.0), jaws(1.0, 0.0)):
        solution = problem.solve(tolerance=tolerance, on_failure="record", time_limit=20.0)
        assert solution.status is Status.NO_SOLUTION


@pytest.mark.parametrize("law", LAWS, ids=identify)
def test_paradoxes_are_proven_for_every_law(law):
    rng = np.random.default_rng(23)
    found = 0
    for _ in range(200):
        root = rng.normal(size=(law.dimension + 1, 3))
        block = root @ root.T + 1e-3 * np.eye(law.dimension + 1)
        # Friction that presses the contact onto the surface where it slides.
        block[0, 1:] *= 10.0
        problem = asp.ContactProblem(
            block, free_velocity=np.r_[-1.0, 10.0 * rng.normal(size=law.dimension)], laws=law
        )
        solution = problem.solve(on_failure="record")
        if solution.status is Status.NO_SOLUTION:
            found += 1
            assert proves_no_solution(problem, solution.infeasibility)
        elif not solution.converged:
            # With p = 3 the solutions of a contact are not listed: nothing tells of none.
            assert law.dimension > 2
        else:
            proof = asp.contact.Infeasibility(
                kind="one_contact",
                contact=0,
                direction=np.eye(block.shape[0])[0],
                closing_velocity=1.0,
                residual=0.0,
            )
            assert not proves_no_solution(problem, proof)
    assert found > 0 or law.dimension > 2


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


def has_a_solution(problem):
    """Whether a linear program finds one where every contact is open, sticks or slips one way.

    Of contacts on a line with one law.
    """
    count = len(problem.laws)
    mu = 1.0 / problem.laws[0].reservoir.gauge(np.array([1.0]))
    free = problem.free_velocity.copy()
    free[::2] += problem.normal_restitution * problem.initial_velocity[::2]
    # Percussions, then velocities.
    unit, motion = np.eye(4 * count), np.hstack([-problem.delassus, np.eye(2 * count)])
    for states in itertools.product(range(4), repeat=count):
        above, zero = [], []
        for k, state in enumerate(states):
            first = 2 * (count + k)
            push, pull, lift, slip = unit[[2 * k, 2 * k + 1, first, first + 1]]
            if state == 0:
                zero, above = [*zero, push, pull], [*above, lift]
            elif state == 1:
                zero, above = [*zero, lift, slip], [*above, mu * push - pull, mu * push + pull]
            else:
                sign = 1.0 if state == 2 else -1.0
                zero = [*zero, lift, pull + sign * mu * push]
                above = [*above, push, sign * slip]
        found = linprog(
            np.zeros(4 * count),
            A_ub=-np.array(above),
            b_ub=np.zeros(len(above)),
            A_eq=np.vstack([motion, *zero]),
            b_eq=np.concatenate([free, np.zeros(len(zero))]),
            bounds=(None, None),
        )
        if found.status == 0:
            return True
    return False


JAMMED = (Status.STALLED, Status.UNBOUNDED, Status.INEXACT)


def check_random_systems(seeds):
    """Return how many systems converged, are proven to close or by cases, or ended without either.

    Friction may leave problems without a solution whose normal rows alone have one.
    """
    counts = {"converged": 0, "closing": 0, "cases": 0, "jammed": 0}
    for seed in seeds:
        directions, problem = random_system(seed)
        solution = problem.solve(tolerance=1e-9, time_limit=20.0, on_failure="record")
        closing = closes(directions, problem)
        if solution.status is Status.NO_SOLUTION:
            assert proves_no_solution(problem, solution.infeasibility), seed
            assert closing is (solution.infeasibility.kind == "closing"), seed
            counts[solution.infeasibility.kind] += 1
            if not closing and problem.laws[0].dimension == 1 and len(problem.laws) <= 3:
                assert not has_a_solution(problem), seed
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
    assert 0 < counts["cases"] + counts["jammed"] < 0.05 * RANDOM_SYSTEMS


def test_verdicts_that_were_missed():
    # A contact that closes slowly.
    assert check_random_systems([6227])["closing"] == 1
    # Systems that friction jams, some of which have a solution that is hard to find.
    counts = check_random_systems((314, 704, 1697, 3682, 5264, 6752, 8130, 5557))
    assert counts["closing"] == 0
    assert counts["cases"] + counts["jammed"] >= 6
    # Systems that a change of the loads by one part in 10⁶ gives a solution: rounding decides.
    assert check_random_systems([8136, 9167])["closing"] == 0


# Bodies that friction jams: percussions up to 1e10 times the loads leave small residuals, while all
# contacts approach by a part of 1e-4 to 1e-3 of the loads.
@pytest.mark.parametrize("seed", [66, 184, 238, 244, 246])
def test_systems_that_friction_jams_are_not_solved(seed):
    directions, matrix = random_system(seed)
    mass = np.eye(len(directions))
    free, laws = matrix.free_velocity, matrix.laws
    bodies = asp.ContactProblem.from_bodies(
        mass, directions=directions, free_velocity=free, laws=laws
    )
    for problem in (matrix, bodies):
        for measure in ("contact", "global"):
            solution = problem.solve(tolerance=1e-9, measure=measure, on_failure="record")
            if solution.status is Status.NO_SOLUTION:
                # Of bodies `G` does not say enough.
                assert problem is matrix
                assert solution.infeasibility.kind == "cases"
                assert proves_no_solution(problem, solution.infeasibility)
            else:
                assert solution.status in JAMMED


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


def hinge(rng, p):
    """A contact whose rows see one direction of motion, which has bounced, and what solves it.

    ξ = b + w s with one unknown s: with ξ_N = 0 the slip is known, and so is the friction. It pulls
    the contact to the surface where w_N(w_N − w_T·x) < 0.
    """
    w = rng.normal(size=1 + p)
    free = w * -np.sign(w[0]) * rng.uniform(0.1, 2.0)
    restitution = rng.choice([0.0, 0.3, 0.8])
    law = asp.FrictionLaw.isotropic(rng.uniform(0.1, 1.5), dimension=p)
    problem = asp.ContactProblem(
        np.outer(w, w),
        free_velocity=free,
        laws=law,
        normal_restitution=restitution,
        initial_velocity=free,
    )
    slip = free[1:] - (1.0 + restitution) * free[0] * w[1:] / w[0]
    resistance = (
        w[0] * (w[0] + w[1:] @ law.force(slip, normal_force=1.0)) if restitution else w[0] ** 2
    )
    return problem, resistance


def test_hinges_with_restitution_have_a_solution_or_a_proof():
    rng = np.random.default_rng(5)
    without = 0
    for k in range(400):
        problem, resistance = hinge(rng, 1 + k % 2)
        if abs(resistance) < 1e-3 * problem.delassus[0, 0]:
            continue
        solution = problem.solve(on_failure="record")
        if resistance > 0.0:
            assert solution.converged, k
            continue
        without += 1
        smooth = problem.replace(laws=asp.FrictionLaw.isotropic(1e-3, dimension=1 + k % 2))
        assert smooth.solve().converged
        assert not proves_no_solution(smooth, solution.infeasibility)
        assert solution.status is Status.NO_SOLUTION, k
        assert solution.infeasibility.kind == "cases"
        assert proves_no_solution(problem, solution.infeasibility), k
    assert without > 20


def hinges(rng):
    """Two or three hinges of one body on a line that have bounced."""
    count, freedoms = rng.integers(2, 4), rng.integers(2, 4)
    seen = [np.outer(rng.normal(size=freedoms), rng.normal(size=2)) for _ in range(count)]
    directions = np.hstack(seen)
    return asp.ContactProblem(
        directions.T @ directions,
        free_velocity=directions.T @ rng.normal(size=freedoms),
        laws=asp.FrictionLaw.isotropic(rng.uniform(0.3, 1.5), dimension=1),
        normal_restitution=0.8,
        initial_velocity=directions.T @ rng.normal(size=freedoms),
    )


def test_hinges_that_bounce_together_have_a_solution_or_a_proof():
    without = proven = 0
    for seed in range(150):
        problem = hinges(np.random.default_rng(seed))
        solution = problem.solve(on_failure="record")
        solvable = has_a_solution(problem)
        if solution.status is Status.NO_SOLUTION:
            assert not solvable, seed
            assert proves_no_solution(problem, solution.infeasibility), seed
            proven += 1
        without += not solvable
    # The others lie within rounding.
    assert without > 10
    assert proven > 0.8 * without


def test_the_checker_asks_for_all_cases_and_for_vectors_that_separate():
    rng = np.random.default_rng(5)
    while True:
        problem = hinges(rng)
        proof = problem.solve(on_failure="record").infeasibility
        if proof is not None and proof.kind == "cases":
            break
    assert proves_no_solution(problem, proof)
    vectors = [k for k, case in enumerate(proof.cases) if not isinstance(case, int)]
    for k in range(len(proof.cases)):
        shorter = proof.cases[:k] + proof.cases[k + 1 :]
        assert not proves_no_solution(problem, proof.replace(cases=shorter)), k
    for k in vectors:
        for wrong in (-proof.cases[k], 0.0 * proof.cases[k], proof.cases[k][:-1]):
            cases = (*proof.cases[:k], wrong, *proof.cases[k + 1 :])
            assert not proves_no_solution(problem, proof.replace(cases=cases)), k
    for cases in ((), (0,), (len(problem.laws),), (*proof.cases, 0)):
        assert not proves_no_solution(problem, proof.replace(cases=cases))
    smooth = problem.replace(laws=asp.FrictionLaw.isotropic(1e-3, dimension=1))
    assert has_a_solution(smooth)
    assert not proves_no_solution(smooth, proof)


@pytest.mark.parametrize("seed", [18, 114, 312])
def test_percussions_do_not_hide_contacts_that_close_slowly(seed):
    # Percussions 1e5 … 1e12 times as large as the loads ask for meet any relative measure.
    directions, problem = random_system(seed)
    assert closes(directions, problem)
    solution = problem.solve(tolerance=1e-9, on_failure="record")
    assert solution.status is Status.NO_SOLUTION
    assert proves_no_solution(problem, solution.infeasibility)


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


def test_the_checker_refuses_proofs_for_problems_without_loads_and_of_the_smallest_numbers():
    line = asp.FrictionLaw.isotropic(0.3, dimension=1)
    solved = asp.ContactProblem(0.1 * np.eye(2), free_velocity=[-1.0, 0.1], laws=line)
    assert solved.solve().status is Status.CONVERGED
    squeezed = jaws(0.2, 0.0).solve(on_failure="record").infeasibility
    tiny = squeezed.replace(contact=0, direction=np.array([5e-324, 0.0]))
    assert not proves_no_solution(solved, tiny)
    cases = tiny.replace(kind="cases", cases=[np.array([-5e-324, 0.0])])
    assert not proves_no_solution(solved, cases)
    both = tiny.replace(kind="cases", cases=[0, np.array([-1.0, 0.0]), np.array([1.0, 0.0])])
    assert not proves_no_solution(solved.replace(free_velocity=np.zeros(2)), both)


@pytest.mark.parametrize("turn", [0.0, 0.5])
def test_friction_of_a_state_holds_corners_between_points(turn):
    angle = 2.0 * np.pi * (1234.0 + turn) / 20_000
    u = np.array([np.cos(angle), np.sin(angle)])
    across = np.array([-u[1], u[0]])
    triangle = asp.Polygon([u, 0.2 * (across - u), -0.2 * (across + u)])
    law = asp.FrictionLaw(triangle, asp.Disk(1.0))
    quadrant = (0.0, 0.5 * np.pi)
    for state in ("closed", quadrant, (angle - 1e-5, angle + 1e-5)):
        friction = grading._friction_of(law, state)
        assert (friction @ -u).max() >= 1.0 - 1e-12
        # Tangents of a triangle meet on its sides and in its corners.
        assert triangle.gauge(-friction).max() < 1.0 + 1e-9


def test_the_checker_refuses_friction_that_tangents_do_not_enclose():
    # A reservoir that grows wider away from its origin, whose far side is between two rays.
    wide = asp.Polygon([(1.0, 0.04), (-0.1, 0.03), (-0.1, -0.03), (1.0, -0.04)]).rotated(np.pi / 64)
    law, line = asp.FrictionLaw(wide, asp.Disk(1.0)), asp.FrictionLaw.isotropic(0.3, dimension=1)
    G = np.eye(6)
    G[2, 4] = G[4, 2] = G[2, 0] = -1.0  # jaws, held apart by the friction of a pressed contact
    along = 0.95 * np.array([1.0, np.tan(np.pi / 64)])
    percussion = np.array([*-along, 1.0, 0.0, 1.0, 0.0])
    held = asp.ContactProblem(
        G,
        free_velocity=-G @ percussion,
        laws=[law, line, line],
        normal_force=[1.0, None, None],
    )
    assert natural_map(held, percussion) < 1e-12
    assert not proves_no_solution(held, proof_by(np.array([0.0, 0.0, -1.0, 0.0, -1.0, 0.0])))


def test_the_checker_does_not_lose_entries_beside_much_larger_ones():
    G = np.eye(10)
    G[2, 0] = G[0, 2] = G[2, 4] = -1.0
    G[[0, 2, 4], 6], G[[0, 2, 4], 8] = (1e17, 1.0, -1e17), (-1e17, 1.0, 1e17)
    percussion = np.zeros(10)
    percussion[[6, 8]] = 1.0
    line = asp.FrictionLaw.isotropic(0.3, dimension=1)
    solved = asp.ContactProblem(G, free_velocity=-G @ percussion, laws=line)
    assert natural_map(solved, percussion) == 0.0
    vector = np.zeros(10)
    vector[[0, 2, 4]] = -1.0
    assert not proves_no_solution(solved, proof_by(vector))


def proof_by(vector):
    """Return a proof of one case."""
    return asp.contact.Infeasibility(
        kind="cases",
        contact=0,
        direction=np.eye(len(vector))[0],
        closing_velocity=1.0,
        residual=0.0,
        cases=[vector],
    )


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
        ("cases", [-1]),
        ("cases", [0.5]),
        ("cases", [[np.nan]]),
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
    with pytest.raises(asp.ParameterError, match="problem: must be a ContactProblem"):
        natural_map(np.eye(3), [0.9, -0.2, 0.0])
    with pytest.raises(asp.ParameterError, match="proof: must be an Infeasibility"):
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


@pytest.mark.parametrize("loads", [(-1.1, 1.0), (-1.01, 1.0), (1.0, -1.1), (-1.0, -0.1)])
@pytest.mark.parametrize("solver", [*SQUEEZERS, asp.ADMM()], ids=identify)
def test_jaws_that_close_on_a_body_that_leaves_one_of_them(solver, loads):
    problem = normals([[1.0, -1.0], [-1.0, 1.0]], loads)
    for tolerance in (1e-8, 1e-10):
        solution = problem.solve(solver, tolerance=tolerance, time_limit=20.0, on_failure="record")
        # The paper's iteration may not come far enough to see it.
        if not isinstance(solver, asp.ProxJacobi) or solution.status is not Status.MAX_ITERATIONS:
            assert solution.status is Status.NO_SOLUTION
            assert proves_no_solution(problem, solution.infeasibility)


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


@pytest.mark.parametrize("ratio", [1e12, 1e13, 1e14, 2.6e14])
def test_heavy_bodies_on_light_ones_are_never_said_to_have_no_solution(ratio):
    problem = normals([[1.0, -1.0], [-1.0, 1.0 + 1.0 / ratio]], [-1.0, 0.0])
    for solver in (asp.Auto(), asp.Exact(), asp.ProximalPoint(), asp.InteriorPoint(), asp.ADMM()):
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
    ("decades", "seed", "tolerance"), [(3, 1, 1e-8), (4, 9, 1e-8), (6, 2, 1e-10)]
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


def test_islands_are_not_without_a_solution_where_one_exists():
    """The measure of the whole does not see the island of light bodies."""
    light, heavy = pile_of_unequal_spheres(3, 1), problems.pile(2, speed=0.1, seed=1)
    both = asp.ContactProblem.from_bodies(
        block_diag(light.mass.toarray(), 1e8 * heavy.mass.toarray()),
        directions=block_diag(light.directions.toarray(), heavy.directions.toarray()),
        free_velocity=np.concatenate([light.free_velocity, heavy.free_velocity]),
        laws=asp.FrictionLaw.isotropic(0.5),
    )
    solution = both.solve(tolerance=1e-10, measure="global", on_failure="record")
    assert solution.status in (Status.CONVERGED, Status.STALLED)
    assert all(island.status is not Status.UNBOUNDED for island in solution.islands)


@pytest.mark.parametrize("mass", [1e15, 1e16, 1e17, 1e20, 1e30])
def test_bodies_that_the_operator_has_lost_are_asked_as_well(mass):
    """A light body between floor and heavy body: P = (M, 0, M, 0) brings both to rest exactly.

    G in double precision is that of an immovable heavy body.
    """
    directions = np.array([[0, 1, 0, -1], [1, 0, -1, 0], [0, 0, 0, 1], [0, 0, 1, 0]], dtype=float)
    masses = np.array([1.0, 1.0, mass, mass])
    before = np.array([0.0, 0.0, 0.0, -1.0])
    exact = np.array([mass, 0.0, mass, 0.0])
    assert not (directions.T @ (before + directions @ exact / masses)).any()
    problem = asp.ContactProblem.from_bodies(
        np.diag(masses),
        directions=directions,
        free_velocity=directions.T @ before,
        laws=normals([[1.0]], [-1.0]).laws[0],
    )
    for solver in (asp.Auto(), asp.Exact(), asp.ProximalPoint(), asp.InteriorPoint()):
        solution = problem.solve(solver, on_failure="record", time_limit=20.0)
        assert solution.status is not Status.NO_SOLUTION
    claim = {"contact": 0, "closing_velocity": 0.5, "residual": 0.0}
    weights = np.array([0.5, 0.0, 0.5, 0.0])
    closing = asp.contact.Infeasibility(kind="closing", direction=weights, **claim)
    # It is a proof where nothing is known but G.
    assert proves_no_solution(problem.replace(delassus=problem.delassus), closing)
    assert not proves_no_solution(problem, closing)


def close_jaws(sliding, squeeze=1e-3):
    """Two opposite walls and one body between them that slides along."""
    block = np.diag([1.0, 1.0, 1.0])
    operator = np.block([[block, block], [block, block]])
    for i, j in [(0, 3), (3, 0)]:
        operator[i, j] = -1.0
    free = np.array([-squeeze, sliding, 0.0, -squeeze, sliding, 0.0])
    return asp.ContactProblem(operator, free_velocity=free, laws=LAW)


@pytest.mark.parametrize("sliding", [0.0, 1.0, 1e3])
@pytest.mark.parametrize("solver", [asp.Auto(), asp.ProximalPoint()], ids=repr)
def test_squeezed_body_has_no_solution_however_fast_it_slides(solver, sliding):
    problem = close_jaws(sliding)
    solution = problem.solve(solver, tolerance=1e-8, time_limit=20.0, on_failure="record")
    assert not solution.converged
    assert solution.certificate.penetration_velocity > 1e-4


def test_a_start_that_was_no_solution_does_no_harm():
    lost = close_jaws(1.0).solve(tolerance=1e-8, on_failure="record")
    feasible = close_jaws(1.0).replace(free_velocity=[-1e-3, 1.0, 0.0, 1e-3, 1.0, 0.0])
    solution = feasible.solve(start=lost)
    assert np.abs(solution.percussion).max() < 1e-1
    assert np.abs(solution.velocity).max() < 2.0


def test_no_solution_error_needs_growth_not_only_an_approach():
    with pytest.raises(NoSolutionError):
        close_jaws(0.0, squeeze=1.0).solve(tolerance=1e-8)


@pytest.mark.parametrize("count", [2, 5, 11, 23, 40])
def test_heavy_bodies_do_not_hide_light_ones_that_are_squeezed(count):
    """Whatever the percussions, normal velocities add up to what the walls close by.

    If they leave as much room, it takes no percussions at all to find velocities that separate.
    """
    proven = 0
    for seed in range(10):
        rng = np.random.default_rng(seed)
        masses = 10.0 ** rng.uniform(-3.0, 3.0, size=count)
        problem = chain(masses, 1e-5, rng)
        assert problem.free_velocity[::3].sum() == pytest.approx(-1e-5, rel=1e-9)
        solution = problem.solve(tolerance=1e-8, on_failure="record")
        if solution.status is Status.NO_SOLUTION:
            proven += 1
            assert proves_no_solution(problem, solution.infeasibility)
            assert np.all(solution.infeasibility.direction[::3] > 0.0)
        # Room in place of closing.
        assert chain(masses, -1e-5, rng).solve(tolerance=1e-8).converged
    assert proven >= 8


def test_proofs_among_bodies_need_weights_that_move_none():
    problem = chain(np.array([1e-5, 1.0, 1e5]), 1e-5, np.random.default_rng(0))
    weights = np.zeros(12)
    weights[::3] = 0.25
    claim = {"kind": "closing", "contact": 0, "closing_velocity": 2.5e-6, "residual": 0.0}
    assert proves_no_solution(problem, asp.contact.Infeasibility(direction=weights, **claim))
    # Nothing proves it where only G is known, which may hold other bodies.
    unknown = problem.replace(delassus=problem.delassus)
    assert not proves_no_solution(unknown, asp.contact.Infeasibility(direction=weights, **claim))
    for contact in range(4):
        other = weights.copy()
        other[3 * contact] *= 1.0 + 1e-9
        assert not proves_no_solution(problem, asp.contact.Infeasibility(direction=other, **claim))


def test_light_directions_of_a_body_that_contacts_hardly_feel_are_no_rounding():
    """Three contacts that close but for an angle of 8e-9, along which a body has hardly any mass.

    Percussions of 10⁹ N s under loads of 1 m/s bring it to move out of the way.
    """
    slope, angle, light, closing = 2.5e-3, 8e-9, 2e-9, 1.4e-3
    normal, tangent = np.array([0.8, 0.6]), np.array([-0.6, 0.8])
    directions = np.zeros((6, 6))
    directions[0, [0, 2]] = 1.0, -1.0
    directions[1:3, 2] = slope * (-normal + angle * tangent)
    directions[1:3, 4] = normal + angle * tangent
    directions[[3, 4, 5], [1, 3, 5]] = 1.0
    mass = np.eye(6)
    mass[0, 0] = 6e5
    mass[1:3, 1:3] = np.outer(normal, normal) + light * np.outer(tangent, tangent)
    free = np.array([1.0, 0.0, -1.0 - closing, 0.0, 0.0, 0.0])
    law = asp.FrictionLaw.isotropic(1e-13, dimension=1)
    problem = asp.ContactProblem.from_bodies(
        mass, directions=directions, free_velocity=free, laws=law
    )
    exact = np.zeros(6)
    exact[::2] = np.linalg.solve(problem.delassus.toarray()[::2, ::2], -free[::2])
    assert np.all(exact[::2] > 0.0)
    assert problem.residual(exact) < 1e-8
    for solver in (asp.Auto(), asp.ProximalPoint(), asp.InteriorPoint(), asp.ADMM()):
        assert problem.solve(solver, tolerance=1e-8).converged
    weights = np.array([1.0, 0.0, 1.0, 0.0, slope, 0.0])
    claim = asp.contact.Infeasibility(
        kind="closing",
        contact=0,
        direction=weights / weights.sum(),
        closing_velocity=closing / weights.sum(),
        residual=0.0,
    )
    assert not proves_no_solution(problem, claim)


def squeezed_packing(side, rows, *, closing):
    """Return side² columns of ten spheres, of which walls squeeze rows, and the rows' contacts.

    A row is named by its place and its level.
    """
    law = asp.FrictionLaw.isotropic(0.3)
    packing = problems.columns(side**2, height=10, law=law)
    velocity = lsqr(packing.directions.T, packing.free_velocity, atol=1e-15, btol=1e-15)[0]
    directions, free = [packing.directions], [packing.free_velocity]
    for place, level in rows:
        first = 10 * side * place + level
        walls = np.zeros((packing.mass.shape[0], 6))
        ends = (first, first + 10 * (side - 1))
        for sphere, sign, column in zip(ends, (1.0, -1.0), (0, 3), strict=True):
            own = walls[6 * sphere : 6 * sphere + 6, column : column + 3]
            own[0, 0] = sign
            own[[1, 5], 1] = 1.0, -0.5 * sign
            own[[2, 4], 2] = 1.0, 0.5 * sign
        directions.append(csc_array(walls))
        free.append(walls.T @ velocity - closing * np.eye(6)[3])
    problem = asp.ContactProblem.from_bodies(
        packing.mass,
        directions=hstack(directions, format="csc"),
        free_velocity=np.concatenate(free),
        laws=law,
    )
    # The contacts whose normals are along a row's centres bring no velocities together.
    along = [{6 * (10 * (side * place + k) + level) for k in range(side)} for place, level in rows]
    among = np.zeros((len(rows), 3 * len(problem.laws)))
    for contact, normal in enumerate(csc_array(problem.directions)[:, ::3].T.toarray()):
        moved = set(np.flatnonzero(normal))
        among[:, 3 * contact] = [moved <= row for row in along]
    return problem, among


ONE_ROW = [(0, 3)]
TWELVE_ROWS = [(place, level) for place in range(6) for level in (3, 5)]


@pytest.mark.parametrize(
    ("side", "rows", "tolerance"),
    [(4, ONE_ROW, 1e-6), (4, ONE_ROW, 1e-8), (6, ONE_ROW, 1e-8), (6, TWELVE_ROWS, 1e-6)],
)
def test_spheres_squeezed_within_a_packing_are_proven_to_be(side, rows, tolerance):
    """Hundreds of others carry loads only, but are not small enough to be left out."""
    problem, among = squeezed_packing(side, rows, closing=1e-3)
    assert np.abs(problem.directions @ among.T).max() == 0.0
    assert among @ problem.free_velocity == pytest.approx(-1e-3, rel=1e-6)
    solution = problem.solve(tolerance=tolerance, measure="global", on_failure="record")
    assert solution.status is Status.NO_SOLUTION
    proof = solution.infeasibility.direction
    assert np.abs(problem.directions @ proof).max() < 1e-14
    assert np.all(proof >= 0.0)
    assert proof @ problem.free_velocity < 0.0
