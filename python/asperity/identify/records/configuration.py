"""Configuration of a tribometer, and raw data as files."""

from __future__ import annotations

import os
import tomllib
from collections.abc import Iterable, Iterator, Mapping, Sequence
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import numpy as np

from asperity._base.arrays import Array
from asperity._base.files import atomic
from asperity._base.value import Value
from asperity.errors import AsperityError, ParameterError, RecordError
from asperity.identify.forces.processing import ProcessedData, process
from asperity.identify.records.calibration import Calibration
from asperity.identify.records.reading import PathLike, read_csv
from asperity.identify.records.record import CHANNELS, Processing, RawData, Recording
from asperity.identify.records.text_table import Format, has_column, read_table
from asperity.identify.records.units import factors

_FORMAT = ("delimiter", "decimal", "header", "encoding")
_TEXT, _NUMBER, _COUNT, _SWITCH = "a text", "a number", "a whole number", "true or false"
_COLUMN, _FILES, _NUMBERS = "a name or a number from 0", "a name or several", "numbers"
_NUMBER_OR_NONE = "a number, or false for none"
# Types a value of each kind may have; bool is an int for Python, not for us.
_TYPES: dict[str, tuple[type, ...]] = {
    _TEXT: (str,),
    _NUMBER: (int, float),
    _COUNT: (int,),
    _SWITCH: (bool,),
    _COLUMN: (str, int),
    _FILES: (str,),
    _NUMBER_OR_NONE: (int, float),
}
_SECTIONS: dict[str, dict[str, str]] = {
    "file": {
        "delimiter": _TEXT,
        "decimal": _TEXT,
        "header": _COUNT,
        "encoding": _TEXT,
        "sample_rate": _NUMBER,
        "turn_rate": _NUMBER,
        "check_units": _SWITCH,
        "on_defect": _TEXT,
    },
    "columns": dict.fromkeys(("time", "angle", *CHANNELS), _COLUMN),
    "units": dict.fromkeys(("time", "angle", *CHANNELS), _TEXT),
    "calibration": {
        "file": _TEXT,
        "loads": _NUMBERS,
        "readings": _NUMBERS,
        "reading_error": _NUMBERS,
        "fit_zero": _SWITCH,
    },
    "no_load": {"files": _FILES},
    "tribometer": {"normal_load": _NUMBER, "radius": _NUMBER},
    "processing": {"cut_off": _NUMBER_OR_NONE, "order": _COUNT, "grid_angle": _NUMBER},
}
# Crosstalk below this is rounding.
_NEGLIGIBLE = 1e-9
_LOADS = tuple(f"load_{channel}" for channel in CHANNELS)


class Configuration(Value):
    """How the files of a tribometer are read and processed, as in a TOML file.

    Args:
        sections: ``file`` (delimiter, decimal, header, encoding, sample_rate, turn_rate,
            check_units, on_defect), ``columns`` and ``units`` as for `read_csv`, ``calibration``
            (file, or loads and readings; reading_error, fit_zero), ``no_load`` (files),
            ``tribometer`` (normal_load, radius), ``processing`` (cut_off, order, grid_angle); all
            optional. A column of the normal channel is read beside normal_load for its crosstalk.
        folder: what the names of files are relative to.

    The file of a calibration has columns load_tangential, load_radial, load_normal in N beside the
    three channels, whose names and units are those of the runs.

    Raises:
        ParameterError: for a section or key that is not known, or a value of another type.

    >>> from asperity.identify import Configuration
    >>> Configuration({"units": {"angle": "deg"}}).sections["units"]
    {'angle': 'deg'}
    """

    sections: dict[str, Any]
    folder: str

    def __init__(self, sections: Mapping[str, Any], *, folder: PathLike = ".") -> None:
        for section, keys in sections.items():
            if section not in _SECTIONS:
                raise ParameterError(section, f"is no section; known are {', '.join(_SECTIONS)}")
            if not isinstance(keys, Mapping):
                raise ParameterError(section, f"must be a section [{section}], got {keys!r}")
            for key, value in keys.items():
                if key not in _SECTIONS[section]:
                    known = ", ".join(_SECTIONS[section])
                    raise ParameterError(f"{section}.{key}", f"is not known; known are {known}")
                kind = _SECTIONS[section][key]
                if not _is_a(value, kind):
                    raise ParameterError(f"{section}.{key}", f"must be {kind}, got {value!r}")
        self._set(sections={k: dict(v) for k, v in sections.items()}, folder=os.fspath(folder))

    def __hash__(self) -> int:
        return hash((repr(self.sections), self.folder))

    @classmethod
    def load(cls, path: PathLike) -> Configuration:
        """Read a TOML file; files it names are relative to it.

        Raises:
            RecordError: if it is missing, no TOML, or holds what is not known.
        """
        place = Path(path)
        try:
            with place.open("rb") as file:
                return cls(tomllib.load(file), folder=place.parent)
        except OSError as error:
            raise RecordError(str(place), f"cannot be read: {error.strerror}") from None
        except (tomllib.TOMLDecodeError, UnicodeError) as error:
            raise RecordError(str(place), f"is no TOML: {error}") from None
        except ParameterError as error:
            raise RecordError(str(place), str(error)) from None

    def read(self, paths: PathLike | Iterable[PathLike]) -> RawData:
        """Return the runs in some files, with the calibration, records without load and options."""
        calibration = self._calibration()
        files = [paths] if isinstance(paths, str | os.PathLike) else list(paths)
        constant = self._constant_normal(files)
        if constant is not None and calibration is not None and _mixes_normal(calibration):
            raise RecordError(
                str(files[0]),
                "normal: the calibration says that the normal load moves the other channels, "
                "which normal_load cannot replace: give the column of the normal channel as well",
            )
        names = self._section("no_load").get("files", [])
        idle = [Path(self.folder, name) for name in ([names] if isinstance(names, str) else names)]
        return RawData(
            self._runs(files, constant, loaded=True),
            calibration=calibration,
            no_load=self._runs(idle, constant, loaded=False) if idle else (),
            processing=Processing(**self._processing()),
            **self._section("tribometer"),
        )

    def process(self, raw: RawData) -> ProcessedData:
        """Return `process` with the options of the section ``processing``.

        What `read` returns has these options already: `process` alone does the same with it.
        """
        return process(raw, **self._processing())

    def _processing(self) -> dict[str, Any]:
        options = self._section("processing")
        if options.get("cut_off") is False or options.get("cut_off") == "none":
            options["cut_off"] = None
        return options

    def _section(self, name: str) -> dict[str, Any]:
        return dict(self.sections.get(name, {}))

    def _constant_normal(self, files: Sequence[PathLike]) -> float | None:
        """Return the load that stands for a normal channel; None if the files have one.

        Crosstalk of the normal load is in the other channels whether λ_N is constant or not: it
        takes the normal channel to remove it.
        """
        load = self._section("tribometer").get("normal_load")
        form = Format(**{k: v for k, v in self._section("file").items() if k in _FORMAT})
        named = "normal" in self._section("columns")
        if load is None or named or (files and has_column(files[0], "normal", form)):
            return None
        return float(load)

    def _runs(
        self, paths: Iterable[PathLike], normal_load: float | None, *, loaded: bool
    ) -> tuple[Recording, ...]:
        return read_csv(
            paths,
            columns=self._section("columns"),
            units=self._section("units"),
            normal_load=normal_load,
            loaded=loaded,
            **self._section("file"),
        )

    def _calibration(self) -> Calibration | None:
        given = self._section("calibration")
        if not given:
            return None
        name = given.pop("file", None)
        if name is not None:
            given["loads"], given["readings"] = self._weighings(Path(self.folder, name))
        if not {"loads", "readings"} <= set(given):
            raise ParameterError("calibration", "must give file, or loads and readings")
        try:
            return Calibration(**given)
        except AsperityError as error:
            raise RecordError(str(name or "calibration"), str(error)) from None

    def _weighings(self, path: Path) -> tuple[Array, Array]:
        columns = self._section("columns")
        wanted = {name: name for name in _LOADS} | {n: columns.get(n, n) for n in CHANNELS}
        form = {key: value for key, value in self._section("file").items() if key in _FORMAT}
        table = read_table(path, wanted, Format(**form))
        if not np.isfinite(table.values).all():
            bad = np.flatnonzero(~np.isfinite(table.values).all(axis=1))
            raise RecordError(str(path), f"no number in line {table.lines(bad[:1])[0]}")
        scale = factors(self._section("units"))
        return table.values[:, :3], table.values[:, 3:] * [scale[name] for name in CHANNELS]


def _is_a(value: Any, kind: str) -> bool:
    if value is None:
        # What TOML cannot say is as if it were not there.
        return True
    if kind == _FILES and not isinstance(value, str):
        return _all_are(value, str)
    if kind == _NUMBER_OR_NONE and (value is False or value == "none"):
        return True
    if kind == _NUMBERS:
        return _holds_numbers(value)
    return isinstance(value, _TYPES[kind]) and (kind == _SWITCH or not isinstance(value, bool))


def _all_are(values: Any, kind: type) -> bool:
    return isinstance(values, list | tuple) and all(isinstance(one, kind) for one in values)


def _holds_numbers(value: Any) -> bool:
    """Return whether a value is a number, or a list of such values."""
    if isinstance(value, list | tuple | np.ndarray):
        return all(_holds_numbers(one) for one in value)
    return isinstance(value, int | float) and not isinstance(value, bool)


def read_raw(paths: PathLike | Iterable[PathLike], config: PathLike) -> RawData:
    """Return the runs in some files as a configuration file says: `Configuration.read`.

    `process` finds the options of the section ``processing`` in what is returned.

    Args:
        paths: files of the runs.
        config: a TOML file, see `Configuration`.

    Raises:
        RecordError: as `read_csv`, and for the configuration.
    """
    configuration = Configuration.load(config)
    with blaming(config):
        return configuration.read(paths)


@contextmanager
def blaming(config: PathLike) -> Iterator[None]:
    """Say of a wrong option which configuration file it is from, and in which section."""
    try:
        yield
    except ParameterError as error:
        sections = [name for name, keys in _SECTIONS.items() if error.argument in keys]
        section = f"[{sections[0]}] " if len(sections) == 1 else ""
        raise RecordError(str(config), f"{section}{error}") from None


def write_raw(raw: RawData, folder: PathLike) -> list[str]:
    """Write raw data as CSV files, with the ``tribometer.toml`` that reads them again.

    Args:
        raw: what is to be written.
        folder: made if it is not there.

    Returns:
        Names of the files, the runs first, ``tribometer.toml`` last.
    """
    place = Path(folder)
    place.mkdir(parents=True, exist_ok=True)
    runs = {f"run_{number}.csv": run for number, run in enumerate(raw.recordings, 1)}
    idle = {f"no_load_{number}.csv": run for number, run in enumerate(raw.no_load, 1)}
    # A normal channel that only repeats what normal_load says was none.
    kept = 2 if _repeats_load(raw) else 3
    for name, run in {**runs, **idle}.items():
        columns = np.column_stack([run.time, run.angle, run.readings[:, :kept]])
        _write_table(place / name, ("time", "angle", *CHANNELS[:kept]), columns)
    lines: list[str] = []
    if idle:
        lines += ["[no_load]", f"files = {_toml(list(idle))}", ""]
    if raw.calibration is not None:
        lines += _write_calibration(place / "calibration.csv", raw.calibration)
    given = {"normal_load": raw.normal_load, "radius": raw.radius}
    lines += ["[tribometer]", *(f"{k} = {v!r}" for k, v in given.items() if v is not None)]
    if raw.processing != Processing():
        lines += ["", "[processing]", *_write_processing(raw.processing)]
    with atomic(place / "tribometer.toml") as file:
        file.write("\n".join([*lines, ""]).encode())
    calibration = ["calibration.csv"] * (raw.calibration is not None)
    return [*runs, *idle, *calibration, "tribometer.toml"]


def _repeats_load(raw: RawData) -> bool:
    load = raw.normal_load
    return load is not None and all(
        (run.readings[:, 2] == level).all()
        for runs, level in ((raw.recordings, load), (raw.no_load, 0.0))
        for run in runs
    )


def _mixes_normal(calibration: Calibration) -> bool:
    t = calibration.matrix
    return bool(abs(t[:2, 2]).max() > _NEGLIGIBLE * abs(t).max())


def _write_calibration(path: Path, calibration: Calibration) -> list[str]:
    _write_table(path, (*_LOADS, *CHANNELS), np.hstack([calibration.loads, calibration.readings]))
    lines = ["[calibration]", f'file = "{path.name}"']
    if calibration.reading_error is not None:
        lines.append(f"reading_error = {calibration.reading_error.tolist()!r}")
    return [*lines, f"fit_zero = {str(calibration.fit_zero).lower()}", ""]


def _write_processing(processing: Processing) -> list[str]:
    cut_off = "false" if processing.cut_off is None else repr(processing.cut_off)
    return [
        f"cut_off = {cut_off}",
        f"order = {processing.order}",
        f"grid_angle = {processing.grid_angle!r}",
    ]


def _write_table(path: Path, names: Iterable[str], values: Array) -> None:
    with atomic(path) as file:
        # 17 digits: what is read again is the same to the bit.
        np.savetxt(file, values, fmt="%.17g", delimiter=",", header=",".join(names), comments="")


def _toml(names: list[str]) -> str:
    quoted = ", ".join(f'"{name}"' for name in names)
    return f"[{quoted}]"
