"""The generated problems of the comparison, made by `asperity.problems`."""

from pathlib import Path

import numpy as np
from problem import Problem, save
from scipy.sparse import csr_matrix

STACKS = {"stack-20": 0.0, "stack-20-pushed": 3.0, "stack-20-sliding": 6.0}
DT = 0.01


def write(folder: Path) -> dict[str, tuple[float, ...]]:
    """Write the problem files into a folder; return (boxes, push, dt) of those that are stacks."""
    from asperity import problems

    made = {name: problems.stack(20, push=push, dt=DT) for name, push in STACKS.items()}
    made |= {
        "stack-100": problems.stack(100),
        "wall-5x5": problems.wall(5, columns=5),
        "wall-10x10-pushed": problems.wall(10, columns=10, push=1.0),
        "wall-20x20": problems.wall(20, columns=20),
        "arch-25": problems.arch(25),
        "table-100-pushed": problems.table(100, push=3.0),
        "columns-touching-25x10": problems.columns(25, height=10),
        "pile-8": problems.pile(8),
        "sliders-1000": problems.sliders(1000),
        "sliders-1000-coupled": problems.sliders(1000, coupled=True),
    }
    for name, problem in made.items():
        matrix, *bodies = (
            csr_matrix(part) for part in (problem.delassus, problem.mass, problem.directions)
        )
        mu = np.array([law.reservoir.radius(0.0) for law in problem.laws])
        save(folder / f"{name}.npz", Problem(matrix, problem.free_velocity, mu, tuple(bodies)))
    return {name: (20.0, push, DT) for name, push in STACKS.items()}
