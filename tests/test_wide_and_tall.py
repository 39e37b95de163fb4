"""Problems that are high or wide: work grows with the contacts, not with what they carry."""

import asperity as asp
import numpy as np
import pytest
from asperity import problems
from profiles import every

TOLERANCE = 1e-8


def solved(problem, **options):
    """Return the solution by the measure of engines, which is asserted to be one."""
    solution = problem.solve(tolerance=TOLERANCE, measure="global", **options)
    assert problem.natural_map(solution.percussion) <= TOLERANCE
    return solution


def factorizations(solution):
    """Return how many there were."""
    return sum(stage.factorizations for stage in solution.stages)


SCENES = {
    "stack": (problems.stack, (25, 250, 2500), 1),
    "wall": (lambda side: problems.wall(side, columns=side, push=1.0), (4, 11, 35), 1),
    "arch": (problems.arch, (24, 249, 2499), 20),
}


@pytest.mark.parametrize("scene", SCENES)
def test_factorisations_do_not_grow_with_the_size(scene):
    make, sizes, most = SCENES[scene]
    for size in sizes:
        assert factorizations(solved(make(size))) <= most


@pytest.mark.parametrize("measure", ["contact", "global"])
def test_bodies_at_rest_are_found_early_where_contacts_are_many(measure):
    wall = problems.wall(35, columns=35, push=1.0)
    solution = wall.solve(measure=measure)
    swept, at_rest = solution.stages
    assert (swept.method, at_rest.method) == ("gauss_seidel", "least_norm")
    assert 1 <= swept.iterations <= 4
    assert at_rest.factorizations == 1
    shared = wall.solve(asp.Auto(threads=2), measure=measure)
    assert shared.percussion.tobytes() == solution.percussion.tobytes()


@pytest.mark.parametrize("law", [None, asp.FrictionLaw.associated(asp.Rectangle(0.5, 0.4))])
def test_a_stack_whose_top_slides_is_solved(law):
    # Not everything sticks: that everything would is the wrong guess.
    solution = solved(problems.stack(250, push=8.0, law=law))
    assert np.linalg.norm(solution.velocity[-12:].reshape(4, 3)[:, 1:], axis=1).min() > 1e-3


SMOOTH = asp.FrictionLaw.isotropic(0.1)
"""With μ = 0.5 columns of spheres have several solutions."""


def test_accelerated_sweeps_find_what_factorisations_do():
    problem = problems.columns(18, height=10, law=SMOOTH)
    swept = solved(problem)
    accelerated = swept.stages[-1]
    assert accelerated.method == "accelerated_gauss_seidel"
    assert accelerated.iterations > 20
    assert factorizations(swept) <= 10
    factored = solved(problem, solver=asp.ProximalPoint())
    np.testing.assert_allclose(swept.velocity, factored.velocity, atol=1e-5)


@pytest.mark.parametrize("columns", [12, 26, 46, 70])
def test_accelerated_sweeps_leave_states_that_are_unstable(columns):
    # Defects of plain sweeps grow slowly there, and an acceleration that returns to them would
    # never end.
    solution = solved(problems.columns(columns, height=10))
    assert {stage.method for stage in solution.stages} == {
        "gauss_seidel",
        "accelerated_gauss_seidel",
    }


def without_bodies(problem, **options):
    """Return the same problem as blocks of G."""
    return asp.ContactProblem(
        problem.delassus, free_velocity=problem.free_velocity, laws=problem.laws, **options
    )


def test_threads_do_not_change_accelerated_sweeps():
    problem = problems.columns(46, height=10)
    one, two = (solved(problem, solver=asp.Auto(threads=n)) for n in (1, 2))
    assert one.stages[-1].method == "accelerated_gauss_seidel"
    assert np.array_equal(one.percussion, two.percussion)


@pytest.mark.parametrize(
    ("layers", "friction", "speed"), every(2, [(6, 0.35, 0.0), (7, 0.35, 0.1)])
)
def test_piles_that_accelerated_sweeps_do_not_end_are_solved(layers, friction, speed):
    """In all units, by the same steps."""
    problem = problems.pile(layers, law=asp.FrictionLaw.isotropic(friction), speed=speed)
    scaled = asp.ContactProblem.from_bodies(
        2.0**30 * problem.mass,
        directions=problem.directions,
        free_velocity=problem.free_velocity * 2.0**-30,
        laws=problem.laws,
    )
    solution = solved(problem)
    assert "admm" in [stage.method for stage in solution.stages]
    assert np.array_equal(solved(scaled).percussion, solution.percussion)


@pytest.mark.parametrize("axes", [1.0, 0.7, 0.1])
def test_problems_of_bodies_and_of_blocks_have_the_same_solutions(axes):
    """Friction of ellipses in all directions, masses that differ, and restitution."""
    random = np.random.default_rng(4)
    for count in (12, 20):
        base = problems.columns(count, height=10, seed=count)
        laws = [
            asp.FrictionLaw.associated(asp.Ellipse(mu, axes * mu, angle=10.0 * turn))
            for mu, turn in random.uniform(0.1, 0.3, (len(base.laws), 2))
        ]
        masses = np.repeat(10.0 ** random.uniform(-0.5, 0.5, base.mass.shape[0] // 6), 6)
        options = {
            "normal_restitution": 0.3,
            "initial_velocity": random.normal(size=len(base.free_velocity)),
        }
        bodies = asp.ContactProblem.from_bodies(
            base.mass * masses,
            directions=base.directions,
            free_velocity=base.free_velocity,
            laws=laws,
            **options,
        )
        blocks = without_bodies(bodies, **options)
        first, second = solved(bodies), solved(blocks)
        assert first.iterations < 1000
        assert blocks.natural_map(first.percussion) <= TOLERANCE
        assert bodies.natural_map(second.percussion) <= TOLERANCE
