"""From synthetic forces to a law to a sliding path, with known truth: part of ``asperity demo``."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from asperity.comparison import PathComparison, compare_path
from asperity.identify import Fit, VirtualTribometer, fit_law, process
from asperity.law import FrictionLaw
from asperity.paper import table1
from asperity.paper.checks import Check
from asperity.paper.filmed import ANGLE, SPEED, slide
from asperity.trajectory import Trajectory

LAW = FrictionLaw(table1.SUPERELLIPSE_C, table1.SUPERELLIPSE_D)
"""The law that is measured virtually: Table 1."""

TRUTH = {
    "reservoir.a": table1.SUPERELLIPSE_C.a,
    "reservoir.b": table1.SUPERELLIPSE_C.b,
    "reservoir.exponent": table1.SUPERELLIPSE_C.exponent,
    "direction.ratio": table1.SUPERELLIPSE_D.a / table1.SUPERELLIPSE_D.b,
    "direction.exponent": table1.SUPERELLIPSE_D.exponent,
}
"""Its parameters under the names of a fit."""

# 10 turns at 50 mm/s, 50 mm off the axis.
_TURN_RATE, _RADIUS = 0.16, 0.05


@dataclass(frozen=True)
class RoundTrip:
    """A law identified from synthetic forces, and the disk's path under it and under the truth."""

    fit: Fit
    truth: Trajectory
    run: Trajectory

    @property
    def comparison(self) -> PathComparison:
        """The path under the identified law beside the true one."""
        return compare_path(self.run, self.truth)


def run(seed: int = 1) -> RoundTrip:
    """Measure the law of Table 1 with a virtual tribometer, fit it, and let a disk slide."""
    virtual = VirtualTribometer(
        LAW,
        normal_force=table1.NORMAL_FORCE,
        turns=10,
        turn_rate=_TURN_RATE,
        radius=_RADIUS,
        sample_rate=1000.0,
        seed=seed,
    )
    fit = fit_law(process(virtual.record()))
    (_, truth), (_, identified) = (slide(law, SPEED, ANGLE) for law in (LAW, fit.law))
    return RoundTrip(fit, truth, identified)


def checks(trip: RoundTrip) -> list[Check]:
    """Compare with the truth: semi-axes and p₁/p₂ to 1 %, exponents to 5 %, the path to 2 mm."""
    found = trip.fit.parameters
    result = []
    for name, value in TRUTH.items():
        share = 0.05 if name.endswith("exponent") else 0.01
        result.append(Check(f"round trip {name}", value, found[name].value, share * value))
    apart = 1e3 * trip.comparison.end_distance
    return [*result, Check("round trip end of the path off", 0.0, apart, 2.0, "mm")]


def columns(trip: RoundTrip) -> dict[str, list[float]]:
    """Return the compared paths as columns of a table."""
    compared = trip.comparison
    names = ("true x [m]", "true y [m]", "x [m]", "y [m]", "distance [m]")
    values = np.column_stack([compared.measured, compared.simulated, compared.distance])
    return {"t [s]": compared.time.tolist(), **dict(zip(names, values.T.tolist(), strict=True))}


def draw(trip: RoundTrip) -> Figure:
    """Draw the forces with the fitted law, its sets, and the two paths."""
    import matplotlib.pyplot as plt

    from asperity.plot import plot_fitted_forces, plot_fitted_sets, style

    with style():
        figure, axes = plt.subplots(1, 3, figsize=(14.0, 4.9), layout="constrained")
        plot_fitted_forces(trip.fit, axes[0])
        axes[0].set_title("Forces of the virtual tribometer")
        plot_fitted_sets(trip.fit, axes[1])
        axes[1].set_title("Identified sets")
        _draw_paths(trip, axes[2])
        figure.suptitle("Round trip on synthetic data: Table 1, forces, law, sliding path")
    return figure


def _draw_paths(trip: RoundTrip, ax: Axes) -> None:
    for motion, label, width, alpha in (
        (trip.truth, "true law", 4.0, 0.35),
        (trip.run, "identified law", 1.6, 1.0),
    ):
        ax.plot(*(1e3 * motion.q[:, :2]).T, label=label, linewidth=width, alpha=alpha)
    ax.set_aspect("equal")
    ax.set(
        title=f"Path of the disk, ends {1e3 * trip.comparison.end_distance:.2f} mm apart",
        xlabel="$x$ across the grooves in mm",
        ylabel="$y$ along the grooves in mm",
    )
    ax.legend(loc="upper left")
