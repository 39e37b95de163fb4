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
        pytest.param(asp.ProxJacobi(), marks=pytest.mark.long),
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
        pytest.param(asp.ProxJacobi(), marks=pytest.mark.long),
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
