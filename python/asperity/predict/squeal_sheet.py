"""Where a finite-element model squeals under a friction law."""

from __future__ import annotations

import math
import os
from collections.abc import Iterator
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path
from typing import Any, Literal, NamedTuple

import numpy as np

from asperity._base.progress import Progress, each, reporter
from asperity._base.report import Facts, Grid, Picture, Section, Text, write_report
from asperity._base.result import Result, counted
from asperity._base.storage.files import ResultFolder
from asperity._base.tables import aligned, write_columns
from asperity.errors import ConvergenceError, ParameterError
from asperity.predict.squeal_model import SquealModel, at
from asperity.steady_sliding import ComplexModes, Equilibrium, equilibrium
from asperity.steady_sliding.sparse.modes import complex_modes
from asperity.steady_sliding.sparse.nearest import nearest
from asperity.steady_sliding.sparse.slepc import nearest_by_slepc

FILES = ("modes.csv", "modes.png", "report.html")
"""What `describe_squeal` writes."""

_COLUMNS = (
    "friction factor [-]",
    "direction [deg]",
    "frequency [Hz]",
    "growth rate [1/s]",
    "damping ratio [-]",
    "backward error [-]",
    "sign is certain",
)
# Growing modes that a text lists, the fastest first; the table has them all.
_TOLD = 12


class SquealCase(NamedTuple):
    """One friction factor and direction.

    Attributes:
        friction: factor of the friction force.
        direction: angle in rad by which the motion of the surface is turned.
        steady: steady sliding, or None where there is none, or no linear motion about it.
        modes: all modes within the band, or None likewise.
        problem: why there are none.
    """

    friction: float
    direction: float
    steady: Equilibrium | None
    modes: ComplexModes | None
    problem: str


@dataclass(frozen=True, repr=False)
class SquealSheet(Result):
    """The modes of a model that slides steadily, for each friction factor and direction.

    Attributes:
        model: what the file says.
        cases: one per friction factor and direction.
    """

    model: SquealModel
    cases: tuple[SquealCase, ...]

    @property
    def unstable(self) -> bool:
        """Whether a mode is certain to grow in some case."""
        return any(one.modes is not None and one.modes.unstable.any() for one in self.cases)

    @cached_property
    def warnings(self) -> tuple[str, ...]:
        """Why the result is doubtful."""
        found = [
            f"No result {_case(one)}: {one.problem}" for one in self.cases if one.modes is None
        ]
        for one in self.cases:
            if one.modes is None or one.steady is None:
                continue
            if not one.steady.closed:
                found.append(f"No contact is closed {_case(one)}: nothing slides.")
            missing = one.modes.certificate
            if missing is not None and not missing.is_complete:
                found.append(f"Modes may be missing {_case(one)}: {missing.summary()}")
            if len(one.modes.beyond):
                rate = one.modes.beyond.real.max()
                found.append(
                    f"Steady sliding is unstable {_case(one)} with {rate:.6g} 1/s beyond the "
                    "growth or the band of [squeal]."
                )
            open_signs = int((~one.modes.sign_is_certain).sum())
            if open_signs:
                found.append(
                    f"Of {counted(open_signs, 'mode')} {_case(one)} the sign of the growth rate is "
                    "not certain."
                )
        found += [one for one in self.model.model.findings if "lost" in one or "damping" in one]
        return tuple(found)

    @cached_property
    def fastest(self) -> SquealCase | None:
        """The case with the fastest mode that is certain to grow."""
        growing = [one for one in self.cases if one.modes is not None and one.modes.unstable.any()]
        return max(
            growing, key=lambda one: one.modes.growth_rate if one.modes else 0.0, default=None
        )

    def verdict(self) -> str:
        """Return whether the model squeals, and why, in a sentence."""
        low, high = self.model.band
        where = f"between {low:g} and {high:g} Hz"
        if all(one.modes is None for one in self.cases):
            return f"there is no result {where}"
        if self.fastest is None or self.fastest.modes is None:
            growth = self.model.options["growth"]
            return f"no mode {where} and with |Re s| up to {growth:.4g} 1/s is certain to grow"
        scanned = f", {_case(self.fastest)}" if len(self.cases) > 1 else ""
        reason = self.fastest.modes.reason
        return f"steady sliding is unstable {where}{scanned}. {reason.removesuffix('.')}"

    def facts(self) -> list[tuple[str, str]]:
        """Return what there is to say, as pairs of name and text."""
        facts = []
        for one in self.cases:
            if one.modes is None or one.steady is None:
                facts.append((_case(one), one.problem))
                continue
            closed, number = len(one.steady.closed), int(one.modes.unstable.sum())
            told = f"{counted(len(one.modes.eigenvalues), 'mode')}, {number} unstable"
            if number:
                told += f", up to {one.modes.growth_rate:.4g} 1/s"
            touching = f"{closed} of {counted(len(one.steady.normal_force), 'contact')} closed"
            facts.append((_case(one), f"{touching}; {told}"))
        facts.append(("law", f"{self.model.law_path}"))
        return facts

    def _modes(self) -> Iterator[tuple[float, ...]]:
        """Yield the rows of the table of modes."""
        for one in self.cases:
            modes = one.modes
            if modes is None:
                continue
            parts = (
                modes.frequencies,
                modes.growth_rates,
                modes.damping_ratios,
                modes.backward_errors,
                modes.sign_is_certain,
            )
            for row in zip(*parts, strict=True):
                yield one.friction, math.degrees(one.direction), *row

    def _growing(self) -> list[list[str]]:
        rows = [row for row in self._modes() if row[3] > 0.0 and row[6]]
        rows.sort(key=lambda row: -row[3])
        return [[f"{value:.6g}" for value in row[:5]] for row in rows[:_TOLD]]

    def __repr__(self) -> str:
        return f"<SquealSheet: {self.model.file.path.name}, {'un' * self.unstable}stable>"

    def summary(self) -> str:
        """Return the verdict and what is doubtful, in sentences."""
        sentences = (f"Squeal of {self.model.title}: {self.verdict()}.", *self.warnings)
        return "\n".join(sentences)

    def text(self) -> str:
        """Return the verdict and tables of text."""
        parts = [f"{self.model.file.path}: {self.verdict()}", aligned(self.facts())]
        growing = self._growing()
        if growing:
            parts.append(aligned([_COLUMNS[:5], *growing], right=range(5)))
        parts.append("\n".join(self.model.model.findings))
        parts.append("\n".join(f"warning: {one}" for one in self.warnings))
        return "\n\n".join(filter(None, parts))

    def data(self) -> dict[str, Any]:
        """Return the same as numbers and texts, for ``--json``."""
        return {
            "file": str(self.model.file.path),
            "law": str(self.model.law_path),
            "unstable": self.unstable,
            "verdict": self.verdict(),
            "band_hz": list(self.model.band),
            "columns": list(_COLUMNS),
            "modes": [[float(value) for value in row] for row in self._modes()],
            "findings": list(self.model.model.findings),
            "warnings": list(self.warnings),
        }

    def write(self, folder: Path) -> None:
        """Write the files into a folder."""
        from matplotlib.figure import Figure

        from asperity.plot import style
        from asperity.plot.look import GREY, png

        table = np.array(list(self._modes()), dtype=np.float64).reshape(-1, len(_COLUMNS))
        write_columns(folder / "modes.csv", dict(zip(_COLUMNS, table.T, strict=True)))
        with style():
            figure = Figure(figsize=(6.4, 4.6), layout="constrained")
            ax = figure.add_subplot()
            friction, hertz, damping = table[:, 0], table[:, 2], 100.0 * table[:, 4]
            ax.axhline(0.0, color=GREY)
            points = ax.scatter(hertz, damping, c=friction, cmap="viridis", zorder=2.0)
            if len(np.unique(friction)) > 1:
                figure.colorbar(points, label="factor of friction")
            ax.set(xlabel="frequency in Hz", ylabel="damping ratio in %")
        picture = Picture("modes", png(figure, 150))
        (folder / "modes.png").write_bytes(picture.png)
        growing = self._growing()
        sections = [
            Section(
                "",
                Text(self.verdict()),
                *(Text(one, "warning") for one in self.warnings),
                Facts(self.facts()),
                picture,
                Text("Modes below zero grow. The table modes.csv has all of them."),
            )
        ]
        if growing:
            sections.append(Section("Modes that grow", Grid(_COLUMNS[:5], growing)))
        found = self.model.model.summary().splitlines()
        sections.append(Section("The matrices", *map(Text, found)))
        write_report(folder / "report.html", f"Squeal of {self.model.title}", sections)


def describe_squeal(
    path: str | os.PathLike[str],
    *,
    law: str | os.PathLike[str] | None = None,
    out: str | os.PathLike[str] | None = None,
    engine: Literal["slepc"] | None = None,
    progress: Progress = None,
) -> SquealSheet:
    """Find all modes of a finite-element model within a band of frequencies, and which grow.

    Args:
        path: of the model's TOML file, as ``asperity init --kind squeal`` writes one.
        law: file of a law that takes the place of the one that the model names.
        out: folder for what `FILES` lists; it is complete or not there.
        engine: ``"slepc"`` finds the eigenvalues by SLEPc under MPI, in a Python with slepc4py that
            the command in the environment variable ``ASPERITY_SLEPC`` starts.
        progress: over friction factors and directions, as of `growth_chart`.

    Raises:
        ConfigurationError: with file, line and key of what is wrong.

    Reference: [WL19] (85)–(88).
    """
    if engine not in (None, "slepc"):
        raise ParameterError("engine", f"must be 'slepc' or None, got {engine!r}")
    folder = None if out is None else ResultFolder(Path(out), FILES, [path, law])
    model = SquealModel.load(path, law=law)
    points = [(mu, phi) for mu in model.friction.tolist() for phi in model.directions.tolist()]
    with reporter(progress, "case") as report:
        cases = tuple(_solved(model, engine, mu, phi) for mu, phi in each(points, report))
    sheet = SquealSheet(model, cases)
    if folder is not None:
        with folder.filled() as place:
            sheet.write(place)
    return sheet


def _solved(
    model: SquealModel, engine: str | None, friction: float, direction: float
) -> SquealCase:
    system = model.system.varied(friction=friction, phi=direction)
    low, high = (2.0 * math.pi * one for one in model.band)
    try:
        steady = equilibrium(system)
        find = nearest if engine is None else nearest_by_slepc
        modes = complex_modes(system, steady, band=(low, high), engine=find, **model.options)
    except (ParameterError, ConvergenceError) as error:
        if isinstance(error, ParameterError) and error.argument in model.options:
            with at(model.file, "squeal"):
                raise
        if isinstance(error, ParameterError) and error.argument == "engine":
            raise
        return SquealCase(friction, direction, None, None, str(error).removeprefix("system: "))
    return SquealCase(friction, direction, steady, modes, "")


def _case(one: SquealCase) -> str:
    return f"at {one.friction:g} times the friction, {math.degrees(one.direction):g}°"
