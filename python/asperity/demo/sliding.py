"""Fig. 27 of [WL19]: sliding paths of a PVC disk on ground steel under four friction laws."""

from collections.abc import Sequence
from dataclasses import dataclass

import matplotlib.pyplot as plt
import numpy as np
from matplotlib.figure import Figure

import asperity as asp
from asperity.demo import table1
from asperity.demo.checks import Check

MASS = 0.018
"""Mass of the disk in kg; it cancels."""

SPEED = 1.52
"""Initial speed in m/s."""

ANGLES = (32.0, 58.0)
"""Initial directions from e₁ in degrees; 32° from e₁ is 58° from the grooves."""

TIME_STEPS = (4e-4, 2e-4, 1e-4)
"""Time steps of the convergence study in s; the last is that of the figure."""

EXPECTED = {
    ("associated, ellipse C", 32.0): (185.6471, 128.8903, 0.299302, 10.9272),
    ("associated, ellipse C", 58.0): (115.7028, 206.7630, 0.313248, 11.4462),
    ("associated, superellipse C", 32.0): (176.5644, 111.4558, 0.274837, 0.9550),
    ("associated, superellipse C", 58.0): (92.6754, 206.8871, 0.310795, 31.0403),
    ("collinear, superellipse C", 32.0): (177.0760, 110.6493, 0.274742, 0.0),
    ("collinear, superellipse C", 58.0): (121.6739, 194.7190, 0.302116, 0.0),
    ("extended, superellipses C, D", 32.0): (165.1716, 140.9547, 0.298289, 32.0087),
    ("extended, superellipses C, D", 58.0): (78.4725, 222.6935, 0.323049, 51.4611),
}
"""Converged end points x, y in mm, times in s and deflections in mm."""


@dataclass(frozen=True)
class SlidingPath:
    """One sliding path until rest."""

    law: str
    angle: float
    """Initial direction from e₁ in degrees."""
    trajectory: asp.Trajectory

    @property
    def end(self) -> tuple[float, float]:
        """End point in mm."""
        x, y = 1e3 * self.trajectory.q[-1]
        return float(x), float(y)

    @property
    def time(self) -> float:
        """Time until rest in s."""
        return float(self.trajectory.t[-1])

    @property
    def deflection(self) -> float:
        """Distance of the end point from the initial straight line in mm."""
        x, y = self.end
        direction = np.deg2rad(self.angle)
        return float(abs(y * np.cos(direction) - x * np.sin(direction)))


def slide(name: str, law: asp.FrictionLaw, angle: float, dt: float) -> SlidingPath:
    """Simulate one path; `angle` in degrees."""
    direction = np.deg2rad(angle)
    trajectory = asp.simulate(
        asp.SlidingPoint(MASS, law=law),
        dt=dt,
        t_end=1.0,
        u0=[SPEED * np.cos(direction), SPEED * np.sin(direction)],
        until_rest=True,
    )
    return SlidingPath(name, angle, trajectory)


def run(dt: float = TIME_STEPS[-1]) -> list[SlidingPath]:
    """Simulate the four laws in both directions."""
    laws = table1.LAWS.items()
    return [slide(name, law, angle, dt) for angle in ANGLES for name, law in laws]


def convergence(runs: Sequence[Sequence[SlidingPath]]) -> list[Check]:
    """Return the observed orders of convergence of the end points, for dt halved twice.

    Straight paths are left out: their end points carry only the rounding of the last step.
    """
    checks = []
    for coarse, middle, fine in zip(*runs, strict=True):
        if EXPECTED[fine.law, fine.angle][3] == 0.0:
            continue
        order = np.log2(
            np.hypot(*np.subtract(coarse.end, middle.end))
            / np.hypot(*np.subtract(middle.end, fine.end))
        )
        checks.append(Check(f"Fig. 27 order in dt, {_name(fine)}", 1.0, float(order), 0.05))
    return checks


def checks(paths: Sequence[SlidingPath]) -> list[Check]:
    """Compare end points, times and deflections with the converged values."""
    result = []
    for path in paths:
        expected = EXPECTED[path.law, path.angle]
        computed = (*path.end, path.time, path.deflection)
        for label, unit, tolerance, theirs, ours in zip(
            ("x", "y", "time", "deflection"),
            ("mm", "mm", "s", "mm"),
            (0.05, 0.05, 1e-3, 0.05),
            expected,
            computed,
            strict=True,
        ):
            result.append(Check(f"Fig. 27 {label}, {_name(path)}", theirs, ours, tolerance, unit))
    return result


def columns(paths: Sequence[SlidingPath]) -> dict[str, list[object]]:
    """Return the paths as columns of a table."""
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


def draw(paths: Sequence[SlidingPath]) -> Figure:
    """Draw the sliding paths of the four laws, one panel per initial direction."""
    with asp.plot.style():
        figure, panels = plt.subplots(
            1, len(ANGLES), figsize=(11.0, 6.0), layout="constrained", sharex=True, sharey=True
        )
        for ax, angle in zip(panels, ANGLES, strict=True):
            chosen = [path for path in paths if path.angle == angle]
            for path in chosen:
                motion = path.trajectory
                # The first panel has the legend of both.
                label = path.law if ax is panels[0] else None
                asp.plot.plot_path(motion.replace(q=1e3 * motion.q), ax=ax, label=label)
            reach = max(np.hypot(*path.end) for path in chosen)
            direction = np.deg2rad(angle)
            ax.plot(
                [0.0, reach * np.cos(direction)],
                [0.0, reach * np.sin(direction)],
                color="grey",
                linewidth=0.9,
                linestyle=":",
                zorder=1,
            )
            ax.set(
                title=f"{angle:.0f}° from the transverse axis",
                xlabel="$x$ across the grooves in mm",
                ylabel="$y$ along the grooves in mm",
            )
            ax.label_outer()
        figure.suptitle("Sliding path of a PVC disk on ground steel, $v_0$ = 1.52 m/s")
    return figure


def _name(path: SlidingPath) -> str:
    return f"{path.angle:.0f}° {path.law}"
