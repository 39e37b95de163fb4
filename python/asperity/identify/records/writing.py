"""Raw data as files that are read again to the bit."""

from __future__ import annotations

from pathlib import Path

from asperity._base.storage import toml
from asperity._base.tables import write_columns
from asperity.errors import ParameterError
from asperity.identify.records.calibration import Calibration
from asperity.identify.records.configuration import LOADS
from asperity.identify.records.reading import PathLike
from asperity.identify.records.record import CHANNELS, Processing, RawData

_VELOCITY = ("velocity_x", "velocity_y")


def write_raw(raw: RawData, folder: PathLike) -> list[str]:
    """Write raw data as CSV files, with the ``tribometer.toml`` that reads them again.

    Args:
        raw: what is to be written.
        folder: made if it is not there.

    Returns:
        Names of the files, the runs first, ``tribometer.toml`` last.
    """
    moving = {run.velocity is not None for run in raw.recordings}
    if len(moving) > 1:
        raise ParameterError("raw", "must have runs of disks or of stages: one file describes all")
    place = Path(folder)
    place.mkdir(parents=True, exist_ok=True)
    runs = {f"run_{number}.csv": run for number, run in enumerate(raw.recordings, 1)}
    idle = {f"no_load_{number}.csv": run for number, run in enumerate(raw.no_load, 1)}
    # A normal channel that only repeats what normal_load says was none.
    kept = 2 if _repeats_load(raw) else 3
    for name, run in {**runs, **idle}.items():
        channels = zip(CHANNELS[:kept], run.readings.T, strict=False)
        moved = () if run.velocity is None else zip(_VELOCITY, run.velocity.T, strict=True)
        columns = {"time": run.time, "angle": run.angle, **dict(moved), **dict(channels)}
        write_columns(place / name, columns)
    sections: dict[str, dict[str, object]] = {}
    if moving == {True}:
        sections["columns"] = {name: name for name in ("angle", *_VELOCITY)}
    if idle:
        sections["no_load"] = {"files": list(idle)}
    if raw.calibration is not None:
        sections["calibration"] = _write_calibration(place / "calibration.csv", raw.calibration)
    stated = {"zero_error": raw.zero_error, "gain_error": raw.gain_error}
    sections["tribometer"] = {
        "normal_load": raw.normal_load,
        "radius": raw.radius,
        **{name: None if error is None else error.tolist() for name, error in stated.items()},
    }
    if raw.processing != Processing():
        given = raw.processing._parameters
        sections["processing"] = {k: False if v is None else v for k, v in given.items()}
    toml.write(place / "tribometer.toml", sections)
    calibration = ["calibration.csv"] * (raw.calibration is not None)
    return [*runs, *idle, *calibration, "tribometer.toml"]


def _repeats_load(raw: RawData) -> bool:
    load = raw.normal_load
    return load is not None and all(
        (run.readings[:, 2] == level).all()
        for runs, level in ((raw.recordings, load), (raw.no_load, 0.0))
        for run in runs
    )


def _write_calibration(path: Path, calibration: Calibration) -> dict[str, object]:
    """Write the weighings of a calibration; return the section that reads them again."""
    columns = [*calibration.loads.T, *calibration.readings.T]
    write_columns(path, dict(zip((*LOADS, *CHANNELS), columns, strict=True)))
    error = calibration.reading_error
    return {
        "file": path.name,
        "reading_error": None if error is None else error.tolist(),
        "fit_zero": calibration.fit_zero,
    }
