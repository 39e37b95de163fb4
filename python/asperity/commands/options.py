"""What several verbs share: exit codes, the option ``--out``, a table of checks."""

from __future__ import annotations

import argparse
import time
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, TypeAlias

if TYPE_CHECKING:
    from asperity.paper.checks import Check

Commands: TypeAlias = "argparse._SubParsersAction[argparse.ArgumentParser]"
"""Where verbs are added."""

SUCCESS, DOUBTFUL, USER_ERROR, INTERRUPTED = 0, 1, 2, 130


def add_out(parser: argparse.ArgumentParser, *, required: bool = True) -> None:
    """Add the folder that a verb writes into."""
    parser.add_argument(
        "--out", metavar="DIR", type=Path, required=required, help="folder to write into"
    )


def add_json(parser: argparse.ArgumentParser) -> None:
    """Add the choice of results as JSON."""
    parser.add_argument(
        "--json", action="store_true", help="print the results as JSON, for other programs"
    )


def print_checks(run: Callable[[], Sequence[Check]], out: Path) -> int:
    """Run, print the table of checks, and return the exit code."""
    from asperity.paper.checks import table

    start = time.perf_counter()
    checks = run()
    seconds = time.perf_counter() - start
    print(table(checks))
    off = sum(not check.ok for check in checks)
    print(f"\n{len(checks)} checks, {off} off; figures and tables in {out}; {seconds:.1f} s")
    return DOUBTFUL if off else SUCCESS
