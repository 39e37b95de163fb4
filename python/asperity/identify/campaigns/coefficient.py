"""What a campaign says of the coefficient along the sliding: all there is to say of one channel."""

from __future__ import annotations

import math
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from asperity._base.report import Block, Grid, Picture, Section, Text
from asperity._base.tables import write_columns, write_csv
from asperity.errors import FitError, ParameterError
from asperity.identify.estimator.identified_law import IdentifiedLaw
from asperity.identify.evidence.coefficient.result import FrictionCoefficient
from asperity.identify.forces.turns import cells
from asperity.law import FrictionLaw, LawFile, Provenance

FIRST = "runs.csv"
"""What every result of forces has."""

TABLES = (FIRST, "turns.png")
STROKES = ("breakaway.csv", "loop.csv", "loop.png")
"""What results of strokes have besides, loops those along one line."""

WITH_RATE = "law_with_rate.toml"
"""What results have besides whose speeds tell a Stribeck factor."""
SAID_OF_RATE = (
    f"{WITH_RATE} has C at rest and this Stribeck factor, for predictions over the speeds of "
    "the runs, without an uncertainty."
)
_BINS = 360


def with_rate(found: FrictionCoefficient, law: FrictionLaw) -> FrictionLaw | None:
    """Return a law with the Stribeck factor over the runs, and with C at rest; None without one.

    C is scaled so that the mean coefficient along the sliding, over the directions of the runs, is
    that of the Stribeck curve at rest.
    """
    curve = found.stribeck
    if isinstance(curve, str):
        return None
    phi = found.processed.phi[found.over_turns.kept]
    cell, within = cells(phi, _BINS)
    counts = np.bincount(cell, minlength=_BINS)
    used = np.flatnonzero(counts)
    # The mean direction of each bin: strokes have it exactly.
    at = 2.0 * math.pi / _BINS * (used + 0.5) + np.bincount(cell, within)[used] / counts[used]
    mean = float(np.average(law.resistance(at)[0], weights=counts[used]))
    return law.replace(reservoir=law.reservoir.scaled(curve.static.value / mean), rate=curve.rate)


def write_coefficient(found: FrictionCoefficient, folder: Path) -> list[Section]:
    """Write tables and pictures of a coefficient; return the sections of a report about it."""
    from asperity.plot import save_figure
    from asperity.plot.coefficient import loop_figure, turns_figure
    from asperity.plot.look import png

    heading, *rows = found.rows()
    write_csv(folder / FIRST, heading, rows)
    figure = turns_figure(found)
    save_figure(figure, folder / "turns.png")
    blocks: list[Block] = [Grid(heading, rows), Text(found.summary())]
    if found.breakaway is not None:
        found.breakaway.to_csv(folder / "breakaway.csv")
        blocks.append(Text(found.breakaway.summary()))
    sections = [
        Section("Friction coefficient of the runs", *blocks),
        Section("Coefficient over turns", Picture("coefficient over turns", png(figure))),
    ]
    try:
        loop = found.loop()
    except FitError:
        return sections
    place = "position [m]" if found.has_length else "position [rad]"
    columns = {place: loop.position, "forwards": loop.forwards, "backwards": loop.backwards}
    write_columns(folder / "loop.csv", columns)
    figure = loop_figure(loop, place)
    save_figure(figure, folder / "loop.png")
    return [*sections, Section("Hysteresis loop", Picture("hysteresis loop", png(figure)))]


@dataclass(frozen=True)
class OneChannel:
    """What a campaign with one friction channel tells.

    Attributes:
        coefficient: along the sliding.
        law: the isotropic law, where it was asked for and runs have one load and speed.
        rated: the isotropic law at rest with its Stribeck factor, where speeds tell one.
        provenance: where it comes from.
    """

    coefficient: FrictionCoefficient
    law: IdentifiedLaw | None
    rated: FrictionLaw | None
    provenance: Provenance

    @classmethod
    def of(
        cls, found: FrictionCoefficient, provenance: Provenance, *, reservoir: str, direction: str
    ) -> OneChannel:
        """Return it with a law if both models are circles.

        Raises:
            ParameterError: for models that one channel cannot tell.
            FitError: where there is no isotropic law.
        """
        pair = {reservoir, direction}
        if pair not in ({"circle"}, {"superellipse"}):
            raise ParameterError(
                "reservoir",
                "one channel tells no direction set: circle for both models makes an isotropic "
                "law, without them there is the coefficient alone",
            )
        if pair != {"circle"}:
            return cls(found, None, None, provenance)
        if len(found.groups) > 1 and not isinstance(found.stribeck, str):
            found.check_isotropic()
            rated = with_rate(found, FrictionLaw.isotropic(1.0))
            return cls(found, None, rated, provenance)
        return cls(found, found.isotropic_law().replace(provenance=provenance), None, provenance)

    @property
    def warnings(self) -> tuple[str, ...]:
        """What the intervals do not include."""
        data, one = self.coefficient.processed, self.coefficient
        found = []
        if not one.goes_back and data.zero_covariance is None:
            found.append(
                "no records without load: an error of the zeros of 1 % of the normal force would "
                "change the coefficient by 0.01: record it, or state zero_error"
            )
        if data.calibration_covariance is None:
            what, then = "no calibration", "record it"
            if data.raw.calibration is not None:
                what, then = "a calibration without an error", "state reading_error"
            found.append(
                f"{what}: an error of the gains of 1 % would change the coefficient by 1 %: "
                f"{then}, or state gain_error"
            )
        found += [
            f"{run.name}: one {'turn' if data.goes_round else 'stroke along each line'} has no "
            "scatter, and the coefficient no interval"
            for run in one.runs
            if math.isnan(run.coefficient.low)
        ]
        return (*found, *one.wrong_signs, *one.unlikely, *one.unsteady)

    @property
    def _further(self) -> list[str]:
        """Warnings that the text on the coefficient has not."""
        said = [one.removeprefix("warning: ") for one in self.coefficient.sentences()]
        return [one for one in self.warnings if one not in said]

    def summary(self) -> str:
        """Return a few paragraphs of text."""
        parts = [self.coefficient.text()]
        parts.append(
            "One channel: the force across the sliding is not known, and neither is a direction "
            "set." + (f" Isotropic law: {self.law.law}." if self.law is not None else "")
        )
        if self.rated is not None:
            parts.append(SAID_OF_RATE)
        if self._further:
            parts.append("\n".join(f"warning: {sentence}" for sentence in self._further))
        return "\n\n".join(parts)

    def results(self) -> dict[str, Any]:
        """Return the same as numbers and texts, for ``--json``."""
        return {"coefficient": self.coefficient.data(), "warnings": list(self.warnings)}

    def write(self, folder: Path, *, title: str) -> None:
        """Write tables, pictures and the report into a folder, and the law if there is one."""
        from asperity._base.report import write_report

        if self.law is not None:
            self.law.save(folder / "law.toml")
        if self.rated is not None:
            LawFile(self.rated, provenance=self.provenance).save(folder / WITH_RATE)
        self.coefficient.to_csv(folder / "turns.csv")
        sections = write_coefficient(self.coefficient, folder)
        head = Section("", *(Text(one, "warning") for one in self._further))
        write_report(folder / "report.html", title, [head, *sections])
