"""Contact problems whose bodies bilateral rows hold: against the whole system, and the stepper."""

import pickle

import numpy as np
import pytest
from asperity import (
    ADMM,
    ContactProblem,
    ContactStepper,
    DimensionError,
    Ellipse,
    Exact,
    FrictionLaw,
    InteriorPoint,
    Interval,
    NoSolutionError,
    ParameterError,
    Phase,
    ProximalPoint,
)
from asperity.contact.grading import natural_map, proves_no_solution
from profiles import counts
from scipy.sparse import csr_array

LAWS = (
    FrictionLaw.isotropic(0.5),
    FrictionLaw(Ellipse(0.6, 0.4), Ellipse(0.3, 0.5)),
    FrictionLaw.isotropic(0.4, dimension=1),
)
DRY = FrictionLaw.associated(Interval(-1.0, 1.0))
SOLVERS = (None, InteriorPoint(), ADMM(), ProximalPoint(), Exact(max_sweeps=100_000))


def held(rng, *, bodies=4, joints=3, repeated=0):
    """Random contacts and a dry joint of bodies with three velocities, and what holds these."""
    laws = [LAWS[k] for k in rng.integers(0, 3, rng.integers(1, 4))] + [DRY]
    force = [None] * (len(laws) - 1) + [0.3]
    rows = sum(law.dimension + 1 for law in laws) - 1
    blocks = rng.normal(size=(bodies, 3, 3))
    mass = np.zeros((3 * bodies, 3 * bodies))
    for k, block in enumerate(blocks):
        mass[3 * k : 3 * k + 3, 3 * k : 3 * k + 3] = block @ block.T + np.eye(3)
    directions, bilateral = rng.normal(size=(3 * bodies, rows)), rng.normal(size=(12, joints))
    bilateral = np.hstack([bilateral, bilateral @ rng.normal(size=(joints, repeated))])
    speed = rng.normal(size=3 * bodies)
    return ContactProblem.from_bodies(
        mass,
        directions=directions,
        free_velocity=directions.T @ speed,
        laws=laws,
        normal_force=force,
        bilateral=bilateral,
        bilateral_velocity=bilateral.T @ speed,
    ), (mass, directions, bilateral, speed)


def whole(problem, mass, directions, bilateral, percussion):
    """Return changes of velocities, and percussions of the bilateral rows, of least norm."""
    n, m = bilateral.shape
    matrix = np.block([[mass, -bilateral], [bilateral.T, np.zeros((m, m))]])
    right = np.append(directions @ percussion, -problem.bilateral_velocity)
    found = np.linalg.lstsq(matrix, right, rcond=1e-12)[0]
    return found[:n], found[n:]


@counts(30, 2000)
def test_velocities_are_those_of_the_whole_system(count):
    rng = np.random.default_rng(0)
    for _ in range(count):
        problem, (mass, directions, bilateral, speed) = held(rng, repeated=rng.integers(0, 3))
        percussion = rng.normal(size=problem.free_velocity.size)
        change, _ = whole(problem, mass, directions, bilateral, percussion)
        velocity = problem.delassus @ percussion + problem.free_velocity
        np.testing.assert_allclose(velocity, directions.T @ (speed + change), atol=1e-9)
        reaction = problem.bilateral_percussion(percussion)
        moved = np.linalg.solve(mass, directions @ percussion + bilateral @ reaction)
        np.testing.assert_allclose(moved, change, atol=1e-9)
        np.testing.assert_allclose(bilateral.T @ (speed + moved), 0.0, atol=1e-9)


@counts(20, 1000)
def test_every_solver_finds_what_the_stepper_finds(count):
    rng = np.random.default_rng(1)
    for _ in range(count):
        problem, (mass, directions, bilateral, speed) = held(rng, repeated=rng.integers(0, 2))
        rows = np.hstack([directions, bilateral])
        items = [LAWS.index(law) for law in problem.laws[:-1]]
        items += [ContactStepper.DRY_FRICTION] + [ContactStepper.BILATERAL] * len(bilateral.T)
        step = ContactStepper(LAWS).solve(
            rows.T @ np.linalg.solve(mass, rows),
            free_velocity=rows.T @ speed,
            items=items,
            bounds=[0.3] * len(items),
        )
        for solver in SOLVERS:
            found = problem.solve(solver, tolerance=1e-9)
            own = np.append(found.percussion, problem.bilateral_percussion(found.percussion))
            if not step.ambiguous_items.any():
                np.testing.assert_allclose(own, step.percussion, atol=1e-6)
            assert problem.certificate(found.percussion).natural_map < 1e-8
            assert problem.natural_map(found.percussion) < 1e-8
            assert problem.residual(found.percussion) < 1e-9
            assert natural_map(problem, found.percussion) < 1e-8


@pytest.mark.parametrize("suffix", [".npz", ".hdf5"])
def test_files_hold_the_rows(tmp_path, suffix):
    pytest.importorskip("h5py")
    problem, _ = held(np.random.default_rng(2))
    problem.save(tmp_path / f"held{suffix}")
    again = ContactProblem.load(tmp_path / f"held{suffix}")
    assert again == problem == pickle.loads(pickle.dumps(problem))
    percussion = problem.solve().percussion
    reaction = problem.bilateral_percussion(percussion)
    assert np.array_equal(again.bilateral_percussion(percussion), reaction)
    assert again.bilateral.shape == (12, 3)


def test_a_file_whose_operator_is_another_one_is_refused(tmp_path):
    problem, _ = held(np.random.default_rng(2))
    problem.save(tmp_path / "held.npz")
    with np.load(tmp_path / "held.npz") as source:
        parts = dict(source)
    for name in ("W_data", "q", "s"):
        np.savez(tmp_path / "wrong.npz", **{**parts, name: 1.01 * parts[name]})
        with pytest.raises(ParameterError, match="must be what bilateral rows leave"):
            ContactProblem.load(tmp_path / "wrong.npz")
    np.savez(tmp_path / "wrong.npz", **{k: v for k, v in parts.items() if not k.startswith("M_")})
    with pytest.raises(ParameterError, match="must come with the bodies"):
        ContactProblem.load(tmp_path / "wrong.npz")


def test_joints_of_other_engines_are_read(tmp_path):
    """FCLIB: M v = H r + G λ + f, u = Hᵀ v + w, 0 = Gᵀ v + b, without the group of G and b."""
    h5py = pytest.importorskip("h5py")
    mass, w = 2.0 * np.eye(3), np.array([0.1, 0.2, 0.3])
    problem = ContactProblem.from_bodies(
        mass,
        directions=[[0.0, 1.0, 0.0], [0.5, 0.0, 1.0], [1.0, 0.0, 0.0]],
        free_velocity=w,
        laws=LAWS[0],
        bilateral=[[0.1], [0.2], [1.0]],
        bilateral_velocity=[0.7],
    )
    problem.save(tmp_path / "held.hdf5")
    force = np.array([1.0, -2.0, 0.5])
    with h5py.File(tmp_path / "held.hdf5", "a") as file:
        del file["fclib_local"]
        file["fclib_global/vectors/f"][:] = force
    found = ContactProblem.load(tmp_path / "held.hdf5")
    expected = problem.replace(
        free_velocity=w + problem.directions.T @ force / 2.0,
        bilateral_velocity=0.7 + problem.bilateral.T @ force / 2.0,
    )
    np.testing.assert_allclose(found.free_velocity, expected.free_velocity, rtol=1e-14)
    np.testing.assert_allclose(found.bilateral_velocity, expected.bilateral_velocity)


def test_bodies_that_bilateral_rows_squeeze_have_a_proof():
    """A rod on a slider between two walls that approach: no percussion moves it along."""
    line = FrictionLaw.isotropic(0.3, dimension=1)
    problem = ContactProblem.from_bodies(
        np.diag([1.0, 1.0, 0.1]),
        directions=[[1.0, 0.0, -1.0, 0.0], [0.0, 1.0, 0.0, 1.0], [0.3, 0.2, -0.3, 0.1]],
        free_velocity=[-1.0, 0.2, -1.0, 0.1],
        laws=[line, line],
        bilateral=[[0.0], [0.0], [1.0]],
    )
    with pytest.raises(NoSolutionError) as caught:
        problem.solve()
    assert proves_no_solution(problem, caught.value.infeasibility)


@pytest.mark.parametrize("ratio", [1e-6, 1e-10, 1e-14])
def test_light_links_hold(ratio):
    """A link of any mass ties two bodies, of which a dry joint stops one."""
    problem = ContactProblem.from_bodies(
        np.diag([1.0, 1.0, ratio]),
        directions=[[1.0], [0.0], [0.0]],
        free_velocity=[1.0],
        laws=FrictionLaw.isotropic(1.0, dimension=1),
        normal_force=100.0,
        bilateral=[[1.0, 0.0], [0.0, 1.0], [-1.0, -1.0]],
        bilateral_velocity=[0.0, 0.0],
    )
    assert problem.solve().percussion == pytest.approx(-2.0 - ratio, rel=1e-7)


def test_nearly_dependent_rows_hold():
    rng = np.random.default_rng(5)
    for angle in (1e-4, 1e-6):
        directions, rows, beside = (
            rng.normal(size=(6, 3)),
            rng.normal(size=(6, 2)),
            rng.normal(size=6),
        )
        free = np.eye(6) - (q := np.linalg.qr(np.column_stack([rows, beside]))[0]) @ q.T
        problem = ContactProblem.from_bodies(
            np.eye(6),
            directions=directions,
            free_velocity=np.zeros(3),
            laws=LAWS[0],
            bilateral=np.column_stack([rows, rows[:, 0] + angle * beside]),
        )
        expected = directions.T @ free @ directions
        found = problem.delassus.toarray()
        assert np.abs(found - expected).max() < 1e-8 * np.abs(expected).max()


def test_copies_keep_what_fits():
    problem, (mass, directions, *_) = held(np.random.default_rng(3))
    one = problem.replace(bilateral=np.eye(12)[:, :1])
    assert one.bilateral_velocity.tolist() == [0.0]
    free = problem.replace(bilateral=None)
    assert free.bilateral is None
    assert free == ContactProblem.from_bodies(
        mass,
        directions=directions,
        free_velocity=free.free_velocity,
        laws=problem.laws,
        normal_force=problem.normal_force,
    )
    plain = problem.replace(delassus=problem.delassus)
    assert plain.bilateral is None
    assert plain.bilateral_percussion(np.zeros(plain.free_velocity.size)).size == 0
    assert np.array_equal(plain.free_velocity, problem.free_velocity)
    assert np.array_equal(plain.solve().percussion, problem.solve().percussion)


def test_islands_remain_islands():
    rng = np.random.default_rng(4)
    rows = np.kron(np.eye(5), rng.normal(size=(3, 1)))
    problem = ContactProblem.from_bodies(
        csr_array(np.eye(15)),
        directions=csr_array(np.kron(np.eye(5), rng.normal(size=(3, 3)))),
        free_velocity=rng.normal(size=15),
        laws=LAWS[0],
        bilateral=csr_array(rows),
    )
    assert problem.delassus.nnz == 45
    assert len(problem.solve().islands) == 5


@pytest.mark.parametrize("angle", [0.0, 0.7])
@pytest.mark.parametrize("column", [1.0, 0.0])
def test_held_tangential_rows_are_let_be(angle, column):
    """A block slides along rails: with γ along e, friction is λ(e), across them too, by hand.

    The row across is either held by the rails or moves nothing at all.
    """
    law = FrictionLaw(Ellipse(0.6, 0.2), Ellipse(0.3, 0.5))
    law = law.rotated(angle)
    slide, push = 4.0, 10.0
    options = {
        "directions": np.diag([1.0, 1.0, column]),
        "laws": law,
        "bilateral": [[0.0], [0.0], [1.0]],
        "bilateral_velocity": [0.0],
    }
    block = ContactProblem.from_bodies(
        2.0 * np.eye(3), free_velocity=[-push / 2.0, slide, 0.0], **options
    )
    normal, along = push, law.force([1.0, 0.0], normal_force=push)
    for solver in SOLVERS:
        found = block.solve(solver)
        assert found.percussion == pytest.approx([normal, *along], rel=1e-7), solver
        assert found.velocity == pytest.approx([0.0, slide + along[0] / 2.0, 0.0], abs=1e-8)
        reaction = block.bilateral_percussion(found.percussion)
        assert reaction == pytest.approx([-column * along[1]], rel=1e-7)
    rest = block.replace(free_velocity=[-push / 2.0, 0.1, 0.0]).solve()
    assert rest.percussion == pytest.approx([push, -0.2, 0.0], abs=1e-12)
    assert rest.phase.tolist() == [Phase.STICK]


@pytest.mark.parametrize("rail", [1e6 / 3.0, 1e6 / 7.0])
def test_held_rows_do_not_rub_by_rounding(rail):
    """A foot rests on a rail that takes away a velocity across it, far larger than its own."""
    foot = ContactProblem.from_bodies(
        np.diag([1.0, 2.0, 3.0]),
        directions=np.diag([1.0, 1.0, 1.7]),
        free_velocity=[-1.0, 0.2, 1.7 * rail],
        laws=FrictionLaw.isotropic(0.5),
        bilateral=np.array([[0.0], [0.0], [1.0 / 3.0]]),
        bilateral_velocity=[rail / 3.0],
    )
    assert foot.free_velocity.tolist() == [-1.0, 0.2, 0.0]
    found = foot.solve()
    assert found.phase.tolist() == [Phase.STICK]
    np.testing.assert_allclose(found.percussion, [1.0, -0.4, 0.0], atol=1e-12)


@counts(20, 1000)
def test_held_rows_are_those_of_the_stepper(count):
    """Feet of bodies in a plane, with laws across it, against the stepper's own treatment."""
    rng = np.random.default_rng(6)
    for seed in range(count):
        bodies, laws = 3, [LAWS[k] for k in rng.integers(0, 2, 2)]
        across = np.kron(np.eye(bodies), [[0.0], [0.0], [1.0]])
        turned = rng.uniform(0.0, 2.0 * np.pi)
        turn = np.array([[np.cos(turned), -np.sin(turned)], [np.sin(turned), np.cos(turned)]])
        foot = np.zeros((3, 3))
        foot[0, 0], foot[1:, 1:] = 1.0, turn if seed % 2 else np.eye(2)
        directions = np.hstack(
            [
                np.kron(rng.normal(size=(bodies, 1)), foot),
                np.kron(rng.normal(size=(bodies, 1)), foot),
            ]
        )
        speed = rng.normal(size=9) * np.tile([1.0, 1.0, 0.0], 3)
        problem = ContactProblem.from_bodies(
            np.eye(9),
            directions=directions,
            free_velocity=directions.T @ speed,
            laws=laws,
            bilateral=across,
        )
        rows = np.hstack([directions, across])
        items = [*(LAWS.index(law) for law in laws), *[ContactStepper.BILATERAL] * bodies]
        step = ContactStepper(LAWS).solve(rows.T @ rows, free_velocity=rows.T @ speed, items=items)
        # Two contacts may have several solutions, each of which is one of the problem.
        assert problem.natural_map(step.percussion[:6]) < 1e-9, seed
        found = problem.solve().percussion
        moved = speed + rows @ np.append(found, problem.bilateral_percussion(found))
        np.testing.assert_allclose(moved[2::3], 0.0, atol=1e-12)
        assert natural_map(problem, found) < 1e-9, seed


@pytest.mark.parametrize(
    ("changes", "argument", "message"),
    [
        ({"bilateral": None, "bilateral_velocity": [0.0]}, "bilateral_velocity", "with bilateral"),
        ({"bilateral": np.eye(2)}, "bilateral", r"\(3, n\)|shape"),
        ({"bilateral_velocity": [0.0]}, "bilateral_velocity", "shape"),
        ({"delassus": np.eye(3)}, "delassus", "left out with bilateral"),
        (
            {"bilateral_velocity": [1.0, 2.1]},
            "bilateral_velocity",
            r"0\.05 \(m/s or rad/s\) of row 1",
        ),
        ({"bilateral": np.eye(3)[:, :1]}, "directions", "must move contact 0, nothing does"),
        ({"directions": np.diag([0.0, 1.0, 1.0])}, "directions", "must move contact 0"),
        (
            {"directions": np.diag([1.0, 0.0, 1.0]), "bilateral": None},
            "directions",
            "row 1 moves nothing",
        ),
        ({"bilateral": [[np.nan], [0.0], [1.0]]}, "bilateral", "finite"),
    ],
)
def test_what_is_wrong_is_named(changes, argument, message):
    options = {
        "directions": np.eye(3),
        "free_velocity": [-1.0, 0.1, 0.1],
        "laws": LAWS[0],
        "bilateral": [[1.0, 2.0], [1.0, 2.0], [0.0, 0.0]],
        **({} if "bilateral" in changes else {"bilateral_velocity": [1.0, 2.0]}),
        **changes,
    }
    with pytest.raises((ParameterError, DimensionError), match=message) as error:
        ContactProblem.from_bodies(np.eye(3), **options)
    assert error.value.argument == argument
    with pytest.raises(ParameterError, match="bilateral: must be left out unless mass"):
        ContactProblem(np.eye(3), free_velocity=np.zeros(3), laws=LAWS[0], bilateral=np.eye(3))
