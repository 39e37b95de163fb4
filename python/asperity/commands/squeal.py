"""``asperity squeal``: which modes of a finite-element model grow while it slides."""

from __future__ import annotations

import argparse
from pathlib import Path

from asperity._base.progress import bar_if_there
from asperity.commands.options import DOUBTFUL, SUCCESS, Commands, add_json, add_out, show


def add(commands: Commands) -> argparse.ArgumentParser:
    """Add the verb; return its parser."""
    parser = commands.add_parser(
        "squeal",
        help="find the modes of a finite-element model that friction makes grow",
        description="Find all modes of a finite-element model within a band of frequencies while "
        "its contacts slide steadily on a moving surface, and say which of them grow, so that it "
        "squeals. The model is a text file that names the matrices (of CalculiX, Abaqus, Nastran, "
        "Ansys, MATLAB or Matrix Market), the set of the contact nodes with their normal, the "
        "motion of the surface, loads, the file of the friction law, the band in Hz, and factors "
        "of the friction and directions of sliding to go through; `asperity init --kind squeal` "
        "writes an example to edit. Writes modes.csv, modes.png (damping ratio over frequency) and "
        "report.html. Exit code 1 if a result is doubtful: there is no steady sliding, modes may "
        "be missing, the sign of a growth rate is not certain, or the matrices have lost friction "
        "or damping. Exit code 2 if something is wrong with the files.",
        epilog="example: asperity squeal squeal.toml --out out/squeal",
    )
    parser.add_argument("model", metavar="MODEL", type=Path, help="file of the model")
    parser.add_argument(
        "--law",
        metavar="FILE",
        type=Path,
        help="file of a friction law, instead of the one that the model names",
    )
    parser.add_argument(
        "--engine",
        choices=("slepc",),
        help="find the eigenvalues by SLEPc under MPI; the environment variable ASPERITY_SLEPC "
        "holds the command that starts a Python with slepc4py, by default mpiexec -n 2 python3",
    )
    add_json(parser)
    add_out(parser, required=False)
    return parser


def run(options: argparse.Namespace) -> int:
    """Describe and print; return the exit code."""
    from asperity.predict.squeal_sheet import describe_squeal

    with bar_if_there("case") as bar:
        sheet = describe_squeal(
            options.model, law=options.law, out=options.out, engine=options.engine, progress=bar
        )
    show(sheet, options, "figure, table and report.html")
    return DOUBTFUL if sheet.warnings else SUCCESS
