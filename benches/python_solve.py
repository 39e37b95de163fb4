"""Time of a solve of many contacts beside one factorisation of its operator by SciPy.

The floor is `scipy.sparse.linalg.splu` of the Delassus operator with a thousandth of its diagonal
added, which one step of Newton's method or of an interior point method cannot do without. Times are
those of the processor, in one thread; the shortest of a few.

Run: python benches/python_solve.py
"""

import os
import time
from collections.abc import Callable
from typing import Any

# Before NumPy: its threads would count as well.
os.environ.setdefault("OMP_NUM_THREADS", "1")

import asperity as asp
import scipy.sparse as sp
from asperity import problems
from report import ratio
from scipy.sparse.linalg import splu

GROOVED = asp.FrictionLaw.associated(asp.Ellipse(0.6, 0.3))
WALLS = {"small": (3, 2), "medium": (6, 5), "large": (12, 10)}


def timed(work: Callable[[], Any], repeats: int = 3) -> float:
    """Return the shortest processor time in s."""
    times = []
    for _ in range(repeats):
        start = time.process_time()
        work()
        times.append(time.process_time() - start)
    return min(times)


def main() -> None:
    """Print the table."""
    print("wall      contacts   solve [ms]   LU [ms]   ratio")
    for name, (rows, columns) in WALLS.items():
        wall = problems.wall(rows, columns=columns, push=20.0, law=GROOVED)
        directions = sp.csr_array(wall.directions)
        inverse = splu(sp.csc_array(wall.mass)).solve(directions.toarray())
        operator = sp.csc_array(directions.T @ inverse)
        operator += sp.diags_array(1e-3 * operator.diagonal(), format="csc")
        solve = timed(lambda w=wall: w.solve(tolerance=1e-8))
        floor = timed(lambda o=operator: splu(o))
        contacts = len(wall.laws)
        print(f"{name:8} {contacts:9} {1e3 * solve:12.2f} {1e3 * floor:9.2f} {solve / floor:7.2f}")
        ratio(
            f"a wall of {contacts} contacts with elliptic laws, solved to 1e-8",
            solve / floor,
            "one sparse LU factorisation of its Delassus operator by SciPy",
            "how many factorisations a solution is worth",
        )
    box = problems.stack(1)
    building = timed(
        lambda: [
            asp.ContactProblem.from_bodies(
                box.mass,
                directions=box.directions,
                free_velocity=box.free_velocity,
                laws=box.laws[0],
            )
            for _ in range(500)
        ]
    )
    floor = timed(lambda: [sp.csr_array(box.directions.T) for _ in range(500)])
    ratio(
        "a problem of the four contacts of a box, made of its bodies",
        building / floor,
        "one transposition of W by SciPy",
        "what it costs to check and keep a small problem",
    )


if __name__ == "__main__":
    main()
