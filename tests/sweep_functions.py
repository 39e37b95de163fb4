"""Functions for sweeps, in a file that worker processes can import."""

import os
import signal
import time
from pathlib import Path

import asperity as asp
import numpy as np
from asperity._base.pool import threads_to_use

GRID = {"a": np.linspace(0.1, 2.0, 13), "b": np.arange(9.0)}
SEED = 11


def several(a, b, rng):
    """Results of all kinds, of which one fails."""
    if b == 4.0 and a > 1.9:
        raise ValueError(f"too much: {a}")
    return {
        "product": np.sin(a) * b,
        "drawn": rng.normal(size=3),
        "phase": asp.Phase.SLIP if a > 1.0 else asp.Phase.STICK,
        "large": a > 1.0,
    }


def noted(a, b, rng, log, pause):
    """The same, and a line in a file of every point that is computed."""
    with open(log, "ab", buffering=0) as file:
        file.write(f"{a!r} {b!r}\n".encode())
    time.sleep(pause)
    return several(a, b, rng)


# On Windows SIGTERM ends a process at once, too.
KILLED = getattr(signal, "SIGKILL", signal.SIGTERM)


def deadly(a, victim):
    """The worker is killed at one point."""
    if a == victim:
        os.kill(os.getpid(), KILLED)
    return a


def deadly_once(a, victim, marker):
    """The worker is killed at one point, the first time only."""
    if a == victim and not Path(marker).exists():
        Path(marker).touch()
        os.kill(os.getpid(), KILLED)
    return a


def surroundings(a):
    """What a worker may use."""
    del a
    return {
        "threads": threads_to_use(),
        "blas": int(os.environ.get("OPENBLAS_NUM_THREADS", "0")),
        "process": os.getpid(),
    }


def slow(a):
    time.sleep(0.02)
    return a


def reference(function=several, grid=GRID, **constants):
    """What a plain loop finds, by name; NaN, -128 or nothing where it fails."""
    from asperity.sweeps.task import generator

    shape = tuple(len(values) for values in grid.values())
    found = {
        "product": np.full(shape, np.nan),
        "drawn": np.full((*shape, 3), np.nan),
        "phase": np.full(shape, -128, np.int8),
        "large": np.full(shape, -128, np.int8),
        "status": np.full(shape, 2, np.int8),
    }
    for i, a in enumerate(grid["a"].tolist()):
        for j, b in enumerate(grid["b"].tolist()):
            try:
                results = function(a, b, generator(SEED, {"a": a, "b": b}), **constants)
            except ValueError:
                continue
            for name, value in results.items():
                found[name][i, j] = value
            found["status"][i, j] = 1
    return found
