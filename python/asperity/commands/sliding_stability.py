"""``asperity stability``: where a friction law makes sliding unstable."""

from __future__ import annotations

import argparse
from pathlib import Path

from asperity._base.progress import bar_if_there
from asperity.commands.options import SUCCESS, Commands, add_json, add_out, show

_BELT = (
    ("mass", "kg", "of the mass on the belt"),
    ("stiffness", "N/m", "of the springs that hold it"),
    ("speed", "m/s", "of the belt"),
    ("normal-force", "N", "that presses the mass on the belt"),
)


def add(commands: Commands) -> argparse.ArgumentParser:
    """Add the verb; return its parser."""
    parser = commands.add_parser(
        "stability",
        help="say in which directions a friction law makes steady sliding unstable",
        description="Find the directions of sliding in which the anisotropy of a friction law "
        "makes steady sliding unstable, so that a machine squeals or chatters, and the growth "
        "rates of such vibrations for a mass that springs hold on a moving belt. With --out it "
        "writes growth.csv, growth.png (growth rates over the direction of the belt and a further "
        "rotation of the force reservoir C, the set whose outline is the friction coefficient over "
        "the direction of the force) and report.html.",
        epilog="example: asperity stability law.toml --mass 0.5 --stiffness 2e4 --out out",
    )
    parser.add_argument("law", metavar="LAW", type=Path, help="file of the law, such as law.toml")
    for name, unit, meaning in _BELT:
        parser.add_argument(
            f"--{name}", metavar=unit, type=float, default=1.0, help=f"{meaning}; default 1 {unit}"
        )
    add_json(parser)
    add_out(parser, required=False)
    return parser


def run(options: argparse.Namespace) -> int:
    """Describe and print; return the exit code."""
    from asperity.predict.stability_sheet import Belt, describe_stability

    belt = Belt(options.mass, options.stiffness, options.speed, options.normal_force)
    with bar_if_there("part") as bar:
        sheet = describe_stability(options.law, belt=belt, out=options.out, progress=bar)
    show(sheet, options, "figure, table and report.html")
    return SUCCESS
