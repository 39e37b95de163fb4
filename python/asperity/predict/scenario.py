"""A scenario: what moves, on what, under which friction law, as a file."""

from __future__ import annotations

import math
import os
from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from asperity import law as law_room
from asperity import sets, system
from asperity._base.progress import Progress
from asperity._base.result import counted
from asperity._base.storage import data
from asperity._base.storage.toml import (
    COUNT,
    NUMBER,
    NUMBERS,
    SWITCH,
    TABLE,
    TEXT,
    Schema,
    TomlFile,
    advice_on,
)
from asperity._base.value import keep_views
from asperity.errors import ParameterError
from asperity.law import FrictionLaw, LawFile
from asperity.predict.kinds import KINDS, Course, Quantity, ScenarioKind
from asperity.runs import integrate, simulate
from asperity.runs.run import Run
from asperity.status import Outcome
from asperity.system import Body, PlanarBody, PointPlane, SlidingDisk

_METHODS = ("time stepping", "event-driven")
_SCHEMA: Schema = {
    "law": TEXT,
    "title": TEXT,
    "system": TABLE,
    "start": {"position": NUMBERS, "velocity": NUMBERS, "speed": NUMBER, "direction_deg": NUMBER},
    "run": {
        "duration": NUMBER,
        "step": NUMBER,
        "until_rest": SWITCH,
        "method": TEXT,
        "output": NUMBER,
    },
    "bands": {"samples": COUNT, "confidence": NUMBER, "seed": COUNT},
}
_CLASSES: dict[str, Any] = {
    **data.classes(sets, law_room, system),
    "Body.box": Body.box,
    "Body.ball": Body.ball,
    "Body.cylinder": Body.cylinder,
    "PlanarBody.box": PlanarBody.box,
    "PlanarBody.disk": PlanarBody.disk,
    "PointPlane.cylinder": PointPlane.cylinder,
}
"""What may be made of the tables of a scenario, by the word in ``type``."""
_SYSTEMS = {kind.system.__name__: kind for kind in KINDS.values()}
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

    @property
    def steps_per_sample(self) -> int:
        """Steps of time stepping from one sample to the next."""
        return max(1, round(self.output / self.step))


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
    kind: ScenarioKind
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
        file = TomlFile(path, _SCHEMA)
        kind = _kind(file)
        keys = _laws_named(file.values["system"], "system")
        if "" in keys:
            if law is not None:
                name = file.values.setdefault("law", os.fspath(law))
                if name in keys:  # another contact names its own file so
                    file.values["law"] = os.path.abspath(law)
            elif "law" not in file.values:
                raise file.error("law", "is missing: name the file of a friction law")
            del keys[""]
            keys[file.values["law"]] = "law"
        elif law is not None:
            raise ParameterError(
                "law", "does not apply: every contact names its own law in the scenario"
            )
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
        laws = {name: LawFile.load(place) for name, place in paths.items()}
        scenario = cls(file, kind, laws, paths, _options(file), _bands(file))
        scenario.setup()
        return scenario

    @property
    def title(self) -> str:
        """Of pictures and reports: what the file says, or its name."""
        return str(self.file.values.get("title", self.file.path.stem))

    def setup(self, laws: Mapping[str, FrictionLaw] | None = None) -> tuple[Any, dict[str, Any]]:
        """Return the system, and its start as ``q0`` and ``u0`` where these are not its own.

        Args:
            laws: by the names of their files in the scenario; default those of the files.

        Raises:
            ConfigurationError: if the file does not describe a system.
        """
        known = {name: file.law for name, file in self.laws.items()} if laws is None else laws
        table = _with_laws(self.file.values["system"], known, self.file.values.get("law"))
        start = self._start()
        if issubclass(self.kind.system, SlidingDisk):
            for name in start:
                if name in table:
                    raise self.file.error(f"system.{name}", "belongs to [start]")
            table, start = {**table, **start}, {}
        law = table.get("law")
        if isinstance(law, FrictionLaw) and law.dimension != 2:
            raise self.file.error("law", f"must be planar, its dimension is {law.dimension}")
        with self.file.named():
            made = data.built_as_typed(table, "system", _CLASSES)
        return made, {f"{'q' if name == 'position' else 'u'}0": x for name, x in start.items()}

    def _start(self) -> dict[str, Any]:
        """Return position and velocity of the section ``[start]``."""
        file, given = self.file, self.file.values.get("start", {})
        if given and self.kind.name == "rigid bodies":
            raise file.error("start", "is not known of RigidBodies: each body has its own")
        found = {}
        for name in ("position", "velocity"):
            found[name] = np.asarray(given.get(name, [0.0, 0.0]), float)
            if found[name].shape != (2,):
                problem = f"must be 2 numbers in brackets, got {given[name]!r}"
                raise file.error(f"start.{name}", problem)
        if "speed" in given or "direction_deg" in given:
            if "velocity" in given:
                raise file.error("start.speed", "is given beside velocity: leave one of them out")
            for name in ("speed", "direction_deg"):
                if name not in given:
                    raise file.error(f"start.{name}", "is missing")
            angle = math.radians(given["direction_deg"])
            found["velocity"] = given["speed"] * np.array([math.cos(angle), math.sin(angle)])
        return found if self.kind.name != "rigid bodies" else {}

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
        made, start = self.setup(laws)
        options = self.options
        with self.blamed():
            if options.event_driven:
                return integrate(
                    made,
                    t_end=options.duration,
                    sample_every=options.output,
                    progress=progress,
                    **start,
                )
            return simulate(
                made,
                dt=options.step,
                t_end=options.duration,
                until_rest=options.until_rest,
                sample_every=options.steps_per_sample * options.step,
                progress=progress,
                **start,
            )

    @contextmanager
    def blamed(self) -> Iterator[None]:
        """Say of what a run refuses that the file is about it."""
        try:
            with self.file.blamed():
                yield
        except ParameterError as error:
            if error.argument not in ("system", "systems", "q0"):
                raise
            raise self.file.error("system", error.message) from None

    def quantities(self, run: Run) -> list[Quantity]:
        """Return what a run is asked for."""
        return list(self.kind.quantities(self.setup()[0], self._course(run)))

    def doubts(self, run: Run) -> list[str]:
        """Return what makes the results of a run doubtful, as sentences."""
        return self.doubtful(run.status, self._course(run))

    def _course(self, run: Run) -> Course:
        """Return the course of a run; where bands are of samples, so is the time of rest."""
        return Course.of_run(run, by_events=self.kind.needs != "samples")

    def doubtful(self, status: Outcome, course: Course) -> list[str]:
        """Return what makes the results of a motion doubtful, as sentences."""
        options, found = self.options, []
        if status not in (Outcome.FINISHED, Outcome.AT_REST):
            found.append(f"the run ended too early, at t = {course.t[-1]:g} s: {status}")
        elif (options.until_rest and status is not Outcome.AT_REST) or (
            self.kind.has_end and course.rest is None
        ):
            found.append(
                f"it does not come to rest within {options.duration:g} s: give a longer duration"
            )
        if self.kind.has_end and course.rest is not None and not options.event_driven:
            # In the last one it sticks already.
            steps = round(course.rest / options.step) - 1
            steps = steps if course.slipped is None else course.slipped
            moved = not np.allclose(course.q[0], course.q[-1])
            if steps < _FEWEST_STEPS and (steps > 0 or moved):
                found.append(
                    f"it slides for {counted(steps, 'step')} only, which is too coarse: give a "
                    "shorter step"
                )
        return found


def _kind(file: TomlFile) -> ScenarioKind:
    if "system" not in file.values:
        raise file.error("system", f"is missing; its type is one of {', '.join(_SYSTEMS)}")
    name = file.values["system"].get("type")
    if name is None:
        raise file.error("system.type", f"is missing; it is one of {', '.join(_SYSTEMS)}")
    if not isinstance(name, str):
        raise file.error("system.type", f"must be a text, got {name!r}")
    if name not in _SYSTEMS:
        raise file.error("system.type", f"{name!r} is not known{advice_on(str(name), _SYSTEMS)}")
    return _SYSTEMS[name]


def _takes_law(table: Mapping[str, Any]) -> bool:
    kind = _CLASSES.get(str(table.get("type")))
    return kind is not None and "law" in data.parameters(kind)


def _laws_named(value: Any, key: str) -> dict[str, str]:
    """Return the keys at which files of laws are named, by these names; "" is the scenario's."""
    found: dict[str, str] = {}
    if isinstance(value, list):
        for i, one in enumerate(value):
            found = {**_laws_named(one, f"{key}[{i}]"), **found}
    elif isinstance(value, Mapping):
        for name, one in value.items():
            found = {**_laws_named(one, f"{key}.{name}"), **found}
        named = value.get("law", "")
        if isinstance(named, str) and _takes_law(value):
            found.setdefault(named, f"{key}.law")
    return found


def _with_laws(value: Any, laws: Mapping[str, FrictionLaw], default: Any) -> Any:
    """Return tables with laws in the place of the names of their files."""
    if isinstance(value, list):
        return [_with_laws(one, laws, default) for one in value]
    if not isinstance(value, Mapping):
        return value
    whole = {name: _with_laws(one, laws, default) for name, one in value.items()}
    named = value.get("law", default)
    if isinstance(named, str) and _takes_law(value):
        whole["law"] = laws[named]
    return whole


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
