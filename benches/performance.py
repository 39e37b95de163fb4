"""Run all benches and write docs/performance.md from the ratios that they report.

    python benches/performance.py                 what `make bench` does
    python benches/performance.py --only step     runs one of them anew
    python benches/performance.py --only          writes the page of what was found before

What a bench prints is kept in out/bench. A bench is a Rust file that a crate declares, or a file
python_*.py beside this one; its ratios are lines of report.rs and report.py.
"""

from __future__ import annotations

import argparse
import datetime
import os
import platform
import subprocess
import sys
import tomllib
from collections.abc import Iterator, Mapping, Sequence
from pathlib import Path
from typing import NamedTuple

import asperity as asp
import asperity._core as _core
import numpy as np
import scipy
from asperity._base.pool import available_cores
from asperity._base.storage.files import atomic

ROOT = Path(__file__).resolve().parents[1]
PAGE = ROOT / "docs" / "performance.md"
KEPT = ROOT / "out" / "bench"
SUBJECTS = {
    "One contact": ("step", "laws", "sets"),
    "Many contacts": ("bodies", "python_solve", "python_islands"),
    "Many runs": ("ensemble", "lanes", "python_ensembles", "python_sweep"),
    "From Python": ("python_overhead", "python_sets"),
    "Stability and limit cycles": ("python_stability",),
    "Measurements": (
        "python_identification",
        "python_laboratory",
        "python_patches",
        "python_tracking",
    ),
}
"""What a user asks for, and the benches that answer."""

HEAD = """# Performance

Every number is a ratio of two times in the same run: that of asperity over that of something else.
`make bench` prints all ratios, the shortest of several times each, and writes this page from the
first two of every bench; `python benches/performance.py --only step` runs one of them anew.
"""
TAIL = """`make many` prints time and memory of the default solver from 10 to 10⁵ contacts,
`make peers` compares other engines on the same contact problems, `make linear` the sparse
factorisations with faer's, and `python benches/solver_steps.py` what each step of the default
solver buys.
"""


class Ratio(NamedTuple):
    """A line of the page."""

    case: str
    value: float
    beside: str
    meaning: str


def commands() -> dict[str, list[str]]:
    """Return how every bench is run, by its name."""
    found = {}
    for manifest in sorted((ROOT / "crates").glob("*/Cargo.toml")):
        crate = tomllib.loads(manifest.read_text(encoding="utf-8"))
        for bench in crate.get("bench", ()):
            words = ["cargo", "bench", "--quiet", "--locked", "--package"]
            found[bench["name"]] = [*words, crate["package"]["name"], "--bench", bench["name"]]
    for path in sorted((ROOT / "benches").glob("python_*.py")):
        found[path.stem] = [sys.executable, str(path)]
    return found


def source(name: str) -> str:
    """Return the file of a bench."""
    return f"benches/{name}.py" if name.startswith("python_") else f"benches/{name}.rs"


def ratios(text: str) -> Iterator[Ratio]:
    """Yield what a bench has reported."""
    for line in text.splitlines():
        if line.startswith("ratio\t"):
            _, case, value, beside, meaning = line.split("\t")
            yield Ratio(case, float(value), beside, meaning)


def run(name: str, words: Sequence[str]) -> str:
    """Run a bench, show what it prints and keep it."""
    print(f"+ {source(name)}", flush=True)
    lines = []
    environment = {**os.environ, "PYTHONUTF8": "1"}
    with subprocess.Popen(
        words, cwd=ROOT, env=environment, stdout=subprocess.PIPE, text=True, encoding="utf-8"
    ) as process:
        assert process.stdout is not None
        for line in process.stdout:
            for one in ratios(line):
                print(f"{one.case}: {_short(one.value)} ({one.meaning})", flush=True)
            if not line.startswith("ratio\t"):
                print(line, end="", flush=True)
            lines.append(line)
    if process.returncode:
        raise subprocess.CalledProcessError(process.returncode, words)
    text = f"measured\t{machine()}" + "".join(lines)
    KEPT.mkdir(parents=True, exist_ok=True)
    with atomic(KEPT / f"{name}.txt") as file:
        file.write(text.encode())
    return text


def machine() -> str:
    """Return the sentences on where and with what the ratios were measured."""
    rust = subprocess.run(["rustc", "--version"], capture_output=True, text=True, check=True)
    built = "with optimisation across crates, as wheels are"
    if os.environ.get("CARGO_PROFILE_RELEASE_LTO") == "off":
        built = "without optimisation across crates, other than wheels are"
    return (
        f"Measured on {datetime.date.today():%Y-%m-%d} with asperity {asp.__version__} on "
        f"{_processor()}, {available_cores()} cores, {platform.system()}; "
        f"Python {platform.python_version()}, NumPy {np.__version__}, SciPy {scipy.__version__}, "
        f"Rust {rust.stdout.split()[1]}, built {built}.\n"
    )


def _processor() -> str:
    """Return the name of the processor as the system tells it."""
    told = Path("/proc/cpuinfo")
    if told.exists():
        for line in told.read_text(encoding="utf-8", errors="replace").splitlines():
            if line.startswith("model name"):
                return line.partition(":")[2].strip()
    return platform.processor() or platform.machine()


def page(found: Mapping[str, Sequence[Ratio]], where: str) -> str:
    """Return the page of what benches have reported."""
    parts = [HEAD, where]
    for subject, names in SUBJECTS.items():
        parts.append(f"## {subject}\n")
        benches = ", ".join(f"`{source(name)}`" for name in names)
        parts.append(f"From {benches}.\n")
        rows = ["| what | ratio | to |", "|---|---|---|"]
        for name in names:
            few = found[name][:2]
            rows += [f"| {one.case} | {_short(one.value)} | {one.beside} |" for one in few]
        parts.append("\n".join(rows) + "\n")
    return "\n".join([*parts, TAIL])


def _short(value: float) -> str:
    """Return three digits: more would change from run to run."""
    return f"{value:.0f}" if value >= 100.0 else f"{value:.3g}"


def main(arguments: Sequence[str] | None = None) -> int:
    """Run what is asked for and write the page; return the exit code."""
    parser = argparse.ArgumentParser(description=(__doc__ or "").splitlines()[0])
    every = commands()
    parser.add_argument("--only", nargs="*", choices=list(every), metavar="BENCH")
    parser.add_argument("--out", type=Path, default=PAGE)
    options = parser.parse_args(arguments)
    if _core.build_profile != "release":
        print("the extension module is a debug build: use `make bench`", file=sys.stderr)
        return 1
    wanted = every if options.only is None else options.only
    for name in wanted:
        run(name, every[name])
    missing = [name for name in every if not (KEPT / f"{name}.txt").exists()]
    if missing:
        print(f"not run yet: {', '.join(missing)}", file=sys.stderr)
        return 1
    kept = {name: (KEPT / f"{name}.txt").read_text(encoding="utf-8") for name in every}
    where = {name: text.partition("\n")[0].partition("\t")[2] for name, text in kept.items()}
    here = machine().strip()
    if others := [name for name, one in where.items() if one != here]:
        print(
            f"of another day, machine or build: {', '.join(others)}; `make bench` runs all",
            file=sys.stderr,
        )
        return 1
    found = {name: list(ratios(text)) for name, text in kept.items()}
    text = page(found, machine())
    with atomic(options.out) as file:
        file.write(text.encode())
    print(f"wrote {options.out}")
    return 0


if __name__ == "__main__":
    sys.exit(main())
