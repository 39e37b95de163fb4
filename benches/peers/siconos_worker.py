"""Solve a problem with one fc3d solver of Siconos, from r = 0 with its default parameters.

Only the limit of iterations is lifted: the time limit decides. The problem is handed over as
(ρW, q), whose unit mean diagonal makes Siconos' own stopping measure nearly the measure of the
comparison (`raw:` before the solver's name: as it is). Storages are tried in turn; where Siconos
stops short of the tolerance of the comparison, its own is made ten and a hundred times smaller.
"""

import warnings
from argparse import Namespace
from functools import partial

import numpy as np
from problem import Problem, rho
from scipy.sparse import csc_matrix
from siconos import numerics
from worker import Attempts, Prepared, serve

DENSE_ROWS = 600
UNLIMITED = 10**8


def attempts(problem: Problem, options: Namespace) -> Attempts:
    """Yield one attempt per storage and tolerance."""
    raw, name = options.solver.startswith("raw:"), options.solver.removeprefix("raw:")
    scale = 1.0 if raw else rho(problem)
    storages = ["dense"] * (len(problem.q) <= DENSE_ROWS) + ["blocks"]
    for storage in storages:
        for tighter in (1.0, 0.1, 0.01):
            limit = options.tolerance * tighter
            yield f"{options.solver} {storage}", partial(call, problem, scale, name, storage, limit)


def call(problem: Problem, scale: float, solver: str, storage: str, tolerance: float) -> Prepared:
    """Return the call of Siconos' driver on (scale·W, q) for r/scale."""
    matrix = csc_matrix(scale * problem.matrix)
    if storage == "dense":
        held = matrix.toarray(order="F")
    else:
        matrix.indices, matrix.indptr = (
            a.astype(np.int64) for a in (matrix.indices, matrix.indptr)
        )
        _, held = numerics.SBM_from_csparse(3, matrix)
    contacts = len(problem.mu)
    data = numerics.FrictionContactProblem(3, contacts, held, problem.q.copy(), problem.mu.copy())
    options = numerics.SolverOptions(getattr(numerics, f"SICONOS_FRICTION_3D_{solver}"))
    options.dparam[numerics.SICONOS_DPARAM_TOL] = tolerance
    options.iparam[numerics.SICONOS_IPARAM_MAX_ITER] = UNLIMITED
    percussion, velocity = np.zeros(3 * contacts), np.zeros(3 * contacts)

    # The storage must live as long as the problem that points to it: `data` does not own it.
    def run(owned: object = (held, matrix)) -> None:
        numerics.fc3d_driver(data, percussion, velocity, options)

    def reset() -> None:
        percussion.fill(0.0)
        velocity.fill(0.0)

    return run, lambda: scale * percussion, reset


if __name__ == "__main__":
    warnings.simplefilter("ignore")
    serve(attempts)
