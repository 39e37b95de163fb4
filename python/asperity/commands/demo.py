"""``asperity demo``: two figures of the paper and a round trip, with their checks."""

from __future__ import annotations

import argparse

from asperity.commands.options import Commands, add_out, print_checks


def add(commands: Commands) -> argparse.ArgumentParser:
    """Add the verb; return its parser."""
    parser = commands.add_parser(
        "demo",
        help="compute Fig. 17 and Fig. 27 of Walker & Leine (2019) and a round trip; check them",
        description="Compute Fig. 17 (limit cycle) and Fig. 27 (sliding paths) of Walker & Leine "
        "(2019) from the measured parameters, and a round trip: synthetic forces of a known law, "
        "the law identified from them, a path simulated with it. Write fig17, fig27 and roundtrip "
        "as .png and .csv and compare with converged values and the truth. Exit code 1 if one is "
        "off.",
        epilog="example: asperity demo --out out/demo",
    )
    add_out(parser)
    return parser


def run(options: argparse.Namespace) -> int:
    """Compute and check; return the exit code."""
    from asperity.paper import demo

    return print_checks(lambda: demo.run(options.out), options.out)
