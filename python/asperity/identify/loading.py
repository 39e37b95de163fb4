"""The door from files to forces over the sliding direction."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from typing import Any

from asperity._base.progress import Progress
from asperity.identify.forces.processing import ProcessedData, process
from asperity.identify.records.configuration import Configuration
from asperity.identify.records.reading import PathLike
from asperity.identify.records.tables.text_table import Source


def load(
    paths: Source | Iterable[Source],
    config: PathLike | Configuration | Mapping[str, Any] | None = None,
    *,
    progress: Progress = None,
) -> ProcessedData:
    """Return the forces over the sliding direction in some files, as a configuration says.

    Every section of the configuration counts: how the files are read and in which windows of time,
    the units, calibration, records without load, what the tribometer is, and the processing.
    ``asperity identify`` goes through here.

    Args:
        paths: files of the runs, one or several of a campaign: text, or spreadsheets (.xlsx), or
            tables in memory, each a ``pandas.DataFrame``.
        config: a TOML file, a `Configuration`, or its sections; by default all that has no default
            is named as `read_csv` expects it.
        progress: ``True`` for a bar of tqdm, or a function of (files read, all files), those of
            records without load too.

    Raises:
        RecordError: for a file that cannot be used, with lines, column and remedy.
        ConfigurationError: for the configuration, naming file, line and key; where it is no file,
            ParameterError.

    >>> import tempfile
    >>> import asperity as asp
    >>> law = asp.FrictionLaw.collinear(asp.Ellipse(0.5, 0.4))
    >>> machine = asp.identify.VirtualTribometer(law, normal_force=9.0, turns=3, sample_rate=200.0)
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     run, *_, config = (f"{folder}/{name}" for name in machine.write(folder))
    ...     asp.identify.load(run, config).turns
    3
    """
    if config is None or isinstance(config, Mapping):
        loaded = Configuration({} if config is None else config)
    elif isinstance(config, Configuration):
        loaded = config
    else:
        loaded = Configuration.load(config)
    raw = loaded.read(paths, progress=progress)
    with loaded.blamed():
        return process(raw)
