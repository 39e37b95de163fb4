"""``asperity identify``: from measured forces to a friction law."""

from __future__ import annotations

import argparse
from pathlib import Path

from asperity._base.progress import bar_if_there
from asperity.commands.options import DOUBTFUL, SUCCESS, Commands, add_out


def add(commands: Commands) -> argparse.ArgumentParser:
    """Add the verb; return its parser."""
    parser = commands.add_parser(
        "identify",
        help="identify a friction law from measured forces",
        description="Identify the force reservoir C and the direction set D from the forces of a "
        "pin-on-disk tribometer, with confidence bands, and compare models. The TOML file says how "
        "the files are read: sections file, columns, units, calibration, no_load, tribometer, "
        "processing, all optional. Writes law.toml, the law with its parameters and their "
        "covariance, sets.png, forces.png, residuals.png, parameters.csv, "
        "directions.csv, turns.csv, models.csv, report.html. Exit code 1 if they are to be read "
        "with warnings, which are printed: records without load or a calibration are missing, the "
        "model does not fit, or the data have another defect. Exit code 2 if something is wrong "
        "with the files; then nothing is written.",
        epilog="example: asperity identify run_1.csv --config tribometer.toml --out out/identify",
    )
    parser.add_argument("paths", metavar="DATA", type=Path, nargs="+", help="CSV files of runs")
    parser.add_argument("--config", metavar="FILE", type=Path, required=True, help="TOML file")
    add_out(parser)
    for name, meaning in (("reservoir", "C"), ("direction", "D")):
        parser.add_argument(
            f"--{name}",
            choices=("circle", "ellipse", "superellipse", "fourier", "best"),
            default="superellipse",
            help=f"model of {meaning}, or the best one by BIC; default superellipse",
        )
    parser.add_argument(
        "--loss",
        choices=("linear", "huber", "cauchy"),
        default="linear",
        help="loss of the residuals: linear for least squares, the others for outliers; "
        "default linear",
    )
    parser.add_argument(
        "--confidence", type=float, default=0.95, help="level of the bands; default 0.95"
    )
    return parser


def run(options: argparse.Namespace) -> int:
    """Identify and print; return the exit code."""
    from asperity.identify.campaign import identify_campaign

    with bar_if_there("stage") as bar:
        found = identify_campaign(
            options.paths,
            options.config,
            options.out,
            reservoir=options.reservoir,
            direction=options.direction,
            loss=options.loss,
            confidence=options.confidence,
            progress=bar,
            announce=bar.announce,
        )
    print(found.summary())
    print(f"\nfigures, tables and report.html in {options.out}")
    return DOUBTFUL if found.fit.warnings else SUCCESS
