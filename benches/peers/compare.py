"""Compare asperity with other engines on the same contact problems, graded by one measure.

    python benches/peers/compare.py FOLDER [--engines asperity,siconos] [--time-limit 30]

FOLDER holds problem files (`problem.py`); generated problems are added. Every solver of every
engine runs in a process of its own, with one thread and from a cold start; the time is that of the
solver's call alone, the best of several where it is short. An engine counts with its fastest solver
that reaches the tolerance. Engines live in Pythons of their own: `engines.py` says where.
"""

import argparse
import sys
import tempfile
from pathlib import Path

import table
from engines import ENGINES, Engine, answer
from problem import load


def main() -> None:
    """Run the comparison and print the table."""
    options = arguments()
    engines = available(options.engines.split(","))
    if not engines:
        sys.exit("none of the engines is there")
    with tempfile.TemporaryDirectory() as scratch:
        paths, stacks = files(options, Path(scratch))
        print(table.head(list(engines)))
        rows = []
        for path in sorted(paths, key=lambda path: len(load(path).mu)):
            rows.append(row(path, engines, options, stacks.get(path.stem)))
            print(table.line(rows[-1], options.tolerance), flush=True)
    print(table.summary(rows, list(engines), options.tolerance))
    if options.csv:
        table.write(options.csv, rows, options.tolerance)


def row(
    path: Path, engines: dict[str, Engine], options: argparse.Namespace, stack: tuple | None
) -> table.Row:
    """Return the answers of all engines to a problem."""
    chosen = dict(part.split("=", 1) for part in options.solvers)
    problem, limits = load(path), (options.tolerance, options.time_limit, options.repeat)
    answers = {}
    for name, engine in engines.items():
        solvers = tuple(chosen[name].split(",")) if name in chosen else engine.solvers
        answers[name] = answer(engine, solvers, path, problem, limits, stack)
    return path.stem, len(problem.mu), answers


def arguments() -> argparse.Namespace:
    """Read the command line."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("folder", type=Path, nargs="?", help="problem files; default none")
    parser.add_argument("--time-limit", type=float, default=30.0, help="s per call")
    parser.add_argument("--tolerance", type=float, default=1e-8)
    parser.add_argument("--engines", default=",".join(ENGINES))
    parser.add_argument("--repeat", type=int, default=5)
    parser.add_argument("--only", default="", help="part of the names of the problems to run")
    parser.add_argument("--no-generated", action="store_true", help="leave out generated problems")
    parser.add_argument("--solvers", action="append", default=[], metavar="ENGINE=A,B")
    parser.add_argument("--csv", type=Path)
    options = parser.parse_args()
    if unknown := set(options.engines.split(",")) - set(ENGINES):
        parser.error(
            f"--engines: unknown {', '.join(sorted(unknown))}; known: {', '.join(ENGINES)}"
        )
    if options.folder and not options.folder.is_dir():
        parser.error(f"{options.folder} is not a folder")
    return options


def available(names: list[str]) -> dict[str, Engine]:
    """Return the engines that are there; name the others and what to install."""
    found = {}
    for name in names:
        version = ENGINES[name].version()
        print(f"{name} {version}" if version else ENGINES[name].advice())
        if version:
            found[name] = ENGINES[name]
    return found


def files(options: argparse.Namespace, scratch: Path) -> tuple[list[Path], dict]:
    """Return the problem files and the stacks among them."""
    paths, stacks = sorted(options.folder.glob("*.npz")) if options.folder else [], {}
    if not options.no_generated:
        try:
            from generated import write as generate

            stacks = generate(scratch)
            paths += scratch.glob("*.npz")
        except (ImportError, AttributeError) as error:
            print(f"no generated problems: {sys.executable} has no complete asperity ({error})")
    return [path for path in paths if options.only in path.stem], stacks


if __name__ == "__main__":
    main()
