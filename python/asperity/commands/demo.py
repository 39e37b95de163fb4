"""``asperity demo``: two figures of the paper and a round trip, with their checks."""

from __future__ import annotations

import argparse
from pathlib import Path
from typing import TYPE_CHECKING

from asperity._base.storage.files import ResultFolder
from asperity._base.tables import write_columns
from asperity.commands.options import Commands, add_out, print_checks

if TYPE_CHECKING:
    from asperity.demo import Check

FILES = tuple(
    f"{name}.{kind}" for name in ("fig17", "fig27", "roundtrip") for kind in ("csv", "png")
)
"""What the demonstration writes."""


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
    return print_checks(lambda: compute(options.out), options.out)


def compute(folder: Path) -> list[Check]:
    """Write figures and tables of Fig. 17, Fig. 27 and the round trip; return the checks."""
    import matplotlib as mpl

    mpl.use("Agg")
    from asperity.demo import belt, round_trip, sliding
    from asperity.plot import save_figure

    out = ResultFolder(folder, FILES)
    cycle, trip = belt.run(), round_trip.run()
    runs = [sliding.run(dt) for dt in sliding.TIME_STEPS]
    with out.filled() as place:
        cycle.trajectory.to_csv(place / "fig17.csv")
        save_figure(belt.draw(cycle), place / "fig17.png")
        write_columns(place / "fig27.csv", sliding.columns(runs[-1]))
        save_figure(sliding.draw(runs[-1]), place / "fig27.png")
        write_columns(place / "roundtrip.csv", round_trip.columns(trip))
        save_figure(round_trip.draw(trip), place / "roundtrip.png")
    return [
        *belt.checks(cycle),
        *sliding.checks(runs[-1]),
        *sliding.convergence(runs),
        *round_trip.checks(trip),
    ]
