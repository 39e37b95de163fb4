"""Solve a problem with one contact solver of pinocchio on its Delassus matrix, from r = 0.

The models are point contacts of free particles: they only carry the friction coefficients, the
matrix is that of the file, scaled by ρ, in pinocchio's order of rows (t₁, t₂, normal). ADMM takes
it for symmetric, which those of some engines are not quite. Tolerances are absolute and tightened
by ten where the measure of the comparison is not reached.
"""

from argparse import Namespace
from functools import partial

import numpy as np
import pinocchio as pin
from problem import Problem, rho
from worker import Attempts, Prepared, serve

DENSE_ROWS = 3000
"""Rows beyond which the dense matrix is not tried."""
UNLIMITED = 10**8
KINDS = {
    "ADMM": (pin.ADMMConstraintSolver, pin.ADMMSolverSettings, pin.ADMMSolverResult),
    "PGS": (pin.PGSConstraintSolver, pin.PGSSolverSettings, pin.PGSSolverResult),
}


def attempts(problem: Problem, options: Namespace) -> Attempts:
    """Yield one attempt per tolerance."""
    if len(problem.q) > DENSE_ROWS:
        return
    for tighter in (1.0, 0.1, 0.01, 0.001):
        limit = options.tolerance * tighter * np.linalg.norm(problem.q)
        yield options.solver, partial(call, problem, options.solver, limit)


def call(problem: Problem, solver: str, tolerance: float) -> Prepared:
    """Return the call of a solver on (ρW, q) for r/ρ."""
    scale, rows = rho(problem), np.arange(len(problem.q)).reshape(-1, 3)
    order = rows[:, [1, 2, 0]].ravel()
    matrix = scale * problem.matrix.toarray()[np.ix_(order, order)]
    delassus, free = pin.DelassusOperatorDense(matrix), problem.q[order]
    models, data = particles(problem.mu)
    make, settings, result = KINDS[solver]
    method, settings, result = make(len(free)), settings(), result()
    settings.absolute_feasibility_tol = settings.absolute_complementarity_tol = tolerance
    settings.relative_feasibility_tol = settings.relative_complementarity_tol = 0.0
    settings.max_iterations, settings.solve_ncp = UNLIMITED, True

    # The operator refers to the matrix without owning it.
    def run(owned: object = matrix) -> None:
        method.solve(delassus, free, models, data, settings, result)

    def read() -> np.ndarray:
        percussion = np.empty(len(free))
        percussion[order] = scale * np.array(result.retrieveConstraintImpulses())
        return percussion

    return run, read


def particles(mu: np.ndarray) -> tuple:
    """Return a point contact per friction coefficient, each of a particle of its own."""
    model, place = pin.Model(), pin.SE3.Identity()
    for k in range(len(mu)):
        joint = model.addJoint(0, pin.JointModelTranslation(), place, f"particle {k}")
        model.appendBodyToJoint(joint, pin.Inertia(1.0, np.zeros(3), np.zeros((3, 3))), place)
    models, data = pin.StdVec_ConstraintModel(), pin.StdVec_ConstraintData()
    for k, coefficient in enumerate(mu):
        contact = pin.PointContactConstraintModel(model, k + 1, place, 0, place)
        contact.setFriction(coefficient)
        models.append(pin.ConstraintModel(contact))
        data.append(models[-1].createData())
    return models, data


if __name__ == "__main__":
    serve(attempts)
