"""From synthetic forces and films to a law and its sliding path: part of ``asperity demo``."""

from dataclasses import dataclass

import matplotlib.pyplot as plt
import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

import asperity as asp
from asperity.demo import table1
from asperity.demo.checks import Check
from asperity.demo.film import Film, film, slide, until_rest
from asperity.identify import Fit, VirtualTribometer, fit_law, process

LAW = asp.FrictionLaw(table1.SUPERELLIPSE_C, table1.SUPERELLIPSE_D)
"""The law that is measured virtually: Table 1."""

TRUTH = {
    "reservoir.a": table1.SUPERELLIPSE_C.a,
    "reservoir.b": table1.SUPERELLIPSE_C.b,
    "reservoir.exponent": table1.SUPERELLIPSE_C.exponent,
    "direction.ratio": table1.SUPERELLIPSE_D.a / table1.SUPERELLIPSE_D.b,
    "direction.exponent": table1.SUPERELLIPSE_D.exponent,
}
"""Its parameters under the names of a fit."""

SHARES = {
    "reservoir.a": 6e-3,
    "reservoir.b": 7e-3,
    "reservoir.exponent": 4e-3,
    "direction.ratio": 2.5e-3,
    "direction.exponent": 1e-3,
}
"""Relative tolerances, three times the scatter over seeds or a little more."""

# 10 turns at 50 mm/s, 50 mm off the axis, read 10 000 times a second.
_TURN_RATE, _RADIUS, _SAMPLE_RATE = 0.16, 0.05, 1e4


@dataclass(frozen=True)
class RoundTrip:
    """A law identified from synthetic forces, a film of the disk, and its path under that law."""

    fit: Fit
    film: Film
    run: asp.Trajectory

    @property
    def comparison(self) -> asp.runs.PathComparison:
        """The path under the identified law beside the tracked one."""
        return asp.compare_path(self.run, self.film.path)


def run(seed: int = 1) -> RoundTrip:
    """Measure the law of Table 1 with a virtual tribometer, fit it, and film a disk that obeys it.

    The disk of the simulation starts as the tracked one and obeys the identified law.
    """
    virtual = VirtualTribometer(
        LAW,
        normal_force=table1.NORMAL_FORCE,
        turns=10,
        turn_rate=_TURN_RATE,
        radius=_RADIUS,
        sample_rate=_SAMPLE_RATE,
        seed=seed,
    )
    fit = fit_law(process(virtual.record()))
    disk, truth = slide(LAW, speed=1.52, angle=58.0)
    tracked = film(disk, truth, fps=250.0, size=(640, 540), seed=seed)
    place, velocity = tracked.path.start
    start = disk.replace(law=fit.law, position=place, velocity=velocity)
    identified = until_rest(start)
    return RoundTrip(fit, tracked, identified)


def checks(trip: RoundTrip) -> list[Check]:
    """Compare law and tracked path with the truth, and the simulated path with the tracked one."""
    found = trip.fit.parameters
    path, camera = trip.film.path, trip.film.camera
    off = np.linalg.norm(path.position[path.seen] - camera.position[path.seen], axis=1)
    return [
        *(
            Check(f"round trip {name}", value, found[name].value, SHARES[name] * value)
            for name, value in TRUTH.items()
        ),
        Check("round trip frames without the mark", 0.0, float((~path.seen).sum()), 0.0),
        Check("round trip tracking, rms", 0.0, 1e3 * float(np.sqrt(np.mean(off**2))), 0.09, "mm"),
        Check("round trip path off, rms", 0.0, 1e3 * trip.comparison.rms, 0.9, "mm"),
        Check("round trip end of the path off", 0.0, 1e3 * trip.comparison.end_distance, 1.5, "mm"),
    ]


def columns(trip: RoundTrip) -> dict[str, list[float]]:
    """Return the compared paths as columns of a table."""
    compared = trip.comparison
    names = ("tracked x [m]", "tracked y [m]", "x [m]", "y [m]", "distance [m]")
    values = np.column_stack([compared.measured, compared.simulated, compared.distance])
    return {"t [s]": compared.time.tolist(), **dict(zip(names, values.T.tolist(), strict=True))}


def draw(trip: RoundTrip) -> Figure:
    """Draw the forces with the fitted law, its sets, and the two paths."""
    with asp.plot.style():
        figure, axes = plt.subplots(1, 3, figsize=(14.0, 4.9), layout="constrained")
        asp.plot.plot_fitted_forces(trip.fit, ax=axes[0])
        axes[0].set_title("Forces of the virtual tribometer")
        asp.plot.plot_fitted_sets(trip.fit, ax=axes[1])
        axes[1].set_title("Identified sets")
        _draw_paths(trip, axes[2])
        figure.suptitle("Round trip on synthetic data: Table 1, forces, law, sliding path, film")
    return figure


def _draw_paths(trip: RoundTrip, ax: Axes) -> None:
    path = trip.film.path
    truth = 1e3 * trip.film.run.q[:, :2]
    ax.plot(*truth.T, label="true law", linewidth=4.0, alpha=0.35)
    ax.plot(*(1e3 * trip.run.q[:, :2]).T, label="identified law")
    tracked = 1e3 * path.position[path.seen][::5]
    ax.plot(
        *tracked.T, "o", color="black", markersize=4.0, label="tracked, 20 ms", fillstyle="none"
    )
    ax.set_aspect("equal")
    ax.set(
        title=f"Path of the disk, ends {1e3 * trip.comparison.end_distance:.2f} mm apart",
        xlabel="$x$ across the grooves in mm",
        ylabel="$y$ along the grooves in mm",
    )
    ax.legend(loc="upper left")
