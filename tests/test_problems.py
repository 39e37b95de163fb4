"""The generated scenes against statics and rigid kinematics, and the problems made of them."""

import asperity as asp
import numpy as np
import pytest
from asperity import problems
from asperity.problems import scenes
from scipy.optimize import linprog
from scipy.sparse import eye_array, kron

IMPULSE = 9.81 * 0.01
SCENES = {
    "stack": (scenes.stack(5, half_sizes=[0.4, 0.3, 0.1], mass=2.0), 5, 20, 30),
    "wall": (scenes.wall(4, columns=3), 14, 84, 84),
    "narrow wall": (scenes.wall(5, columns=1), 7, 36, 42),
    "table": (scenes.table(7), 1, 7, 6),
    "line of feet": (scenes.table([[-1.0, 0.0], [0.2, 0.0], [1.0, 0.0]]), 1, 3, 5),
    "one foot": (scenes.table(1), 1, 1, 3),
    "arch": (scenes.arch(9), 9, 40, 54),
    "columns": (scenes.columns(5, height=4, touching=False), 20, 20, 60),
    "touching columns": (scenes.columns(9, height=4), 36, 84, 212),
    "pile": (scenes.pile(3), 14, 45, 84),
}
FREE_STANDING = ["stack", "wall", "narrow wall", "table", "arch", "touching columns", "pile"]


def delassus(scene):
    """Return WᵀM⁻¹W as a dense matrix."""
    directions = scene.directions.toarray()
    return directions.T @ np.linalg.solve(scene.mass_matrix.toarray(), directions)


def at_rest(scene, mu):
    """Return percussions in a pyramid inside the cone that leave all bodies at rest, or None."""
    contacts = len(scene.point)
    # |P_t1|, |P_t2| ≤ μ P_N/√2 for both tangents.
    rows = [
        [-mu / np.sqrt(2.0), sign * (k == 1), sign * (k == 2)] for k in (1, 2) for sign in (1, -1)
    ]
    cone = kron(eye_array(contacts), np.array(rows))
    momentum = -(scene.mass_matrix @ scene.free_motion())
    bounds = [(0.0, None), (None, None), (None, None)] * contacts
    found = linprog(
        np.zeros(3 * contacts),
        A_ub=cone,
        b_ub=np.zeros(4 * contacts),
        A_eq=scene.directions,
        b_eq=momentum,
        bounds=bounds,
    )
    return found.x if found.status == 0 else None


@pytest.mark.parametrize("name", SCENES)
def test_sizes_and_rank(name):
    scene, bodies, contacts, rank = SCENES[name]
    assert (len(scene.mass), len(scene.point)) == (bodies, contacts)
    matrix = delassus(scene)
    np.testing.assert_allclose(matrix, matrix.T, atol=1e-12)
    values = np.linalg.eigvalsh(matrix)
    assert values.min() > -1e-12 * values.max()
    assert (values > 1e-10 * values.max()).sum() == rank


@pytest.mark.parametrize("name", FREE_STANDING)
def test_an_equilibrium_exists_and_carries_the_weight(name):
    scene = SCENES[name][0]
    percussion = at_rest(scene, 0.7)
    assert percussion is not None
    force = np.einsum("nij,ni->nj", scene.frame, percussion.reshape(-1, 3))
    on_bodies = force[scene.lower < 0].sum(axis=0) - force[scene.upper < 0].sum(axis=0)
    np.testing.assert_allclose(on_bodies, [0.0, 0.0, scene.mass.sum() * IMPULSE], atol=1e-9)


def test_an_arch_stands_down_to_the_thickness_of_milankovitch():
    assert at_rest(scenes.arch(100, thickness=0.109), 2.0) is not None
    assert at_rest(scenes.arch(100, thickness=0.106), 2.0) is None


def test_inertia_of_a_voussoir_against_integration():
    scene = scenes.arch(4, thickness=0.6, depth=0.3, mass=2.0)
    nodes, weights = np.polynomial.legendre.leggauss(12)
    r, w_r = 1.0 + 0.3 * nodes, weights * (1.0 + 0.3 * nodes)
    angle, y = np.pi / 8 * (1.0 + nodes), 0.15 * nodes
    radius, turn, along = np.meshgrid(r, angle, y, indexing="ij")
    points = np.stack([radius * np.cos(turn), along, radius * np.sin(turn)], axis=-1).reshape(-1, 3)
    weight = np.einsum("i,j,k->ijk", w_r, weights, weights).ravel()
    weight *= 2.0 / weight.sum()
    np.testing.assert_allclose(scene.center[0], weight @ points / 2.0, atol=1e-12)
    arm = points - scene.center[0]
    moment = np.einsum("k,ki,kj->ij", weight, arm, arm)
    np.testing.assert_allclose(scene.inertia[0], np.trace(moment) * np.eye(3) - moment, atol=1e-12)


@pytest.mark.parametrize("scene", [scenes.columns(7, height=3), scenes.pile(4)])
def test_spheres_touch_and_no_others_do(scene):
    apart = np.linalg.norm(scene.center[:, None] - scene.center, axis=-1)
    touching = np.argwhere(np.triu(np.abs(apart - 1.0) < 1e-9)).tolist()
    between = scene.lower >= 0
    pairs = np.sort(np.column_stack([scene.lower, scene.upper])[between], axis=1).tolist()
    assert sorted(pairs) == sorted(touching)
    assert apart[np.triu_indices(len(apart), 1)].min() > 1.0 - 1e-9
    for body in (scene.lower[between], scene.upper[between]):
        distance = np.linalg.norm(scene.point[between] - scene.center[body], axis=1)
        np.testing.assert_allclose(distance, 0.5)


def test_free_motion():
    scene = scenes.stack(2, mass=2.0)
    velocity = np.arange(12.0).reshape(2, 6)
    motion = scene.free_motion(
        force=scene.pushed(1, push=3.0), velocity=velocity, dt=0.1, gravity=10.0
    )
    expected = velocity + np.zeros((2, 6))
    expected[:, 2] -= 1.0
    expected[1, 0] += 0.15
    np.testing.assert_allclose(motion, expected.ravel())


@pytest.mark.parametrize(
    ("make", "argument"),
    [
        (lambda: scenes.stack(0), "boxes"),
        (lambda: scenes.stack(2, mass=-1.0), "mass"),
        (lambda: scenes.stack(2, half_sizes=[1.0, 1.0]), "half_sizes"),
        (lambda: scenes.wall(2, columns=1.5), "columns"),
        (lambda: scenes.table([[0.0, 0.0, 0.0]]), "feet"),
        (lambda: scenes.arch(3, thickness=2.5), "thickness"),
        (lambda: scenes.columns(2, height=0), "height"),
        (lambda: scenes.pile(2, radius=0.0), "radius"),
        (lambda: scenes.stack(2).replace(lower=np.full(8, 2)), "lower"),
        (lambda: scenes.stack(2).replace(upper=np.full(8, -1)), "upper"),
        (lambda: scenes.stack(2).replace(frame=np.ones((8, 3, 3))), "frame"),
        (lambda: scenes.stack(2).replace(inertia=-np.ones((2, 3, 3))), "inertia"),
        (lambda: scenes.stack(2).free_motion(dt=0.0), "dt"),
        (lambda: scenes.stack(2).free_motion(force=[1.0, 0.0, 0.0]), "force"),
        (lambda: scenes.stack(2).free_motion(velocity=np.full((2, 6), np.nan)), "velocity"),
        (lambda: problems.stack(2, push=np.inf), "push"),
        (lambda: problems.stack(2, law=asp.FrictionLaw.isotropic(0.3, dimension=1)), "law"),
        (lambda: problems.stack(2, law=[asp.FrictionLaw.isotropic(0.3)] * 7), "law"),
        (lambda: problems.stack(2, law=0.5), "law"),
        (lambda: problems.sliders(3, seed=-1), "seed"),
        (lambda: problems.sliders(3, speed=-1.0), "speed"),
    ],
)
def test_bad_arguments_are_named(make, argument):
    with pytest.raises(asp.AsperityError, match=argument):
        make()


def test_the_whole_stack_stays_below_the_friction_limit_and_its_top_slides_beyond():
    for push, speed in ((4.0, 0.0), (6.0, 0.01 * (6.0 - 0.5 * 9.81))):
        problem = problems.stack(4, push=push)
        percussion = problem.solve().percussion.reshape(4, 4, 3)
        np.testing.assert_allclose(percussion[..., 0].sum(axis=1), IMPULSE * np.arange(4, 0, -1))
        change = problem.directions @ percussion.ravel() / problem.mass.diagonal()
        assert change[18] + 0.01 * push == pytest.approx(speed, abs=1e-9)


def test_a_pushed_table_presses_on_its_front_feet():
    percussion = problems.table(4, push=3.0).solve().percussion.reshape(4, 3)
    assert percussion[:, 0].sum() == pytest.approx(IMPULSE)
    # The moment about the ground: push times height 1 m over feet at x = ±1 m.
    assert percussion[0, 0] - percussion[2, 0] == pytest.approx(0.03)


@pytest.mark.parametrize(
    "problem",
    [
        problems.stack(20, push=3.0),
        problems.wall(4, columns=4, push=2.0),
        problems.table(12, push=3.0),
        problems.arch(15),
        problems.columns(9, height=3),
        problems.columns(4, height=3, normal_restitution=0.5),
        problems.pile(3),
        problems.sliders(50, coupled=True),
    ],
    ids=["stack", "wall", "table", "arch", "columns", "restitution", "pile", "sliders"],
)
def test_small_problems_are_solved_and_keep_the_momentum(problem):
    solution = problem.solve(tolerance=1e-8, measure="global", time_limit=30.0)
    assert solution.converged
    change = np.linalg.solve(problem.mass.toarray(), problem.directions @ solution.percussion)
    velocity = problem.free_velocity + problem.directions.T @ change
    np.testing.assert_allclose(velocity, solution.velocity, atol=1e-9)
