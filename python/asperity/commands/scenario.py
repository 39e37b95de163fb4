"""``asperity simulate``: from a scenario and a law to a motion."""

from __future__ import annotations

import argparse
from pathlib import Path

from asperity._base.progress import bar_if_there
from asperity.commands.options import DOUBTFUL, SUCCESS, Commands, add_json, add_out, show


def add(commands: Commands) -> argparse.ArgumentParser:
    """Add the verb; return its parser."""
    parser = commands.add_parser(
        "simulate",
        help="compute where bodies slide and stop, from a scenario file and a friction law",
        description="Compute the motion of a scenario: a sliding point or disk, a mass on a belt, "
        "or boxes, balls and cylinders on planes. The scenario is a text file that names masses, "
        "sizes, the start and the file of the friction law; `asperity init` writes an example to "
        "edit. With --bands the law is drawn again and again from the uncertainty with which it "
        "was measured, and intervals of all results are given. Writes results.csv, path.csv, "
        "run.npz, path.png, history.png and report.html, with --bands draws.csv. Exit code 1 if a "
        "result is doubtful: the body does not come to rest in time, steps did not converge, or "
        "drawn laws gave no motion. Exit code 2 if something is wrong with the files.",
        epilog="example: asperity simulate scenario.toml --law out/identify/law.toml --bands "
        "--out out/simulate",
    )
    parser.add_argument("scenario", metavar="SCENARIO", type=Path, help="file of the scenario")
    parser.add_argument(
        "--law",
        metavar="FILE",
        type=Path,
        help="file of a friction law, instead of the one that the scenario names",
    )
    parser.add_argument(
        "--bands",
        action="store_true",
        help="how uncertain the results are because the law is; needs a law of asperity identify",
    )
    add_json(parser)
    add_out(parser, required=False)
    return parser


def run(options: argparse.Namespace) -> int:
    """Simulate and print; return the exit code."""
    from asperity.predict.simulation import simulate_scenario

    with bar_if_there() as move:
        found = simulate_scenario(
            options.scenario,
            law=options.law,
            bands=options.bands,
            out=options.out,
            progress=move,
        )
    show(found, options, "figures, tables and report.html")
    return DOUBTFUL if found.warnings else SUCCESS
