"""What a friction law is: verdicts, coefficients over the direction of sliding, pictures."""

from __future__ import annotations

import os
import textwrap
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from asperity._base import arrays
from asperity._base.arrays import Array, unit_vectors
from asperity._base.report import Facts, Grid, Picture, Section, Text, write_report
from asperity._base.result import NO_UNIT, Axis, Series, Table, TableResult
from asperity._base.storage.files import ResultFolder
from asperity._base.tables import aligned
from asperity.errors import ConfigurationError
from asperity.identify import IdentifiedLaw
from asperity.law import EngineReport, FrictionLaw, LawFile

FILES = ("coefficients.csv", "sets.png", "coefficients.png", "report.html")
"""What `describe_law` writes."""

# Directions of the printed table and of the file, in degrees.
_PRINTED, _WRITTEN = 15.0, 1.0


@dataclass(frozen=True, repr=False)
class LawSheet(TableResult):
    """A planar law and its properties; as a table its coefficients over the sliding direction.

    Attributes:
        file: the law and where it comes from.
        path: of the file.
    """

    file: LawFile
    path: Path

    @property
    def law(self) -> FrictionLaw:
        """The law."""
        return self.file.law

    def verdicts(self) -> list[tuple[str, bool, str]]:
        """Return questions, answers, and what the answers mean for sliding."""
        law = self.law
        return [
            (
                "force opposite to sliding",
                bool(law.is_collinear),
                "a sliding body keeps its direction"
                if law.is_collinear
                else "a sliding body turns",
            ),
            (
                "associated (C and D alike)",
                bool(law.is_associated),
                _stability(law),
            ),
            (
                "dissipative",
                bool(law.is_dissipative),
                "friction always takes energy"
                if law.is_dissipative
                else "in some directions friction would feed energy into the motion",
            ),
            (
                "reservoir convex",
                bool(law.reservoir.is_convex),
                "" if law.reservoir.is_convex else "forces between two admissible ones may slip",
            ),
            (
                "same forwards and backwards",
                bool(law.reservoir.is_symmetric) and bool(law.direction.is_symmetric),
                "",
            ),
        ]

    def coefficients(self, step_deg: float) -> dict[str, Array]:
        """Return coefficients over the direction of sliding.

        Args:
            step_deg: between two directions in degrees.

        Returns:
            Columns with their units: direction of sliding, magnitude of the force, resistance
            (friction against the sliding), angle from the sliding direction to that of −λ. Of a law
            that depends on the speed they are those without this dependence.
        """
        phi_deg = np.arange(0.0, 360.0, arrays.positive(step_deg, "step_deg"))
        phi = np.deg2rad(phi_deg)
        force = -self.law.replace(rate=None).force(unit_vectors(phi))
        return {
            "sliding direction [deg]": phi_deg,
            "friction coefficient [-]": np.linalg.norm(force, axis=-1),
            "resistance against sliding [-]": (force * unit_vectors(phi)).sum(axis=-1),
            # Rounding below this has no sign to be printed.
            "deflection of the force [deg]": np.round(np.rad2deg(self.law.deflection(phi)), 9)
            + 0.0,
        }

    def extremes(self) -> list[tuple[str, str]]:
        """Return the extremes of the coefficients, in words."""
        found = self.coefficients(_WRITTEN)
        phi, mu, _, turned = found.values()
        low, high, most = int(mu.argmin()), int(mu.argmax()), int(np.abs(turned).argmax())
        return [
            ("smallest friction coefficient", f"{mu[low]:.4f}, sliding at {phi[low]:.0f}°"),
            ("largest friction coefficient", f"{mu[high]:.4f}, sliding at {phi[high]:.0f}°"),
            (
                "largest deflection of the force",
                f"{turned[most]:+.2f}°, sliding at {phi[most]:.0f}°",
            ),
        ]

    def parameters(self) -> list[tuple[str, ...]]:
        """Return identified parameters as a table of texts; empty if there are none."""
        if not isinstance(self.file, IdentifiedLaw):
            return []
        known = self.file.turns is not None
        errors = self.file.standard_errors if known else np.full(len(self.file.values), np.nan)
        rows: list[tuple[str, ...]] = [("parameter", "estimate", "standard error", "unit")]
        for name, value, error, unit in zip(
            self.file.names, self.file.values, errors, self.file.units, strict=True
        ):
            shown = f"{error:.2g}" if np.isfinite(error) else "not known"
            rows.append((name, f"{value:.6g}", shown, unit))
        return rows

    def origin(self) -> list[tuple[str, str]]:
        """Return where the law comes from."""
        made = self.file.provenance
        facts = [("file", str(self.path)), ("made by", made.made_by), ("date", made.date)]
        facts += [("note", made.note)]
        facts += [("from", name) for name, _ in made.files]
        return [(name, text) for name, text in facts if text]

    def report(self) -> list[tuple[str, str]]:
        """Return what is known of a law from another engine or from forces; empty of others."""
        report = self.law.report
        if report is None:
            return []
        if not isinstance(report, EngineReport):
            made = (
                f"{report.samples} directions, met to {report.misfit:.2g} of the largest force; "
                f"closure {report.closure:.5g}, 1 where there is a direction set without repair"
            )
            return [("made of forces over the direction", made)]
        turned = f", {np.rad2deg(report.angle):.4g}° from e1" if report.angle else ""
        facts = [
            ("like the engine", f"{report.engine}, version {report.version}"),
            ("its first axis", report.axes + turned),
            ("what it does otherwise", report.deviation),
            ("found by", report.source),
        ]
        if report.creep is not None:
            facts.append(("its creep under half load", f"{report.creep:.4g} m/s"))
        if report.end_error is not None:
            facts.append(
                ("distance of the end points, docs/engines.md", f"{1e3 * report.end_error:.2g} mm")
            )
        return facts

    def __repr__(self) -> str:
        return f"<LawSheet: {self.path.name}>"

    def summary(self) -> str:
        """Return the extremes of the coefficients and the properties, in sentences."""
        extremes = [f"{name} {value}" for name, value in self.extremes()]
        answers = [
            f"{question}: {'yes' if answer else 'no'}" for question, answer, _ in self.verdicts()
        ]
        return (
            f"Friction law of {self.path.name}: {'; '.join(extremes)}.\nIt is {', '.join(answers)}."
        )

    def _table(self) -> Table:
        columns = self.coefficients(_WRITTEN)
        phi, *others = columns.items()
        words = ("friction_coefficient", "resistance", "deflection")
        meanings = ("magnitude of the friction force", "against the sliding", "of the force")
        units = (NO_UNIT, NO_UNIT, "deg")
        series = {
            word: Series(values, ("sliding_direction",), unit, meaning)
            for word, (_, values), unit, meaning in zip(words, others, units, meanings, strict=True)
        }
        axis = Axis(phi[1], "deg", "direction of sliding, counter-clockwise from e1")
        return Table({"sliding_direction": axis}, series, {"law": self.path.name})

    def text(self) -> str:
        """Return all there is to say as tables of text."""
        answers = [
            (question, "yes" if answer else "no", meaning)
            for question, answer, meaning in self.verdicts()
        ]
        table = self.coefficients(_PRINTED)
        rows: list[tuple[str, ...]] = [tuple(table)]
        rows += [
            (f"{a:.0f}", f"{b:.4f}", f"{c:.4f}", f"{d:+.2f}")
            for a, b, c, d in zip(*table.values(), strict=True)
        ]
        parts = [
            aligned(self.origin()),
            f"reservoir C: {self.law.reservoir}\ndirection set D: {self.law.direction}",
            aligned(answers),
            aligned(self.extremes()),
            aligned(rows, right=(0, 1, 2, 3)),
        ]
        if self.report():
            parts.insert(1, "\n".join(_paragraph(*fact) for fact in self.report()))
        if self.parameters():
            parts.insert(-3, aligned(self.parameters(), right=(1, 2)))
        if self.law.rate is not None:
            parts.insert(
                -3,
                f"dependence on the speed: {self.law.rate!r}, by whose factor the coefficients "
                "below are to be multiplied",
            )
        return "\n\n".join(parts)

    def data(self) -> dict[str, Any]:
        """Return the same as numbers and texts, for ``--json``."""
        file = self.file
        result: dict[str, Any] = {
            "file": str(self.path),
            "verdicts": {question: answer for question, answer, _ in self.verdicts()},
            "coefficients": {
                name: values.tolist() for name, values in self.coefficients(_PRINTED).items()
            },
        }
        if self.law.report is not None:
            result["report"] = dict(self.law.report._parameters)
        if isinstance(file, IdentifiedLaw):
            result["parameters"] = dict(zip(file.names, file.values.tolist(), strict=True))
            if file.turns is not None:
                errors = file.standard_errors.tolist()
                result["standard_errors"] = dict(zip(file.names, errors, strict=True))
        return result

    def write(self, folder: Path) -> None:
        """Write the files into a folder."""
        from matplotlib.figure import Figure

        from asperity.plot import plot_deflection, plot_friction_coefficient, plot_law, style
        from asperity.plot.look import png

        self.to_csv(folder / "coefficients.csv")
        with style():
            sets = Figure(figsize=(5.2, 4.8), layout="constrained")
            plot_law(self.law, ax=sets.add_subplot())
            over = Figure(figsize=(6.4, 5.4), layout="constrained")
            upper, lower = over.subplots(2, 1, sharex=True)
            plot_friction_coefficient(self.law, ax=upper)
            plot_deflection(self.law, ax=lower)
        pictures = [Picture("sets", png(sets, 150)), Picture("coefficients", png(over, 150))]
        for picture in pictures:
            (folder / f"{picture.name}.png").write_bytes(picture.png)
        answers = [
            (question, ("yes" if answer else "no") + (f": {meaning}" if meaning else ""))
            for question, answer, meaning in self.verdicts()
        ]
        tables = (self.origin(), self.report(), answers, self.extremes())
        blocks: list[Any] = [Facts(one) for one in tables if one]
        if self.parameters():
            header, *rows = self.parameters()
            blocks.append(Grid(header, rows))
        code = Text(self.path.read_text(encoding="utf-8-sig"), "code")
        write_report(
            folder / "report.html",
            f"Friction law {self.path.name}",
            [Section("", *blocks, *pictures), Section("File", code)],
        )


def _paragraph(name: str, text: str) -> str:
    """Return sentences in lines that a terminal shows."""
    return textwrap.fill(f"{name}: {text}", 100, subsequent_indent="  ")


def _stability(law: FrictionLaw) -> str:
    """Return what associated or other flow means for steady sliding."""
    if not law.is_associated:
        return "anisotropy may make steady sliding unstable: see `asperity stability`"
    if law.rate is not None:
        # A force that falls with the speed is not monotone, whatever its direction.
        return (
            "anisotropy makes nothing unstable, but the dependence on the speed may: see "
            "`asperity stability`"
        )
    return "two motions never move apart; steady sliding is stable"


def describe_law(
    path: str | os.PathLike[str], *, out: str | os.PathLike[str] | None = None
) -> LawSheet:
    """Read a planar law and say what it is; write what `FILES` lists if a folder is given.

    Args:
        path: of the file, as `FrictionLaw.save` or ``asperity identify`` writes it.
        out: folder; it is complete or not there.

    Raises:
        ConfigurationError: with file, line and key of what is wrong.
            A law that is not planar is refused too.
    """
    folder = None if out is None else ResultFolder(Path(out), FILES, [path])
    sheet = LawSheet(planar_law(path), Path(path))
    if folder is not None:
        with folder.filled() as place:
            sheet.write(place)
    return sheet


def planar_law(path: str | os.PathLike[str]) -> LawFile:
    """Read the file of a planar law.

    Raises:
        ConfigurationError: with file, line and key of what is wrong, or if it is not planar.
    """
    file = LawFile.load(path)
    if file.law.dimension != 2:
        raise ConfigurationError(
            os.fspath(path), f"must be planar, its dimension is {file.law.dimension}", key="[law]"
        )
    return file
