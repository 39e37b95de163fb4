"""Solving many problem files, graded apart from the solvers."""

from __future__ import annotations

import time
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path

from asperity._base import arrays
from asperity.contact import ContactProblem, ContactSolution, Stage
from asperity.contact.files import SUFFIXES
from asperity.contact.grading import natural_map
from asperity.errors import AsperityError, ParameterError
from asperity.solvers import Solver

# Solves shorter than this are repeated; their best time counts.
_SHORT = 1.0
COLUMNS = (
    "name", "contacts", "status", "iterations", "factorizations", "residual", "time [s]", "stages"
)  # fmt: skip


@dataclass(frozen=True)
class SolvedFile:
    """One solved file.

    Attributes:
        name: of the file, without its ending.
        contacts: number of contacts.
        solution: what the solver returned.
        residual: natural map by `grading`, not by the core.
        seconds: time of the solve, the best one if it was repeated.
        solved: whether `residual` is within the tolerance.
    """

    name: str
    contacts: int
    solution: ContactSolution
    residual: float
    seconds: float
    solved: bool

    def cells(self) -> tuple[str, ...]:
        """Return the row as text."""
        stages = self.solution.stages
        return (
            self.name,
            str(self.contacts),
            # What the solver takes for solved and the grader does not is a contradiction.
            str(self.solution.status) if self.solved or not self.solution.converged else "off",
            str(self.solution.iterations),
            str(sum(stage.factorizations for stage in stages)),
            f"{self.residual:.1e}",
            f"{self.seconds:.3g}",
            " ".join(map(_stage, stages)),
        )


def problem_files(paths: Sequence[Path]) -> list[Path]:
    """Return the problem files among the paths and in the folders among them."""
    found: list[Path] = []
    for path in paths:
        if path.is_dir():
            inside = [one for one in path.iterdir() if one.suffix in SUFFIXES]
            if not inside:
                raise ParameterError(str(path), f"holds no {', '.join(SUFFIXES)} files")
            found += sorted(inside)
        elif path.suffix not in SUFFIXES and not path.exists():
            raise ParameterError(str(path), "is not there")
        elif path.suffix not in SUFFIXES:
            raise ParameterError(str(path), f"must end in {', '.join(SUFFIXES)}")
        else:
            found.append(path)
    return found


def solve_files(
    files: Sequence[Path],
    solver: Solver,
    *,
    tolerance: float,
    time_limit: float,
    repeat: int,
    unreadable: list[tuple[str, str]],
) -> Iterator[SolvedFile]:
    """Solve the problems of the files, those of few contacts first.

    A file that cannot be read ends up among `unreadable` and stops nothing. Short solves are
    repeated, and their best time counts.
    """
    arrays.positive(tolerance, "tolerance")
    arrays.positive(time_limit, "time_limit")
    arrays.count(repeat, "repeat")
    loaded = []
    for path in files:
        try:
            loaded.append((path.stem, ContactProblem.load(path)))
        except AsperityError as error:
            unreadable.append((path.name, str(error)))
    for name, problem in sorted(loaded, key=lambda one: len(one[1].laws)):
        seconds = float("inf")
        for _ in range(repeat):
            start = time.perf_counter()
            solution = problem.solve(
                solver,
                tolerance=tolerance,
                time_limit=time_limit,
                on_failure="record",
                measure="global",
            )
            seconds = min(seconds, time.perf_counter() - start)
            if seconds > _SHORT:
                break
        residual = natural_map(problem, solution.percussion)
        solved = solution.converged and bool(residual <= tolerance)
        yield SolvedFile(name, len(problem.laws), solution, residual, seconds, solved)


def _stage(stage: Stage) -> str:
    factored = f"/{stage.factorizations}" if stage.factorizations else ""
    return f"{stage.method}:{stage.iterations}{factored}"
