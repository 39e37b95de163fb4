"""Figure 19: Sliding paths on ground steel
===========================================

How do initial speed and direction decide where a disk goes? The law is that of PVC of Fig. 24, and
the paths are simulated.
"""

from collections.abc import Sequence

import asperity as asp
import numpy as np
from asperity.demo import Check
from asperity.demo.film import slide
from matplotlib.axes import Axes
from paper.drawing import GREY, INK, Array
from paper.frame import Redrawn, panels, show
from paper.measurements.pairings import PVC
from paper.statements import truth

SPEEDS = (0.62, 0.95, 1.25, 1.49)
"""Initial speeds of Fig. 19a in m/s; own."""

ANGLES = (0.0, 15.0, 30.0, 47.0, 60.0, 75.0, 90.0)
"""Initial directions of Fig. 19b to the grooves in degrees; own but for 47°."""

_EVERY = 100
_SLOW = 0.05


def _draw_paths(runs: Sequence[asp.Trajectory], names: Sequence[str], ax: Axes) -> None:
    colors = _shades(len(runs))
    for run, name, color in zip(runs, names, colors, strict=True):
        place, plain = 1e3 * run.q[:, :2], name.replace("$", "")
        ax.plot(*place.T, color=color, label=name)
        ax.plot(*place[::_EVERY].T, "o", color=color, markersize=2.5, gid=f"{plain}, 10 ms apart")
        ahead = run.u[0, :2] / np.linalg.norm(run.u[0, :2])
        reach = np.stack([np.zeros(2), np.linalg.norm(place[-1]) * ahead])
        ax.plot(
            *reach.T,
            color=GREY,
            linewidth=0.8,
            linestyle=":",
            zorder=1.0,
            gid=f"{plain}, initial direction",
        )
    ax.plot([], [], "o", color=INK, markersize=2.5, label="10 ms apart")
    ax.set_aspect("equal")
    ax.set(xlabel="$x$ across the grooves in mm", ylabel="$y$ along the grooves in mm")
    ax.legend(loc="upper left", bbox_to_anchor=(1.0, 1.0))


def _shades(count: int) -> Array:
    from matplotlib import colormaps

    return colormaps["viridis"](np.linspace(0.0, 0.85, count))


def _speed_checks(runs: Sequence[asp.Trajectory]) -> list[Check]:
    ends = np.array([run.q[-1, :2] for run in runs])
    lengths = np.linalg.norm(ends, axis=1)
    similar = ends / np.square(SPEEDS)[:, None]
    spread = np.abs(similar / similar[-1] - 1.0).max()
    return [
        truth("Fig. 19a faster disks slide farther", bool((np.diff(lengths) > 0.0).all())),
        Check("Fig. 19a paths are similar, ends over v²", 0.0, float(spread), 2e-3),
        truth("Fig. 19a the disk leaves the straight line", _deflection(runs[-1]) > 10.0),
        *(
            truth(f"Fig. 19a ends along the grooves, {speed:g} m/s", _last_angle(run) < 15.0)
            for speed, run in zip(SPEEDS, runs, strict=True)
        ),
    ]


def _angle_checks(runs: Sequence[asp.Trajectory]) -> list[Check]:
    along, across = runs[0], runs[-1]
    between = [_deflection(run) for run in runs[1:-1]]
    lengths = [float(np.linalg.norm(run.q[-1, :2])) for run in (along, across)]
    return [
        Check("Fig. 19b deflection along the grooves", 0.0, _deflection(along), 1e-6, "mm"),
        Check("Fig. 19b deflection across the grooves", 0.0, _deflection(across), 1e-6, "mm"),
        truth("Fig. 19b deflection towards the grooves between", min(between) > 0.0),
        truth("Fig. 19b farther along the grooves than across", lengths[0] > lengths[1]),
    ]


def _deflection(run: asp.Trajectory) -> float:
    """Return how far the end lies from the initial straight line, towards the grooves, in mm."""
    (x, y), (u, v) = run.q[-1, :2], run.u[0, :2] / np.linalg.norm(run.u[0, :2])
    return 1e3 * float(u * y - v * x)


def _last_angle(run: asp.Trajectory) -> float:
    """Return the angle of the velocity to the grooves in degrees when it has become slow."""
    speed = np.linalg.norm(run.u[:, :2], axis=1)
    u, v = run.u[np.flatnonzero(speed > _SLOW)[-1], :2]
    return float(np.rad2deg(np.arctan2(abs(u), abs(v))))


def draw() -> Redrawn:
    """Draw paths (a) of different initial speeds at 47°, (b) of different initial directions."""
    parameters = "synthetic: simulated disk on three pads, invented law of Fig. 24"
    figure, axes = panels(
        19, "sliding paths on ground steel", 2, figsize=(12.0, 5.4), parameters=parameters
    )
    by_speed = [slide(PVC.law, speed, 47.0)[1] for speed in SPEEDS]
    by_angle = [slide(PVC.law, SPEEDS[-1], angle)[1] for angle in ANGLES]
    names = [f"$v_0$ = {speed:g} m/s" for speed in SPEEDS]
    _draw_paths(by_speed, names, axes[0])
    axes[0].set_title(r"(a) $\varphi$ = 47° to the grooves")
    names = [rf"$\varphi$ = {angle:g}°" for angle in ANGLES]
    _draw_paths(by_angle, names, axes[1])
    axes[1].set_title(f"(b) $v_0$ = {SPEEDS[-1]:g} m/s")
    return Redrawn(figure, [*_speed_checks(by_speed), *_angle_checks(by_angle)])


# %%
if __name__ == "__main__":
    show(draw)
