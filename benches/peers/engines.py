"""The engines of the comparison: where they are, what to install, how a worker of one is run."""

import json
import os
import subprocess
import sys
import tempfile
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from problem import Problem, grade

HERE = Path(__file__).parent
ONE_THREAD = {
    f"{name}_NUM_THREADS": "1" for name in ("OMP", "OPENBLAS", "MKL", "BLIS", "RAYON", "NUMEXPR")
}
STARTUP = 60.0
"""Seconds a worker may take besides its calls, before it is given up."""
CALLS = 24
"""Calls of a worker at the most: repetitions, storages and tolerances."""


@dataclass(frozen=True)
class Engine:
    """An engine, the solvers tried by default, the module whose import shows that it is there."""

    name: str
    solvers: tuple[str, ...]
    module: str
    distribution: str
    install: str
    python: str = sys.executable

    @property
    def variable(self) -> str:
        """Environment variable that names the engine's Python."""
        return f"ASPERITY_{self.name.upper()}_PYTHON"

    @property
    def interpreter(self) -> str:
        """The Python that runs the engine's worker."""
        return os.environ.get(self.variable, self.python)

    def version(self) -> str | None:
        """Return the engine's version, or None where it cannot be imported."""
        script = (
            f"import {self.module}; import importlib.metadata as m\n"
            f"try: print(m.version({self.distribution!r}))\n"
            "except m.PackageNotFoundError: print('unknown')"
        )
        try:
            done = subprocess.run([self.interpreter, "-c", script], capture_output=True, text=True)
        except OSError:
            return None
        return done.stdout.split()[-1] if done.returncode == 0 else None

    def advice(self) -> str:
        """Say how to make the engine available."""
        return (
            f"{self.name} is left out: {self.interpreter} cannot import {self.module}; "
            f"{self.install}, or set {self.variable} to a Python that can"
        )


ENGINES = {
    engine.name: engine
    for engine in (
        Engine("asperity", ("default",), "asperity", "asperity", "run `make .venv/.installed`"),
        Engine(
            "siconos",
            ("NSGS", "raw:PROX", "PROX", "NSN_AC", "raw:NSN_AC", "ADMM"),
            "siconos.numerics",
            "siconos",
            "on Debian or Ubuntu `apt-get install python3-siconos python3-scipy`",
            "/usr/bin/python3",
        ),
        Engine("pinocchio", ("ADMM", "PGS"), "pinocchio", "pin", "`pip install pin scipy`"),
        Engine("mujoco", ("Newton",), "mujoco", "mujoco", "`pip install mujoco scipy`"),
    )
}


@dataclass(frozen=True)
class Answer:
    """The best of an engine's solvers on a problem; `label` says which, or what went wrong."""

    label: str
    best: float = np.inf
    median: float = np.inf
    residual: float = np.inf


def answer(
    engine: Engine,
    solvers: tuple[str, ...],
    path: Path,
    problem: Problem,
    limits: tuple[float, float, int],
    stack: tuple[float, ...] | None,
) -> Answer:
    """Return the best answer; a solver is stopped when it is slower than the best before it."""
    tolerance, time_limit, repeat = limits
    best = Answer("not for this problem")
    for solver in solvers:
        # What is slower than the best cannot be it; short times are left some room for noise.
        left = min(time_limit, max(0.5, 1.5 * best.best)) if solved(best, tolerance) else time_limit
        words = ["--solver", solver, "--tolerance", tolerance, "--time-limit", left]
        words += ["--repeat", repeat, *(["--stack", *stack] if stack else [])]
        found = run(engine, path, problem, [str(word) for word in words], left)
        if solved(found, tolerance) and solved(best, tolerance):
            best = min(best, found, key=lambda one: one.best)
        elif found.residual < best.residual or best.label == "not for this problem":
            best = found
    return best


def solved(one: Answer, tolerance: float) -> bool:
    """Whether an answer reaches the tolerance."""
    return one.residual <= tolerance


def run(engine: Engine, path: Path, problem: Problem, words: list[str], limit: float) -> Answer:
    """Run a worker; its percussions are graded here, whatever it says of them."""
    with tempfile.TemporaryDirectory() as folder:
        out = Path(folder) / "out"
        worker = [engine.interpreter, str(HERE / f"{engine.name}_worker.py"), str(path), str(out)]
        try:
            done = subprocess.run(
                worker + words,
                stdout=subprocess.DEVNULL,
                stderr=subprocess.PIPE,
                env=os.environ | ONE_THREAD,
                timeout=STARTUP + CALLS * limit,
            )
        except subprocess.TimeoutExpired:
            return Answer("no answer")
        result = out.with_suffix(".json")
        if not result.exists():
            return Answer(failure(done))
        found = json.loads(result.read_text())
        with np.load(out.with_suffix(".npz")) as data:
            residual = grade(problem, data["percussion"])
        return Answer(found["label"], found["best"], found["median"], residual)


def failure(done: subprocess.CompletedProcess) -> str:
    """Say why a worker left no result."""
    if done.returncode == 0:
        return "not for this problem"
    if done.returncode == -14:
        return "time limit"
    lines = done.stderr.decode(errors="replace").strip().splitlines()
    return f"failed ({done.returncode}): {lines[-1][:100] if lines else 'no message'}"
