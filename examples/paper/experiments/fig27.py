"""Figure 27: Measured and simulated sliding path
=================================================

Does a law identified from forces predict where a disk goes? Four laws run from the tracked start,
next to the tracked path. All data are synthetic, so that the truth is known.
"""

from collections.abc import Mapping
from functools import cache

import asperity as asp
import numpy as np
from asperity.demo import Check
from asperity.demo.film import STEP, Film, until_rest
from matplotlib.axes import Axes
from paper.curves import named
from paper.drawing import BLUE, GREEN, INK, ORANGE, PURPLE
from paper.frame import Redrawn, panels, show
from paper.measurements.filmed import SPEED, filmed
from paper.measurements.identified import Identified, identified
from paper.statements import truth

_EXTENDED = "extended, superellipses C, D"
_SPIN = 40.0
_WEIGHT = 0.018 * 9.81


def simulated(found: Identified, film: Film) -> dict[str, asp.Trajectory]:
    """Return the runs of a point mass under the identified laws, from the tracked start."""
    place, velocity = film.path.start
    return {
        name: asp.simulate(
            asp.SlidingPoint(film.disk.mass, law=law),
            dt=STEP,
            t_end=1.0,
            q0=place,
            u0=velocity,
            until_rest=True,
        )
        for name, law in found.laws.items()
    }


def _draw_paths(film: Film, runs: Mapping[str, asp.Trajectory], ax: Axes) -> None:
    fifth = 1e3 * film.path.position[film.path.seen][::5]
    ax.plot(
        *fifth.T, "o", color=INK, markersize=4.5, markerfacecolor="white", label="tracked, 10 ms"
    )
    for (name, run), color in zip(runs.items(), _COLORS, strict=True):
        (line,) = ax.plot(*(1e3 * run.q[:, :2]).T, color=color, label=name)
        named(name, [line])
    spinning = _spinning().q[:, :2]
    (line,) = ax.plot(*(1e3 * spinning).T, ":", color=INK, label=f"disk with spin {_SPIN:g} rad/s")
    named("disk with spin", [line])
    ax.set_aspect("equal")
    ax.set(
        title="(a) paths",
        xlabel="$x$ across the grooves in mm",
        ylabel="$y$ along the grooves in mm",
    )
    ax.legend(loc="upper left")


_COLORS = (BLUE, GREEN, PURPLE, ORANGE)


def _draw_distances(compared: Mapping[str, asp.runs.PathComparison], ax: Axes) -> None:
    for (name, comparison), color in zip(compared.items(), _COLORS, strict=True):
        ax.plot(1e3 * comparison.time, 1e3 * comparison.distance, color=color, gid=name)
    ax.set_yscale("log")
    ax.set_ylim(bottom=1e-2)
    ax.set(title="(b) distance from the tracked path", xlabel="time in ms", ylabel="distance in mm")


def _draw_loads(film: Film, ax: Axes) -> None:
    runs = {"without spin": film.run, f"{_SPIN:g} rad/s": _spinning()}
    for (name, run), linestyle in zip(runs.items(), ("-", ":"), strict=True):
        moving = run.normal_force[1:]
        for pad, color in enumerate((BLUE, ORANGE, GREEN)):
            label = f"pad {pad + 1}, {name}"
            time = 1e3 * run.t[1:]
            ax.plot(time, 1e3 * moving[:, pad], linestyle, color=color, label=label)
    ax.set_ylim(0.0, 135.0)
    ax.set(title="(c) loads of the pads", xlabel="time in ms", ylabel=r"$\lambda_N$ in mN")
    ax.legend(loc="upper left", ncols=2, fontsize="small")


@cache
def _spinning() -> asp.Trajectory:
    return until_rest(filmed().disk.replace(spin=_SPIN))


def _path_checks(film: Film, compared: Mapping[str, asp.runs.PathComparison]) -> list[Check]:
    ends = {name: 1e3 * one.end_distance for name, one in compared.items()}
    others = [value for name, value in ends.items() if name != _EXTENDED]
    speed = float(np.linalg.norm(film.path.start[1]))
    return [
        Check("Fig. 27 initial speed", SPEED, speed, 0.01, "m/s"),
        Check("Fig. 27 end point off, extended law", 0.0, ends[_EXTENDED], 3.0, "mm"),
        Check("Fig. 27 rms distance, extended law", 0.0, 1e3 * compared[_EXTENDED].rms, 1.5, "mm"),
        truth("Fig. 27 no other law ends within 15 mm", min(others) > 15.0),
    ]


def _disk_checks(film: Film) -> list[Check]:
    point = asp.simulate(
        asp.SlidingPoint(film.disk.mass, law=film.disk.law),
        dt=STEP,
        t_end=1.0,
        u0=film.disk.velocity,
        until_rest=True,
        tolerance=1e-13,
    )
    apart = asp.compare_path(film.run, point).largest
    sums = (film.run.normal_force[1:].sum(axis=1), _spinning().normal_force[1:].sum(axis=1))
    off = max(float(np.abs(total / _WEIGHT - 1.0).max()) for total in sums)
    return [
        Check("Fig. 27 disk without spin beside the point", 0.0, 1e3 * apart, 1e-6, "mm"),
        Check("Fig. 27 sum of the pads' loads over the weight", 1.0, 1.0 + off, 1e-10),
    ]


def draw() -> Redrawn:
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
    film, found = filmed(), identified()
    runs = simulated(found, film)
    compared = {name: asp.compare_path(run, film.path) for name, run in runs.items()}
    _draw_paths(film, runs, axes[0])
    _draw_distances(compared, axes[1])
    _draw_loads(film, axes[2])
    return Redrawn(figure, [*_path_checks(film, compared), *_disk_checks(film)])


# %%
if __name__ == "__main__":
    show(draw)
