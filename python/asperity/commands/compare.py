"""``asperity compare``: whether identified friction laws differ."""

from __future__ import annotations

import argparse
from pathlib import Path

from asperity.commands.options import SUCCESS, Commands, add_json, add_out, show


def add(commands: Commands) -> argparse.ArgumentParser:
    """Add the verb; return its parser."""
    parser = commands.add_parser(
        "compare",
        help="say whether identified friction laws differ: before and after wear, two specimens",
        description="Compare laws that `asperity identify` has written with the first of them: "
        "differences of the friction coefficient, of the deflection of the force, of C and D over "
        "the direction, with bands that hold all directions at once, and the probability that "
        "equal laws differ as much. With --out it writes comparison.csv, comparison.png, paths.png "
        "(of bodies that are launched under the laws) and report.html.",
        epilog="example: asperity compare new/law.toml worn/law.toml --out out/compare",
    )
    parser.add_argument("law", metavar="LAW", type=Path, nargs="+", help="files of the laws")
    parser.add_argument(
        "--same-calibration",
        action="store_true",
        help="one calibration served all records: its errors are left out of the differences",
    )
    parser.add_argument(
        "--confidence",
        metavar="LEVEL",
        type=float,
        default=0.95,
        help="of the bands; a law differs if zero leaves them. Default 0.95",
    )
    add_json(parser)
    add_out(parser, required=False)
    return parser


def run(options: argparse.Namespace) -> int:
    """Compare and print; return the exit code."""
    from asperity.predict.comparison_sheet import describe_comparison

    sheet = describe_comparison(
        options.law,
        confidence=options.confidence,
        same_calibration=options.same_calibration,
        out=options.out,
    )
    show(sheet, options, "figures, table and report.html")
    return SUCCESS
