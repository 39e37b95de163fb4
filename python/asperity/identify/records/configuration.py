"""How the files of a tribometer are read and processed, as a TOML file says it."""

from __future__ import annotations

import os
from collections.abc import Iterable, Mapping, Sequence
from contextlib import AbstractContextManager, nullcontext
from pathlib import Path
from typing import Any

import numpy as np

from asperity._base.arrays import Array
from asperity._base.progress import Progress, Report, part_of, reporter
from asperity._base.storage import toml
from asperity._base.storage.toml import COUNT, NUMBER, NUMBERS, SWITCH, TEXT, Kind, TomlFile
from asperity._base.value import Value
from asperity.errors import AsperityError, ParameterError, RecordError
from asperity.identify.records.calibration import Calibration
from asperity.identify.records.reading import (
    FORM,
    PathLike,
    Reader,
    Window,
    read_records,
    sources,
)
from asperity.identify.records.record import CHANNELS, Processing, RawData, Recording
from asperity.identify.records.sliding.motion import force_columns, motion_columns
from asperity.identify.records.tables.headings import UNITS, known_units
from asperity.identify.records.tables.text_table import (
    Format,
    Source,
    name_of,
    names_in,
    read_table,
)

_TIME = Kind(
    "a number, or a time of day in quotes", lambda value: NUMBER.holds(value) or TEXT.holds(value)
)
_COLUMN = Kind("a name or a number from 0", lambda value: COUNT.holds(value) or TEXT.holds(value))
_CUT_OFF = Kind(
    "a number, or false for none",
    lambda value: NUMBER.holds(value) or value is False or value == "none",
)
SCHEMA: dict[str, dict[str, Kind]] = {
    "file": {
        "delimiter": TEXT,
        "decimal": TEXT,
        "header": COUNT,
        "encoding": TEXT,
        "names": COUNT,
        "thousands": TEXT,
        "sheet": _COLUMN,
        "sample_rate": NUMBER,
        "turn_rate": NUMBER,
        "counts_per_turn": NUMBER,
        "arm": NUMBER,
        "one_channel": SWITCH,
        "rectified": SWITCH,
        "check_units": SWITCH,
        "on_defect": TEXT,
    },
    "columns": dict.fromkeys(UNITS, _COLUMN),
    "units": dict.fromkeys(UNITS, TEXT),
    "run": {"from": _TIME.or_several(), "to": _TIME.or_several(), "angles": NUMBERS},
    "calibration": {
        "file": TEXT,
        "loads": NUMBERS,
        "readings": NUMBERS,
        "reading_error": NUMBERS,
        "fit_zero": SWITCH,
    },
    "no_load": {
        "files": TEXT.or_several(),
        "from": _TIME.or_several(),
        "to": _TIME.or_several(),
    },
    "tribometer": {
        "normal_load": NUMBER,
        "radius": NUMBER,
        "zero_error": NUMBERS,
        "gain_error": NUMBERS,
    },
    "processing": {"cut_off": _CUT_OFF, "order": COUNT, "grid_angle": NUMBER},
}
# Crosstalk below this is rounding.
_NEGLIGIBLE = 1e-9
LOADS = tuple(f"load_{channel}" for channel in CHANNELS)


class Configuration(Value):
    """How the files of a tribometer are read and processed, as in a TOML file.

    Args:
        sections: ``file`` (delimiter, decimal, header, encoding, names, thousands, sheet,
            sample_rate, turn_rate, counts_per_turn, arm, one_channel, rectified, check_units,
            on_defect), ``columns`` and ``units`` as for `read_csv`, ``run`` (from, to, angles),
            ``calibration`` (file, or loads and readings; reading_error, fit_zero), ``no_load``
            (files; from, to), ``tribometer`` (normal_load, radius; zero_error in N and gain_error,
            relative, as of `RawData`), ``processing`` (cut_off, order, grid_angle); all optional. A
            column of the normal channel is read beside normal_load for its crosstalk. Windows
            ``from`` … ``to``, numbers in the unit of the times or texts for a clock, or lists of
            them, are those of each file of the runs; those of ``no_load`` are of its own files if
            it names some.
        folder: what the names of files are relative to.

    The file of a calibration has columns load_tangential, load_radial, load_normal in N beside the
    three channels, whose names and units are those of the runs.

    Raises:
        ParameterError: for a section or key that is not known, or a value of another type.

    >>> from asperity.identify import Configuration
    >>> Configuration({"units": {"angle": "deg"}}).sections["units"]
    {'angle': 'deg'}
    """

    sections: Mapping[str, Any]
    folder: str
    # What it was loaded from: errors name the lines in it.
    _file: TomlFile | None = None

    def __init__(self, sections: Mapping[str, Any], *, folder: PathLike = ".") -> None:
        toml.check(sections, SCHEMA)
        self._set(sections={k: dict(v) for k, v in sections.items()}, folder=os.fspath(folder))

    def __hash__(self) -> int:
        return hash((repr(self.sections), self.folder))

    @classmethod
    def load(cls, path: PathLike) -> Configuration:
        """Read a TOML file; files it names are relative to it.

        Raises:
            ConfigurationError: with line and key, if it is missing, no TOML, or holds what is not
                known.
        """
        file = TomlFile(path, SCHEMA)
        loaded = cls(file.values, folder=file.path.parent)
        loaded._keep(_file=file)
        return loaded

    @property
    def files(self) -> list[Path]:
        """The files that it names: weighings and records without load."""
        weighings = self._section("calibration").get("file")
        return [*([] if weighings is None else [Path(self.folder, weighings)]), *self._no_load]

    @property
    def _no_load(self) -> list[Path]:
        names = self._section("no_load").get("files", [])
        return [Path(self.folder, name) for name in ([names] if isinstance(names, str) else names)]

    def read(self, paths: Source | Iterable[Source], *, progress: Progress = None) -> RawData:
        """Return the runs in some files, with the calibration, records without load and options.

        `process` finds the options of the section ``processing`` in what is returned; `load` does
        both.

        Args:
            paths: of the files, or tables in memory.
            progress: ``True`` for a bar of tqdm, or a function of (files read, all files), those of
                records without load too.

        Raises:
            RecordError: as `read_csv`.
            ConfigurationError: for an option that does not fit, if a file gave it; else
                ParameterError.
        """
        with reporter(progress, "file") as report, self.blamed():
            return self._read(paths, report)

    def blamed(self) -> AbstractContextManager[None]:
        """Say of errors where in the file an option stands, if there is a file."""
        return nullcontext() if self._file is None else self._file.blamed()

    def _read(self, paths: Source | Iterable[Source], report: Report | None) -> RawData:
        calibration = self._calibration()
        files = sources(paths)
        constant = self._constant_normal(files)
        if constant is not None and calibration is not None:
            t = calibration.matrix
            if abs(t[:2, 2]).max() > _NEGLIGIBLE * abs(t).max():
                raise RecordError(
                    name_of(files[0]),
                    "normal: the calibration says that the normal load moves the other channels, "
                    "which normal_load cannot replace: give the column of the normal channel as "
                    "well",
                )
        idle = self._no_load
        whole = len(files) + len(idle)
        runs, within = self._runs(files, constant, part_of(report, 0, whole))
        if idle:
            later = part_of(report, len(files), whole)
            given = self._windows("no_load")
            windows = {False: [(None, None)] if given is None else given}
            within = read_records(idle, windows, self._reader(constant), progress=later)[1]
        if calibration is not None and "file" not in self._section("calibration"):
            self._refuse_scaled(runs)
        return RawData(
            runs,
            calibration=calibration,
            no_load=within,
            one_channel=self._section("file").get("one_channel", False),
            processing=Processing(**self._processing()),
            **self._section("tribometer"),
        )

    def _refuse_scaled(self, runs: Sequence[Recording]) -> None:
        """Refuse units of headings alone beside a calibration that is given in numbers."""
        columns = self._section("columns")
        read = (*force_columns(columns, motion_columns(columns)), "normal")
        for run in runs:
            for name, unit in zip(read, run._units, strict=False):
                if UNITS[name][unit.removeprefix("-")] != 1.0 and name not in self._section(
                    "units"
                ):
                    raise RecordError(
                        run.source,
                        f"{name}: its heading says {unit!r}, the readings of the calibration do "
                        "not say theirs: state the unit, in which both are then",
                        ("units",),
                    )

    def _processing(self) -> dict[str, Any]:
        options = self._section("processing")
        if options.get("cut_off") is False or options.get("cut_off") == "none":
            options["cut_off"] = None
        return options

    def _section(self, name: str) -> dict[str, Any]:
        return dict(self.sections.get(name, {}))

    @property
    def _format(self) -> Format:
        return Format(**{k: v for k, v in self._section("file").items() if k in FORM})

    def _constant_normal(self, files: Sequence[Source]) -> float | None:
        """Return the load that stands for a normal channel; None if the files have one.

        Crosstalk of the normal load is in the other channels whether λ_N is constant or not: it
        takes the normal channel to remove it.
        """
        load = self._section("tribometer").get("normal_load")
        named = "normal" in self._section("columns")
        if load is None or named or "normal" in names_in(files[0], self._format):
            return None
        return float(load)

    def _reader(self, normal_load: float | None) -> Reader:
        """Return what reads all files alike."""
        others = {k: v for k, v in self._section("file").items() if k not in FORM}
        columns, units = self._section("columns"), self._section("units")
        return Reader(self._format, columns, units, normal_load=normal_load, **others)

    def _runs(
        self, files: Sequence[Source], normal_load: float | None, report: Report | None
    ) -> tuple[tuple[Recording, ...], tuple[Recording, ...]]:
        """Return the runs, and what the windows without load of the same files hold."""
        windows = {True: self._windows("run") or [(None, None)]}
        if not self._no_load and (idle := self._windows("no_load")) is not None:
            windows[False] = idle
        angles, reader = self._section("run").get("angles"), self._reader(normal_load)
        return read_records(files, windows, reader, angles=angles, progress=report)

    def _windows(self, section: str) -> list[Window] | None:
        """Return the windows of time of a section; None if it has none."""
        given = self._section(section)
        ends = [given.get(name) for name in ("from", "to")]
        if ends == [None, None]:
            return None
        low, high = (one if isinstance(one, tuple) else [one] for one in ends)
        if len(low) != len(high):
            raise ParameterError(
                section, f"must have as many ends as begins: {len(low)} from, {len(high)} to"
            )
        return list(zip(low, high, strict=True))

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
            if name is None:
                raise
            raise RecordError(name, str(error)) from None

    def _weighings(self, path: Path) -> tuple[Array, Array]:
        columns = self._section("columns")
        channels = (*force_columns(columns, motion_columns(columns)), "normal")
        wanted = {name: name for name in LOADS} | {n: columns.get(n, n) for n in channels}
        units = self._section("units")
        table = read_table(path, wanted, self._format, units=units)
        if not np.isfinite(table.values).all():
            bad = np.flatnonzero(~np.isfinite(table.values).all(axis=1))
            raise RecordError(str(path), f"no number in line {table.lines(bad[:1])[0]}")
        factor = [
            known_units(name)[table.units.get(name, "N").removeprefix("-")] for name in wanted
        ]
        sign = [-1.0 if units.get(name, "").startswith("-") else 1.0 for name in wanted]
        values = table.values * factor * sign
        return values[:, :3], values[:, 3:]


def read_raw(
    paths: Source | Iterable[Source], config: PathLike, *, progress: Progress = None
) -> RawData:
    """Return the runs in some files as a configuration file says: `Configuration.read`.

    `process` finds the options of the section ``processing`` in what is returned; `load` does both.

    Args:
        paths: files of the runs, or tables in memory.
        config: a TOML file, see `Configuration`.
        progress: as of `Configuration.read`.

    Raises:
        RecordError: as `read_csv`.
        ConfigurationError: for the configuration, naming file, line and key.
    """
    return Configuration.load(config).read(paths, progress=progress)
