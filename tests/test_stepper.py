"""Steps of mechanisms: contacts among joints, limits, dry joints and rows that nothing moves."""

import copy
import itertools
import pickle
import subprocess
import sys

import numpy as np
import pytest
import scipy.sparse
from asperity import (
    ADMM,
    ContactProblem,
    ContactStepper,
    Ellipse,
    Exact,
    FrictionLaw,
    InteriorPoint,
    NoSolutionError,
    ParameterError,
    Phase,
    ProxGaussSeidel,
    Status,
)
from asperity.contact.grading import proves_no_solution
from profiles import counts
from scipy.linalg import block_diag
from scipy.optimize import linprog
from scipy.sparse import coo_array, csc_array, csr_array

FREE, JOINT, DRY = (
    ContactStepper.FRICTIONLESS,
    ContactStepper.BILATERAL,
    ContactStepper.DRY_FRICTION,
)
LAWS = (
    FrictionLaw.isotropic(0.5),
    FrictionLaw(Ellipse(0.6, 0.3), Ellipse(0.6, 0.3)),
    FrictionLaw(Ellipse(0.6, 0.4), Ellipse(0.3, 0.5)),
    FrictionLaw.isotropic(0.4, dimension=1),
)
TOLERANCE = 1e-10


def row_starts(items):
    sizes = [1 + LAWS[item].dimension if item >= 0 else 1 for item in items]
    return np.cumsum([0, *sizes])


def mechanism(rng, *, coordinates=12):
    """Random rows of a mechanism with as many coordinates; loops repeat some joints."""
    items = rng.choice([FREE, JOINT, DRY, 0, 1, 2, 3], size=rng.integers(1, 7)).tolist()
    starts = row_starts(items)
    rows = rng.normal(size=(starts[-1], coordinates))
    mass = rng.uniform(0.1, 10.0, coordinates)
    speed = rng.normal(size=coordinates)
    joints = [start for start, item in zip(starts, items, strict=False) if item == JOINT]
    if len(joints) > 1 and rng.random() < 0.5:
        # The last one repeats the others.
        rows[joints[-1]] = rng.normal(size=len(joints) - 1) @ rows[joints[:-1]]
    for start, item in zip(starts, items, strict=False):
        if item in (0, 1, 2) and rng.random() < 0.2:
            # A planar model: one direction of the plane of contact is dead.
            angle = rng.uniform(0.0, np.pi) if rng.random() < 0.5 else 0.0
            along = rng.normal(size=coordinates)
            rows[start + 1], rows[start + 2] = np.cos(angle) * along, np.sin(angle) * along
    delassus = rows / mass @ rows.T
    bounds = rng.uniform(0.0, 2.0, len(items)) * (rng.random(len(items)) < 0.9)
    return items, delassus, rows @ speed, bounds


def check(items, delassus, free, bounds, step):
    """Assert the laws of all items at the percussions of a step, by hand."""
    velocity = delassus @ step.percussion + free
    np.testing.assert_allclose(step.velocity, velocity, atol=1e-12 * np.abs(free).max())
    unit = np.abs(free).max() / np.diag(delassus).max()
    small_p = 1e-6 * max(unit, np.abs(step.percussion).max())
    small_v = 1e-6 * max(np.abs(free).max(), np.abs(velocity).max())
    for k, (item, start) in enumerate(zip(items, row_starts(items), strict=False)):
        p, v = step.percussion[start], velocity[start]
        if item == JOINT:
            assert abs(v) < small_v
        elif item == DRY:
            assert abs(p) <= bounds[k] + small_p
            assert abs(v) < small_v or abs(p + bounds[k] * np.sign(v)) < small_p
        else:
            assert p >= -small_p
            assert v >= -small_v
            assert min(p / small_p, v / small_v) < 1.0
        if item >= 0:
            law, end = LAWS[item], start + 1 + LAWS[item].dimension
            friction, slip = step.percussion[start + 1 : end], velocity[start + 1 : end]
            if p > small_p:
                assert law.reservoir.gauge(-friction / p) < 1.0 + 1e-6
                if np.linalg.norm(slip) > small_v:
                    expected = law.force(slip, normal_force=p)
                    assert np.linalg.norm(friction - expected) < small_p


@counts(300, 10_000)
def test_all_rows_obey_their_laws(count):
    rng = np.random.default_rng(0)
    stepper = ContactStepper(LAWS, tolerance=TOLERANCE)
    converged = 0
    for seed in range(count):
        items, delassus, free, bounds = mechanism(rng)
        stepper.forget()
        step = stepper.solve(
            delassus, free_velocity=free, items=items, bounds=bounds, on_failure="record"
        )
        converged += step.converged
        if step.converged:
            try:
                check(items, delassus, free, bounds, step)
            except AssertionError as error:
                raise AssertionError(f"seed {seed}: {items}") from error
    # With less friction than Painleve's paradox takes there is always a solution.
    assert converged >= 0.99 * count


@counts(30, 1000)
def test_the_order_of_items_leaves_every_bit(count):
    rng = np.random.default_rng(1)
    for _ in range(count):
        items, delassus, free, bounds = mechanism(rng, coordinates=5)
        keys, starts = rng.permutation(1000)[: len(items)] - 500, row_starts(items)
        stepper, other = ContactStepper(LAWS), ContactStepper(LAWS)
        one = stepper.solve(
            delassus, free_velocity=free, items=items, bounds=bounds, keys=keys, on_failure="record"
        )
        order = rng.permutation(len(items))
        rows = np.concatenate([np.arange(starts[k], starts[k + 1]) for k in order])
        two = other.solve(
            delassus[np.ix_(rows, rows)],
            free_velocity=free[rows],
            items=np.array(items)[order],
            bounds=bounds[order],
            keys=keys[order],
            on_failure="record",
        )
        assert one.status == two.status
        assert np.array_equal(one.percussion[rows], two.percussion)
        assert np.array_equal(one.phase[order], two.phase)


@counts(50, 1000)
def test_contacts_alone_are_a_contact_problem(count):
    rng = np.random.default_rng(2)
    for _ in range(count):
        items = rng.choice([0, 1, 2, 3], size=rng.integers(1, 6)).tolist()
        rows = rng.normal(size=(row_starts(items)[-1], 20))
        delassus, free = rows @ rows.T, rows @ rng.normal(size=20)
        step = ContactStepper(LAWS).solve(delassus, free_velocity=free, items=items)
        problem = ContactProblem(delassus, free_velocity=free, laws=[LAWS[item] for item in items])
        solution = problem.solve()
        assert np.array_equal(step.percussion, solution.percussion)
        assert np.array_equal(step.phase, solution.phase)
        assert step.residual == solution.residual


@counts(50, 1000)
def test_contacts_among_joints_are_a_contact_problem(count, tmp_path):
    """Solved without the stepper it has the percussions of a step, and it goes into a file."""
    rng = np.random.default_rng(3)
    stepper = ContactStepper(LAWS)
    for _ in range(count):
        items = [0, *rng.choice([0, 1, 2, 3, FREE, JOINT, DRY], size=rng.integers(1, 6)).tolist()]
        starts = row_starts(items)
        rows = rng.normal(size=(starts[-1], 20))
        delassus, free = rows @ rows.T, rows @ rng.normal(size=20)
        bounds = rng.uniform(0.0, 2.0, len(items))
        stepper.forget()
        step = stepper.solve(delassus, free_velocity=free, items=items, bounds=bounds)
        problem, places = stepper.contact_problem()
        assert places.tolist() == [k for k, item in enumerate(items) if item != JOINT]
        solution = problem.solve(ProxGaussSeidel())
        for own, k in zip(problem.row_slices, places, strict=True):
            found = step.percussion[starts[k] : starts[k + 1]]
            np.testing.assert_allclose(solution.percussion[own][: len(found)], found, atol=1e-6)
    problem.save(tmp_path / "problem.npz")
    assert ContactProblem.load(tmp_path / "problem.npz") == problem


@counts(100, 5000)
def test_conic_methods_solve_dry_joints_beside_contacts(count):
    rng = np.random.default_rng(4)
    laws, stalled = (*LAWS, FrictionLaw.isotropic(0.3, dimension=3)), 0
    for seed in range(count):
        items = [DRY, *rng.choice([DRY, FREE, JOINT, 0, 1, 2, 3, 4], size=rng.integers(1, 7))]
        sizes = [1 + laws[item].dimension if item >= 0 else 1 for item in items]
        rows = rng.normal(size=(sum(sizes), sum(sizes) + 4))
        options = {
            "free_velocity": rows @ rng.normal(size=len(rows[0])),
            "items": items,
            "bounds": 10.0 ** rng.uniform(-3.0, 3.0, len(items)) * (rng.random(len(items)) < 0.9),
        }
        one = ContactStepper(laws).solve(rows @ rows.T, **options)
        size = max(1.0, np.abs(one.percussion).max())
        for solver in (InteriorPoint(), ADMM()):
            stepper = ContactStepper(laws, solver=solver)
            step = stepper.solve(rows @ rows.T, **options, on_failure="record")
            stalled += not step.converged
            certificate = stepper.certificate()
            assert certificate.natural_map < 1e-9, (seed, solver)
            assert certificate.direction_violation < 1e-9 * size, (seed, solver)
            if not one.ambiguous_items.any():
                np.testing.assert_allclose(step.percussion, one.percussion, atol=1e-6 * size)
    # Of 5,000 problems the interior point method ends three at 1.7e-10.
    assert stalled <= count // 1000


@pytest.mark.parametrize("ratio", [1e-12, 1e-15])
def test_light_links_are_no_contradiction(ratio):
    """A bar strikes a stop, tied to a second one by a light link: masses tell, G does not."""
    mass = np.diag([1.0, 1.0, ratio])
    joints, stop = np.array([[1.0, 0.0], [0.0, 1.0], [-1.0, -1.0]]), np.array([[0.0], [1.0], [0.0]])
    rows, speed = np.hstack([joints, stop]), np.array([-1.0, 0.0, 0.0])
    step = {"free_velocity": rows.T @ speed, "items": [JOINT, JOINT, FREE]}
    with pytest.raises(NoSolutionError, match="a link is so light that G") as caught:
        ContactStepper(LAWS).solve(rows.T @ np.linalg.solve(mass, rows), **step)
    assert "contradict each other, or" in str(caught.value)
    assert "no percussion" not in str(caught.value)
    problem = ContactProblem.from_bodies(
        mass,
        directions=stop,
        free_velocity=stop.T @ speed,
        laws=None,
        bilateral=joints,
        bilateral_velocity=joints.T @ speed,
    )
    found = problem.solve().percussion
    reaction = problem.bilateral_percussion(found)
    np.testing.assert_allclose([*reaction, *found], [1.0, -1.0, 1.0], rtol=1e-6)
    heavier = np.diag([1.0, 1.0, 1e-8])
    held = ContactStepper(LAWS).solve(rows.T @ np.linalg.solve(heavier, rows), **step)
    np.testing.assert_allclose(held.percussion, [1.0, -1.0, 1.0], rtol=1e-6)


def test_a_step_without_a_solution_hands_over_its_proof():
    stepper = ContactStepper(FrictionLaw.isotropic(1.0, dimension=1))
    delassus = np.array([[1.0, 2.0, 0.0], [2.0, 3.0, 0.0], [0.0, 0.0, 1.0]])
    with pytest.raises(NoSolutionError) as caught:
        stepper.solve(delassus, free_velocity=[-1.0, 5.0, 0.3], items=[0, JOINT])
    assert proves_no_solution(caught.value.problem, caught.value.infeasibility)


@pytest.mark.parametrize("scale", [1e-3, 0.3, 1.0, 1e3])
def test_bodies_that_a_joint_squeezes_are_no_contradiction_of_joints(scale):
    rows = np.array([[1.0, 0.0, scale], [0.0, -1.0, -scale]])
    stepper = ContactStepper([])
    kinds = [FREE, FREE, JOINT]
    with pytest.raises(NoSolutionError) as caught:
        stepper.solve(rows.T @ rows, free_velocity=[-1.0, -1.0, 0.0], items=kinds)
    assert "are left" not in str(caught.value)
    assert proves_no_solution(caught.value.problem, caught.value.infeasibility)


def test_feet_that_slide_in_different_directions_share_as_if_of_equal_compliance():
    """Those of a box that slides and turns, whatever the order of its feet."""
    inertia, feet = np.diag([0.018] * 3 + [2.55e-6, 2.55e-6, 4.8e-6]), [(-1, -1), (1, -1), (-1, 1)]
    rows = [
        [*axis, *np.cross([0.02 * x, 0.02 * y, -0.005], axis)]
        for x, y in [*feet, (1, 1)]
        for axis in np.eye(3)[[2, 0, 1]]
    ]
    rows, speed = np.array(rows), np.array([0.8, 1.2, -9.81e-3, 0.0, 0.0, 10.0])
    loads = []
    for order in itertools.permutations(range(4)):
        own = rows.reshape(4, 3, 6)[list(order)].reshape(12, 6)
        step = ContactStepper(LAWS[0]).solve(
            own @ np.linalg.solve(inertia, own.T), free_velocity=own @ speed, items=[0] * 4
        )
        loads.append(step.percussion[::3][np.argsort(order)])
    assert np.ptp(loads, axis=0).max() < 1e-9 * np.max(loads)
    # Loads of a plane: what a rigid body on equal springs has.
    assert abs(loads[0] @ [1.0, -1.0, -1.0, 1.0]) < 1e-9 * np.max(loads)


def test_dead_rows_of_an_ellipse_have_the_friction_along_the_direction_that_is_left():
    # The ellipse of 0.8 and 0.2, turned by 30 degrees: its extent along x.
    law = FrictionLaw(*[Ellipse(0.8, 0.2, angle=np.pi / 6)] * 2)
    step = ContactStepper(law).solve(
        np.diag([1.0, 1.0, 0.0]), free_velocity=[-1.0, 3.0, 0.0], items=[0]
    )
    extent = np.hypot(0.8 * np.cos(np.pi / 6), 0.2 * np.sin(np.pi / 6))
    assert step.percussion[1] == pytest.approx(-extent, rel=1e-12)
    np.testing.assert_allclose(step.percussion[1:], law.force([2.0, 0.0], normal_force=1.0))


@pytest.mark.parametrize("law", LAWS[:3])
def test_bodies_that_slide_across_what_can_move(law):
    # Nothing moves along y but the surface, at 3 m/s.
    step = ContactStepper(law).solve(
        np.diag([1.0, 2.0, 0.0]), free_velocity=[-1.0, 1.0, 3.0], items=[0]
    )
    slip = step.velocity[1:]
    assert slip[1] == 3.0
    expected = law.force(slip, normal_force=step.percussion[0])
    np.testing.assert_allclose(step.percussion[1:], expected, atol=1e-7)


@pytest.mark.parametrize("across", [1e-1, 1e-2, 1e-3])
def test_bodies_that_hardly_slide_across_what_can_move(across):
    step = ContactStepper(LAWS[1]).solve(
        np.diag([1.0, 1.0, 0.0]), free_velocity=[-1.0, 0.5, across], items=[0]
    )
    expected = LAWS[1].force(step.velocity[1:], normal_force=step.percussion[0])
    np.testing.assert_allclose(step.percussion[1:], expected, atol=1e-9)


def test_a_contact_that_nothing_moves_carries_nothing():
    delassus = np.diag([0.0, 0.0, 0.0, 2.0])
    step = ContactStepper(LAWS).solve(
        delassus, free_velocity=[0.0, 0.0, 0.0, -1.0], items=[0, FREE]
    )
    np.testing.assert_allclose(step.percussion, [0.0, 0.0, 0.0, 0.5])
    assert step.phase.tolist() == [Phase.NONE, Phase.STICK]
    with pytest.raises(NoSolutionError, match="item 0, where 1 m/s are left"):
        ContactStepper(LAWS).solve(delassus, free_velocity=[-1.0, 0.0, 0.0, -1.0], items=[0, FREE])


def test_redundant_joints_share_and_contradicting_ones_end():
    stepper = ContactStepper(LAWS[0])
    ones = np.ones((2, 2))
    shared = stepper.solve(ones, free_velocity=[-1.0, -1.0], items=[JOINT, JOINT])
    np.testing.assert_allclose(shared.percussion, [0.5, 0.5])
    # Drift makes rows differ that loops repeat; large percussions do not hide it.
    opposed = np.array([[1.0, -1.0], [-1.0, 1.0]])
    drift = stepper.solve(opposed, free_velocity=[-1.0 - 1e-9, 1.0], items=[JOINT, JOINT])
    np.testing.assert_allclose(drift.percussion, [0.5, -0.5], atol=1e-9)
    assert drift.mismatch == pytest.approx(5e-10, rel=1e-3)
    with pytest.raises(NoSolutionError, match=r"item [01], where 0\.5 m/s are left"):
        stepper.solve(opposed, free_velocity=[-2.0, 1.0], items=[JOINT, JOINT])


@pytest.mark.parametrize("seed", [612, 1314, 1874, 2918])
def test_percussions_that_run_away_do_not_hide_that_joints_move(seed):
    """No velocity opens the contacts, by at least 1e-3 m/s, while the joints rest."""
    rng = np.random.default_rng(seed)
    rows, free = rng.normal(size=(3, 10)), rng.normal(size=10)
    delassus, joints = rows.T @ rows, [3, 7]
    inside = np.vstack([-rows[:, [0, 4, 8, 9]], np.ones(4)]).T
    held = np.vstack([rows[:, joints], np.zeros(2)]).T
    least = [0.0, 0.0, 0.0, -1.0]
    bounds = (None, 9.0)
    nearest = linprog(least, inside, free[[0, 4, 8, 9]], held, -free[joints], bounds=bounds)
    assert nearest.x[3] < -1e-3
    step = ContactStepper(FrictionLaw.isotropic(0.3)).solve(
        0.5 * (delassus + delassus.T),
        free_velocity=free,
        items=[0, JOINT, 0, JOINT, FREE, FREE],
        on_failure="record",
    )
    assert step.status is Status.UNBOUNDED
    assert np.abs(step.velocity[joints]).max() == step.mismatch > 0.01


@pytest.mark.parametrize("change", 10.0 ** np.arange(-9.0, -2.0, 0.5))
def test_joints_that_almost_repeat_each_other_hold(change):
    rng = np.random.default_rng(17)
    for _ in range(20):
        rows = rng.normal(size=(7, 8))
        rows[3] = rows[0] + change * rng.normal(size=8)
        free = rows @ rng.normal(size=8)
        step = ContactStepper(LAWS).solve(
            rows / rng.uniform(0.1, 10.0, 8) @ rows.T, free_velocity=free, items=[JOINT] * 4 + [0]
        )
        assert np.abs(step.velocity[:4]).max() < 1e-6 * np.abs(free[:4]).max()


def test_fast_rows_elsewhere_hide_nothing():
    with pytest.raises(NoSolutionError, match=r"item 0, where 0\.5 m/s are left"):
        ContactStepper(LAWS[0]).solve(
            np.diag([0.0, 0.0, 0.0, 1.0]), free_velocity=[-0.5, 0.0, 0.0, 1e6], items=[0, FREE]
        )
    joints = np.array([[1.0, 1.0, 0.0], [1.0, 1.0, 0.0], [0.0, 0.0, 1.0]])
    with pytest.raises(NoSolutionError, match=r"0\.001 m/s are left"):
        ContactStepper(LAWS[0]).solve(
            joints, free_velocity=[-1e-3, 1e-3, 1e4], items=[JOINT, JOINT, JOINT]
        )


def test_a_joint_holds_a_contact_in_place():
    # A block of 2 kg on rails: the joint takes one direction of the plane, friction the other.
    rows = np.vstack([np.eye(3), [0.0, 0.0, 1.0]])
    step = ContactStepper(LAWS[1]).solve(
        rows @ rows.T / 2.0, free_velocity=rows @ [-1.0, 2.0, 5.0], items=[0, JOINT]
    )
    np.testing.assert_allclose(step.percussion, [2.0, -1.2, 0.0, -10.0], rtol=1e-12)
    assert step.phase.tolist() == [Phase.SLIP, Phase.STICK]


def test_a_dry_joint_at_half_its_bound_holds():
    step = ContactStepper(LAWS[0]).solve([[4.0]], free_velocity=[0.6], items=[DRY], bounds=[0.3])
    assert step.velocity.tolist() == [0.0]
    free = ContactStepper(LAWS[0]).solve([[4.0]], free_velocity=[0.6], items=[DRY], bounds=[0.0])
    assert free.velocity.tolist() == [0.6]


def test_a_step_goes_on_from_the_items_of_the_step_before():
    # A corner of the direction set: both stick and slip are solutions; the phase before decides.
    rng = np.random.default_rng(3)
    rows = rng.normal(size=(9, 4))
    delassus, free = rows @ rows.T, rows @ rng.normal(size=4)
    stepper = ContactStepper(LAWS[2])
    first = stepper.solve(delassus, free_velocity=free, items=[0, 0, 0], keys=[7, 8, 9])
    again = stepper.solve(delassus, free_velocity=free, items=[0, 0, 0], keys=[7, 8, 9])
    assert again.iterations <= first.iterations
    swapped = [3, 4, 5, 0, 1, 2, 6, 7, 8]
    other = stepper.solve(
        delassus[np.ix_(swapped, swapped)],
        free_velocity=free[swapped],
        items=[0, 0, 0],
        keys=[8, 7, 9],
    )
    np.testing.assert_allclose(other.percussion, again.percussion[swapped], atol=1e-12)


def test_no_items_are_solved():
    step = ContactStepper(LAWS).solve(np.zeros((0, 0)), free_velocity=[], items=[])
    assert step.converged
    assert step.percussion.size == 0


@pytest.mark.parametrize(
    ("changes", "argument", "message"),
    [
        ({"items": [9]}, "items", "item 0 must be the number of one of"),
        ({"items": [-7]}, "items", "item 0 must be the number of one of"),
        ({"items": [0.5]}, "items", "integers"),
        ({"items": [0, FREE]}, "free_velocity", "each of the 4 rows of items, has 3"),
        ({"keys": [1, 2]}, "keys", "1"),
        ({"items": [FREE] * 3, "keys": [4, 5, 4]}, "keys", "items 0 and 2"),
        ({"free_velocity": [np.nan, 0.0, 0.0]}, "free_velocity", "finite"),
        ({"delassus": -np.eye(3)}, "delassus", "negative"),
        ({"delassus": np.eye(3) + np.eye(3, k=1), "items": [JOINT] * 3}, "delassus", "symmetric"),
        ({"delassus": np.eye(3)[:2]}, "delassus", r"entries, 3, got shape \(2, 3\)"),
        ({"delassus": np.eye(2)}, "delassus", r"entries, 3, got shape \(2, 2\)"),
        ({"items": [DRY] * 3}, "bounds", "must be given, item 0 is DRY_FRICTION"),
        ({"items": [DRY] * 3, "bounds": [1.0]}, "bounds", "one entry per item"),
    ],
)
def test_what_is_wrong_is_named(changes, argument, message):
    arguments = {"delassus": np.eye(3), "free_velocity": [-1.0, 0.0, 0.0], "items": [0], **changes}
    with pytest.raises(ParameterError, match=message) as error:
        ContactStepper(LAWS).solve(arguments.pop("delassus"), **arguments)
    assert error.value.argument == argument


def test_status_is_recorded():
    squeezed = np.array([[1.0, -1.0], [-1.0, 1.0]])
    step = ContactStepper(LAWS).solve(
        squeezed, free_velocity=[-1.0, -1.0], items=[FREE, FREE], on_failure="record"
    )
    assert step.status is Status.NO_SOLUTION


def test_velocities_do_not_depend_on_the_order_to_the_bit():
    rng = np.random.default_rng(4)
    for _ in range(30):
        items, delassus, free, bounds = mechanism(rng)
        keys, starts = rng.permutation(len(items)), row_starts(items)
        order = rng.permutation(len(items))
        rows = np.concatenate([np.arange(starts[k], starts[k + 1]) for k in order])
        options = {"free_velocity": free, "items": items, "bounds": bounds, "keys": keys}
        one = ContactStepper(LAWS).solve(delassus, on_failure="record", **options)
        options = {"items": np.array(items)[order], "bounds": bounds[order], "keys": keys[order]}
        two = ContactStepper(LAWS).solve(
            delassus[np.ix_(rows, rows)], free_velocity=free[rows], on_failure="record", **options
        )
        assert np.array_equal(one.velocity[rows], two.velocity)
        assert one.mismatch == two.mismatch


def test_threads_wait_for_a_stepper():
    # In a process of its own, as threads that hold each other cannot be stopped.
    script = """
import threading, numpy as np, asperity as asp
rng = np.random.default_rng(0)
rows = rng.normal(size=(120, 60))
stepper = asp.ContactStepper(asp.FrictionLaw.isotropic(0.5))
def run():
    for _ in range(20):
        stepper.solve(rows @ rows.T, free_velocity=rows[:, 0], items=[0] * 40, on_failure="record")
threads = [threading.Thread(target=run) for _ in range(3)]
[thread.start() for thread in threads]
[thread.join() for thread in threads]
"""
    subprocess.run([sys.executable, "-c", script], check=True, timeout=60)


def test_joints_without_a_finite_velocity_are_no_solution():
    step = ContactStepper(LAWS).solve(
        np.diag([1e-300, 1e-300]),
        free_velocity=[1e100, 1e100],
        items=[JOINT, JOINT],
        on_failure="record",
    )
    assert step.status is Status.NO_SOLUTION


def test_bounds_of_other_items_do_not_count():
    step = ContactStepper(LAWS).solve(
        np.eye(5),
        free_velocity=[-1.0, 0.0, 0.0, 0.2, 0.5],
        items=[0, JOINT, DRY],
        bounds=[np.nan, -1.0, 0.3],
    )
    assert step.percussion[4] == -0.3


def test_keys_are_integers_of_64_bits():
    stepper, squeezed = ContactStepper(LAWS), {"free_velocity": [-1.0, -1.0], "items": [FREE, FREE]}
    assert stepper.solve(np.eye(2), keys=[2**53, 2**53 + 1], **squeezed).converged
    with pytest.raises(ParameterError, match="keys: must be integers, less than"):
        stepper.solve(np.eye(2), keys=np.array([2**63 + 1, 3], dtype=np.uint64), **squeezed)


def test_copies():
    stepper = ContactStepper(LAWS, solver=Exact(), tolerance=1e-9)
    step = stepper.solve(np.eye(3), free_velocity=[-1.0, 3.0, 0.0], items=[0])
    for again in (copy.copy(stepper), pickle.loads(pickle.dumps(stepper))):
        assert again.tolerance == 1e-9
        assert again.laws == stepper.laws
        other = again.solve(np.eye(3), free_velocity=[-1.0, 3.0, 0.0], items=[0])
        assert np.array_equal(other.percussion, step.percussion)
    same = pickle.loads(pickle.dumps(step))
    assert repr(same) == repr(step)
    assert np.array_equal(same.velocity, step.velocity)
    assert not same.velocity.flags.writeable
    with pytest.raises(AttributeError, match="immutable"):
        step.percussion = 0.0


def several(rng, count=4):
    """Random mechanisms that do not meet, all their rows in one list, and keys of their items."""
    parts = [mechanism(rng) for _ in range(count)]
    items = [item for own, *_ in parts for item in own]
    delassus = block_diag(*(own[1] for own in parts))
    free, bounds = (np.concatenate([own[k] for own in parts]) for k in (2, 3))
    return parts, items, delassus, free, bounds, rng.permutation(len(items))


def test_sparse_matrices_have_the_steps_of_dense_ones():
    rng = np.random.default_rng(11)
    one, two = ContactStepper(LAWS), ContactStepper(LAWS)
    for number in range(30):
        _, items, delassus, free, bounds, keys = several(rng)
        starts = row_starts(items)
        order = rng.permutation(len(items))
        rows = np.concatenate([np.arange(starts[k], starts[k + 1]) for k in order])
        sparse = (coo_array, csc_array, csr_array)[number % 3](delassus[np.ix_(rows, rows)])
        for _ in range(2):  # From the percussions of the step before, too.
            options = {"free_velocity": free, "items": items, "bounds": bounds, "keys": keys}
            dense = one.solve(delassus, on_failure="record", **options)
            other = two.solve(
                sparse,
                free_velocity=free[rows],
                items=np.array(items)[order],
                bounds=bounds[order],
                keys=keys[order],
                on_failure="record",
            )
            np.testing.assert_array_equal(other.percussion, dense.percussion[rows])
            np.testing.assert_array_equal(other.velocity, dense.velocity[rows])
            np.testing.assert_array_equal(other.phase, dense.phase[order])
            assert (other.status, other.iterations) == (dense.status, dense.iterations)
            free = 0.9 * free


def test_mechanisms_that_do_not_meet_move_as_each_alone():
    rng = np.random.default_rng(12)
    for _ in range(20):
        parts, items, delassus, free, bounds, _ = several(rng)
        together = ContactStepper(LAWS, tolerance=1e-12).solve(
            csr_array(delassus), free_velocity=free, items=items, bounds=bounds, on_failure="record"
        )
        first = 0
        for own_items, own, own_free, own_bounds in parts:
            alone = ContactStepper(LAWS, tolerance=1e-12).solve(
                own,
                free_velocity=own_free,
                items=own_items,
                bounds=own_bounds,
                on_failure="record",
            )
            past = first + len(own_free)
            scale = np.abs(alone.velocity).max() + np.abs(own_free).max()
            if alone.converged:
                np.testing.assert_allclose(
                    together.velocity[first:past], alone.velocity, atol=1e-8 * scale
                )
            first = past


@pytest.mark.parametrize(
    ("delassus", "message"),
    [
        (csr_array(np.eye(2)), r"entries, 3, got shape \(2, 2\)"),
        (csr_array(np.eye(3, 2)), r"entries, 3, got shape \(3, 2\)"),
        (csc_array(np.eye(3, 7)), r"entries, 3, got shape \(3, 7\)"),
        (csr_array(np.diag([1.0, np.nan, 1.0])), "finite"),
    ],
)
def test_what_is_wrong_with_sparse_matrices_is_named(delassus, message):
    with pytest.raises(ParameterError, match=message) as error:
        ContactStepper(LAWS).solve(delassus, free_velocity=np.zeros(3), items=[0])
    assert error.value.argument == "delassus"


def test_a_matrix_that_is_not_symmetric_is_refused():
    rng = np.random.default_rng(0)
    rows = rng.standard_normal((12, 6))
    delassus, free = rows @ rows.T, rng.standard_normal(12)
    stepper = ContactStepper([FrictionLaw.isotropic(0.5)])
    known = stepper.solve(delassus, free_velocity=free, items=[0] * 4).percussion
    rounded = delassus * (1.0 + 1e-12 * rng.standard_normal(delassus.shape))
    stepper.forget()
    found = stepper.solve(rounded, free_velocity=free, items=[0] * 4).percussion
    np.testing.assert_allclose(rows.T @ found, rows.T @ known, atol=1e-8)
    for form in (np.asarray, scipy.sparse.csr_array):
        for row, column in ((0, 7), (7, 0), (4, 5)):
            other = delassus.copy()
            other[row, column] += 1e-3
            with pytest.raises(ParameterError, match="delassus: must be symmetric"):
                stepper.solve(form(other), free_velocity=free, items=[0] * 4)


@pytest.mark.parametrize("power", range(13))
def test_squeezed_bodies_beside_a_joint_are_no_solution_whatever_their_masses(power):
    """Two stops drive bodies against a joint between them, one up to 10¹² times as heavy."""
    rows = np.array([[1.0, 0.0, 1.0], [0.0, -1.0, -1.0]])
    delassus = rows.T @ np.diag([1.0, 10.0**-power]) @ rows
    items = [FREE, FREE, JOINT]
    step = ContactStepper([]).solve(
        delassus, free_velocity=[-1.0, -1.0, 0.0], items=items, on_failure="record"
    )
    assert step.status in (Status.NO_SOLUTION, Status.UNBOUNDED)


@pytest.mark.parametrize("seed", [0, 6, 9])
def test_pads_that_slide_along_a_cube_are_solved_whatever_rounding_makes_of_their_gaps(seed):
    """Two pads on slides that a lift carries and dry friction holds squeeze a cube."""
    mass = np.diag([1.2, 0.1, 0.1, *[0.2] * 3, *[1.2e-4] * 3])
    listed = [np.eye(9)[0]]
    for side, y, z in itertools.product((0, 1), (-0.02, 0.02), (-0.01, 0.03)):
        inwards = 1.0 - 2.0 * side
        normal, first = np.array([inwards, 0.0, 0.0]), np.array([0.0, 0.0, 1.0])
        for axis in (normal, first, np.cross(normal, first)):
            pads = np.array([axis[2], *(axis[0] * np.eye(2)[side])])
            arm = np.array([-0.03 * inwards, y, z])
            listed.append(np.concatenate([-pads, axis, np.cross(arm, axis)]))
    rows = np.array(listed)
    free = rows @ [0.09, 0.015, -0.015, 0.0, 0.0, 0.077, 0.0, 0.0, 0.0]
    rng = np.random.default_rng(seed)
    free[1::3] += 10.0 ** rng.uniform(-12, -9) * rng.normal(size=8)
    step = ContactStepper(FrictionLaw.associated(Ellipse(0.3, 0.8))).solve(
        rows @ np.linalg.solve(mass, rows.T),
        free_velocity=free,
        items=[DRY] + [0] * 8,
        bounds=[1e-3] + [0.0] * 8,
    )
    assert step.residual < 1e-10
