"""``asperity identify``: from measured forces to a friction law."""

from __future__ import annotations

import argparse
from pathlib import Path

from asperity._base.progress import bar_if_there
from asperity.commands.options import (
    DOUBTFUL,
    SUCCESS,
    Commands,
    add_inspect,
    add_json,
    add_models,
    add_out,
    require,
    show_inspection,
)
from asperity.errors import ParameterError


def add(commands: Commands) -> argparse.ArgumentParser:
    """Add the verb; return its parser."""
    parser = commands.add_parser(
        "identify",
        help="identify a friction law from measured forces",
        description="Find the friction law of a pairing of surfaces from the forces that a "
        "pin-on-disk tribometer has recorded: how large friction is in every direction of sliding, "
        "and how far the friction force is turned away from opposing the sliding. The law consists "
        "of two sets, drawn in sets.png. The force reservoir C holds the friction forces per unit "
        "normal force that the contact can give: its outline is the friction coefficient over the "
        "direction of the force. The shape of the direction set D says which of these forces acts "
        "while the surface slides in a given direction. All numbers come with confidence "
        "intervals. Shapes of the sets: a circle is the same in all directions, an ellipse has two "
        "axes, a superellipse rounder or sharper corners between them, fourier is any curve; best "
        "compares them and takes the one that fits best for its number of parameters (by BIC, the "
        "Bayesian information criterion). The configuration, a TOML file, says how the data are "
        "read: sections file, columns, units, run, calibration, no_load, tribometer and "
        "processing, all optional; --inspect guesses one. Written are law.toml, the law with the "
        "uncertainty of its parameters, which "
        "`asperity law`, `asperity simulate` and `asperity stability` take; sets.png, "
        "forces.png and residuals.png; parameters.csv, directions.csv, turns.csv and models.csv; "
        "runs.csv, turns.png and report.html with all of it; law_with_rate.toml, C at rest with a "
        "Stribeck factor, where speeds tell one. Runs are grouped by load and speed; "
        "the scatter between mountings, the dependence on load, speed and time, and of strokes the "
        "static coefficient are said. Records with a friction force alone need one_channel = true "
        "in [file]: then there is the coefficient, and law.toml only with --reservoir circle "
        "--direction circle, where friction is the same in all directions, or in its place "
        "law_with_rate.toml where speeds tell a Stribeck factor. "
        "Exit code 1 if they are to be read with the warnings that are printed: records without "
        "load or a calibration are missing, the model does not fit, or the data have another "
        "defect. Exit code 2 if something is wrong with the files; then nothing is written.",
        epilog="examples: asperity identify --inspect run_1.csv --config tribometer.toml; "
        "asperity identify run_1.csv --config tribometer.toml --out out/identify",
    )
    parser.add_argument(
        "paths",
        metavar="DATA",
        type=Path,
        nargs="*",
        help="files of the runs, text tables or .xlsx: rotation of the disk, or motion of a stage; "
        "tangential, radial and normal force",
    )
    parser.add_argument(
        "--config", metavar="FILE", type=Path, help="how they are read, a TOML file"
    )
    add_out(parser, required=False)
    add_inspect(parser)
    parser.add_argument(
        "--sheet",
        metavar="NAME",
        help="sheet of a spreadsheet to --inspect, its name or its number from 0; by default that "
        "which seems to hold the data. The configuration that is written names it",
    )
    add_models(parser, "best")
    add_json(parser)
    return parser


def run(options: argparse.Namespace) -> int:
    """Identify and print; return the exit code."""
    if options.inspect is not None:
        from asperity.identify import inspect_file

        sheet = _sheet(options.inspect, options.sheet)
        return show_inspection(inspect_file(options.inspect, sheet=sheet), options)
    if options.sheet is not None:
        raise ParameterError("sheet", "is for --inspect; the configuration has it in [file]")
    require(
        options,
        paths="names no file",
        config="must be given: --inspect FILE writes one",
        out="must be given",
    )
    from asperity.identify.campaigns.forces import identify_campaign

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
    if options.json:
        from asperity.predict.simulation import as_json

        print(as_json(found.results()))
    else:
        print(found.summary())
        print(f"\nfigures, tables and report.html in {options.out}")
    return DOUBTFUL if found.warnings else SUCCESS


def _sheet(path: Path, given: str | None) -> str | int | None:
    """Return a sheet of a spreadsheet by its name, or by its number if none has it as a name."""
    if given is None or not given.isdigit():
        return given
    from asperity.identify.records.tables.text_table import SPREADSHEETS, sheets_of

    named = path.suffix.lower() in SPREADSHEETS and given in sheets_of(path)
    return given if named else int(given)
