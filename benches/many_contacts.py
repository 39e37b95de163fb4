"""Time and memory of the default solver per contact, from 10 to 10⁵ contacts.

    python benches/many_contacts.py [--scenes sliders,wall] [--sizes 10,1000] [--time-limit 60]

Every size runs in a process of its own. The solve is done by a fork of it, whose largest resident
memory starts at that of the finished problem: the growth is what the solver needs, and a fork's own
2 MB. Memory of the problem: the growth from the bare interpreter to the finished problem. A scene
ends at the first size that is not solved within the limit.
"""

import argparse
import ctypes
import json
import os
import resource
import subprocess
import sys
import time
from collections.abc import Callable
from functools import partial

import asperity as asp
import asperity._core as _core
import numpy as np
from asperity import problems

SIZES = [10, 100, 1_000, 10_000, 100_000]
UNIT = 1 if sys.platform == "darwin" else 1024
"""Bytes per unit of `ru_maxrss`."""
HEAD = (
    "scene             contacts    make s   solve ms   us/contact  "
    "kB/contact: problem    solve  residual  status"
)
ENOUGH = 1.0
"""Seconds of repetitions after which no further one is begun, but for the second."""


def wall(contacts: int):
    """Return a square wall with about as many contacts."""
    side = max(1, round(np.sqrt(contacts / 8)))
    return problems.wall(side + (side == 1), columns=side, push=1.0)


def columns(contacts: int, friction: float = 0.5, seed: int = 0):
    """Return columns of ten spheres with about as many contacts."""
    law = asp.FrictionLaw.isotropic(friction)
    return problems.columns(max(1, round(contacts / 28)), height=10, law=law, seed=seed)


SCENES = {
    "sliders": problems.sliders,
    "coupled sliders": lambda contacts: problems.sliders(contacts, coupled=True),
    "stack": lambda contacts: problems.stack(max(1, contacts // 4)),
    "wall": wall,
    "columns of 10": columns,
    "slippery columns": partial(columns, friction=0.2),
    "arch": lambda contacts: problems.arch(max(1, contacts // 4 - 1)),
}
RANDOM = ("columns of 10", "slippery columns")
"""Scenes whose bodies move at random before the step."""


def numbers(text: str) -> list[int]:
    """Return the numbers of a list with commas."""
    return [int(number) for number in text.split(",")]


def main() -> None:
    """Print a line per scene and size."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--scenes", default=",".join(SCENES))
    parser.add_argument("--sizes", type=numbers, default=SIZES, help="of contacts, with commas")
    parser.add_argument("--seed", type=int, default=0, help="of the scenes that move at random")
    parser.add_argument("--time-limit", type=float, default=60.0, help="s per solve")
    parser.add_argument("--tolerance", type=float, default=1e-8)
    parser.add_argument("--repeat", type=int, default=5)
    parser.add_argument("--one", nargs=2, help=argparse.SUPPRESS)
    options = parser.parse_args()
    if unknown := set(options.scenes.split(",")) - set(SCENES):
        parser.error(f"--scenes: unknown {', '.join(sorted(unknown))}; known: {', '.join(SCENES)}")
    if options.one:
        measure(options.one[0], int(options.one[1]), options)
        return
    if _core.build_profile != "release":
        sys.exit("the extension module is a debug build: install with `make .venv/.installed`")
    print(HEAD)
    for scene in options.scenes.split(","):
        for size in options.sizes:
            if not line(scene, size):
                break


def line(scene: str, size: int) -> bool:
    """Measure one size in a process of its own and print its line; return whether it is solved."""
    again = [sys.executable, *sys.argv, "--one", scene, str(size)]
    done = subprocess.run(again, capture_output=True, text=True)
    if done.returncode or not done.stdout:
        last = (done.stderr.strip().splitlines() or ["no message"])[-1]
        print(f"{scene:16} {size:9d}  failed ({done.returncode}): {last}")
        return False
    found = json.loads(done.stdout)
    n, grown = found["contacts"], [found[name] / 1e3 for name in ("held", "grown")]
    print(
        f"{scene:16} {n:9d} {found['make']:9.3f} {1e3 * found['solve']:10.3f} "
        f"{1e6 * found['solve'] / n:12.3f} {grown[0] / n:20.2f} {grown[1] / n:8.2f} "
        f"{found['residual']:9.1e}  {found['status']}",
        flush=True,
    )
    return found["solved"]


def measure(scene: str, size: int, options: argparse.Namespace) -> None:
    """Make a problem, solve it in a fork and print what was measured."""
    bare = forked(peak)
    start = time.perf_counter()
    seed = {"seed": options.seed} if scene in RANDOM else {}
    problem = SCENES[scene](size, **seed)
    make = time.perf_counter() - start
    found = {"contacts": len(problem.laws), "make": make}
    found |= forked(lambda: solved(problem, options, options.repeat))
    if hasattr(libc := ctypes.CDLL(None), "malloc_trim"):
        libc.malloc_trim(0)  # what making the problem has freed would be lent to the solver
    found["held"] = forked(peak) - bare
    found["grown"] = forked(lambda: solved(problem, options, 1))["grown"]
    print(json.dumps(found))


def solved(problem: asp.ContactProblem, options: argparse.Namespace, repeat: int) -> dict:
    """Return the shortest processor time of a solve, the growth of memory and how it ended.

    The first solve analyses the pattern. There is a second one at every size, so that what is
    compared among sizes is a solve with the analysis kept.
    """
    times: list[float] = []
    before = peak()
    enough = False
    while not enough:
        start = time.process_time()
        solution = problem.solve(
            tolerance=options.tolerance,
            time_limit=options.time_limit,
            on_failure="record",
            measure="global",
        )
        times.append(time.process_time() - start)
        long = len(times) > 1 and sum(times) > ENOUGH
        enough = len(times) == repeat or long or not solution.converged
    return {
        "solve": min(times),
        "grown": peak() - before,
        "residual": solution.natural_map,
        "solved": solution.converged,
        "status": solution.status.name.lower(),
    }


def peak() -> int:
    """Return the largest resident memory of this process so far in bytes."""
    return resource.getrusage(resource.RUSAGE_SELF).ru_maxrss * UNIT


def forked(work: Callable):
    """Return what a fork of this process returns; its peak starts at what is resident now."""
    reader, writer = os.pipe()
    if (child := os.fork()) == 0:
        os.write(writer, json.dumps(work()).encode())
        os._exit(0)
    os.close(writer)
    _, status = os.waitpid(child, 0)
    if status:
        sys.exit(f"the solve ended with {os.waitstatus_to_exitcode(status)}")
    with os.fdopen(reader) as file:
        return json.load(file)


if __name__ == "__main__":
    main()
