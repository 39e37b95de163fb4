"""Both simulations and the round trip with figures, tables, checks: ``asperity demo``."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

import numpy as np

from asperity._base.tables import write_columns
from asperity.paper import fig17, fig27
from asperity.paper.checks import Check


def run(folder: Path) -> list[Check]:
    """Write figures and tables of Fig. 17, Fig. 27 and the round trip; return the checks."""
    import matplotlib as mpl

    mpl.use("Agg")
    from asperity.paper import figures, round_trip
    from asperity.plot import save_figure

    folder.mkdir(parents=True, exist_ok=True)
    cycle = fig17.run()
    cycle.trajectory.to_csv(folder / "fig17.csv")
    save_figure(figures.draw_fig17(cycle), folder / "fig17.png")
    runs = [fig27.run(dt) for dt in fig27.TIME_STEPS]
    write_columns(folder / "fig27.csv", _columns(runs[-1]))
    save_figure(figures.draw_fig27(runs[-1]), folder / "fig27.png")
    trip = round_trip.run()
    write_columns(folder / "roundtrip.csv", round_trip.columns(trip))
    save_figure(round_trip.draw(trip), folder / "roundtrip.png")
    return [
        *fig17.checks(cycle, fig17.system()),
        *fig27.checks(runs[-1]),
        *fig27.convergence(runs),
        *round_trip.checks(trip),
    ]


def _columns(paths: Sequence[fig27.SlidingPath]) -> dict[str, list[object]]:
    motions = [path.trajectory for path in paths]
    lengths = [len(motion.t) for motion in motions]
    t, q, u = (np.concatenate([getattr(motion, name) for motion in motions]) for name in "tqu")
    return {
        "law": np.repeat([path.law for path in paths], lengths).tolist(),
        "angle [deg]": np.repeat([path.angle for path in paths], lengths).tolist(),
        "t [s]": t.tolist(),
        "x [m]": q[:, 0].tolist(),
        "y [m]": q[:, 1].tolist(),
        "u_x [m/s]": u[:, 0].tolist(),
        "u_y [m/s]": u[:, 1].tolist(),
    }
