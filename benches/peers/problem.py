"""Problem files of isotropic contacts and the one measure that grades every engine; numpy, scipy.

A file is an npz archive without pickle: `W_data, W_indices, W_indptr, W_shape` (CSR), `q`, `mu`;
u = W r + q with rows (normal, t₁, t₂) contact by contact. Where bodies are known, also M and H
(sparse, as W), f and b: M v = f + H r, u = Hᵀ v + b.
"""

import os
from pathlib import Path
from typing import NamedTuple

import numpy as np
from scipy.sparse import csr_matrix


class Problem(NamedTuple):
    """u = W r + q with ‖r_T‖ ≤ μ r_N; `bodies` are M and H where they are known."""

    matrix: csr_matrix
    q: np.ndarray
    mu: np.ndarray
    bodies: tuple[csr_matrix, csr_matrix] | None = None


def load(path: str | os.PathLike) -> Problem:
    """Read a problem file."""
    with np.load(path, allow_pickle=False) as data:
        bodies = (sparse(data, "M"), sparse(data, "H")) if "H_data" in data else None
        return Problem(sparse(data, "W"), data["q"], data["mu"], bodies)


def sparse(data: np.lib.npyio.NpzFile, name: str) -> csr_matrix:
    """Return one of the matrices of a file."""
    parts = tuple(data[f"{name}_{part}"] for part in ("data", "indices", "indptr"))
    return csr_matrix(parts, shape=tuple(data[f"{name}_shape"]))


def save(path: Path, problem: Problem) -> None:
    """Write a problem file."""
    arrays = {"q": problem.q, "mu": problem.mu}
    matrices = {"W": problem.matrix}
    if problem.bodies is not None:
        matrices |= dict(zip("MH", problem.bodies, strict=True))
        arrays |= {"f": np.zeros(problem.bodies[0].shape[0]), "b": problem.q}
    for name, matrix in matrices.items():
        for part in ("data", "indices", "indptr", "shape"):
            arrays[f"{name}_{part}"] = np.asarray(getattr(matrix, part))
    np.savez(path, **arrays)


def rho(problem: Problem) -> float:
    """Return 3n/tr W, the scale of r over u, in kg."""
    return len(problem.q) / problem.matrix.diagonal().sum()


def grade(problem: Problem, percussion: np.ndarray) -> float:
    """Return ‖r − P_K(r − ρũ)‖ / max(‖r‖, ρ‖q‖), ũ_N = u_N + μ‖u_T‖: independent of units."""
    if percussion.shape != problem.q.shape or not np.isfinite(percussion).all():
        return np.inf
    with np.errstate(all="ignore"):  # a solver may have diverged
        defect = natural_map(problem, percussion)
    return defect if np.isfinite(defect) else np.inf


def natural_map(problem: Problem, percussion: np.ndarray) -> float:
    """Return the relative natural map of finite percussions."""
    scale, mu = rho(problem), problem.mu
    r = percussion.reshape(-1, 3)
    u = (problem.matrix @ percussion + problem.q).reshape(-1, 3)
    z = r - scale * u
    z[:, 0] -= scale * mu * np.linalg.norm(u[:, 1:], axis=1)
    defect = np.linalg.norm(r - projected(z, mu))
    return defect / max(np.linalg.norm(r), scale * np.linalg.norm(problem.q))


def projected(z: np.ndarray, mu: np.ndarray) -> np.ndarray:
    """Return the projections of rows (N, T₁, T₂) onto the cones ‖T‖ ≤ μ N."""
    tangent = np.linalg.norm(z[:, 1:], axis=1)
    inside, polar = tangent <= mu * z[:, 0], mu * tangent <= -z[:, 0]
    normal = (z[:, 0] + mu * tangent) / (1.0 + mu**2)
    shrink = mu * normal / np.where(tangent > 0.0, tangent, 1.0)
    onto = np.column_stack([normal, shrink[:, None] * z[:, 1:]])
    onto[polar] = 0.0
    onto[inside] = z[inside]
    return onto
