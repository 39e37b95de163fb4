"""Eigenvalues of a pencil near a shift by SLEPc: a script for another Python, run as FILE FOLDER.

It needs NumPy, and petsc4py and slepc4py built for complex numbers, and nothing of asperity.
"""

from __future__ import annotations

import sys
from pathlib import Path

# Without scaling, TOAR says of half of its values that they have converged, and they are wrong.
OPTIONS = "-pep_scale scalar -pep_tol 1e-14 -st_type sinvert -st_pc_factor_mat_solver_type mumps"


def solve(folder: Path) -> None:
    """Read ``pencil.npz`` of a folder and write ``found.npz``: values, and modes as rows."""
    import numpy as np
    import slepc4py

    slepc4py.init(["slepc", *OPTIONS.split()])
    from petsc4py import PETSc
    from slepc4py import SLEPc

    if not np.issubdtype(PETSc.ScalarType, np.complexfloating):
        sys.exit("slepc4py is built for real numbers: PETSC_DIR and SLEPC_DIR choose another one")
    given = np.load(folder / "pencil.npz")

    def matrix(name: str) -> PETSc.Mat:
        indptr, indices, data = (given[f"{name}_{part}"] for part in ("indptr", "indices", "data"))
        n = len(indptr) - 1
        made = PETSc.Mat().create()
        made.setSizes(((PETSc.DECIDE, n), (PETSc.DECIDE, n)))
        made.setUp()
        first, last = made.getOwnershipRange()
        own = slice(indptr[first], indptr[last])
        rows = (indptr[first : last + 1] - indptr[first]).astype(PETSc.IntType)
        parts = rows, indices[own].astype(PETSc.IntType), data[own].astype(PETSc.ScalarType)
        size = (last - first, n)
        return PETSc.Mat().createAIJ(size=(size, size), csr=parts)

    K, C, M = (matrix(name) for name in ("stiffness", "damping", "mass"))
    problem = SLEPc.PEP().create()
    problem.setOperators([K, C, M])
    problem.setDimensions(int(given["count"]))
    problem.setWhichEigenpairs(SLEPc.PEP.Which.TARGET_MAGNITUDE)
    problem.setTarget(complex(given["shift"]))
    problem.setFromOptions()
    problem.solve()
    found = [K.createVecRight() for _ in range(problem.getConverged())]
    values = [complex(problem.getEigenpair(i, x)) for i, x in enumerate(found)]
    problem.destroy()
    # As `nearest` does, take away what the factors at the shift see of the residuals.
    shift = complex(given["shift"])
    P = K.copy()
    for factor, part in ((shift, C), (shift**2, M)):
        P.axpy(factor, part)
    solver = PETSc.KSP().create()
    solver.setOperators(P)
    solver.setType("preonly")
    solver.getPC().setType("lu")
    solver.getPC().setFactorSolverType("mumps")
    modes = []
    residual, y = P.createVecs()
    onto, whole = PETSc.Scatter.toZero(y)
    for s, x in zip(values, found, strict=True):
        K.mult(x, residual)
        for factor, part in ((s, C), (s**2, M)):
            part.mult(x, y)
            residual.axpy(factor, y)
        solver.solve(residual, y)
        x.axpy(-1.0, y)
        onto.scatter(x, whole)
        modes.append(whole.getArray().copy())
    if PETSc.COMM_WORLD.rank == 0:
        np.savez(folder / "found.npz", values=np.array(values), modes=np.array(modes))


if __name__ == "__main__":
    solve(Path(sys.argv[1]))
