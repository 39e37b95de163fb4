"""``asperity init``: an example scenario to edit."""

from __future__ import annotations

import argparse
from pathlib import Path

from asperity.commands.options import SUCCESS, Commands, quoted

_KINDS = ("sliding point", "sliding disk", "mass on belt", "rigid bodies", "squeal")


def add(commands: Commands) -> argparse.ArgumentParser:
    """Add the verb; return its parser."""
    parser = commands.add_parser(
        "init",
        help="write an example scenario and a friction law to edit",
        description="Write scenario.toml and law.toml, with comments that say what every line "
        "means, to start from; with --kind squeal squeal.toml, law.toml and the matrices of a "
        "small model. Files that are there are never overwritten.",
        epilog="example: asperity init --kind 'sliding disk' --out disk, then: asperity simulate "
        "disk/scenario.toml",
    )
    parser.add_argument(
        "--kind", choices=_KINDS, default=_KINDS[0], help=f"what moves; default {_KINDS[0]}"
    )
    parser.add_argument(
        "--out", metavar="DIR", type=Path, default=Path(), help="folder; default the current one"
    )
    return parser


def run(options: argparse.Namespace) -> int:
    """Write and print; return the exit code."""
    from asperity.predict.examples import write_example

    scenario, *others = write_example(options.kind, options.out)
    *rest, last = map(str, [scenario, *others])
    verb = "squeal" if options.kind == "squeal" else "simulate"
    print(f"wrote {', '.join(rest)} and {last}\nnow: asperity {verb} {quoted(scenario)}")
    return SUCCESS
