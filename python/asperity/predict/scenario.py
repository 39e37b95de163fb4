"""A scenario: what moves, on what, under which friction law, as a file."""

from __future__ import annotations

import math
import os
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from asperity._base.progress import Progress
from asperity._base.result import counted
from asperity._base.storage.toml import COUNT, NUMBER, SWITCH, TEXT, Schema, TomlFile, advice_on
from asperity._base.value import keep_views
from asperity.errors import ParameterError
from asperity.law import FrictionLaw, LawFile
from asperity.law.file import SCHEMA as law_schema
from asperity.predict.kinds import KINDS, Kind, Quantity, Setup, rest_time
from asperity.runs import integrate, simulate
from asperity.runs.run import Run
from asperity.runs.trajectory import Trajectory
from asperity.status import Outcome, Phase

_METHODS = ("time stepping", "event-driven")
_COMMON: Schema = {
    "kind": TEXT,
    "law": TEXT,
    "title": TEXT,
    "run": {
        "duration": NUMBER,
        "step": NUMBER,
        "until_rest": SWITCH,
        "method": TEXT,
        "output": NUMBER,
    },
    "bands": {"samples": COUNT, "confidence": NUMBER, "seed": COUNT},
}
# So many samples are kept of a run that does not say otherwise, in files and pictures: all steps of
# most runs, because extremes of a vibration are those of its samples.
_SAMPLES = 20_000
# Time stepping is of first order, and the time until rest is known to a step at best: with so many
# to a hundredth.
_FEWEST_STEPS = 100
# More take hours: the step is a slip of the hand.
_MOST_STEPS = 1e9


@dataclass(frozen=True)
class RunOptions:
    """How a scenario is computed.

    Attributes:
        duration: in s; a run that ends at rest may be shorter.
        step: of time stepping in s.
        until_rest: whether to end where everything rests.
        event_driven: whether by `integrate` instead of `simulate`.
        output: time between the samples that are kept in s.
    """

    duration: float
    step: float
    until_rest: bool
    event_driven: bool
    output: float


@dataclass(frozen=True)
class BandOptions:
    """How the uncertainty of laws is propagated.

    Attributes:
        samples: number of laws that are drawn.
        confidence: level of the intervals.
        seed: of the random numbers.
    """

    samples: int
    confidence: float
    seed: int


@dataclass(frozen=True)
class Scenario:
    """What moves, on what, under which law, and how it is computed; made by `Scenario.load`.

    Attributes:
        file: the file, for messages.
        kind: of the scenario.
        laws: laws and where they come from, by the names that the scenario gives their files.
        law_paths: of these files.
        options: how it is computed.
        bands: how the uncertainty of the laws is propagated.
    """

    file: TomlFile
    kind: Kind
    laws: Mapping[str, LawFile]
    law_paths: Mapping[str, Path]
    options: RunOptions
    bands: BandOptions

    def __post_init__(self) -> None:
        keep_views(self)

    @classmethod
    def load(
        cls, path: str | os.PathLike[str], *, law: str | os.PathLike[str] | None = None
    ) -> Scenario:
        """Read a scenario and the laws it names, which are beside it or at absolute paths.

        Args:
            path: of the TOML file; `asperity init` writes examples.
            law: file of a law that takes the place of the one in the key ``law``.

        Raises:
            ConfigurationError: with file, line and key of what is wrong.
        """
        kind = _kind(path)
        file = TomlFile(path, {**_COMMON, **kind.schema})
        contacts = file.values.get("contacts", [])
        keys = {}
        if not contacts or any("law" not in one for one in contacts):
            if law is not None:
                file.values.setdefault("law", os.fspath(law))
            elif "law" not in file.values:
                raise file.error("law", "is missing: name the file of a friction law")
            keys[file.values["law"]] = "law"
        elif law is not None:
            raise ParameterError("law", "is that of no contact, each names its own in the scenario")
        for i, one in enumerate(contacts):
            if "law" in one:
                keys.setdefault(one["law"], f"contacts[{i}].law")
        paths = {name: Path(file.path.parent, name) for name in sorted(keys)}
        if law is not None:
            paths[file.values["law"]] = Path(law)
        for name, place in paths.items():
            if not place.is_file():
                there = (
                    "is a folder: name the law's file in it" if place.is_dir() else "is not there"
                )
                problem = f"names the file {place}, which {there}"
                if keys[name] == "law" and law is not None:
                    raise ParameterError("law", problem)
                raise file.error(keys[name], problem)
        laws = {name: load_law(place) for name, place in paths.items()}
        scenario = cls(file, kind, laws, paths, _options(file), _bands(file))
        scenario.setup()
        return scenario

    @property
    def title(self) -> str:
        """Of pictures and reports: what the file says, or its name."""
        return str(self.file.values.get("title", self.file.path.stem))

    def setup(self, laws: Mapping[str, FrictionLaw] | None = None) -> Setup:
        """Return system and initial state, with the laws of the files or with others.

        Args:
            laws: by the names of their files in the scenario.

        Raises:
            ConfigurationError: if the file does not describe a system.
        """
        given = {name: file.law for name, file in self.laws.items()} if laws is None else laws
        return self.kind.build(self.file, given)

    def run(
        self,
        laws: Mapping[str, FrictionLaw] | None = None,
        *,
        progress: Progress = None,
    ) -> Run:
        """Compute the motion.

        Args:
            laws: by the names of their files in the scenario; default those of the files.
            progress: as of `simulate` and `integrate`.

        Raises:
            AsperityError: as `simulate` and `integrate`.
        """
        setup, options = self.setup(laws), self.options
        start: dict[str, Any] = {"q0": setup.q0, "u0": setup.u0}
        with self.file.blamed():
            if options.event_driven:
                return integrate(
                    setup.system,
                    t_end=options.duration,
                    sample_every=options.output,
                    progress=progress,
                    **start,
                )
            return simulate(
                setup.system,
                dt=options.step,
                t_end=options.duration,
                until_rest=options.until_rest,
                sample_every=max(1, round(options.output / options.step)) * options.step,
                progress=progress,
                **start,
            )

    def quantities(self, run: Run) -> list[Quantity]:
        """Return what a run is asked for."""
        return list(self.kind.quantities(self.setup().system, run))

    def doubts(self, run: Run) -> list[str]:
        """Return what makes the results of a run doubtful, as sentences."""
        options, found = self.options, []
        if run.status not in (Outcome.FINISHED, Outcome.AT_REST):
            found.append(f"the run ended too early, at t = {run.t[-1]:g} s: {run.status}")
        elif (options.until_rest and run.status is not Outcome.AT_REST) or (
            self.kind.has_end and rest_time(run) is None
        ):
            found.append(
                f"it does not come to rest within {options.duration:g} s: give a longer duration"
            )
        if isinstance(run, Trajectory):
            if run.failed_steps:
                found.append(f"{counted(run.failed_steps, 'step')} did not converge")
            slipped = int(run.phase_counts[:, Phase.SLIP].max(initial=0))
            if self.kind.has_end and 0 < slipped < _FEWEST_STEPS:
                found.append(
                    f"it slides for {counted(slipped, 'step')} only, which is too coarse: give a "
                    "shorter step"
                )
        return found


def _kind(path: str | os.PathLike[str]) -> Kind:
    """Return the kind of a scenario, which says what else its file may hold."""
    file = TomlFile(path, {"kind": TEXT}, others=True)
    name = file.values.get("kind")
    if name is None:
        raise file.error("kind", f"is missing; kinds are {', '.join(KINDS)}")
    if name not in KINDS:
        raise file.error("kind", f"{name!r} is not known{advice_on(name, KINDS)}")
    return KINDS[name]


def load_law(path: str | os.PathLike[str]) -> LawFile:
    """Read the file of a law, as an `IdentifiedLaw` if it has parameters with their covariance.

    Raises:
        ConfigurationError: with file, line and key of what is wrong.
    """
    from asperity.identify import IdentifiedLaw

    identified = "parameters" in TomlFile(path, law_schema).values
    return IdentifiedLaw.load(path) if identified else LawFile.load(path)


def _options(file: TomlFile) -> RunOptions:
    values = file.values.get("run", {})
    method = values.get("method", _METHODS[0])
    if method not in _METHODS:
        raise file.error("run.method", f"{method!r} is not known{advice_on(method, _METHODS)}")
    event_driven = method == _METHODS[1]
    needed = ("duration",) if event_driven else ("duration", "step")
    for name in needed:
        if name not in values:
            raise file.error(f"run.{name}", "is missing")
    for name in ("duration", "step", "output"):
        if name in values and not (0.0 < values[name] < math.inf):
            raise file.error(f"run.{name}", f"must be positive, got {values[name]!r}")
    if event_driven:
        for name in ("step", "until_rest"):
            if name in values:
                raise file.error(f"run.{name}", f"has no meaning for the method {_METHODS[1]!r}")
    duration = float(values["duration"])
    step = float(values.get("step", duration))
    if step > duration:
        raise file.error("run.step", f"must not be longer than the duration, got {step!r}")
    if duration / step > _MOST_STEPS:
        raise file.error(
            "run.step",
            f"must leave at most {_MOST_STEPS:.0e} steps, {step!r} s makes {duration / step:.2g}",
        )
    output = float(values.get("output", max(duration / _SAMPLES, 0.0 if event_driven else step)))
    return RunOptions(duration, step, bool(values.get("until_rest", False)), event_driven, output)


def _bands(file: TomlFile) -> BandOptions:
    values = file.values.get("bands", {})
    bands = BandOptions(
        int(values.get("samples", 200)),
        float(values.get("confidence", 0.95)),
        int(values.get("seed", 1)),
    )
    if not 0.0 < bands.confidence < 1.0:
        raise file.error("bands.confidence", f"must lie in (0, 1), got {bands.confidence!r}")
    # With fewer draws the interval would have to reach beyond the outermost of them.
    fewest = max(20, math.ceil(2.0 / (1.0 - bands.confidence) - 1e-9))
    if bands.samples < fewest:
        raise file.error(
            "bands.samples",
            f"must be at least {fewest} for the confidence {bands.confidence:g}, "
            f"got {bands.samples}",
        )
    if bands.seed < 0:
        raise file.error("bands.seed", f"must be 0 or more, got {bands.seed}")
    return bands
