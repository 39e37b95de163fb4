"""From files of a tribometer to a law, with figures, tables and a report."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from asperity._base.arrays import Array, along_and_across
from asperity._base.progress import Count, Progress, Report, reporter
from asperity._base.storage.files import ResultFolder
from asperity._base.tables import aligned, write_columns, write_csv
from asperity.errors import FitError
from asperity.identify.campaigns.coefficient import (
    SAID_OF_RATE,
    STROKES,
    WITH_RATE,
    OneChannel,
    with_rate,
    write_coefficient,
)
from asperity.identify.campaigns.coefficient import TABLES as COEFFICIENT
from asperity.identify.estimator.identified_law import recorded_under
from asperity.identify.estimator.loss import LossName
from asperity.identify.evidence.coefficient.dependence import several_loads
from asperity.identify.evidence.coefficient.result import (
    FrictionCoefficient,
    friction_coefficient,
)
from asperity.identify.evidence.coefficient.static import sliding
from asperity.identify.evidence.coefficient.turns import count_of_runs
from asperity.identify.evidence.forces.diagnostics import SETS, UNITS_AND_SCALE
from asperity.identify.evidence.forces.estimation import fit_law
from asperity.identify.evidence.forces.report import cells, loads_of, write_report
from asperity.identify.evidence.forces.result import Fit
from asperity.identify.forces.averaged import Averaged
from asperity.identify.forces.measured_sets import MeasuredSets
from asperity.identify.forces.processing import ProcessedData
from asperity.identify.forces.turns import TurnAverage
from asperity.identify.loading import load
from asperity.identify.records.configuration import Configuration
from asperity.law import FrictionLaw, LawFile, Provenance

_PICTURES = ("sets.png", "forces.png", "residuals.png")
_TABLES = ("directions.csv", "parameters.csv", "turns.csv", "models.csv")
_LAW = "law.toml"
FILES = (*COEFFICIENT, *_TABLES, _LAW, *_PICTURES, "report.html")
"""What `identify_campaign` writes of turns; of strokes `STROKES` besides, of speeds `WITH_RATE`."""

STAGES = ("reading", "fitting", "comparing models", "writing")
"""What it announces, and counts in its progress; reading counts file by file."""

_DIRECTIONS = 360


@dataclass(frozen=True)
class Identification:
    """What a campaign of measurements tells, and where it comes from."""

    data: ProcessedData
    fit: Fit
    provenance: Provenance

    @cached_property
    def coefficient(self) -> FrictionCoefficient:
        """Friction coefficients along the sliding, over turns, runs, loads and speeds."""
        return friction_coefficient(self.data, confidence=self.fit.confidence or 0.95)

    @property
    def warnings(self) -> tuple[str, ...]:
        """Those of the fit, and on runs of unlikely units, or whose load or speed varies."""
        return (*self.fit.warnings, *self.coefficient.unlikely, *self.coefficient.unsteady)

    @cached_property
    def rated(self) -> FrictionLaw | None:
        """The law with the Stribeck factor over the runs, and C at rest, where speeds tell one."""
        return with_rate(self.coefficient, self.fit.law)

    @cached_property
    def sliding(self) -> NDArray[np.bool_]:
        """Which samples count: those of turns, or of strokes while the pin slips."""
        return sliding(self.data)

    @cached_property
    def averaged(self) -> Averaged:
        """Means over directions of sliding, so many that each holds samples of every turn.

        Of strokes they are those of the directions that there are, while the pin slips.
        """
        if not self.data.goes_round:
            return self.data._averaged(_DIRECTIONS, self.sliding)
        return self.data.averaged(self.data.full_bins(_DIRECTIONS, each_turn=True))

    @cached_property
    def sets(self) -> MeasuredSets:
        """C and D from these means.

        Raises:
            ParameterError: for strokes in fewer than eight directions.
        """
        means = self.averaged
        return MeasuredSets(means.phi, means.force / means.normal_force[:, None])

    def summary(self) -> str:
        """Return a few lines of text: the data, their defects, Table 1 of [WL19], the law."""
        parts = [aligned(self._facts()), aligned(self._parameters(), right=(1, 2, 3))]
        parts += [SETS, UNITS_AND_SCALE]
        names, force = self.fit.parameters, self.data.usual_load
        if {"reservoir.a", "reservoir.b"} <= set(names) and not several_loads(self.data):
            a, b = (force * names[f"reservoir.{name}"].value for name in "ab")
            parts.append(f"semi-axes of C at {force:.4g} N: {a:.4g} N, {b:.4g} N")
        if self.fit.turns > 1:
            best = self.fit.comparison.best
            pair = best.reservoir, best.direction
            fitted = pair == (self.fit.reservoir_model, self.fit.direction_model)
            remedy = "" if fitted else '; fit them with "best" for both'
            parts.append(
                f"shapes: the best fit for its number of parameters (smallest BIC) is {pair[0]} "
                f"for C and {pair[1]} for D{remedy}"
            )
        parts.append(self.coefficient.text())
        if self.rated is not None:
            parts.append(SAID_OF_RATE)
        if self.fit.warnings:
            parts.append("\n".join(f"warning: {sentence}" for sentence in self.fit.warnings))
        return "\n\n".join(parts)

    def results(self) -> dict[str, Any]:
        """Return parameters, coefficients and warnings as numbers and texts, for ``--json``."""
        return {
            "parameters": {name: dict(x._parameters) for name, x in self.fit.parameters.items()},
            "models": [self.fit.reservoir_model, self.fit.direction_model],
            "residuals": self.fit.rms,
            "coefficient": self.coefficient.data(),
            "warnings": list(self.warnings),
        }

    def _facts(self) -> list[tuple[str, str]]:
        data, raw = self.data, self.data.raw
        calibration = raw.calibration
        condition = "none" if calibration is None else f"condition {calibration.condition:.4g}"
        if calibration is not None and data.calibration_covariance is None:
            condition += "; not in the bands: its error takes a fourth load or reading_error"
        if raw.gain_error is not None:
            condition += f"; gain_error {_listed(100.0 * raw.gain_error)} %"
        idle = len(raw.no_load)
        records = f"{idle} record{'s' * (idle > 1)} without load" if idle else "none"
        if raw.zero_error is not None:
            records += f"; zero_error {_listed(raw.zero_error)} N"
        facts = [
            (
                "data",
                f"{np.count_nonzero(self.sliding)} of {len(data.phi)} samples in {data.turns} "
                f"{'turns' if data.goes_round else 'strokes'}, "
                f"{len(raw.recordings)} runs"
                + f"; {data.lifted} strokes without load left out"
                * (data.lifted > 0),
            ),
            ("directions", str(self.fit.coverage)),
            ("normal force", loads_of(data)),
            ("calibration", condition),
            ("zero", records),
        ]
        if data.goes_round:
            sets = self.sets
            across, along = sets.radii_on_axes
            facts += [
                ("C on e1, e2", f"{across:.4g}, {along:.4g} per unit normal force"),
                ("closure of D", f"{sets.closure:.6g}"),
                ("asymmetry", f"{sets.asymmetry:.3g} of the largest force"),
                ("convexity defect", f"{sets.convexity_defect:.3g} rad"),
                ("associativity", str(self.fit.associativity)),
            ]
        return [*facts, ("residuals", f"{self.fit.rms:.4g} N rms")]

    def _parameters(self) -> list[tuple[str, ...]]:
        bands = self.fit.confidence is not None
        rows: list[tuple[str, ...]] = [("parameter", "estimate", *("from", "to") * bands)]
        for name, one in self.fit.parameters.items():
            rows.append((name, *cells(name, one)[: 1 + 2 * bands]))
        return rows

    def write(self, folder: Path, *, title: str) -> None:
        """Write what `FILES` lists into a folder."""
        from asperity.plot import save_figure
        from asperity.plot.identification import report_figures

        self.fit.save_law(folder / _LAW, provenance=self.provenance)
        if self.rated is not None:
            LawFile(self.rated, provenance=self.provenance).save(folder / WITH_RATE)
        figures = report_figures(self.fit)
        for name, figure in zip(_PICTURES, figures.values(), strict=True):
            save_figure(figure, folder / name)
        self.fit.to_csv(folder / "parameters.csv")
        write_columns(folder / "directions.csv", self._directions())
        write_csv(folder / "turns.csv", _TURN_COLUMNS, self._turns())
        if self.fit.turns > 1:
            self.fit.comparison.to_csv(folder / "models.csv")
        else:
            # A single turn cannot be left out.
            write_csv(folder / "models.csv", ("model",), ())
        further = write_coefficient(self.coefficient, folder)
        write_report(self.fit, folder / "report.html", title, figures, further)

    def _directions(self) -> dict[str, Any]:
        """Return mean measured and modelled forces over directions of sliding, and points of D."""
        bins = self.averaged
        force = bins.force / bins.normal_force[:, None]
        against, across = along_and_across(force, bins.phi)
        bands = self.fit.bands(bins.phi)
        points = np.full((len(bins.phi), 2), np.nan)
        if self.data.goes_round:
            points = self.sets.direction_by_support
        return {
            "phi [rad]": bins.phi,
            "measured -lambda_1/lambda_N": force[:, 0],
            "measured -lambda_2/lambda_N": force[:, 1],
            "measured l_t": against,
            "measured l_p": across,
            "model l_t": bands.resistance[:, 0],
            "model l_p": bands.resistance[:, 1],
            "half width l_t": bands.resistance_half_width[:, 0],
            "half width l_p": bands.resistance_half_width[:, 1],
            "D_1": points[:, 0],
            "D_2": points[:, 1],
        }

    def _turns(self) -> list[tuple[object, ...]]:
        """Return the mean of each channel over each turn, its offset from all turns, and the drift.

        Low and high are the band of the mean of all turns. Strokes have directions of their own,
        and no mean of all.
        """
        rows: list[tuple[object, ...]] = []
        if not self.data.goes_round:
            for channel, level in self.data._stroke_means(self.sliding).items():
                rows += [(channel, at, mean, "", "", "", "") for at, mean in enumerate(level)]
            return rows
        for channel, average in self.data.turn_averages(len(self.averaged.phi)).items():
            level = average.turns.mean(axis=1)
            all_turns = TurnAverage([0.0], level[:, None], confidence=average.confidence)
            band = float(all_turns.low[0]), float(all_turns.high[0])
            for turn, (mean, offset) in enumerate(zip(level, average.offset, strict=True)):
                rows.append((channel, turn, mean, *band, offset, average.drift))
        return rows


_TURN_COLUMNS = ("channel", "turn", "mean", "low", "high", "offset", "drift per turn")


def identify_campaign(
    paths: Sequence[Path],
    config: Path,
    out: Path,
    *,
    reservoir: str = "superellipse",
    direction: str = "superellipse",
    loss: LossName = "linear",
    confidence: float = 0.95,
    progress: Progress = None,
    announce: Callable[[str], object] = lambda _: None,
) -> Identification | OneChannel:
    """Identify a law and write what `FILES` lists into `out`; nothing if something is wrong.

    Of records with one channel it is the coefficient, and an isotropic law if both models are
    circles.

    Args:
        paths: files of the runs, one or several of a campaign.
        config: TOML file, see `identify.Configuration`.
        out: folder; made if it is not there.
        reservoir: model of C, ``"circle"``, ``"ellipse"``, ``"superellipse"``,
            ``"fourier"`` or ``"best"`` of those compared, by BIC.
        direction: model of D, likewise.
        loss: ``"linear"``, ``"soft_l1"``, ``"huber"`` or ``"cauchy"``.
        confidence: of the bands.
        progress: ``True`` for a bar of tqdm, or a function of (stages done, all stages); while
            files are read, of which each is a share of the first stage.
        announce: called with the name of every stage of `STAGES` when it begins.

    Raises:
        RecordError: if a file cannot be used.
        ConfigurationError: if the configuration cannot be used.
        ParameterError: if an option or the folder cannot be used.
        FitError: if nothing fits, or the fitted D is not convex.
    """
    folder = ResultFolder(out, (*FILES, *STROKES, WITH_RATE), [*paths, config])
    with reporter(progress, "stage") as report:

        def begin(stage: str) -> None:
            announce(stage)
            count.add(STAGES.index(stage))

        count = Count(len(STAGES), report)
        begin("reading")
        loaded = Configuration.load(config)
        data = load(list(paths), loaded, progress=_share(report))
        origin = Provenance.of_files(
            [*paths, config, *loaded.files],
            made_by=f"asperity identify --reservoir {reservoir} --direction {direction} "
            f"--loss {loss} --confidence {confidence!r}",
            note=recorded_under(data.loads, runs=count_of_runs(data)),
            configuration=loaded.sections,
        )
        begin("fitting")
        title = f"Friction law of {', '.join(path.name for path in paths)}"
        if data.raw.one_channel:
            coefficient = friction_coefficient(data, confidence=confidence)
            models = {"reservoir": reservoir, "direction": direction}
            alone = OneChannel.of(coefficient, origin, **models)
            begin("writing")
            with folder.filled() as place:
                alone.write(place, title=title.replace("law", "coefficient"))
            count.finish()
            return alone
        # The bands need two turns.
        bands = confidence if data.turns > 1 else None
        fit = fit_law(data, reservoir=reservoir, direction=direction, loss=loss, confidence=bands)
        found = Identification(data, fit, origin)
        if not np.isfinite(found.fit.law.alpha_min):
            raise FitError("the fitted sets make no law")
        begin("comparing models")
        if data.turns > 1:
            _ = found.fit.comparison
        begin("writing")
        with folder.filled() as place:
            found.write(place, title=title)
        count.finish()
    return found


def _listed(errors: Array) -> str:
    """Return one number if all are equal, else all."""
    texts = [f"{error:.3g}" for error in errors.tolist()]
    return texts[0] if len(set(texts)) == 1 else ", ".join(texts)


def _share(report: Report | None) -> Report | None:
    """Return what reports files as shares of the first stage."""
    return None if report is None else lambda done, files: report(done / files, len(STAGES))
