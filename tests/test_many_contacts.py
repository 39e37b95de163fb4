"""Random problems of 10 to 100 contacts with all kinds of laws, bodies and contacts."""

import itertools

import asperity as asp
import numpy as np
import pytest
from profiles import every
from random_problems import LAW, LAWS, pile
from samples import identify
from scipy.sparse import block_diag, coo_array, csr_array

ASSOCIATED = [law for law in LAWS if law.is_associated]
PLANAR = [law for law in ASSOCIATED if law.dimension < 3]
ELLIPTIC = [
    asp.FrictionLaw.isotropic(0.4, dimension=1),
    asp.FrictionLaw(asp.Ellipse(0.6, 0.2), asp.Ellipse(1.0, 2.0, angle=0.3)),
    asp.FrictionLaw.isotropic(0.3, dimension=3),
]
TOLERANCE = 1e-8


def with_decimals(problem, decimals):
    """Return the problem with rounded numbers, which are hardly ever others on another processor.

    The BLAS of another processor sums the products of numpy in another order, and where a solve is
    long, that decides which methods it takes.
    """
    return asp.ContactProblem.from_bodies(
        csr_array(problem.mass.toarray().round(decimals)),
        directions=csr_array(problem.directions.toarray().round(decimals)),
        free_velocity=problem.free_velocity.round(decimals),
        laws=problem.laws,
        normal_force=problem.normal_force,
    )


def solve_and_check(problem, time_limit=20.0, tolerance=TOLERANCE):
    solution = problem.solve(tolerance=tolerance, time_limit=time_limit, on_failure="record")
    if solution.converged:
        assert problem.residual(solution.percussion) <= tolerance
        certificate = solution.certificate
        size = max(np.abs(solution.percussion).max(), np.abs(solution.velocity).max())
        assert certificate.tension <= 1e-6 * size
        assert certificate.penetration_velocity <= 1e-5 * size
        assert certificate.cone_violation <= 1e-5 * size
    return solution


def mixed(seed):
    """Problem number `seed`: from well-conditioned to four contacts where one would do."""
    rng = np.random.default_rng(seed)
    contacts = int(rng.integers(10, 101))
    return pile(rng, LAWS, contacts, per_pair=1 + seed % 4)


@pytest.mark.parametrize("first", range(0, 60, 10))
def test_mixed_problems_are_solved(first):
    unsolved = [
        seed for seed in range(first, first + 10) if not solve_and_check(mixed(seed)).converged
    ]
    assert unsolved == []


@pytest.mark.long
@pytest.mark.parametrize("first", range(0, 1000, 50))
def test_a_thousand_mixed_problems_are_solved(first):
    unsolved = [
        seed for seed in range(first, first + 50) if not solve_and_check(mixed(seed)).converged
    ]
    assert unsolved == []


@pytest.mark.parametrize(("contacts", "seed"), every(2, [(400, 3), (500, 30)]))
def test_redundant_problems_of_hundreds_of_contacts_are_solved(contacts, seed):
    """Four contacts between the same two bodies."""
    problem = with_decimals(pile(np.random.default_rng(seed), LAWS, contacts, per_pair=4), 12)
    assert solve_and_check(problem, time_limit=120.0).converged


@pytest.mark.long
@pytest.mark.parametrize("first", range(0, 200, 10))
def test_problems_of_a_thousand_contacts_are_solved(first):
    unsolved = []
    for seed in range(first, first + 10):
        problem = pile(np.random.default_rng(seed), LAWS, 1000, per_pair=1 + seed % 4)
        solution = solve_and_check(problem, time_limit=60.0)
        if not solution.converged:
            unsolved.append(f"{seed}: {solution.status}")
    assert unsolved == []


def full_rank(rng, laws, contacts):
    """Prescribed normal forces and a regular G: with associated laws the solution is unique.

    It minimises ½PᵀGP + bᵀP over all −P in P_N C, a strictly convex function over a convex set.
    """
    chosen = [laws[int(rng.integers(len(laws)))] for _ in range(contacts)]
    rows = sum(law.dimension for law in chosen)
    jacobian = rng.normal(size=(rows, 2 * rows))
    return asp.ContactProblem(
        csr_array(jacobian @ jacobian.T / rows),
        free_velocity=rng.normal(size=rows),
        laws=chosen,
        normal_force=rng.uniform(0.2, 2.0, size=contacts),
    )


SOLVERS = [asp.Auto(), asp.SemismoothNewton(), asp.ProximalPoint(), asp.ProxGaussSeidel()]


@pytest.mark.parametrize("seed", range(10))
@pytest.mark.parametrize("laws", [ASSOCIATED, PLANAR], ids=["any p", "p < 3"])
def test_solvers_agree_where_the_solution_is_unique(seed, laws):
    rng = np.random.default_rng(1000 + seed)
    problem = full_rank(rng, laws, int(rng.integers(10, 40)))
    # The exact solver of one contact is one of the line and the plane.
    solvers = [*SOLVERS, asp.Exact()] if laws is PLANAR else SOLVERS
    solutions = [problem.solve(solver, tolerance=1e-10) for solver in solvers]
    size = np.abs(solutions[0].percussion).max()
    for solution in solutions[1:]:
        np.testing.assert_allclose(
            solution.percussion, solutions[0].percussion, rtol=0, atol=1e-7 * size
        )


CROSSED = [
    asp.Auto(),
    asp.Exact(),
    asp.SemismoothNewton(),
    asp.ProximalPoint(),
    asp.InteriorPoint(),
    asp.ADMM(),
    asp.ProxGaussSeidel(max_iterations=2000),
    asp.ProxJacobi(max_iterations=2000),
]
MASSES = {
    "ordinary": (1.0, 2.0, 1.5),
    "redundant": (1.0, 2.0, 1.5),
    "light on heavy": (1e6, 1e3, 1.0),
    "heavy on light": (1.0, 1e2, 1e4),
    "no normal load": (1.0, 2.0, 1.5),
}
DIMENSIONS = {
    1: asp.FrictionLaw.isotropic(0.4, dimension=1),
    2: asp.FrictionLaw.associated(asp.Ellipse(0.5, 0.3)),
    3: asp.FrictionLaw.isotropic(0.3, dimension=3),
}


def stack(kind, p):
    """Three bodies on each other with translations and a spin; M, W, Wᵀu and the law."""
    bodies = len(MASSES[kind])

    def contact(body, below):
        block = np.zeros((4 * bodies, 1 + p))
        for k, axis in enumerate((2, 0, 1, 3)[: 1 + p]):
            block[4 * body + axis, k] = 1.0
            if below >= 0:
                block[4 * below + axis, k] = -1.0
        return block

    contacts = [contact(body, body - 1) for body in range(bodies)]
    if kind == "redundant":
        contacts += [contact(0, -1), contact(0, -1), contact(1, 0)]
    directions = np.hstack(contacts)
    mass = np.diag(np.outer(MASSES[kind], [1.0, 1.0, 1.0, 0.1]).ravel())
    velocity = np.outer([1.0, -1.0, 1.0], [0.05, 0.02, 0.0, 0.1])
    velocity[:, 2] = 0.0 if kind == "no normal load" else -0.0981
    return mass, directions, directions.T @ velocity.ravel(), DIMENSIONS[p]


def may_fail(solver, kind, p):
    """Whether the documented limits of a solver are met.

    One contact after the other carries a heavy body's weight down in small portions; Newton's
    method alone needs a good start; rounding ends the interior point; penalties of one size do not
    suit masses of many.
    """
    heavy = kind == "heavy on light"
    if isinstance(solver, asp.Auto | asp.ProximalPoint):
        return False
    if isinstance(solver, asp.Exact):
        return heavy
    if isinstance(solver, asp.SemismoothNewton):
        return heavy and p > 1
    if isinstance(solver, asp.ADMM):
        return kind == "light on heavy"
    return isinstance(solver, asp.InteriorPoint | asp.ProxJacobi) or heavy


@pytest.mark.parametrize("p", [1, 2, 3])
@pytest.mark.parametrize("kind", MASSES)
@pytest.mark.parametrize("solver", CROSSED, ids=identify)
def test_every_solver_takes_every_form_of_every_kind_of_problem(solver, kind, p):
    mass, directions, free, law = stack(kind, p)
    dense = directions.T @ np.linalg.inv(mass) @ directions
    for problem in (
        asp.ContactProblem(dense, free_velocity=free, laws=law),
        asp.ContactProblem(csr_array(dense), free_velocity=free, laws=law),
        asp.ContactProblem.from_bodies(mass, directions=directions, free_velocity=free, laws=law),
    ):
        solution = problem.solve(solver, tolerance=1e-9, on_failure="record")
        assert solution.converged == (problem.residual(solution.percussion) <= 1e-9)
        assert solution.infeasibility is None
        if not solution.converged:
            # A limit is the reason only where it was reached.
            limit = getattr(solver, "max_iterations", getattr(solver, "max_sweeps", None))
            limited = solution.iterations >= limit
            expected = asp.Status.MAX_ITERATIONS if limited else asp.Status.STALLED
            assert solution.status is expected
            assert may_fail(solver, kind, p)


@pytest.mark.parametrize("exponents", [(3, 0, 0), (-9, 0, 0), (0, 6, 0), (0, 0, -6), (5, -4, 7)])
def test_verdicts_do_not_depend_on_units(exponents):
    """Problems with and without solution, in units of kg, m, s times powers of ten."""
    kilogram, metre, second = 10.0 ** np.array(exponents, dtype=float)
    speed = metre / second
    closing = np.kron([[1.0, -1.0], [-1.0, 1.0]], np.diag([1.0, 0.0])) + np.diag([0, 1, 0, 1])
    squeezed = asp.ContactProblem(closing, free_velocity=[-0.2, 0.5, -0.1, 0.5], laws=DIMENSIONS[1])
    mass, directions, free, law = stack("heavy on light", 2)
    solved = asp.ContactProblem(
        directions.T @ np.linalg.inv(mass) @ directions, free_velocity=free, laws=law
    )
    for problem in (squeezed, solved):
        twin = problem.replace(
            delassus=problem.delassus / kilogram, free_velocity=problem.free_velocity * speed
        )
        found, scaled = (one.solve(on_failure="record") for one in (problem, twin))
        assert found.status is scaled.status
        if found.converged:
            expected = found.percussion * kilogram * speed
            np.testing.assert_allclose(
                scaled.percussion, expected, rtol=1e-6, atol=1e-8 * np.abs(expected).max()
            )


@pytest.mark.parametrize("solver", CROSSED[:6], ids=identify)
def test_the_residual_bounds_what_is_left_of_the_normal_law(solver):
    """−ξ_N ≤ r max(|P|/ρ, loads); −P_N and min(P_N, ρξ_N) ≤ ρ times that, contact by contact."""
    for seed in range(30):
        rng = np.random.default_rng(3000 + seed)
        problem = pile(
            rng, ELLIPTIC, int(rng.integers(2, 8)), per_pair=1 + seed % 3, unilateral=1.0
        )
        tolerance = 10.0 ** -rng.uniform(2, 9)
        solution = problem.solve(solver, tolerance=tolerance, on_failure="record")
        operator, percussion = problem.delassus.toarray(), solution.percussion
        brought = np.abs(operator) @ np.abs(percussion) + np.abs(problem.free_velocity)
        for rows in problem.row_slices:
            rho = (rows.stop - rows.start) / np.trace(operator[rows, rows])
            size = max(np.linalg.norm(percussion[rows]) / rho, np.linalg.norm(brought[rows]))
            left = (1.000001 * solution.residual + 1e-14) * size
            normal, velocity = percussion[rows.start], solution.velocity[rows.start]
            assert -velocity <= left
            assert -normal <= rho * left
            assert min(normal, rho * velocity) <= rho * left


@pytest.mark.parametrize("solver", [asp.ProximalPoint(), asp.Auto()])
def test_dense_sparse_and_bodies_are_one_problem(solver):
    rng = np.random.default_rng(5)
    bodies = pile(rng, LAWS, 12, per_pair=1)
    sparse = bodies.replace(delassus=bodies.delassus)
    dense = bodies.replace(delassus=bodies.delassus.toarray())
    assert sparse.mass is None
    percussion = rng.normal(size=bodies.free_velocity.size)
    for other in (sparse, dense):
        assert other.residual(percussion) == pytest.approx(bodies.residual(percussion))
        assert other.natural_map(percussion) == pytest.approx(bodies.natural_map(percussion))
    velocities = [
        problem.solve(solver, tolerance=1e-9).velocity for problem in (bodies, sparse, dense)
    ]
    for velocity in velocities[1:]:
        np.testing.assert_allclose(velocity, velocities[0], atol=1e-6)


@pytest.mark.parametrize(
    "problem",
    [
        asp.problems.sliders(1500, coupled=True, seed=2),
        asp.problems.wall(10, columns=9, law=asp.FrictionLaw.associated(asp.Ellipse(0.6, 0.4))),
        # Threads share the contacts of a colour.
        asp.problems.columns(46, height=10),
    ],
    ids=["sliders", "wall", "columns"],
)
def test_same_input_same_bits_on_any_number_of_threads(problem):
    # Threads are used for more than 512 contacts.
    assert len(problem.laws) > 512
    first, second, *threaded = (
        problem.solve(asp.Auto(threads=threads), tolerance=TOLERANCE, on_failure="record")
        for threads in (1, 1, 2, 4)
    )
    assert first == second
    for solution in threaded:
        np.testing.assert_array_equal(first.percussion, solution.percussion)
        np.testing.assert_array_equal(first.phase, solution.phase)


def test_default_solver_follows_the_rule_of_selection():
    law = asp.FrictionLaw(asp.Ellipse(0.3, 0.1, angle=np.deg2rad(30.0)), asp.Ellipse(3.0, 1.0))
    rng = np.random.default_rng(5)
    ambiguous = different = 0
    for _ in range(300):
        operator = np.eye(4)
        operator[:2, 2:] = operator[2:, :2] = 1e-6 * np.eye(2)
        before = rng.normal(size=4) * 0.4
        problem = asp.ContactProblem(operator, free_velocity=before, laws=law, normal_force=1.0)
        first = problem.solve(asp.Exact())
        then = problem.replace(free_velocity=before + 0.05 * rng.normal(size=4))
        exact, auto = (then.solve(solver, start=first) for solver in (asp.Exact(), asp.Auto()))
        ambiguous += exact.ambiguous
        different += np.abs(exact.percussion - auto.percussion).max() > 1e-6
    assert ambiguous > 0
    assert different == 0


def test_bodies_in_every_form_are_one_problem_with_g_as_by_hand():
    rng = np.random.default_rng(5)
    for case in range(30):
        bodies, contacts = rng.integers(1, 5, size=2)
        roots = rng.normal(size=(bodies, 3, 3))
        blocks = roots @ roots.transpose(0, 2, 1) + np.eye(3)
        mass = np.asarray(block_diag(list(blocks)).toarray())
        mass = 0.5 * (mass + mass.T)
        directions = rng.normal(size=(3 * bodies, 3 * contacts))
        directions[1:][rng.random((len(directions) - 1, 3 * contacts)) < 0.5] = 0.0
        # The same with its columns in any order, and with every entry in two halves.
        rows, columns = directions.nonzero()
        order = rng.permutation(rows.size)
        twice = np.tile(rows, 2), np.tile(columns, 2)
        halves = np.tile(0.5 * directions[rows, columns], 2), twice
        shuffled = csr_array(directions)
        for start, end in itertools.pairwise(shuffled.indptr):
            shuffled.indices[start:end] = shuffled.indices[start:end][::-1]
            shuffled.data[start:end] = shuffled.data[start:end][::-1]
        shuffled.has_sorted_indices = True
        triplets = directions[rows, columns][order], (rows[order], columns[order])
        forms = [
            directions,
            csr_array(directions),
            csr_array(directions).tocsc(),
            csr_array(directions).tolil(),
            coo_array(triplets, shape=directions.shape),
            coo_array(halves, shape=directions.shape),
            shuffled,
        ]
        masses = [mass, csr_array(mass), csr_array(mass).tocsc(), csr_array(mass).tobsr((3, 3))]
        by_hand = directions.T @ np.linalg.solve(mass, directions)
        made = [
            asp.ContactProblem.from_bodies(
                masses[k % len(masses)], directions=form, free_velocity=by_hand[0], laws=LAW
            )
            for k, form in enumerate(forms)
        ]
        for problem in made:
            assert problem == made[0], case
            assert hash(problem) == hash(made[0]), case
            assert np.array_equal(problem.mass.toarray(), mass), case
            assert np.array_equal(problem.directions.toarray(), directions), case
            assert problem.directions.indices.dtype == np.int64, case
        size = 1e-13 * max(1.0, np.abs(by_hand).max())
        assert np.abs(made[0].delassus.toarray() - by_hand).max() < size, case
        # The core's own G.
        percussion = rng.normal(size=3 * contacts)
        solution = made[0].solve(on_failure="record", start=percussion)
        expected = by_hand @ solution.percussion + by_hand[0]
        largest = max(1.0, np.abs(solution.percussion).max())
        assert np.abs(solution.velocity - expected).max() < 10.0 * size * largest, case


@pytest.mark.parametrize(
    ("mass", "words"),
    [
        ([[1.0, 0.1], [0.2, 1.0]], "symmetric, it is off by 0.1"),
        ([[1.0, 0.1], [0.0, 1.0]], "symmetric, it is off by 0.1"),
        ([[1.0, 0.0], [0.0, 0.0]], "diagonal is not positive"),
        ([[1.0, 2.0], [2.0, 1.0]], "positive definite"),
    ],
)
def test_masses_that_are_none_are_refused_in_words(mass, words):
    for form in (np.array, csr_array):
        with pytest.raises(asp.ParameterError, match=words) as caught:
            asp.ContactProblem.from_bodies(
                form(mass),
                directions=np.eye(2, 3),
                free_velocity=np.zeros(3),
                laws=LAW,
            )
        assert caught.value.argument == "mass"
