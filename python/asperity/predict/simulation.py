"""From the file of a scenario to a motion, with bands, figures, tables and a report."""

from __future__ import annotations

import json
import os
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from asperity._base.progress import Progress
from asperity._base.report import Facts, Grid, Picture, Section, Text, write_report
from asperity._base.result import NO_UNIT, Axis, Series, Table, TableResult, counted
from asperity._base.storage.files import ResultFolder
from asperity._base.tables import aligned, write_columns
from asperity.predict.bands import PredictionBands, propagate
from asperity.predict.kinds import Quantity
from asperity.predict.scenario import Scenario
from asperity.runs.run import Run

if TYPE_CHECKING:
    from matplotlib.figure import Figure

_TABLES = ("results.csv", "path.csv", "run.npz")
_PICTURES = ("path.png", "history.png")
FILES = (*_TABLES, *_PICTURES, "report.html")
"""What `simulate_scenario` writes; ``draws.csv`` too with bands, without them it is removed."""


@dataclass(frozen=True, repr=False)
class Simulation(TableResult):
    """The motion of a scenario; as a table its results, with their intervals.

    Attributes:
        scenario: what was computed.
        run: the motion with the laws of the files.
        quantities: what it was asked for.
        bands: what the uncertainty of the laws means for it; None if it was not asked for.
    """

    scenario: Scenario
    run: Run
    quantities: tuple[Quantity, ...]
    bands: PredictionBands | None

    @property
    def warnings(self) -> tuple[str, ...]:
        """What makes the results doubtful, as sentences."""
        found = self.scenario.doubts(self.run)
        if self.bands is not None:
            for sentences, effect in (
                (self.bands.failed, "no motion"),
                (self.bands.doubts, "a doubtful motion"),
            ):
                if sentences:
                    found.append(
                        f"{counted(len(sentences), 'drawn law')} gave {effect}, the first because "
                        f"{sentences[0]}"
                    )
        return tuple(found)

    def rows(self) -> list[tuple[str, ...]]:
        """Return the results as a table of texts with a header."""
        bands = self.bands
        interval = () if bands is None else (f"{100 * bands.confidence:g} % from", "to")
        rows: list[tuple[str, ...]] = [("quantity", "value", "unit", *interval)]
        for i, one in enumerate(self.quantities):
            ends = () if bands is None else (f"{bands.low[i]:.6g}", f"{bands.high[i]:.6g}")
            rows.append((one.name, f"{one.value:.6g}", one.unit, *ends))
        return rows

    def __repr__(self) -> str:
        return f"<Simulation: {self.scenario.title}, {self.scenario.kind.name}, {self.run.status}>"

    def summary(self) -> str:
        """Return the results, in sentences."""
        bands = self.bands
        lines = [f"{self.scenario.kind.meaning[0].upper()}{self.scenario.kind.meaning[1:]}:"]
        for i, one in enumerate(self.quantities):
            text = f"{one.name}: {one.value:.6g} {one.unit}".rstrip()
            if bands is not None:
                percent = f"{100 * bands.confidence:g} %"
                text += f" ({percent} from {bands.low[i]:.6g} to {bands.high[i]:.6g})"
            lines.append(f"{text},")
        lines.append(f"computed in {counted(self.run.steps, 'step')}; {self.run.status}.")
        lines += [f"Doubtful: {sentence}." for sentence in self.warnings]
        return "\n".join(lines)

    def _table(self) -> Table:
        bands = self.bands
        names = [one.name for one in self.quantities]
        units = [one.unit or NO_UNIT for one in self.quantities]
        values = np.array([one.value for one in self.quantities])
        series = {
            "value": Series(values, ("quantity",), description="with the laws of the files"),
            "unit": Series(np.array(units), ("quantity",), description="of value, low and high"),
        }
        facts: dict[str, str | int | float] = {"scenario": self.scenario.title}
        if bands is not None:
            facts["confidence"] = bands.confidence
            for name, values in (("low", bands.low), ("high", bands.high)):
                series[name] = Series(values, ("quantity",), description=f"{name} end of interval")
        axis = Axis(names, description="what the scenario is asked for", units=units)
        return Table({"quantity": axis}, series, facts)

    def text(self) -> str:
        """Return the results as a table of text."""
        lines = [
            f"{self.scenario.title}: {self.scenario.kind.meaning}",
            f"{self.run.status}, {self.run.steps} steps",
            "",
            aligned(self.rows(), right=(1, 3, 4)),
        ]
        lines += [f"warning: {sentence}" for sentence in self.warnings]
        return "\n".join(lines)

    def data(self) -> dict[str, Any]:
        """Return the results as numbers and texts, for ``--json``."""
        bands = self.bands
        quantities = [
            {
                "name": one.name,
                "unit": one.unit,
                "value": one.value,
                **(
                    {}
                    if bands is None
                    else {"low": float(bands.low[i]), "high": float(bands.high[i])}
                ),
            }
            for i, one in enumerate(self.quantities)
        ]
        result: dict[str, Any] = {
            "scenario": str(self.scenario.file.path),
            "kind": self.scenario.kind.name,
            "laws": {name: str(path) for name, path in self.scenario.law_paths.items()},
            "status": str(self.run.status),
            "steps": self.run.steps,
            "quantities": quantities,
            "warnings": list(self.warnings),
        }
        if bands is not None:
            result["confidence"] = bands.confidence
            result["draws"] = len(bands.draws)
            if bands.region is not None:
                result["end_region"] = {
                    "centre": bands.region.centre.tolist(),
                    "covariance": bands.region.covariance.tolist(),
                    "radius": bands.region.radius,
                }
        return result

    def write(self, folder: Path) -> None:
        """Write the files into a folder."""
        from asperity.plot.look import png

        self.to_csv(folder / "results.csv")
        paths = self.scenario.kind.paths(self.scenario.setup()[0], self.run.q)
        columns = {"t [s]": self.run.t}
        for name, path in paths.items():
            for axis, values in zip("xyz", path.T, strict=False):
                columns[f"{name} {axis} [m]"] = values
        write_columns(folder / "path.csv", columns)
        self.run.save(folder / "run.npz")
        if self.bands is not None:
            draws = {
                f"{one.name} [{one.unit or '-'}]": self.bands.draws[:, i]
                for i, one in enumerate(self.quantities)
            }
            write_columns(folder / "draws.csv", draws)
        header, *rows = self.rows()
        pictures = [Picture(name, png(one, 150)) for name, one in self._figures().items()]
        for picture in pictures:
            (folder / f"{picture.name}.png").write_bytes(picture.png)
        sections = [
            Section(
                "",
                Text(self.scenario.kind.meaning),
                Facts(self._facts()),
                Grid(header, rows),
                *(Text(sentence, "warning") for sentence in self.warnings),
                *pictures,
            ),
            Section("Scenario", Text(self.scenario.file.text, "code")),
        ]
        write_report(folder / "report.html", self.scenario.title, sections)

    def _facts(self) -> list[tuple[str, str]]:
        scenario = self.scenario
        facts = [("scenario", str(scenario.file.path))]
        for name, law in scenario.laws.items():
            made = law.provenance
            known = [made.made_by and f"made by {made.made_by}", made.date]
            words = [str(scenario.law_paths[name]), *filter(None, known)]
            facts.append((f"law {name}", "; ".join(words)))
        facts.append(("status", f"{self.run.status}, {self.run.steps} steps"))
        if self.bands is not None:
            facts.append(("laws drawn", f"{len(self.bands.draws)}, seed {scenario.bands.seed}"))
        return facts

    def _figures(self) -> dict[str, Figure]:
        from asperity.predict.pictures import history, paths

        path = paths(self.scenario, self.run, self.quantities, self.bands)
        return {"path": path, "history": history(self.scenario, self.run)}


def simulate_scenario(
    path: str | os.PathLike[str],
    *,
    law: str | os.PathLike[str] | None = None,
    bands: bool = False,
    out: str | os.PathLike[str] | None = None,
    progress: Progress = None,
) -> Simulation:
    """Compute the motion of a scenario; write what `FILES` lists if a folder is given.

    Args:
        path: of the scenario, see `Scenario.load`.
        law: file of a law instead of the one that the scenario names.
        bands: whether to draw the laws from their uncertainty, see `propagate`.
        out: folder; it is complete or not there.
        progress: ``True`` for a bar of tqdm, or a function of (draws done, all) with bands, else
            of what is done of the motion.

    Raises:
        ConfigurationError: with file, line and key of what is wrong.
        AsperityError: if the motion cannot be computed.
    """
    folder = None if out is None else ResultFolder(Path(out), (*FILES, "draws.csv"), [path, law])
    scenario = Scenario.load(path, law=law)
    run = scenario.run(progress=None if bands else progress)
    quantities = tuple(scenario.quantities(run))
    found = propagate(scenario, nominal=quantities, progress=progress) if bands else None
    result = Simulation(scenario, run, quantities, found)
    if folder is not None:
        with folder.filled() as place:
            result.write(place)
    return result


def as_json(data: dict[str, Any]) -> str:
    """Return results as JSON, in which what is not a number is null."""

    def plain(value: Any) -> Any:
        if isinstance(value, Mapping):
            return {key: plain(one) for key, one in value.items()}
        if isinstance(value, list | tuple):
            return [plain(one) for one in value]
        if isinstance(value, float | np.floating):
            return float(value) if np.isfinite(value) else None
        return value

    return json.dumps(plain(data), indent=2, ensure_ascii=False)
