"""From files of measured paths to a law, with a figure and tables."""

from __future__ import annotations

from collections.abc import Sequence
from contextlib import nullcontext
from pathlib import Path
from typing import Any

from asperity._base.storage.files import ResultFolder
from asperity._base.storage.toml import NUMBER, NUMBERS, TEXT, Schema, Tables, TomlFile
from asperity._base.tables import write_columns
from asperity.errors import ParameterError
from asperity.identify.estimator.loss import LossName
from asperity.identify.evidence.paths.estimation import fit_paths
from asperity.identify.evidence.paths.launch import Launch
from asperity.identify.evidence.paths.observed import COLUMNS, observed
from asperity.identify.evidence.paths.result import PathFit
from asperity.identify.records.configuration import SCHEMA
from asperity.identify.records.tables.text_table import Format
from asperity.law import FrictionLaw, Provenance
from asperity.system import SlidingPoint

FILES = ("launches.csv", "law.toml", "paths.png", "parameters.csv")
"""What `identify_paths` writes."""

_LAUNCH: Schema = {
    "place": NUMBERS,
    **dict.fromkeys(
        (
            "place_error",
            "speed",
            "speed_error",
            "direction",
            "direction_error",
            "time",
            "time_error",
        ),
        NUMBER,
    ),
}
_SCHEMA: Schema = {
    "file": {name: SCHEMA["file"][name] for name in vars(Format())},
    "columns": dict.fromkeys(COLUMNS, SCHEMA["columns"]["time"]),
    "units": dict.fromkeys(COLUMNS, TEXT),
    "system": {"gravity": NUMBER},
    "paths": {"position_error": NUMBER, "length_error": NUMBER},
    "launch": _LAUNCH,
    "launches": Tables(_LAUNCH),
    "fixed": {
        "reservoir": dict.fromkeys(("radius", "a", "b", "exponent", "angle"), NUMBER),
        "direction": dict.fromkeys(("ratio", "exponent", "angle"), NUMBER),
    },
}
# The law that the fitted one takes the place of.
_ANY = FrictionLaw.isotropic(0.5)


def identify_paths(
    paths: Sequence[Path],
    config: Path | None,
    out: Path,
    *,
    reservoir: str = "superellipse",
    direction: str = "superellipse",
    loss: LossName = "linear",
    confidence: float = 0.95,
) -> PathFit:
    """Identify a law and write what `FILES` lists into `out`; nothing if something is wrong.

    The body slides on a horizontal plane without turning, or as if it did: the mass drops out.

    Args:
        paths: CSV files, one for each launch.
        config: TOML file of what is known beside them, or None.
        out: folder; made if it is not there.
        reservoir: model of C, as for `fit_paths`.
        direction: model of D, likewise.
        loss: of the positions, as for `fit_paths`.
        confidence: of the confidence intervals.

    Raises:
        ConfigurationError: if the configuration cannot be used.
        RecordError: if a file cannot be used.
        ParameterError: if an option or the folder cannot be used.
        FitError: if the paths do not tell the parameters, or nothing fits.
    """
    folder = ResultFolder(out, FILES, [*paths, config])
    file = None if config is None else TomlFile(config, _SCHEMA)
    given: dict[str, Any] = {} if file is None else file.values
    with nullcontext() if file is None else file.named():
        launches = _launches(given, len(paths))
        fixed = {
            f"{part}.{name}": value
            for part, values in given.get("fixed", {}).items()
            for name, value in values.items()
        }
    with nullcontext() if file is None else file.blamed():
        system = SlidingPoint(1.0, law=_ANY, **given.get("system", {}))
        known = given.get("paths", {})
        reading: dict[str, Any] = {
            name: given[name] for name in ("file", "columns", "units") if name in given
        }
        fit = fit_paths(
            observed([str(path) for path in paths], known.get("position_error"), reading),
            system=system,
            reservoir=reservoir,
            direction=direction,
            launch=launches,
            fixed=fixed,
            loss=loss,
            confidence=confidence,
            **known,
        )
    origin = Provenance.of_files(
        [*paths, *([] if config is None else [config])],
        made_by=f"asperity identify-paths --reservoir {reservoir} --direction {direction} "
        f"--loss {loss} --confidence {confidence!r}",
        configuration=given,
    )
    with folder.filled() as place:
        _write(fit, place, origin)
    return fit


def _launches(given: dict[str, Any], count: int) -> list[Launch]:
    """Return what is known of every launch: of all, and of each."""
    each = given.get("launches")
    if each is not None and len(each) != count:
        raise ParameterError(
            "launches", f"must be as many as there are paths, {count}, are {len(each)}"
        )
    known = given.get("launch", {})
    own = [{}] * count if each is None else each
    return [_launch({**known, **one}) for one in own]


def _launch(values: dict[str, Any]) -> Launch:
    try:
        return Launch(**values)
    except ParameterError as error:
        raise type(error)(f"launch.{error.argument}", error.message) from None


def _write(fit: PathFit, folder: Path, origin: Provenance) -> None:
    from matplotlib.figure import Figure

    from asperity.plot import plot_fitted_paths, save_figure, style

    fit.save_law(folder / "law.toml", provenance=origin)
    with style():
        figure = Figure(figsize=(6.0, 6.0), layout="constrained")
        plot_fitted_paths(fit, ax=figure.add_subplot())
    save_figure(figure, folder / "paths.png")
    fit.to_csv(folder / "parameters.csv")
    write_columns(folder / "launches.csv", fit.launch_columns())
