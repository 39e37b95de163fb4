"""``asperity identify-paths``: from measured paths to a friction law."""

from __future__ import annotations

import argparse
from pathlib import Path

from asperity.commands.options import (
    DOUBTFUL,
    SUCCESS,
    Commands,
    add_inspect,
    add_models,
    add_out,
    require,
    show_inspection,
)


def add(commands: Commands) -> argparse.ArgumentParser:
    """Add the verb; return its parser."""
    parser = commands.add_parser(
        "identify-paths",
        help="identify a friction law from paths of a sliding body",
        description="Find the friction law of a pairing of surfaces from the paths of a body that "
        "is launched on a horizontal plane and slides until it stops: no force is measured. The "
        "law consists of two sets, as for `asperity identify`: the force reservoir C, whose "
        "outline is the friction coefficient over the direction of the force, and the direction "
        "set D, whose shape says how the force is turned against the sliding. Simulated paths are "
        "fitted to the measured points over time; speed, direction and time of every launch are "
        "estimated with the law. All numbers come with confidence intervals from what differs "
        "between paths. The configuration, a TOML file, says what is known: [system] gravity; "
        "[paths] position_error and length_error; [launch] place, speed, direction, time of all "
        "launches with their errors, or a list [[launches]] with those of each path; "
        "[file], [columns] and [units] how the tables are written, as for `asperity identify`, "
        "where their headings do not say it (--inspect guesses them); "
        "[fixed.reservoir] and [fixed.direction] parameters such as angle. Lengths are in m, "
        "times in s, angles in rad. Written are law.toml, the law with the uncertainty of its "
        "parameters, which `asperity law`, `asperity simulate` and `asperity stability` take; "
        "paths.png; parameters.csv and launches.csv. Exit code 1 if they are to be read with the "
        "warnings that are printed. Exit code 2 if something is wrong with the files; then "
        "nothing is written.",
        epilog="example: asperity identify-paths film_*/path.csv --config paths.toml --out out",
    )
    parser.add_argument(
        "paths",
        metavar="PATH",
        type=Path,
        nargs="*",
        help="tables with columns t [s], x1 [m], x2 [m] and, if known, x1 error [m], "
        "x2 error [m], such as path.csv of `asperity track`, or as other trackers write them",
    )
    parser.add_argument(
        "--config", metavar="FILE", type=Path, help="what is known beside the paths, a TOML file"
    )
    add_out(parser, required=False)
    add_inspect(parser)
    add_models(parser)
    return parser


def run(options: argparse.Namespace) -> int:
    """Identify and print; return the exit code."""
    if options.inspect is not None:
        from asperity.identify.records.inspection import inspect_path

        return show_inspection(inspect_path(options.inspect), options)
    require(options, paths="names no file", out="must be given")
    from asperity.identify.campaigns.paths import identify_paths

    fit = identify_paths(
        options.paths,
        options.config,
        options.out,
        reservoir=options.reservoir,
        direction=options.direction,
        loss=options.loss,
        confidence=options.confidence,
    )
    print(fit.summary())
    print(f"\nlaw, figure and tables in {options.out}")
    return DOUBTFUL if fit.warnings else SUCCESS
