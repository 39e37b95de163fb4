"""Files of contact problems: round trips, the layouts other engines read, errors that name keys."""

import asperity as asp
import h5py
import numpy as np
import pytest
from asperity.contact.files import percussions
from samples import LAWS, TILTED_ELLIPSES, random_problem
from scipy.sparse import block_diag, csc_array, csr_array, tril, triu

DISK = asp.FrictionLaw.isotropic(0.5)
SUFFIXES = [".npz", ".h5", ".hdf5"]

every_format = pytest.mark.parametrize("suffix", SUFFIXES)


def scattered(rng, shape, *, density):
    """Return a sparse array with random entries in random places, with every release of SciPy."""
    return csr_array(np.where(rng.random(shape) < density, rng.random(shape), 0.0))


def blocks(rng, bodies):
    """Mass matrix of bodies with six coordinates each."""
    factors = rng.normal(size=(bodies, 6, 6))
    return block_diag([csr_array(a @ a.T + np.eye(6)) for a in factors], format="csr")


def plain(law=DISK, contacts=4):
    rng = np.random.default_rng(7)
    rows = contacts * (law.dimension + 1)
    root = rng.normal(size=(rows, rows))
    return asp.ContactProblem(
        csr_array(root @ root.T), free_velocity=rng.normal(size=rows), laws=law
    )


def of_bodies(law=DISK, **options):
    rng = np.random.default_rng(8)
    directions = scattered(rng, (12, 9), density=0.4) + np.eye(12, 9)
    free = directions.T @ rng.normal(size=12)
    return asp.ContactProblem.from_bodies(
        blocks(rng, 2), directions=directions, free_velocity=free, laws=law, **options
    )


def with_everything():
    """All laws, restitution, prescribed forces."""
    rng = np.random.default_rng(9)
    problem = random_problem(rng, LAWS, 3 * len(LAWS), rng.random(3 * len(LAWS)) < 0.5)
    contacts, rows = len(problem.laws), problem.free_velocity.size
    return problem.replace(
        delassus=csr_array(problem.delassus),
        normal_restitution=rng.random(contacts),
        tangential_restitution=rng.random(contacts),
        initial_velocity=rng.normal(size=rows),
    )


PROBLEMS = {
    "plain": plain(),
    "plane": plain(asp.FrictionLaw.isotropic(0.3, dimension=1)),
    "drilling": plain(asp.FrictionLaw.associated(asp.CoulombContensou(0.3))),
    "mixed": plain().replace(laws=[DISK, asp.FrictionLaw.isotropic(0.1)] * 2),
    "extended": plain(TILTED_ELLIPSES),
    "restitution": plain().replace(normal_restitution=0.5, initial_velocity=np.ones(12)),
    "initial": plain().replace(initial_velocity=np.ones(12)),
    "everything": with_everything(),
}


@every_format
@pytest.mark.parametrize("name", PROBLEMS)
def test_round_trip_keeps_every_bit(tmp_path, name, suffix):
    path = tmp_path / f"problem{suffix}"
    PROBLEMS[name].save(path)
    assert asp.ContactProblem.load(path) == PROBLEMS[name]
    assert [file.name for file in tmp_path.iterdir()] == [path.name]


@every_format
@pytest.mark.parametrize("cases", [20, pytest.param(2000, marks=pytest.mark.long)])
def test_every_problem_comes_back_equal(tmp_path, suffix, cases):
    path = tmp_path / f"problem{suffix}"
    for seed in range(cases):
        rng = np.random.default_rng(seed)
        # Often of one law, and often without prescribed forces: what other engines can hold.
        laws = rng.choice(LAWS, size=rng.integers(1, 4)).tolist()
        unilateral = rng.random(5) >= rng.choice([0.0, 0.5])
        problem = random_problem(rng, laws, 5, unilateral)
        if rng.random() < 0.5:
            problem = problem.replace(tangential_restitution=rng.random(5))
        if rng.random() < 0.5:
            problem = problem.replace(delassus=csr_array(problem.delassus))
        elif rng.random() < 0.5:
            rows = problem.free_velocity.size
            directions = scattered(rng, (24, rows), density=0.4) + np.eye(24, rows)
            problem = problem.replace(mass=blocks(rng, 4), directions=directions)
        problem.save(path)
        read = asp.ContactProblem.load(path)
        assert read == problem
        assert hash(read) == hash(problem)
        percussion = rng.normal(size=problem.free_velocity.size)
        assert read.residual(percussion) == problem.residual(percussion)


@every_format
@pytest.mark.parametrize("law", [DISK, TILTED_ELLIPSES])
@pytest.mark.parametrize("known", [True, False], ids=["known", "assembled"])
def test_bodies_come_back(tmp_path, law, known, suffix):
    problem = of_bodies(law)
    if known:
        problem = of_bodies(law, delassus=problem.delassus)
    path = tmp_path / f"problem{suffix}"
    problem.save(path)
    read = asp.ContactProblem.load(path)
    assert read == problem
    assert (read.delassus != problem.delassus).nnz == 0
    assert read != of_bodies(law).replace(delassus=problem.delassus)
    np.testing.assert_array_equal(
        read.solve(tolerance=1e-9).percussion, problem.solve(tolerance=1e-9).percussion
    )


def test_plain_npz_has_the_keys_of_other_engines(tmp_path):
    path = tmp_path / "plain.npz"
    plain().save(path)
    with np.load(path, allow_pickle=False) as data:
        assert set(data) == {"W_data", "W_indices", "W_indptr", "W_shape", "q", "mu"}
        assert data["mu"].tolist() == [0.5] * 4
        assert data["W_indices"].dtype == np.int32
        assert data["W_shape"].tolist() == [12, 12]
    of_bodies().save(path)
    with np.load(path, allow_pickle=False) as data:
        assert set(data) - {"W_data", "W_indices", "W_indptr", "W_shape", "q", "mu"} == {
            *(f"{name}_{part}" for name in "MH" for part in ("data", "indices", "indptr", "shape")),
            "f",
            "b",
            "W_form",
        }
        names = [[data[f"{n}_{p}"] for p in ("data", "indices", "indptr")] for n in "MHW"]
        mass, directions, delassus = (
            csr_array(tuple(parts), shape=data[f"{n}_shape"])
            for n, parts in zip("MHW", names, strict=True)
        )
        # M v = f + H r, u = Hᵀ v + b is u = W r + q.
        inverse = np.linalg.inv(mass.toarray())
        product = directions.T @ inverse @ directions
        np.testing.assert_allclose(product, delassus.toarray(), atol=1e-12)
        np.testing.assert_allclose(directions.T @ inverse @ data["f"] + data["b"], data["q"])


def test_fclib_layout(tmp_path):

    path = tmp_path / "problem.hdf5"
    of_bodies().save(path)
    with h5py.File(path) as file:
        assert file["fclib_local/spacedim"][:].tolist() == [3]
        for matrix in ("fclib_local/W", "fclib_global/M", "fclib_global/H"):
            group = file[matrix]
            assert set(group) == {"nzmax", "m", "n", "nz", "p", "i", "x"}
            assert group["nz"][:].tolist() == [-2]
            assert group["p"].shape == (group["m"][0] + 1,)
            assert group["i"].shape == group["x"].shape == (group["nzmax"][0],)
            assert group["p"].dtype == group["i"].dtype == np.int32
        assert set(file["fclib_local/vectors"]) == {"q", "mu"}
        assert set(file["fclib_global/vectors"]) == {"f", "w", "mu"}
        assert set(file["data"]) == {"form"}


def parts(matrix, form, spare=0):
    """Return nz, p, i, x of a matrix; `spare` entries are allocated and not used."""
    if form == "rows":
        matrix = csr_array(matrix)
        return -2, matrix.indptr, matrix.indices, matrix.data
    if form == "columns":
        matrix = csc_array(matrix)
        return -1, matrix.indptr, matrix.indices, matrix.data
    # As in CSparse: rows in i, columns in p.
    rows, columns = (np.append(index, np.zeros(spare, np.int32)) for index in matrix.tocoo().coords)
    return matrix.nnz, columns, rows, np.append(matrix.tocoo().data, [9.0] * spare)


def rewrite(path, name, *written):

    with h5py.File(path, "a") as file:
        for key, value in zip(("nz", "p", "i", "x"), written, strict=True):
            del file[f"{name}/{key}"]
            file[f"{name}/{key}"] = np.atleast_1d(value)


@pytest.mark.parametrize("form", ["rows", "columns", "triplets"])
def test_all_storage_forms_of_a_matrix_are_read(tmp_path, form):
    rng = np.random.default_rng(3)
    # Not symmetric: one that is would hide a transposed reading.
    operator = plain().delassus + scattered(rng, (12, 12), density=0.3)
    problem = plain().replace(delassus=operator)
    path = tmp_path / "problem.h5"
    problem.save(path)
    rewrite(path, "fclib_local/W", *parts(operator, form, spare=3 * (form == "triplets")))
    assert asp.ContactProblem.load(path) == problem


@pytest.mark.parametrize("form", ["rows", "columns", "triplets"])
@pytest.mark.parametrize("triangle", [lambda m: m, tril, triu], ids=["both", "lower", "upper"])
def test_all_storage_forms_of_bodies_are_read(tmp_path, form, triangle):

    problem, path = of_bodies(), tmp_path / "global.h5"
    problem.save(path)
    rewrite(path, "fclib_global/M", *parts(triangle(problem.mass), form))
    rewrite(path, "fclib_global/H", *parts(problem.directions, form))
    with h5py.File(path, "a") as file:
        del file["fclib_local"]
    assert asp.ContactProblem.load(path) == problem


def test_a_global_problem_alone_is_assembled(tmp_path):

    problem, path = of_bodies(), tmp_path / "global.h5"
    problem.save(path)
    force, gap = np.arange(12.0), np.arange(9.0)
    with h5py.File(path, "a") as file:
        del file["fclib_local"]
        file["fclib_global/vectors/f"][:] = force
        file["fclib_global/vectors/w"][:] = gap
    read = asp.ContactProblem.load(path)
    expected = problem.directions.T @ np.linalg.solve(problem.mass.toarray(), force) + gap
    np.testing.assert_allclose(read.free_velocity, expected, atol=1e-12)
    np.testing.assert_allclose(read.delassus.toarray(), problem.delassus.toarray(), atol=1e-14)


def test_solution_and_guesses_of_a_file_check_and_start_a_solve(tmp_path):

    problem, path = of_bodies(), tmp_path / "problem.h5"
    problem.save(path)
    assert percussions(path).solution is None
    solution = problem.solve()
    guesses = [k * solution.percussion for k in range(11)]
    with h5py.File(path, "a") as file:
        file["solution/r"] = solution.percussion
        file["guesses/number_of_guesses"] = [len(guesses)]
        for number, guess in enumerate(guesses, 1):
            file[f"guesses/{number}/r"] = guess
    found = percussions(path)
    assert problem.natural_map(found.solution) == solution.natural_map
    np.testing.assert_array_equal(found.guesses, guesses)
    again = problem.solve(asp.ProximalPoint(), start=found.solution)
    assert again.iterations <= problem.solve(asp.ProximalPoint()).iterations
    np.testing.assert_allclose(again.percussion, solution.percussion, atol=1e-9)
    with pytest.raises(asp.DimensionError, match="start"):
        problem.solve(start=found.solution[:-1])
