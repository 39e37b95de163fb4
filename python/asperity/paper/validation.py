"""Fig. 27 of [WL19] end to end: measured path, and paths under the laws identified from forces."""

from __future__ import annotations

from collections.abc import Mapping
from functools import cache

import numpy as np
from matplotlib.axes import Axes

from asperity.paper import filmed
from asperity.paper.checks import Check
from asperity.paper.data import Curves
from asperity.paper.identified import Identified, identified
from asperity.paper.redrawn import Redrawn, panels, record
from asperity.paper.statements import truth
from asperity.plot.look import BLUE, GREEN, INK, ORANGE, PURPLE, style
from asperity.runs.comparison import PathComparison, compare_path
from asperity.runs.time_stepping import simulate
from asperity.runs.trajectory import Trajectory
from asperity.system import SlidingPoint

_EXTENDED = "extended, superellipses C, D"
_STEP = 1e-4
_SPIN = 40.0
_WEIGHT = 0.018 * 9.81


def fig27() -> Redrawn:
    """Draw the tracked path with simulated ones, their distances, and the loads of the pads.

    The initial velocity is that of the tracked path; the laws are identified from the forces.
    """
    figure, axes = panels(
        27,
        "measured and simulated sliding path",
        3,
        figsize=(14.0, 5.4),
        parameters="synthetic data: virtual tribometer and camera",
        width_ratios=(1.25, 1.0, 1.0),
    )
    film, found, curves = filmed.filmed(), identified(), Curves()
    runs = simulated(found, film)
    compared = {name: compare_path(run, film.path) for name, run in runs.items()}
    with style():
        _draw_paths(curves, film, runs, axes[0])
        _draw_distances(curves, compared, axes[1])
        _draw_loads(curves, film, axes[2])
    return Redrawn(figure, curves, [*_path_checks(film, compared), *_disk_checks(film)])


def simulated(found: Identified, film: filmed.Filmed) -> dict[str, Trajectory]:
    """Return the runs of a point mass under the identified laws, from the tracked start."""
    place, velocity = film.path.start
    return {
        name: simulate(
            SlidingPoint(film.disk.mass, law=law),
            dt=_STEP,
            t_end=1.0,
            q0=place,
            u0=velocity,
            until_rest=True,
        )
        for name, law in found.laws.items()
    }


def _draw_paths(
    curves: Curves, film: filmed.Filmed, runs: Mapping[str, Trajectory], ax: Axes
) -> None:
    fifth = 1e3 * film.path.position[film.path.seen][::5]
    (dots,) = ax.plot(
        *fifth.T, "o", color=INK, markersize=4.5, markerfacecolor="white", label="tracked, 10 ms"
    )
    record(curves, "a", "tracked", [dots])
    for (name, run), color in zip(runs.items(), _COLORS, strict=True):
        (line,) = ax.plot(*(1e3 * run.q[:, :2]).T, color=color, label=name)
        record(curves, "a", name, [line])
    spinning = _spinning().q[:, :2]
    (line,) = ax.plot(*(1e3 * spinning).T, ":", color=INK, label=f"disk with spin {_SPIN:g} rad/s")
    record(curves, "a", "disk with spin", [line])
    ax.set_aspect("equal")
    ax.set(
        title="(a) paths",
        xlabel="$x$ across the grooves in mm",
        ylabel="$y$ along the grooves in mm",
    )
    ax.legend(loc="upper left")


_COLORS = (BLUE, GREEN, PURPLE, ORANGE)


def _draw_distances(curves: Curves, compared: Mapping[str, PathComparison], ax: Axes) -> None:
    for (name, comparison), color in zip(compared.items(), _COLORS, strict=True):
        (line,) = ax.plot(1e3 * comparison.time, 1e3 * comparison.distance, color=color)
        record(curves, "b", name, [line])
    ax.set_yscale("log")
    ax.set_ylim(bottom=1e-2)
    ax.set(
        title="(b) distance from the tracked path",
        xlabel="time in ms",
        ylabel="distance in mm",
    )


def _draw_loads(curves: Curves, film: filmed.Filmed, ax: Axes) -> None:
    runs = {"without spin": film.run, f"{_SPIN:g} rad/s": _spinning()}
    for (name, run), linestyle in zip(runs.items(), ("-", ":"), strict=True):
        moving = run.normal_force[1:]
        for pad, color in enumerate((BLUE, ORANGE, GREEN)):
            label = f"pad {pad + 1}, {name}"
            time = 1e3 * run.t[1:]
            (line,) = ax.plot(time, 1e3 * moving[:, pad], linestyle, color=color, label=label)
            record(curves, "c", label, [line])
    ax.set_ylim(0.0, 135.0)
    ax.set(title="(c) loads of the pads", xlabel="time in ms", ylabel=r"$\lambda_N$ in mN")
    ax.legend(loc="upper left", ncols=2, fontsize="small")


@cache
def _spinning() -> Trajectory:
    disk = filmed.filmed().disk.replace(spin=_SPIN)
    return simulate(disk, dt=_STEP, t_end=1.0, until_rest=True, tolerance=1e-13)


def _path_checks(film: filmed.Filmed, compared: Mapping[str, PathComparison]) -> list[Check]:
    ends = {name: 1e3 * one.end_distance for name, one in compared.items()}
    others = [value for name, value in ends.items() if name != _EXTENDED]
    speed = float(np.linalg.norm(film.path.start[1]))
    return [
        Check("Fig. 27 initial speed", filmed.SPEED, speed, 0.01, "m/s"),
        Check("Fig. 27 end point off, extended law", 0.0, ends[_EXTENDED], 3.0, "mm"),
        Check("Fig. 27 rms distance, extended law", 0.0, 1e3 * compared[_EXTENDED].rms, 1.5, "mm"),
        truth("Fig. 27 no other law ends within 15 mm", min(others) > 15.0),
    ]


def _disk_checks(film: filmed.Filmed) -> list[Check]:
    point = simulate(
        SlidingPoint(film.disk.mass, law=film.disk.law),
        dt=_STEP,
        t_end=1.0,
        u0=film.disk.velocity,
        until_rest=True,
        tolerance=1e-13,
    )
    apart = compare_path(film.run, point).largest
    sums = (film.run.normal_force[1:].sum(axis=1), _spinning().normal_force[1:].sum(axis=1))
    off = max(float(np.abs(total / _WEIGHT - 1.0).max()) for total in sums)
    return [
        Check("Fig. 27 disk without spin beside the point", 0.0, 1e3 * apart, 1e-6, "mm"),
        Check("Fig. 27 sum of the pads' loads over the weight", 1.0, 1.0 + off, 1e-10),
    ]
