"""From files of a tribometer to a law with figures, tables and a report: ``asperity identify``."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from asperity._base.arrays import Array, unit_vectors
from asperity._base.files import all_or_none, check_folder, write_csv
from asperity._base.progress import stages
from asperity.errors import FitError
from asperity.identify import Averaged, Configuration, Fit, MeasuredSets, ProcessedData, fit_law
from asperity.identify.records.configuration import blaming

if TYPE_CHECKING:
    from matplotlib.figure import Figure

FILES = (
    "sets.png",
    "forces.png",
    "residuals.png",
    "parameters.csv",
    "directions.csv",
    "turns.csv",
    "models.csv",
    "report.html",
)
"""What `identify` writes."""

_STAGES = 6
_DIRECTIONS = 360


@dataclass(frozen=True)
class Identification:
    """What a campaign of measurements tells."""

    data: ProcessedData
    fit: Fit

    @cached_property
    def averaged(self) -> Averaged:
        """Means over directions of sliding, so many that each holds samples of every turn."""
        return self.data.averaged(self.data.full_bins(_DIRECTIONS, each_turn=True))

    @cached_property
    def sets(self) -> MeasuredSets:
        """C and D from these means."""
        means = self.averaged
        return MeasuredSets(means.phi, means.force / means.normal_force[:, None])

    def summary(self) -> str:
        """Return a few lines of text: the data, their defects, Table 1 of [WL19], the law."""
        data, sets = self.data, self.sets
        force = float(data.normal_force.mean())
        calibration = data.raw.calibration
        condition = "none" if calibration is None else f"condition {calibration.condition:.4g}"
        if calibration is not None and data.calibration_covariance is None:
            condition += "; not in the bands: its error takes a fourth load or reading_error"
        lines = [
            f"data              {data.used} of {len(data.phi)} samples in {data.turns} turns, "
            f"{len(data.raw.recordings)} runs",
            f"normal force      {force:.4g} N",
            f"calibration       {condition}",
            f"zero              {_records(len(data.raw.no_load))}",
            "C on e1, e2       {:.4g}, {:.4g} per unit normal force".format(*sets.radii_on_axes),
            f"closure of D      {sets.closure:.6g}",
            f"asymmetry         {sets.asymmetry:.3g} of the largest force",
            f"convexity defect  {sets.convexity_defect:.3g} rad",
            f"residuals         {self.fit.rms:.4g} N rms",
            "",
            _HEAD + ("" if self.fit.confidence is None else f" {'from':>12} {'to':>12}"),
            *(_line(*row) for row in _parameters(self.fit)),
        ]
        names = self.fit.parameters
        if {"reservoir.a", "reservoir.b"} <= set(names):
            a, b = (force * names[f"reservoir.{name}"].value for name in "ab")
            lines += ["", f"semi-axes of C at {force:.4g} N: {a:.4g} N, {b:.4g} N"]
        if self.fit.turns > 1:
            best = self.fit.comparison.best
            fitted = (best.reservoir, best.direction) == (
                self.fit.reservoir_model,
                self.fit.direction_model,
            )
            remedy = "" if fitted else "; fit them with --reservoir best --direction best"
            lines += [
                "",
                f"models            BIC prefers {best.reservoir} for C and {best.direction} for D"
                + remedy,
            ]
        lines += ["", *(f"warning: {sentence}" for sentence in self.fit.warnings)]
        return "\n".join(lines).rstrip()


def _records(count: int) -> str:
    return f"{count} record{'s' * (count > 1)} without load" if count else "none"


def identify(
    paths: Sequence[Path],
    config: Path,
    out: Path,
    *,
    reservoir: str = "superellipse",
    direction: str = "superellipse",
    loss: str = "linear",
    confidence: float = 0.95,
) -> Identification:
    """Identify a law and write what `FILES` lists into `out`; nothing if something is wrong.

    Args:
        paths: files of the runs, one or several of a campaign.
        config: TOML file, see `identify.Configuration`.
        out: folder; made if it is not there.
        reservoir: model of C, ``"circle"``, ``"ellipse"``, ``"superellipse"``,
            ``"fourier"`` or ``"best"`` of those compared, by BIC.
        direction: model of D, likewise.
        loss: ``"linear"``, ``"huber"`` or ``"cauchy"``.
        confidence: of the bands.

    Raises:
        RecordError: if a file or the configuration cannot be used.
        ParameterError: if an option or the folder cannot be used.
        FitError: if nothing fits, or the fitted D is not convex.
    """
    check_folder(out, FILES)
    with stages(_STAGES) as announce:
        announce("reading")
        configuration = Configuration.load(config)
        with blaming(config):
            raw = configuration.read(list(paths))
            announce("processing")
            data = configuration.process(raw)
        announce("fitting")
        # The bands need two turns.
        bands = confidence if data.turns > 1 else None
        fit = fit_law(data, reservoir, direction, loss=loss, confidence=bands)
        found = Identification(data, fit)
        if not np.isfinite(fit.law.alpha_min):
            raise FitError("the fitted sets make no law")
        announce("comparing models")
        if data.turns > 1:
            _ = fit.comparison
        announce("drawing")
        figures = _figures(fit)
        announce("writing")
        _write(found, figures, out, title=", ".join(path.name for path in paths))
    return found


def _figures(fit: Fit) -> dict[str, Figure]:
    import matplotlib as mpl

    mpl.use("Agg")
    from asperity.plot import identification, style

    with style():
        return {
            "sets.png": identification.sets_figure(fit),
            "forces.png": identification.forces_figure(fit),
            "residuals.png": identification.residuals_figure(fit),
        }


def _write(found: Identification, figures: Mapping[str, Figure], out: Path, *, title: str) -> None:
    from asperity.plot import save_figure

    with all_or_none(out, FILES) as folder:
        for name, figure in figures.items():
            save_figure(figure, folder / name)
        header = ("parameter", "estimate", "low", "high", "standard_error", "identifiable")
        write_csv(folder / "parameters.csv", header, _parameters(found.fit))
        write_csv(folder / "directions.csv", _DIRECTION_COLUMNS, _directions(found).tolist())
        write_csv(folder / "turns.csv", _TURN_COLUMNS, _turns(found))
        write_csv(folder / "models.csv", _MODEL_COLUMNS, _models(found.fit))
        found.fit.report(folder / "report.html", title=f"Friction law of {title}")


def _parameters(fit: Fit) -> list[tuple[str, float, float, float, float, bool]]:
    return [
        (name, one.value, one.low, one.high, one.standard_error, one.identifiable)
        for name, one in fit.parameters.items()
    ]


_HEAD = f"{'parameter':<22} {'estimate':>12}"


def _line(name: str, value: float, low: float, high: float, _: float, told: bool) -> str:
    if not told:
        return f"{name:<22} not identifiable"
    band = f" {low:>12.6g} {high:>12.6g}" if np.isfinite(low) else ""
    return f"{name:<22} {value:>12.6g}{band}"


_DIRECTION_COLUMNS = (
    "phi [rad]",
    "measured -lambda_1/lambda_N",
    "measured -lambda_2/lambda_N",
    "measured l_t",
    "measured l_p",
    "model l_t",
    "model l_p",
    "half width l_t",
    "half width l_p",
    "D_1",
    "D_2",
)


def _directions(found: Identification) -> Array:
    """Return mean measured and modelled forces over directions of sliding, and points of D."""
    bins = found.averaged
    force = bins.force / bins.normal_force[:, None]
    e = unit_vectors(bins.phi)
    along, across = np.sum(e * force, axis=1), e[:, 0] * force[:, 1] - e[:, 1] * force[:, 0]
    bands = found.fit.bands(bins.phi)
    columns = [bins.phi, *force.T, along, across, *bands.resistance.T]
    return np.column_stack(
        [*columns, *bands.resistance_half_width.T, *found.sets.direction_by_support.T]
    )


_MODEL_COLUMNS = (
    "reservoir",
    "direction",
    "parameters",
    "residual rms [N]",
    "BIC minus best",
    "left out minus best",
    "left out error",
    "fitted",
)


def _models(fit: Fit) -> list[tuple[object, ...]]:
    """Return the compared models; none where a single turn cannot be left out."""
    if fit.turns < 2:
        return []
    fitted = fit.reservoir_model, fit.direction_model
    return [
        (
            one.reservoir,
            one.direction,
            one.parameters,
            one.rms,
            one.bic,
            one.left_out,
            one.left_out_error,
            (one.reservoir, one.direction) == fitted,
        )
        for one in fit.comparison.candidates
    ]


_TURN_COLUMNS = (
    "channel",
    "turn",
    "mean",
    "low",
    "high",
    "offset",
    "drift per turn",
)


def _turns(found: Identification) -> list[tuple[object, ...]]:
    """Return the mean of each channel over each turn, its offset from all turns, and the drift.

    Low and high are the band of the mean of all turns.
    """
    from asperity.identify.forces.turns import TurnAverage

    rows: list[tuple[object, ...]] = []
    for channel, average in found.data.turn_averages(len(found.averaged.phi)).items():
        level = average.turns.mean(axis=1)
        all_turns = TurnAverage([0.0], level[:, None], confidence=average.confidence)
        band = float(all_turns.low[0]), float(all_turns.high[0])
        for turn, (mean, offset) in enumerate(zip(level, average.offset, strict=True)):
            rows.append((channel, turn, mean, *band, offset, average.drift))
    return rows
