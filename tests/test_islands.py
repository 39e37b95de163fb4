"""Islands: contacts that influence each other are solved as if there were no others."""

import itertools

import asperity as asp
import numpy as np
import pytest
from asperity import Status, problems
from asperity.contact.grading import proves_no_solution
from random_problems import shuffled, side_by_side
from scipy.sparse import block_diag, csr_array

DISK = asp.FrictionLaw.isotropic(0.5)
ELLIPSES = asp.FrictionLaw(asp.Ellipse(0.6, 0.3, angle=0.4), asp.Ellipse(0.3, 0.6))
# Painlevé's paradox: friction draws the contact into the floor whatever it does.
PARADOX = asp.ContactProblem(
    [[1.0, 2.0], [2.0, 3.0]],
    free_velocity=[-1.0, 5.0],
    laws=asp.FrictionLaw.isotropic(1.0, dimension=1),
)


def scenes():
    """Return problems of one island each that sweeps solve, and some that take more."""
    return [
        problems.wall(3, columns=2, push=1.1, law=DISK),
        problems.stack(3, law=ELLIPSES),
        problems.wall(4, columns=3, push=1.0, law=ELLIPSES),
        problems.arch(5, law=asp.FrictionLaw.isotropic(0.9)),
        problems.sliders(3, law=ELLIPSES),
        problems.columns(1, height=4, law=DISK),
    ]


def ranges(parts):
    """Return the contacts of each part, and its rows."""
    contacts = np.cumsum([0] + [len(part.laws) for part in parts])
    rows = np.cumsum([0] + [part.free_velocity.size for part in parts])
    return list(itertools.pairwise(contacts)), list(itertools.pairwise(rows))


@pytest.mark.parametrize("measure", ["contact", "global"])
def test_islands_are_solved_as_problems_of_their_own(measure):
    parts = scenes()
    solution = side_by_side(parts).solve(measure=measure)
    assert solution.converged
    contacts, rows = ranges(parts)
    for part, (first, past), (start, stop) in zip(parts, contacts, rows, strict=True):
        own = [island for island in solution.islands if first <= island.contacts[0] < past]
        assert sorted(i for island in own for i in island.contacts) == list(range(first, past))
        assert all(island.status is Status.CONVERGED for island in own)
        percussion = solution.percussion[start:stop]
        assert part.residual(percussion) <= (1e-10 if measure == "contact" else 1e-8)
        alone = part.solve(measure=measure)
        np.testing.assert_allclose(solution.velocity[start:stop], alone.velocity, atol=1e-7)


def test_an_island_does_not_depend_on_others_to_the_bit():
    wall, others = problems.wall(4, columns=3, push=1.0, law=ELLIPSES), scenes()
    size = wall.free_velocity.size
    first = side_by_side([wall, *others[:2]]).solve().percussion[:size]
    second = side_by_side([wall, *others[2:]]).solve().percussion[:size]
    assert (first == second).all()
    last = side_by_side([*others[3:], wall]).solve().percussion[-size:]
    assert (first == last).all()


@pytest.mark.parametrize("measure", ["contact", "global"])
def test_threads_and_the_order_of_islands_change_no_bit(measure):
    wall = problems.wall(6, columns=5, push=1.0, law=DISK)
    problem = side_by_side([*scenes(), wall, problems.sliders(40), wall])
    # Of more than 512 contacts several threads sweep islands, too.
    assert len(problem.laws) > 512
    one = problem.solve(measure=measure)
    for threads in (2, 3):
        other = problem.solve(asp.Auto(threads=threads), measure=measure)
        assert (other.percussion == one.percussion).all()
        assert (other.velocity == one.velocity).all()
        assert (other.phase == one.phase).all()
        assert (other.ambiguous_contacts == one.ambiguous_contacts).all()
        assert other.islands == one.islands
        assert other.stages == one.stages
    # Islands interleave, but the contacts of each keep their order.
    random = np.random.default_rng(3)
    numbers = [list(island.contacts) for island in problem.solve().islands]
    turn = random.permutation([k for k, own in enumerate(numbers) for _ in own])
    queues = [iter(own) for own in numbers]
    mixed, rows = shuffled(problem, [next(queues[k]) for k in turn])
    plain, _ = shuffled(problem, range(len(problem.laws)))
    found = mixed.solve(measure=measure)
    assert (found.percussion == plain.solve(measure=measure).percussion[rows]).all()
    assert len(found.islands) == len(one.islands)


@pytest.mark.parametrize("solver", [asp.Auto(), asp.Exact(), asp.Auto(threads=2)], ids=repr)
def test_an_island_without_solution_says_so_beside_others_that_are_solved(solver):
    table = problems.table(3, law=DISK)
    parts = [problems.stack(2, law=DISK), PARADOX, table]
    solution = side_by_side(parts).solve(solver, on_failure="record")
    assert solution.status is Status.NO_SOLUTION
    contacts, rows = ranges(parts)
    bad = contacts[1][0]
    for island in solution.islands:
        assert (island.status is Status.NO_SOLUTION) == (island.contacts == (bad,))
    assert solution.infeasibility.contact == solution.worst_contact == bad
    assert proves_no_solution(side_by_side(parts), solution.infeasibility)
    assert table.residual(solution.percussion[slice(*rows[2])]) <= 1e-10


def test_islands_that_are_solved_already_are_kept():
    parts = [problems.wall(4, columns=3, push=1.0 + 0.1 * k, law=ELLIPSES) for k in range(4)]
    problem = side_by_side(parts)
    solution = problem.solve()
    again = problem.solve(start=solution)
    assert [island.iterations for island in again.islands] == [0, 0, 0, 0]
    assert (again.percussion == solution.percussion).all()
    free = np.array(problem.free_velocity)
    _, rows = ranges(parts)
    free[slice(*rows[2])] *= 1.2
    pushed = problem.replace(free_velocity=free).solve(start=solution)
    assert [island.iterations > 0 for island in pushed.islands] == [False, False, True, False]
    assert pushed.converged


@pytest.mark.parametrize("measure", ["contact", "global"])
@pytest.mark.parametrize("solver", [asp.Auto(), asp.Auto(threads=2)], ids=repr)
def test_what_a_limit_of_time_leaves_is_told_and_belongs_to_this_solve(solver, measure):
    walls = [problems.wall(5, columns=4, push=1.0, law=DISK)] * 3
    kept = side_by_side(walls)
    full = kept.solve(measure=measure)
    limit = {"time_limit": 1e-9, "on_failure": "record", "measure": measure}
    # Solved before, then from nothing: nothing of the first solution is left.
    again = kept.solve(solver, **limit)
    fresh = side_by_side(walls).solve(solver, **limit)
    assert again.status is fresh.status is Status.TIME_LIMIT
    assert (again.percussion == fresh.percussion).all()
    assert again.infeasibility is None
    assert not again.ambiguous
    for solution in (again, fresh):
        assert {island.status for island in solution.islands} == {Status.TIME_LIMIT}
        assert np.isfinite([island.residual for island in solution.islands]).all()
        told = solution.natural_map if measure == "global" else solution.residual
        true = kept.natural_map if measure == "global" else kept.residual
        assert told == true(solution.percussion)
    # Percussions to start from are not lost.
    options = limit | {"tolerance": 1e-15}
    started = kept.solve(solver, start=full, **options)
    assert kept.residual(started.percussion) <= 1e-9


def test_proofs_and_flags_of_a_solve_do_not_outlive_it():
    several = asp.ContactProblem(
        [[1.0, 0.5], [0.5, 1.0]],
        free_velocity=[-1.0, 0.9],
        laws=asp.FrictionLaw.isotropic(3.0, dimension=1),
    )
    wall = problems.wall(5, columns=4, push=1.0, law=DISK)
    kept = side_by_side([wall, PARADOX, *[several] * 5])
    assert kept.solve(on_failure="record").infeasibility is not None
    for measure in ("contact", "global"):
        limited = kept.solve(time_limit=1e-9, on_failure="record", measure=measure)
        assert limited.infeasibility is None
        assert not limited.ambiguous


def test_a_proof_for_one_contact_says_nothing_of_others():
    apart = np.zeros((4, 4))
    apart[:2, :2] = PARADOX.delassus
    apart[2:, 2:] = np.eye(2)
    law = asp.FrictionLaw.isotropic(1.0, dimension=1)
    free = [*PARADOX.free_velocity, -1.0, 0.2]
    problem = asp.ContactProblem(apart, free_velocity=free, laws=law)
    for solver in (asp.Auto(), asp.Exact(), asp.SemismoothNewton()):
        solution = problem.solve(solver, on_failure="record")
        assert [island.contacts for island in solution.islands] == [(0,), (1,)]
        assert solution.islands[0].status is not Status.CONVERGED
        assert solution.islands[1].status is not Status.NO_SOLUTION
    # Zeros that a sparse array stores connect nothing.
    stored = csr_array(np.ones((4, 4)))
    stored.data[:] = apart.ravel()
    islands = asp.ContactProblem(stored, free_velocity=free, laws=law).solve(on_failure="record")
    assert [island.contacts for island in islands.islands] == [(0,), (1,)]


@pytest.mark.parametrize("stored", ["mass", "directions"])
def test_zeros_that_bodies_store_connect_nothing(stored):
    full = csr_array(np.ones((6, 6)))
    full.data[:] = np.eye(6).ravel()
    parts = {"mass": csr_array(np.eye(6)), "directions": csr_array(np.eye(6))} | {stored: full}
    apart = asp.ContactProblem.from_bodies(
        parts["mass"],
        directions=parts["directions"],
        free_velocity=[-1.0, 0.1, 0.1, -1.0, 0.2, 0.1],
        laws=DISK,
    )
    assert [island.contacts for island in apart.solve().islands] == [(0,), (1,)]


def test_iterations_of_an_island_are_all_that_it_took():
    wall = problems.wall(5, columns=4, push=1.0, law=DISK)
    solution = side_by_side([wall, problems.sliders(1, law=DISK)]).solve()
    assert solution.islands[0].iterations == solution.iterations
    sweeps, *others = solution.stages
    assert sweeps.method == "gauss_seidel"
    assert others
    assert solution.iterations == sum(stage.iterations for stage in solution.stages)


def test_contacts_that_go_on_together_are_reported_as_such():
    """A contact is solved by its own measure, but not beside heavy ones by that of the whole."""
    random = np.random.default_rng(11)
    for _ in range(40):
        turn, _ = np.linalg.qr(random.normal(size=(3, 3)))
        block = turn @ np.diag([1.0, 1e-3, 10.0 ** random.uniform(-6, -2)]) @ turn.T
        free = np.concatenate([-block @ [1.0, 0.1, 0.05], np.tile([1e-9, 0.0, 0.0], 1000)])
        operator = block_diag([csr_array(block), csr_array(np.eye(3000) * 1e-9)], format="csr")
        problem = asp.ContactProblem(operator, free_velocity=free, laws=DISK)
        swept = problem.solve(asp.Exact(), measure="global", tolerance=1e-18, on_failure="record")
        own = asp.ContactProblem(block, free_velocity=free[:3], laws=DISK)
        alone = own.natural_map(swept.percussion[:3])
        if swept.natural_map > 4.0 * alone:  # both are rounding
            break
    assert swept.natural_map > 4.0 * alone
    # Between the two measures of what one sweep finds.
    tolerance = np.sqrt(alone * swept.natural_map)
    solution = problem.solve(measure="global", tolerance=tolerance, on_failure="record")
    methods = [stage.method for stage in solution.stages]
    assert methods[:2] == ["gauss_seidel", "gauss_seidel"]
    assert solution.iterations == sum(stage.iterations for stage in solution.stages)


def lighter(problem, part):
    """Return the same bodies, with this part of their masses."""
    return asp.ContactProblem.from_bodies(
        csr_array(problem.mass) * part,
        directions=problem.directions,
        free_velocity=problem.free_velocity,
        laws=problem.laws,
    )


@pytest.mark.parametrize("measure", ["contact", "global"])
@pytest.mark.parametrize(
    "solver",
    [
        asp.SemismoothNewton(),
        asp.InteriorPoint(),
        asp.ProximalPoint(),
        asp.ADMM(),
        asp.Exact(),
        asp.ProxJacobi(),
        asp.Auto(),
    ],
    ids=repr,
)
def test_islands_are_graded_by_their_own_measure(solver, measure):
    wall = problems.wall(3, columns=2, push=1.1, law=DISK)
    parts = [wall, lighter(problems.stack(2, push=8.0, law=DISK), 1e-9), problems.sliders(2)]
    both = side_by_side(parts)
    options = {"on_failure": "record", "tolerance": 1e-8, "measure": measure}
    solution = both.solve(solver, **options)
    contacts, rows = ranges(parts)
    own = [island.contacts for island in solution.islands]
    last = contacts[-1][0]
    assert own == [tuple(range(*contacts[0])), tuple(range(*contacts[1])), (last,), (last + 1,)]
    for island, part, (start, stop) in zip(solution.islands, parts[:2], rows[:2], strict=False):
        percussion = solution.percussion[start:stop]
        true = part.residual if measure == "contact" else part.natural_map
        assert island.residual == pytest.approx(true(percussion), rel=1e-4, abs=1e-12)
    for island in solution.islands:
        assert (island.status is Status.CONVERGED) == (island.residual <= 1e-8)


@pytest.mark.parametrize("measure", ["contact", "global"])
@pytest.mark.parametrize(
    "solver",
    [
        asp.SemismoothNewton(),
        asp.InteriorPoint(),
        asp.ProximalPoint(),
        asp.ADMM(),
        asp.Exact(),
        asp.ProxJacobi(),
        asp.ProxGaussSeidel(),
        asp.Auto(),
        asp.Auto(threads=2),
    ],
    ids=repr,
)
def test_what_is_reported_is_to_the_bit_the_measure_of_the_percussions(solver, measure):
    wall = problems.wall(3, columns=2, push=1.1, law=DISK)
    parts = [wall, problems.stack(2, law=DISK), problems.sliders(2), problems.arch(5, law=DISK)]
    for problem in (side_by_side(parts), *parts):
        for tolerance in (1e-2, 1e-4, 1e-8):
            options = {"on_failure": "record", "tolerance": tolerance, "time_limit": 1.0}
            solution = problem.solve(solver, measure=measure, **options)
            true = problem.residual if measure == "contact" else problem.natural_map
            assert solution.residual == true(solution.percussion)


@pytest.mark.parametrize("threads", [1, 2])
@pytest.mark.parametrize("limit", [None, 0.2])
def test_an_island_that_closes_is_not_hidden_by_a_measure_of_the_whole(limit, threads):
    wall = problems.wall(5, columns=4, push=1.0, law=DISK)
    # Two jaws that close on a body: no percussions keep them apart.
    jaws = asp.ContactProblem.from_bodies(
        np.eye(3) * 1e-12,
        directions=np.hstack([np.eye(3), np.diag([-1.0, 1.0, 1.0])]),
        free_velocity=[-1.0, 0.1, 0.2, -0.5, 0.3, 0.1],
        laws=DISK,
    )
    both = side_by_side([jaws, wall])
    options = {"measure": "global", "tolerance": 1e-8, "time_limit": limit}
    options["on_failure"] = "record"
    solution = both.solve(asp.Auto(threads=threads), **options)
    # The whole has a natural map of 1e-10, which does not see the jaws.
    assert solution.status in (Status.STALLED, Status.NO_SOLUTION)
    closed, rest = solution.islands
    assert closed.status is solution.status
    assert rest.status is Status.CONVERGED
    # By the measure of contacts every island counts.
    assert both.solve(on_failure="record").status is Status.NO_SOLUTION


@pytest.mark.parametrize("bad", [(1,), (0, 1), (2,)])
@pytest.mark.parametrize("solver", [asp.Auto(), asp.Exact()], ids=repr)
def test_a_contact_without_solution_is_named_wherever_it_is(solver, bad):
    blocks = [PARADOX.delassus if i in bad else np.eye(2) for i in range(3)]
    problem = asp.ContactProblem(
        block_diag(blocks, format="csr"),
        free_velocity=np.tile(PARADOX.free_velocity, 3),
        laws=PARADOX.laws[0],
    )
    solution = problem.solve(solver, on_failure="record")
    assert solution.status is Status.NO_SOLUTION
    assert solution.infeasibility.contact == bad[0]
    assert proves_no_solution(problem, solution.infeasibility)
    found = [island.status is Status.NO_SOLUTION for island in solution.islands]
    assert found == [i in bad for i in range(3)]


def test_islands_are_those_of_the_last_solve():
    problem = problems.sliders(1, law=ELLIPSES)
    problem.solve(asp.ProxGaussSeidel(max_iterations=1), on_failure="record")
    [island] = problem.solve().islands
    assert island.status is Status.CONVERGED


@pytest.mark.parametrize("size", [1e4, 1e8, 1e13])
def test_percussions_that_run_away_are_no_start(size):
    wall = problems.wall(6, columns=5, law=DISK)
    start = size * np.random.default_rng(0).random(wall.free_velocity.size)
    solution = wall.solve(asp.SemismoothNewton(), start=start)
    assert solution.residual <= 1e-10


def test_solving_again_changes_no_bit():
    """A problem keeps its analysis between solves, whatever was solved with it before."""
    kept = side_by_side(scenes())
    solvers = [asp.Auto(), asp.ProximalPoint(), asp.InteriorPoint(), asp.Exact(), asp.Auto()]
    for solver in solvers:
        for measure in ("contact", "global"):
            options = {"measure": measure, "on_failure": "record", "tolerance": 1e-8}
            fresh = kept.replace().solve(solver, **options)
            again = kept.solve(solver, **options)
            assert (again.percussion == fresh.percussion).all()
            assert again.stages == fresh.stages
            assert again.islands == fresh.islands
            warm = kept.solve(solver, start=fresh, **options)
            assert (
                warm.percussion == kept.replace().solve(solver, start=fresh, **options).percussion
            ).all()


def test_piles_step_side_by_side_as_each_alone():
    def balls(piles):
        bodies, pairs = [], []
        for k in range(piles):
            for j in range(3):
                spot = (0.7 * k, 0.0, 0.1 + 0.2 * j)
                push = (0.4 * (k + 1), 0.1, 0.0) if j == 2 else (0.0, 0.0, 0.0)
                bodies.append(asp.Body.ball(1.0, radius=0.1, position=spot, velocity=push))
                pairs.append(
                    asp.SpherePlane(3 * k, radius=0.1, plane=asp.Plane(), law=ELLIPSES)
                    if j == 0
                    else asp.SphereSphere(
                        3 * k + j - 1, radius=0.1, other=3 * k + j, other_radius=0.1, law=DISK
                    )
                )
        return asp.simulate(asp.RigidBodies(bodies, pairs=pairs), dt=1e-3, t_end=0.05)

    together, fewer = balls(3), balls(2)
    assert (together.u[:, : fewer.u.shape[1]] == fewer.u).all()
    np.testing.assert_allclose(together.u[:, :18], balls(1).u, atol=1e-8)


def test_a_large_island_leaves_time_for_small_ones():
    parts = [problems.pile(9), *(problems.wall(4, columns=3, push=1.0) for _ in range(5))]
    solution = side_by_side(parts).solve(time_limit=0.5, on_failure="record")
    assert solution.status is Status.TIME_LIMIT
    first, *others = solution.islands
    assert first.status is Status.TIME_LIMIT
    assert all(island.status is Status.CONVERGED for island in others)
