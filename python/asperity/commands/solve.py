"""``asperity solve``: contact problems from files."""

from __future__ import annotations

import argparse
from pathlib import Path

from asperity._base.tables import line, write_csv
from asperity.commands.options import DOUBTFUL, SUCCESS, Commands
from asperity.solvers import NAMES, named

# Widths of the columns after the name: lines are printed one after the other.
_WIDTHS = (8, 14, 10, 14, 8, 9, 0)
_NUMBERS = (1, 3, 4, 5, 6)


def add(commands: Commands) -> argparse.ArgumentParser:
    """Add the verb; return its parser."""
    parser = commands.add_parser(
        "solve",
        help="solve contact problems from files and grade the solutions",
        description="For developers of simulations: solve contact problems, the equations of one "
        "time step with friction, from .npz and HDF5 files (those of the collection FCLIB), and "
        "print a row for each with the method, the time and the residual. The residual, 0 for "
        "an exact solution, is that of the natural map, "
        "||P - proj(P - rho xi)||/max(||P||, rho ||b||), "
        "computed apart from the solvers; stages are method:iterations/factorizations. Exit code "
        "1 if a problem is not solved to the tolerance.",
        epilog="example: asperity solve problems/ --tolerance 1e-8 --time-limit 30 --csv out.csv",
    )
    parser.add_argument(
        "paths", metavar="FOLDER_OR_FILE", type=Path, nargs="+", help="files or folders of files"
    )
    parser.add_argument(
        "--tolerance", type=float, default=1e-8, help="of the residual; default 1e-8"
    )
    parser.add_argument(
        "--time-limit",
        metavar="SECONDS",
        type=float,
        default=30.0,
        help="longest time of one solve in s; default 30",
    )
    parser.add_argument(
        "--solver",
        choices=list(NAMES),
        default="auto",
        help="method; default auto, which tries several",
    )
    parser.add_argument(
        "--repeat",
        metavar="N",
        type=int,
        default=1,
        help="solve N times and print the shortest time, where it is short; default 1",
    )
    parser.add_argument("--csv", metavar="FILE", type=Path, help="write the table to a file too")
    return parser


def run(options: argparse.Namespace) -> int:
    """Solve and print; return the exit code."""
    from asperity._base.storage.files import refuse_input
    from asperity.contact.batch import COLUMNS, problem_files, solve_files

    files = problem_files(options.paths)
    if options.csv is not None:
        refuse_input(options.csv, files, "csv")
    widths = (max(len(path.stem) for path in files), *_WIDTHS)
    print(line(COLUMNS, widths, right=_NUMBERS))
    rows = []
    unreadable: list[tuple[str, str]] = []
    for row in solve_files(
        files,
        named(options.solver),
        tolerance=options.tolerance,
        time_limit=options.time_limit,
        repeat=options.repeat,
        unreadable=unreadable,
    ):
        print(line(row.cells(), widths, right=_NUMBERS), flush=True)
        rows.append(row)
    solved, seconds = sum(row.solved for row in rows), sum(row.seconds for row in rows)
    for name, why in unreadable:
        print(f"{name}: unreadable: {why}")
    total = len(rows) + len(unreadable)
    print(f"solved {solved} of {total} to {options.tolerance:g}, {seconds:.3g} s in all")
    if options.csv is not None:
        write_csv(options.csv, COLUMNS, (row.cells() for row in rows))
    return SUCCESS if solved == total else DOUBTFUL
