"""What must not change when contacts are listed otherwise, in other company or in other units.

No oracle is needed: the same contacts are solved twice. Every relation is one function of a seed,
as in `test_metamorphic.py`, here for problems of up to some hundred contacts between bodies.
"""

import asperity as asp
import numpy as np
import pytest
from asperity import Status
from asperity.contact.grading import proves_no_solution
from profiles import counts
from random_problems import any_problem, chain, shuffled, side_by_side
from scipy.sparse import csr_array
from test_metamorphic import check

MEASURES = ("contact", "global")
SOLVERS = (asp.Auto(), asp.Auto(threads=2))


def alone_and_side_by_side(rng):
    """The company of other contacts, their order and the number of threads change no bit."""
    parts = [any_problem(rng), any_problem(rng)]
    measure = str(rng.choice(MEASURES))
    options = {"tolerance": 1e-8, "measure": measure, "on_failure": "record"}
    first, second = (part.solve(**options).percussion for part in parts)
    together = side_by_side(parts).natural_map(np.append(first, second))
    if measure == "global" and together > options["tolerance"]:
        # The natural map of the whole asks for more than that of each of them.
        return
    for solver in SOLVERS:
        both = side_by_side(parts).solve(solver, **options).percussion
        assert np.array_equal(both, np.append(first, second)), "in order"
        both = side_by_side(parts[::-1]).solve(solver, **options).percussion
        assert np.array_equal(both, np.append(second, first)), "the other way round"


def powers_of_two(rng):
    """Units that are powers of two change no bit, of masses, whose roots are taken, of four."""
    problem = any_problem(rng)
    mass, speed = 4.0 ** rng.integers(-30, 31), 2.0 ** rng.integers(-60, 61)
    scaled = asp.ContactProblem.from_bodies(
        csr_array(problem.mass) * mass,
        directions=problem.directions,
        free_velocity=problem.free_velocity * speed,
        laws=problem.laws,
        normal_force=[f if f is None else f * mass * speed for f in problem.normal_force],
    )
    measure = str(rng.choice(MEASURES))
    one, two = (
        each.solve(tolerance=1e-8, measure=measure, on_failure="record")
        for each in (problem, scaled)
    )
    assert np.array_equal(two.percussion, one.percussion * (mass * speed))
    assert two.status == one.status
    assert two.stages == one.stages


def another_order(rng):
    """Contacts in another order are solved as well, and what is found solves the first order."""
    problem = any_problem(rng)
    other, rows = shuffled(problem, rng.permutation(len(problem.laws)))
    one, two = problem.solve(tolerance=1e-8), other.solve(tolerance=1e-8)
    for solution, solves, order in ((one, other, rows), (two, problem, np.argsort(rows))):
        assert solves.residual(solution.percussion[order]) <= 1.01e-8


def never_beyond_its_room(chain_of, rng, closing):
    """A chain whose walls close is never solved, one with as much room always is."""
    for sign in (1.0, -1.0):
        problem = chain_of(sign * closing)
        for measure in MEASURES:
            solution = problem.solve(
                tolerance=10.0 ** -rng.integers(8, 11), measure=measure, on_failure="record"
            )
            if sign < 0.0:
                assert solution.converged, f"{solution.status} with room, {measure}"
                continue
            assert solution.status is not Status.CONVERGED, f"closing, {measure}"
            if solution.status is Status.NO_SOLUTION:
                assert proves_no_solution(problem, solution.infeasibility)


def closing_chain(rng):
    """Bodies of masses of up to nine decades in a row."""
    count = int(np.exp(rng.uniform(np.log(2), np.log(300))))
    masses = 10.0 ** rng.uniform(-4.5, 4.5, size=count)
    bits = rng.bit_generator.state

    def again(closing):
        rng.bit_generator.state = bits
        return chain(masses, closing, rng)

    never_beyond_its_room(again, rng, 10.0 ** rng.uniform(-5.0, -1.0))


def squeezed_on_top(rng):
    """A light body between walls that close, on a tower of heavy ones."""
    count, light = int(np.exp(rng.uniform(np.log(2), np.log(200)))), 10.0 ** -rng.uniform(0.0, 9.0)
    masses = np.append(np.ones(count), light)
    # One contact under every body, with its normal upwards; then two at the sides of the last one.
    directions = np.zeros((3 * count + 3, 3 * count + 9))
    for body in range(count + 1):
        rows, upward = slice(3 * body, 3 * body + 3), np.roll(np.eye(3), 1, axis=1)
        directions[rows, rows] = upward
        if body > 0:
            directions[3 * body - 3 : 3 * body, rows] = -upward
    directions[-3:, -6:-3], directions[-3:, -3:] = np.eye(3), np.diag([-1.0, 1.0, 1.0])
    free = directions.T @ np.tile([0.0, 0.0, -0.1], count + 1)
    sides = np.append(np.zeros(free.size - 6), [1.0, 0.0, 0.0, 1.0, 0.0, 0.0])

    def tower(closing):
        return asp.ContactProblem.from_bodies(
            np.diag(np.repeat(masses, 3)),
            directions=directions,
            free_velocity=free - closing * sides,
            laws=asp.FrictionLaw.isotropic(0.5),
        )

    never_beyond_its_room(tower, rng, 10.0 ** rng.uniform(-6.0, -2.0))


@counts(30, 500)
def test_an_island_is_solved_alone_as_beside_others(count):
    check(alone_and_side_by_side, count)


@counts(10, 1000)
@pytest.mark.parametrize(
    "relation",
    [powers_of_two, another_order, closing_chain, squeezed_on_top],
    ids=lambda relation: relation.__name__,
)
def test_relation(relation, count):
    check(relation, count)
