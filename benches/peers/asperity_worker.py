"""Solve a problem with asperity as a user would: load the file, solve it, no parameter set.

A problem keeps what it knows of its pattern and its buffers from one solve
to the next, and laws keep their tables; percussions start from zero. The
solver's name is a class of `asperity`, its default parameters; without a name the default solver.
"""

from argparse import Namespace
from functools import partial

import asperity as asp
import numpy as np
from problem import Problem
from worker import Attempts, Prepared, serve


def attempts(problem: Problem, options: Namespace) -> Attempts:
    """Yield the one attempt."""
    yield options.solver, partial(call, options)


def call(options: Namespace) -> Prepared:
    """Return the call of `ContactProblem.solve`."""
    problem = asp.ContactProblem.load(options.problem)
    solver = None if options.solver == "default" else getattr(asp, options.solver)()
    solutions = []

    def run() -> None:
        solutions.append(
            problem.solve(
                solver,
                tolerance=options.tolerance,
                time_limit=options.time_limit,
                on_failure="record",
                measure="global",
            )
        )

    return run, lambda: np.asarray(solutions[-1].percussion), solutions.clear


if __name__ == "__main__":
    serve(attempts)
