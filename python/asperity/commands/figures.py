"""``asperity figures``: the figures of the paper with their checks."""

from __future__ import annotations

import argparse

from asperity.commands.options import Commands, add_out, print_checks


def add(commands: Commands) -> argparse.ArgumentParser:
    """Add the verb; return its parser."""
    parser = commands.add_parser(
        "figures",
        help="redraw the figures of Walker & Leine (2019) and check what they state",
        description="Redraw Figs. 1-8 and 10-27 of Walker & Leine (2019): figNN.png, figNN.csv "
        "with its curves (points x, y) and arrows (from x, y by dx, dy), and a table of the "
        "statements that belong to it, Propositions 1-5 among them. Parameters the paper does not "
        "give are chosen here, measurements are synthetic; each figure says so. Exit code 1 if a "
        "statement does not hold.",
        epilog="example: asperity figures --only 1-4,7 --out out/figures",
    )
    parser.add_argument(
        "--only", metavar="NUMBERS", default="1-27", help="such as 1-4,7; default all"
    )
    add_out(parser)
    return parser


def run(options: argparse.Namespace) -> int:
    """Draw and check; return the exit code."""
    from asperity.paper import redraw

    chosen = redraw.numbers(options.only)
    code = print_checks(lambda: redraw.run(options.out, chosen), options.out)
    for sentence in redraw.left_out(chosen):
        print(sentence)
    return code
