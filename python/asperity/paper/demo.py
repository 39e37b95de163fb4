"""Both simulations with their figures, tables and checks: ``asperity demo``."""

from __future__ import annotations

import csv
import io
from collections.abc import Sequence
from pathlib import Path

from asperity._files import atomic
from asperity.paper import fig17, fig27
from asperity.paper.checks import Check


def run(folder: Path) -> list[Check]:
    """Write fig17.png, fig17.csv, fig27.png, fig27.csv into `folder`; return the checks."""
    import matplotlib as mpl

    mpl.use("Agg")
    from asperity.paper import figures
    from asperity.plot import save_figure

    folder.mkdir(parents=True, exist_ok=True)
    cycle = fig17.run()
    cycle.trajectory.to_csv(folder / "fig17.csv")
    save_figure(figures.draw_fig17(cycle), folder / "fig17.png")
    runs = [fig27.run(dt) for dt in fig27.TIME_STEPS]
    _write_paths(runs[-1], folder / "fig27.csv")
    save_figure(figures.draw_fig27(runs[-1]), folder / "fig27.png")
    return [
        *fig17.checks(cycle, fig17.system()),
        *fig27.checks(runs[-1]),
        *fig27.convergence(runs),
    ]


def _write_paths(paths: Sequence[fig27.SlidingPath], target: Path) -> None:
    text = io.StringIO(newline="")
    writer = csv.writer(text, lineterminator="\n")
    writer.writerow(["law", "angle [deg]", "t [s]", "x [m]", "y [m]", "u_x [m/s]", "u_y [m/s]"])
    for path in paths:
        motion = path.trajectory
        for t, q, u in zip(motion.t.tolist(), motion.q.tolist(), motion.u.tolist(), strict=True):
            writer.writerow([path.law, path.angle, t, *q, *u])
    with atomic(target) as file:
        file.write(text.getvalue().encode())
