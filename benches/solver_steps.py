"""What does each step of `Auto` buy? Problems solved, and time, with all steps and without one.

    python benches/solver_steps.py [FOLDER] [--time-limit 5] [--every 4] [--random 20]

Stored problems are those of FOLDER, by default of $ASPERITY_CONTACT_PROBLEMS; piles and columns are
every fourth of those of `hard_problems.py --piles` and `--wide`; random ones are piles of bodies
with 1 to 4 contacts each and all kinds of laws. The global measure is to reach 1e-8. Per set and
step: how many more problems are solved with the step than without it, and the time without it over
the time with it, the geometric mean over problems that both solve. A step that buys neither is not
worth its code.
"""

import argparse
import os
import sys
import time
from pathlib import Path

import asperity as asp
import numpy as np
from asperity import problems
from hard_problems import more_piles_and_columns, piles_and_columns

sys.path.append(str(Path(__file__).resolve().parents[1] / "tests"))
from random_problems import LAWS, pile

TOLERANCE = 1e-8
CONTACTS = 400
"""Of a random problem: Newton's method solves most of those with fewer."""
SHORT, AGAIN = 0.02, 5
"""Seconds below which a solve is repeated, and how often; the shortest time counts."""
PERCEPTIBLE = 1.05
"""Ratio of times from which on a step saves time: repeated runs differ by less."""

Problems = list[tuple[str, asp.ContactProblem]]


def main() -> None:
    """Print a table per set of problems, and what buys nothing in any."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    stored = os.environ.get("ASPERITY_CONTACT_PROBLEMS")
    parser.add_argument("folder", type=Path, nargs="?", default=stored and Path(stored))
    parser.add_argument("--time-limit", type=float, default=5.0, help="s per solve")
    parser.add_argument("--every", type=int, default=4, help="which of the piles and columns")
    parser.add_argument("--random", type=int, default=20, help="number of random problems")
    parser.add_argument("--steps", default=",".join(asp.Auto.STEPS), help="that are left out")
    options = parser.parse_args()
    sets = {
        "stored": [] if options.folder is None else read(options.folder),
        "piles and columns": (piles_and_columns() + more_piles_and_columns())[:: options.every],
        "many spheres": [
            ("pile 8", problems.pile(8)),
            ("100 columns", problems.columns(100, height=10)),
        ],
        "random": [random_pile(seed) for seed in range(options.random)],
    }
    steps = options.steps.split(",")
    useful = set()
    for name, cases in sets.items():
        if cases:
            useful |= table(name, cases, steps, options.time_limit)
    print(f"buys nothing here: {', '.join(s for s in steps if s not in useful) or 'no step'}")


def read(folder: Path) -> Problems:
    """Return the problems of a folder, or of `open` in it."""
    inner = folder / "open"
    paths = sorted((inner if inner.is_dir() else folder).glob("*.npz"))
    return [(path.stem, asp.ContactProblem.load(path)) for path in paths]


def random_pile(seed: int) -> tuple[str, asp.ContactProblem]:
    """Return a random problem of all kinds of laws."""
    random = np.random.default_rng(seed)
    return f"random {seed}", pile(random, LAWS, CONTACTS, per_pair=1 + seed % 4)


def table(name: str, cases: Problems, steps: list[str], limit: float) -> set[str]:
    """Print what each step buys on some problems; return the steps that buy something."""
    solvers = {"": asp.Auto(), **{step: asp.Auto(without=(step,)) for step in steps}}
    # One problem after another, by all solvers, so that what else the machine does slows all alike.
    found = [
        [solved(problem, solver, limit) for solver in solvers.values()] for _, problem in cases
    ]
    times = np.array(found)
    done = np.isfinite(times)
    spent = np.where(done, times, limit).sum(axis=0)
    print(f"{name}: {done[:, 0].sum()} of {len(cases)} solved, {spent[0]:.1f} s by all steps")
    print(f"  {'without':18} solved   time s   buys: solved   time")
    useful = set()
    for k, step in enumerate(steps, start=1):
        both = done[:, 0] & done[:, k]
        ratio = np.exp(np.log(times[both, k] / times[both, 0]).mean()) if both.any() else np.nan
        more = done[:, 0].sum() - done[:, k].sum()
        if more > 0 or ratio > PERCEPTIBLE:
            useful.add(step)
        print(
            f"  {step:18} {done[:, k].sum():6} {spent[k]:8.1f} {more:+14} {ratio:6.2f}", flush=True
        )
    return useful


def solved(problem: asp.ContactProblem, solver: asp.Auto, limit: float) -> float:
    """Return the processor time of a solve of a problem that is not analysed yet; or infinity."""
    times: list[float] = []
    while not times or (len(times) < AGAIN and times[0] < SHORT):
        fresh = problem.replace()
        start = time.process_time()
        solution = fresh.solve(
            solver, tolerance=TOLERANCE, measure="global", time_limit=limit, on_failure="record"
        )
        times.append(time.process_time() - start)
        if problem.natural_map(solution.percussion) > TOLERANCE:
            return np.inf
    return min(times)


if __name__ == "__main__":
    main()
