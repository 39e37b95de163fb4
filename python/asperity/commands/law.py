"""``asperity law``: what a friction law is."""

from __future__ import annotations

import argparse
from pathlib import Path

from asperity.commands.options import SUCCESS, Commands, add_json, add_out, show


def add(commands: Commands) -> argparse.ArgumentParser:
    """Add the verb; return its parser."""
    parser = commands.add_parser(
        "law",
        help="say what a friction law is: coefficients over the direction, properties, pictures",
        description="Print what a file of a friction law holds: where it comes from, its "
        "properties, and for every direction of sliding the friction coefficient and the angle by "
        "which the friction force is turned against the sliding direction. A law consists of two "
        "sets: the force reservoir C, whose outline is the friction coefficient over the direction "
        "of the force, and the direction set D, whose shape says how the force is turned. "
        "With --out it writes coefficients.csv, sets.png, coefficients.png and report.html.",
        epilog="example: asperity law out/identify/law.toml --out out/law",
    )
    parser.add_argument("law", metavar="LAW", type=Path, help="file of the law, such as law.toml")
    add_json(parser)
    add_out(parser, required=False)
    return parser


def run(options: argparse.Namespace) -> int:
    """Describe and print; return the exit code."""
    from asperity.predict.law_sheet import describe_law

    sheet = describe_law(options.law, out=options.out)
    show(sheet, options, "figures, table and report.html")
    return SUCCESS
