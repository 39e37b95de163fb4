"""What the workers have in common: one process solves one problem with one solver of one engine.

A worker gives `serve` a function that yields attempts, (label, prepare): `prepare()` does what is
not timed and returns the call that is, and a function that reads r afterwards. The process is
killed by the alarm if a call exceeds the limit; what was found before is already in the files.
"""

import argparse
import json
import signal
import time
from collections.abc import Callable, Iterator
from pathlib import Path
from statistics import median

import numpy as np
from problem import Problem, grade, load

Call = Callable[[], object]
Prepared = tuple[Call, Callable[[], np.ndarray]] | tuple[Call, Callable[[], np.ndarray], Call]
Attempts = Iterator[tuple[str, Callable[[], Prepared]]]

GRACE = 1.05
"""An engine that keeps the limit by itself may answer a little later than the others are killed."""
ENOUGH = 1.0
"""Seconds of repetitions after which no further one is begun."""
SHORT, AGAIN = 1e-2, 50
"""Seconds below which a call is repeated, and how often."""


def serve(attempts: Callable[[Problem, argparse.Namespace], Attempts]) -> None:
    """Solve the problem named on the command line and write `out`.json and `out`.npz."""
    parser = argparse.ArgumentParser()
    parser.add_argument("problem", type=Path)
    parser.add_argument("out", type=Path)
    parser.add_argument("--solver", default="")
    parser.add_argument("--tolerance", type=float, required=True)
    parser.add_argument("--time-limit", type=float, required=True)
    parser.add_argument("--repeat", type=int, required=True)
    parser.add_argument("--stack", type=float, nargs=3, help="boxes, push and dt of a stack")
    options = parser.parse_args()
    problem = load(options.problem)
    best: dict = {}
    for label, prepare in attempts(problem, options):
        if label in best.get("solved", ()):
            continue
        found, percussion = timed(problem, prepare, options)
        found["label"] = label
        if not best or better(found, best, options.tolerance):
            solved = [*best.get("solved", ())]
            best = {**found, "solved": solved}
            np.savez(options.out.with_suffix(".npz"), percussion=percussion)
        if found["residual"] <= options.tolerance:
            best["solved"].append(label)
        options.out.with_suffix(".json").write_text(json.dumps(best))


def timed(problem: Problem, prepare: Callable[[], Prepared], options: argparse.Namespace) -> tuple:
    """Return the times of a solver's calls, its residual and its percussions.

    An engine that can be reset solves short problems again and again, so that caches are warm for
    all engines alike; every solve starts from no percussions.
    """
    times: list[float] = []
    while len(times) < options.repeat and sum(times) < ENOUGH:
        call, read, *reset = prepare()
        times.append(clock(call, options))
        percussion = read()
        residual = grade(problem, percussion)
        if residual > options.tolerance:
            break
        if reset and times[-1] < SHORT:
            for _ in range(AGAIN):
                reset[0]()
                times.append(clock(call, options))
            break
    return {"best": min(times), "median": median(times), "residual": residual}, percussion


def clock(call: Call, options: argparse.Namespace) -> float:
    """Return the time of a call, which a signal ends at the limit."""
    signal.setitimer(signal.ITIMER_REAL, GRACE * options.time_limit)
    start = time.perf_counter()
    call()
    seconds = time.perf_counter() - start
    signal.setitimer(signal.ITIMER_REAL, 0.0)
    return seconds


def better(one: dict, other: dict, tolerance: float) -> bool:
    """Whether `one` is solved and faster, or nearer to being solved."""
    if min(one["residual"], other["residual"]) > tolerance:
        return one["residual"] < other["residual"]
    if max(one["residual"], other["residual"]) > tolerance:
        return one["residual"] <= tolerance
    return one["best"] < other["best"]
