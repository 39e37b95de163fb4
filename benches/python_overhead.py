"""Cost of a step from Python as a ratio to the same run from Rust.

A million steps of the mass on the belt, every 100th saved; allowed: 10 % more per step. Run after
`cargo bench`, whose binary gives the floor: `python benches/python_overhead.py`.
"""

import subprocess
import sys
import time

import asperity as asp
import asperity._core as _core
import numpy as np
from report import ratio as report

STEPS = 1_000_000
RUST = [
    "cargo",
    "bench",
    "--quiet",
    "--locked",
    "-p",
    "asperity",
    "--bench",
    "step",
    "--",
    "million",
]


def rust() -> float:
    """Return nanoseconds per step."""
    return float(
        subprocess.run(RUST, check=True, capture_output=True, text=True).stdout.split()[-1]
    )


def python() -> float:
    """Return nanoseconds per step."""
    law = asp.FrictionLaw(asp.Ellipse(30.0, 10.0, angle=np.deg2rad(30.0)), asp.Ellipse(3.0, 1.0))
    direction = np.deg2rad(50.0)
    velocity = [np.cos(direction), np.sin(direction)]
    belt = asp.MassOnBelt(1.0, stiffness=1.0, law=law, normal_force=1.0, belt_velocity=velocity)
    best = np.inf
    for _ in range(7):
        start = time.perf_counter()
        asp.simulate(belt, dt=1e-3, t_end=STEPS * 1e-3, sample_every=0.1)
        best = min(best, time.perf_counter() - start)
    return best / STEPS * 1e9


def main() -> None:
    """Print the ratio; the runs alternate so that noise meets both alike."""
    if _core.build_profile != "release":
        sys.exit("the extension module is a debug build: install with `make .venv/.installed`")
    times = [(rust(), python()) for _ in range(3)]
    from_rust, from_python = (min(column) for column in zip(*times, strict=True))
    print("a million steps, every 100th saved      ns/step    ratio   allowed")
    print(f"from Rust                              {from_rust:8.1f}")
    ratio = from_python / from_rust
    print(f"from Python                            {from_python:8.1f}  {ratio:7.2f}   1.10")
    report(
        "a million steps from Python, every 100th saved",
        ratio,
        "the same run from Rust",
        "what a run loses by being called from Python",
    )


if __name__ == "__main__":
    main()
