"""Contact problems of other engines, graded by their own measure.

The data are not part of the project: `ASPERITY_CONTACT_PROBLEMS` names their folder.
"""

import os
from pathlib import Path

import asperity as asp
import numpy as np
import pytest
from asperity.contact.files import percussions
from asperity.contact.grading import natural_map
from scipy.sparse import csr_array

VARIABLE = "ASPERITY_CONTACT_PROBLEMS"
# Walls of thousands of blocks on which no engine reaches the tolerance.
OPEN = {"gen_RockWall-nc01786-step000051", "gen_BigWall-nc03373-step000001"}
COUNT, TOLERANCE, TIME_LIMIT = 35, 1e-8, 30.0


def files():
    folder = os.environ.get(VARIABLE)
    return [] if folder is None else sorted((Path(folder) / "open").glob("*.npz"))


def case(path):
    return pytest.param(path, id=path.stem, marks=pytest.mark.long if path.stem in OPEN else ())


CASES = [case(path) for path in files()] or [
    pytest.param(None, marks=pytest.mark.skip(f"set {VARIABLE} to the folder of the problems"))
]
every_problem = pytest.mark.parametrize("path", CASES)


def nat_scaled(matrix, q, mu, r):
    """‖r − P_K(r − ρũ)‖ / max(‖r‖, ρ‖q‖), ρ = 3n/tr W, ũ_N = u_N + μ‖u_T‖ (De Saxcé)."""
    rho = len(q) / matrix.diagonal().sum()
    u = (matrix @ r + q).reshape(-1, 3)
    r = r.reshape(-1, 3)
    shifted = u.copy()
    shifted[:, 0] += mu * np.linalg.norm(u[:, 1:], axis=1)
    z = r - rho * shifted
    tangent = np.linalg.norm(z[:, 1:], axis=1)
    inside = tangent <= mu * z[:, 0]
    polar = mu * tangent <= -z[:, 0]
    normal = np.maximum((z[:, 0] + mu * tangent) / (1 + mu**2), 0.0)
    direction = z[:, 1:] / np.maximum(tangent, np.finfo(float).tiny)[:, None]
    projected = np.column_stack([normal, (mu * normal)[:, None] * direction])
    projected[inside], projected[polar] = z[inside], 0.0
    scale = max(np.linalg.norm(r), rho * np.linalg.norm(q))
    return np.linalg.norm(r - projected) / scale


@every_problem
def test_solution_satisfies_the_measure_of_the_collection(path):
    problem = asp.ContactProblem.load(path)
    solution = problem.solve(
        tolerance=TOLERANCE, time_limit=TIME_LIMIT, measure="global", on_failure="record"
    )
    data = np.load(path)
    parts = (data["W_data"], data["W_indices"], data["W_indptr"])
    matrix = csr_array(parts, shape=tuple(data["W_shape"]))
    graded = nat_scaled(matrix, data["q"], data["mu"], solution.percussion)
    assert graded == pytest.approx(natural_map(problem, solution.percussion), rel=1e-3, abs=1e-15)
    if path.stem in OPEN:
        assert graded < 1e-4
    else:
        assert solution.converged
        assert graded <= 1.01 * TOLERANCE


@pytest.mark.skipif(not files(), reason=f"set {VARIABLE} to the folder of the problems")
def test_all_problems_are_there():
    assert len(files()) == COUNT
    assert {path.stem for path in files()} > OPEN


# What other engines write: triplets, bodies alone, mass matrices of which one triangle is stored.
LIBRARY = [
    "Box_Stacks-i0035-31-0",
    "Box_Stacks-i0122-82-5",
    "CubeH8",
    "LMGC_100_PR_PerioBox-i00361-60-03000",
    "LMGC_GlobalFrictionContactProblem00046",
]


def library(name):
    folder = os.environ.get(VARIABLE)
    if folder is None:
        pytest.skip(f"set {VARIABLE} to the folder of the problems")
    return Path(folder) / "fclib" / f"{name}.hdf5"


def read_matrix(group):
    """Return a matrix in the layout of CSparse as a dense array."""
    rows, columns = int(group["m"][0]), int(group["n"][0])
    form, p, i, x = int(group["nz"][0]), group["p"][:], group["i"][:], group["x"][:]
    if form == -2:
        p, i = i, np.repeat(np.arange(rows), np.diff(p))
    matrix = np.zeros((rows, columns))
    for row, column, value in zip(i, p, x, strict=True):
        matrix[row, column] += value
    return matrix


def read_library(path):
    """Return W, q and μ of the local form."""
    import h5py

    with h5py.File(path) as file:
        if "fclib_local" in file:
            vectors = file["fclib_local/vectors"]
            return read_matrix(file["fclib_local/W"]), vectors["q"][:], vectors["mu"][:]
        mass, directions = (read_matrix(file[f"fclib_global/{name}"]) for name in "MH")
        vectors = file["fclib_global/vectors"]
        if not np.tril(mass, -1).any():
            mass = np.triu(mass) + np.triu(mass, 1).T
        moved = np.linalg.solve(mass, np.column_stack([directions, vectors["f"][:]]))
        projected = directions.T @ moved
        return projected[:, :-1], projected[:, -1] + vectors["w"][:], vectors["mu"][:]


@pytest.mark.parametrize("name", LIBRARY)
def test_files_of_the_library_are_solved(name):
    path = library(name)
    problem = asp.ContactProblem.load(path)
    solution = problem.solve(tolerance=TOLERANCE, time_limit=TIME_LIMIT, measure="global")
    matrix, q, mu = read_library(path)
    assert nat_scaled(matrix, q, mu, solution.percussion) <= 1.01 * TOLERANCE


@pytest.mark.parametrize("name", LIBRARY)
@pytest.mark.parametrize("suffix", [".npz", ".hdf5"])
def test_files_of_the_library_are_equal_once_written(tmp_path, name, suffix):
    problem = asp.ContactProblem.load(library(name))
    copy = tmp_path / f"copy{suffix}"
    problem.save(copy)
    assert asp.ContactProblem.load(copy) == problem


def test_rolling_friction_in_the_library_is_refused():
    with pytest.raises(asp.ParameterError, match="rolling friction"):
        asp.ContactProblem.load(library("Chute-ndof-768-nc-4-3"))


@pytest.mark.parametrize("name", LIBRARY[:2])
def test_what_a_file_calls_a_solution_is_graded(name):
    problem = asp.ContactProblem.load(library(name))
    found = percussions(library(name))
    # These files hold zeros, not a solution.
    assert problem.natural_map(found.solution) > 0.9
    assert problem.solve(start=found.guesses[0], tolerance=TOLERANCE, measure="global").converged
