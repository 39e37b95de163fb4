"""``asperity export``: a friction law in the words of another program."""

from __future__ import annotations

import argparse
from pathlib import Path
from typing import Any

from asperity.commands.options import SUCCESS, Commands, add_json


def add(commands: Commands) -> argparse.ArgumentParser:
    """Add the verb; return its parser."""
    parser = commands.add_parser(
        "export",
        help="write a friction law in the words of MuJoCo, Drake, Abaqus and others",
        description="Write what another program takes for a friction law: the parameters that come "
        "nearest, and as comments what is lost: the largest error of the friction force and of its "
        "direction, how far apart a sliding body ends, and what the program was found to do "
        "otherwise. Standard errors of an identified law and the covariance of its coordinates, "
        "as JSON, are comments, too.",
        epilog="example: asperity export law.toml --to mujoco",
    )
    parser.add_argument("law", metavar="LAW", type=Path, help="file of the law, such as law.toml")
    parser.add_argument("--to", metavar="PROGRAM", required=True, help="name of the program")
    parser.add_argument(
        "--out", metavar="FILE", type=Path, help="file to write instead of printing"
    )
    add_json(parser)
    return parser


def run(options: argparse.Namespace) -> int:
    """Export and print; return the exit code."""
    import json

    from asperity._base.storage.files import refuse_input
    from asperity.identify import IdentifiedLaw
    from asperity.law.export import exported
    from asperity.predict.law_sheet import planar_law
    from asperity.predict.simulation import as_json

    if options.out is not None:
        refuse_input(options.out, [options.law], "out")
    file = planar_law(options.law)
    notes = [f"Friction law of {options.law.name}."]
    covariance = None
    if isinstance(file, IdentifiedLaw) and file.turns is not None:
        rows = zip(file.names, file.values, file.standard_errors, strict=True)
        notes += [f"{name} = {value:.6g} ± {error:.2g}" for name, value, error in rows]
        matrix = [[float(f"{one:.6g}") for one in row] for row in file.covariance.tolist()]
        covariance = {"coordinates": file.coordinates, "matrix": matrix}
        notes.append(f"covariance = {json.dumps(covariance)}")
    export = exported(file.law, options.to, notes=notes)
    if options.out is not None:
        export.save(options.out)
    if options.json:
        prices = ("force_error", "angle_error", "end_distance")
        data: dict[str, Any] = {
            "target": export.target,
            "version": export.version,
            "text": export.text,
        }
        data |= {"parameters": dict(export.parameters)}
        data |= {name: getattr(export, name) for name in prices}
        report = None if export.law is None else export.law.report
        data |= {"end_error": None if report is None else report.end_error}
        print(as_json(data | {"covariance": covariance}))
    elif options.out is None:
        print(export.text, end="")
    return SUCCESS
