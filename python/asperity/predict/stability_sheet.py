"""Where a friction law makes steady sliding unstable."""

from __future__ import annotations

import math
import os
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path
from typing import Any

import numpy as np

from asperity._base import arrays
from asperity._base.arrays import Array
from asperity._base.progress import Progress
from asperity._base.report import Facts, Picture, Section, Text, write_report
from asperity._base.result import Result
from asperity._base.storage.files import ResultFolder
from asperity._base.tables import aligned, write_columns
from asperity.law import FrictionLaw
from asperity.predict.law_sheet import planar_law
from asperity.steady_sliding import (
    CriticalIntervals,
    GrowthChart,
    critical_directions,
    critical_rotation,
    growth_chart,
)
from asperity.steady_sliding.critical.directions import destabilising
from asperity.system import MassOnBelt

FILES = ("growth.csv", "growth.png", "report.html")
"""What `describe_stability` writes."""

# Directions of the belt and rotations of C of the chart, one every degree and every second one.
_DIRECTIONS, _ROTATIONS = 181, 91


@dataclass(frozen=True)
class Belt:
    """The mass on a belt whose growth rates are computed.

    Attributes:
        mass: m in kg.
        stiffness: k in N/m, of equal springs along both axes.
        speed: of the belt in m/s.
        normal_force: λ_N in N.
    """

    mass: float = 1.0
    stiffness: float = 1.0
    speed: float = 1.0
    normal_force: float = 1.0

    def __post_init__(self) -> None:
        for name in ("mass", "stiffness", "speed", "normal_force"):
            arrays.positive(getattr(self, name), name)

    def system(self, law: FrictionLaw) -> MassOnBelt:
        """Return the system; the chart turns its belt."""
        return MassOnBelt(
            self.mass,
            stiffness=self.stiffness,
            law=law,
            normal_force=self.normal_force,
            belt_velocity=[self.speed, 0.0],
        )


@dataclass(frozen=True, repr=False)
class StabilitySheet(Result):
    """A law, and where it makes steady sliding unstable.

    Attributes:
        law: the law.
        path: of its file.
        belt: the mass on a belt of the growth rates.
        directions: intervals of sliding directions in which sliding is unstable.
        rotations: intervals of the angle by which C would have to be turned for there to be any.
        chart: growth rates of the mass on the belt over its direction and further rotations of C.
    """

    law: FrictionLaw
    path: Path
    belt: Belt
    directions: CriticalIntervals
    rotations: CriticalIntervals
    chart: GrowthChart

    @property
    def growth(self) -> Array:
        """Growth rates in 1/s over the directions `chart.phi` of the belt, of C as it is.

        NaN where the outline of D is flat.
        """
        return self.chart.growth[:, 0]

    @property
    def fastest(self) -> float:
        """Largest of the growth rates in 1/s; 0 if nothing grows."""
        return float(np.nanmax(self.growth, initial=0.0))

    @cached_property
    def margins(self) -> Array:
        """Angles in rad between sliding and its instability by anisotropy, over `chart.phi`.

        By so much γ lies outside the tangent cone of C: negative where sliding is unstable, π/2
        where the force does not turn with γ.

        Reference: [WL19] Thm. 2.
        """
        slip = -arrays.unit_vectors(self.chart.phi)
        return destabilising(self.law.reservoir, self.law.direction, slip)

    @property
    def unstable(self) -> bool:
        """Whether sliding is unstable in some directions, as C and D are."""
        return bool(self.directions) or self.fastest > 0.0

    def verdict(self) -> str:
        """Return what the law does to steady sliding, in a sentence."""
        if not self.directions:
            text = "anisotropy makes no direction of sliding unstable"
            if self.law.rate is not None and self.fastest > 0.0:
                return f"{text}, but friction that falls with the speed does"
            return text
        where = _intervals(self.directions)
        return f"sliding in the directions {where} is unstable by anisotropy alone"

    def facts(self) -> list[tuple[str, str]]:
        """Return what there is to say, as pairs of name and text."""
        belt = self.belt
        facts = [
            ("unstable sliding directions", _intervals(self.directions) or "none"),
            ("rotations of C that make some unstable", _intervals(self.rotations) or "none"),
            (
                "mass on a belt",
                f"m = {belt.mass:g} kg, k = {belt.stiffness:g} N/m, v = {belt.speed:g} m/s, "
                f"normal force {belt.normal_force:g} N",
            ),
        ]
        if self.fastest > 0.0:
            along = math.degrees(self.chart.phi[int(np.nanargmax(self.growth))])
            text = (
                f"exp({self.fastest:.4g} t), t in s; the belt moves along {along:.0f}°, the mass "
                f"slides on it along {(along + 180.0) % 360.0:.0f}°"
            )
        else:
            text = "nothing grows"
        at = int(self.margins.argmin())
        least, along = np.rad2deg([self.margins[at], self.chart.phi[at]])
        margin = f"{least:.1f}° at the least, on a belt along {along:.0f}°; unstable below 0°"
        return [
            *facts,
            ("fastest growth on this belt", text),
            ("margin to instability by anisotropy", margin),
        ]

    def __repr__(self) -> str:
        return f"<StabilitySheet: {self.path.name}, {'un' * self.unstable}stable>"

    def summary(self) -> str:
        """Return where sliding is unstable, in sentences."""
        facts = "\n".join(f"{name}: {text}," for name, text in self.facts())
        return f"Law of {self.path.name}: {self.verdict()}.\n{facts[:-1]}."

    def text(self) -> str:
        """Return the verdict and a table of text."""
        return f"{self.path}: {self.verdict()}\n\n{aligned(self.facts())}"

    def data(self) -> dict[str, Any]:
        """Return the same as numbers and texts, for ``--json``."""
        return {
            "file": str(self.path),
            "unstable": self.unstable,
            "verdict": self.verdict(),
            "critical_directions_deg": [list(np.rad2deg(one)) for one in self.directions],
            "critical_rotations_deg": [list(np.rad2deg(one)) for one in self.rotations],
            "belt": vars(self.belt),
            "belt_directions_deg": np.rad2deg(self.chart.phi).tolist(),
            "growth_rates": self.growth.tolist(),
            "margins_deg": np.rad2deg(self.margins).tolist(),
        }

    def write(self, folder: Path) -> None:
        """Write the files into a folder."""
        from matplotlib.figure import Figure

        from asperity.plot import plot_growth_chart, style
        from asperity.plot.look import GREY, png

        columns = {
            "belt direction [deg]": np.rad2deg(self.chart.phi),
            "growth rate [1/s]": self.growth,
            "margin [deg]": np.rad2deg(self.margins),
        }
        write_columns(folder / "growth.csv", columns)
        with style():
            figure = Figure(figsize=(6.4, 4.6), layout="constrained")
            ax = figure.add_subplot()
            if np.nanmax(self.chart.growth, initial=0.0) > 0.0:
                explanation = (
                    "White: a disturbance neither grows nor decays, or decays. Along the lower "
                    "edge C is as the file has it."
                )
                plot_growth_chart(self.chart, ax=ax)
                ax.set_ylabel("further rotation of C in degrees")
            else:
                explanation = (
                    "Nothing grows, however C is turned. Drawn is the margin to instability by "
                    "anisotropy, below 0° sliding would be unstable."
                )
                ax.plot(np.rad2deg(self.chart.phi), np.rad2deg(self.margins))
                ax.axhline(0.0, color=GREY)
                ax.set(xlabel="direction of the belt in degrees", ylabel="margin in degrees")
        picture = Picture("growth", png(figure, 150))
        (folder / "growth.png").write_bytes(picture.png)
        write_report(
            folder / "report.html",
            f"Stability of sliding under {self.path.name}",
            [Section("", Text(self.verdict()), Facts(self.facts()), picture, Text(explanation))],
        )


def describe_stability(
    path: str | os.PathLike[str],
    *,
    belt: Belt | None = None,
    out: str | os.PathLike[str] | None = None,
    progress: Progress = None,
) -> StabilitySheet:
    """Read a planar law and say where it makes steady sliding unstable.

    Args:
        path: of the file, as `FrictionLaw.save` or ``asperity identify`` writes it.
        belt: of the growth rates; default one with mass, stiffness, speed and normal force 1.
        out: folder for what `FILES` lists; it is complete or not there.
        progress: of the growth rates, as of `growth_chart`.

    Raises:
        ConfigurationError: with file, line and key of what is wrong.
            A law that is not planar is refused too.

    Reference: [WL19] §4.3, Thm. 2.
    """
    folder = None if out is None else ResultFolder(Path(out), FILES, [path])
    law = planar_law(path).law
    chosen = Belt() if belt is None else belt
    phi = np.linspace(0.0, 2.0 * math.pi, 2 * _DIRECTIONS - 1)
    # Sets that are the same forwards and backwards are themselves after half a turn.
    turns = 1 if law.reservoir.is_symmetric else 2
    zeta = np.linspace(0.0, turns * math.pi, turns * (_ROTATIONS - 1) + 1)
    sheet = StabilitySheet(
        law,
        Path(path),
        chosen,
        critical_directions(law),
        critical_rotation(law.reservoir, law.direction),
        growth_chart(chosen.system(law), phi=phi, zeta=zeta, progress=progress),
    )
    if folder is not None:
        with folder.filled() as place:
            sheet.write(place)
    return sheet


def _intervals(found: CriticalIntervals) -> str:
    parts = [f"{math.degrees(a):.2f}° to {math.degrees(b):.2f}°" for a, b in found]
    return ", ".join(parts)
