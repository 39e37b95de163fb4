"""Contact problems of other engines, graded by their own measure.

The data are not part of the project: `ASPERITY_CONTACT_PROBLEMS` names their folder.
"""

import os
from pathlib import Path

import asperity as asp
import numpy as np
import pytest
from asperity.grading import natural_map
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
