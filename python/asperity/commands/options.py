"""What several verbs share: exit codes, options such as ``--out``, a table of checks."""

from __future__ import annotations

import argparse
import os
import shlex
import subprocess
import time
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any, TypeAlias

from asperity._base.tables import aligned
from asperity.errors import ParameterError

if TYPE_CHECKING:
    from asperity.demo import Check
    from asperity.identify import Inspection

Commands: TypeAlias = "argparse._SubParsersAction[argparse.ArgumentParser]"
"""Where verbs are added."""

SUCCESS, DOUBTFUL, USER_ERROR, INTERRUPTED, PIPE_CLOSED = 0, 1, 2, 130, 141


def quoted(path: Path) -> str:
    """Return a path as the shell of this system takes it."""
    return subprocess.list2cmdline([str(path)]) if os.name == "nt" else shlex.quote(str(path))


def add_out(parser: argparse.ArgumentParser, *, required: bool = True) -> None:
    """Add the folder that a verb writes into."""
    parser.add_argument(
        "--out", metavar="DIR", type=Path, required=required, help="folder to write into"
    )


def add_inspect(parser: argparse.ArgumentParser) -> None:
    """Add the choice of a guess how a file is written."""
    parser.add_argument(
        "--inspect",
        metavar="FILE",
        type=Path,
        help="only show the columns of a file with their ranges, and write the configuration that "
        "seems to read it, to be looked over: to the file of --config, by default beside FILE "
        "with the ending .toml; a file that is there stays as it is",
    )


def show_inspection(found: Inspection, options: argparse.Namespace) -> int:
    """Print what a file seems to be and write its configuration; return the exit code."""
    if options.paths or options.out is not None:
        raise ParameterError("inspect", "takes one file, and no others and no --out beside it")
    print(found.summary())
    target = options.config or options.inspect.with_suffix(".toml")
    if target.exists():
        print(f"\n{target} is there already and stays as it is")
    else:
        found.write(target)
        print(f"\nconfiguration to look over in {target}")
    return DOUBTFUL if found.notes else SUCCESS


def require(options: argparse.Namespace, **needed: str) -> None:
    """Refuse a call without some options that --inspect does without."""
    for name, what in needed.items():
        if not getattr(options, name):
            raise ParameterError("DATA" if name == "paths" else name, what)


def add_models(parser: argparse.ArgumentParser, *further: str) -> None:
    """Add the choice of models of C and D, the loss, and the level of the confidence intervals.

    Args:
        parser: of a verb that fits a law.
        further: what can be chosen beside the shapes.
    """
    for name, meaning in (
        ("reservoir", "force reservoir C"),
        ("direction", "direction set D"),
    ):
        parser.add_argument(
            f"--{name}",
            choices=("circle", "ellipse", "superellipse", "fourier", *further),
            default="superellipse",
            help=f"shape of the {meaning}; default superellipse",
        )
    parser.add_argument(
        "--loss",
        choices=("linear", "soft_l1", "huber", "cauchy"),
        default="linear",
        help="how data far from the law count: linear fully, by least squares; soft_l1, huber and "
        "cauchy less and less, for records with outliers. Default linear",
    )
    parser.add_argument(
        "--confidence",
        metavar="LEVEL",
        type=float,
        default=0.95,
        help="of the confidence intervals; default 0.95",
    )


def add_json(parser: argparse.ArgumentParser) -> None:
    """Add the choice of results as JSON."""
    parser.add_argument(
        "--json", action="store_true", help="print the results as JSON, for other programs"
    )


def show(sheet: Any, options: argparse.Namespace, files: str) -> None:
    """Print what a sheet says, as JSON if asked for, or else with where its files are."""
    from asperity.predict.simulation import as_json

    print(as_json(sheet.data()) if options.json else sheet.text())
    if options.out is not None and not options.json:
        print(f"\n{files} in {options.out}")


def print_checks(run: Callable[[], Sequence[Check]], out: Path) -> int:
    """Run, print the table of checks, and return the exit code."""
    start = time.perf_counter()
    checks = run()
    seconds = time.perf_counter() - start
    print(table(checks))
    off = sum(not check.ok for check in checks)
    print(f"\n{len(checks)} checks, {off} off; figures and tables in {out}; {seconds:.1f} s")
    return DOUBTFUL if off else SUCCESS


def table(checks: Sequence[Check]) -> str:
    """Return a text table: quantity, expected, computed, error, tolerance, unit, verdict.

    >>> from asperity.commands.options import table
    >>> from asperity.demo import Check
    >>> print(table([Check("period", 28.703, 28.6, 0.02, "s")]))
    quantity   expected   computed     error  tolerance
    period    28.703000  28.600000  -1.0e-01    2.0e-02  s  OFF
    """
    rows = [
        (
            check.quantity,
            f"{check.expected:.6f}",
            f"{check.computed:.6f}",
            f"{check.error:.1e}",
            f"{check.tolerance:.1e}",
            check.unit,
            "ok" if check.ok else "OFF",
        )
        for check in checks
    ]
    header = ("quantity", "expected", "computed", "error", "tolerance")
    return aligned([header, *rows], right=range(1, 5))
