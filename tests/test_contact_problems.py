"""Small contact problems of other engines, graded by their own measure.

The data are not part of the project: `ASPERITY_CONTACT_PROBLEMS` names their folder.
"""

import os
from pathlib import Path

import asperity as asp
import numpy as np
import pytest
from scipy.sparse import csr_array

NAMES = [
    "FrictionContact3D_RR_1c",
    "GFC3D_OneContact",
    "Rover11035",
    "GFC3D_TwoRods1",
    "Confeti-ex13-4contact-Fc3D-SBM",
    "Rover4516",
    "Rover1040",
    "LMGC_GlobalFrictionContactProblem00046",
    "FrictionContactProblem00031_2Dto3D",
    "NESpheres_30_1",
]


@pytest.fixture(scope="module")
def folder():
    path = os.environ.get("ASPERITY_CONTACT_PROBLEMS")
    if path is None:
        pytest.skip("set ASPERITY_CONTACT_PROBLEMS to the folder of contact problems")
    return Path(path) / "open"


def nat_scaled(matrix, q, mu, r):
    """‖r − P_K(r − ρũ)‖ / max(‖r‖, ρ‖q‖), ρ = 3n/tr W, ũ_N = u_N + μ‖u_T‖ (De Saxcé)."""
    rho = len(q) / np.trace(matrix)
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


@pytest.mark.parametrize("name", NAMES)
def test_solution_satisfies_the_measure_of_the_collection(folder, name):
    data = np.load(folder / f"{name}.npz")
    parts = (data["W_data"], data["W_indices"], data["W_indptr"])
    matrix = csr_array(parts, shape=tuple(data["W_shape"])).toarray()
    laws = [
        asp.FrictionLaw.isotropic(mu) if mu > 0 else asp.FrictionLaw.isotropic(1e-9)
        for mu in data["mu"]
    ]
    problem = asp.ContactProblem(matrix, data["q"], laws)
    solution = problem.solve(time_limit=20.0)
    assert nat_scaled(matrix, data["q"], data["mu"], solution.percussion) < 1e-8
