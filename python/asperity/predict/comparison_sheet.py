"""Identified laws beside a first one: where they differ, and what that means for sliding bodies."""

from __future__ import annotations

import os
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path
from typing import Any

import numpy as np

from asperity._base.arrays import Array, unit_vectors
from asperity._base.report import Facts, Grid, Picture, Section, Text, write_report
from asperity._base.result import NO_UNIT, Axis, Series, Table, TableResult
from asperity._base.storage.files import ResultFolder
from asperity._base.tables import aligned
from asperity.errors import ParameterError
from asperity.identify import IdentifiedLaw, LawComparison, compare_laws
from asperity.identify.estimator.law_comparison import CurveName, probability
from asperity.identify.evidence.coefficient.dependence import LEAST_RATIO
from asperity.law import FrictionLaw

FILES = ("comparison.csv", "comparison.png", "paths.png", "report.html")
"""What `describe_comparison` writes."""

_UNITS: dict[CurveName, str] = {
    "coefficient": NO_UNIT,
    "deflection": "rad",
    "reservoir": NO_UNIT,
    "direction": NO_UNIT,
}
# Launches in degrees, with 1 m/s on a horizontal plane.
_LAUNCHES = np.arange(0.0, 360.0, 30.0)
_SPEED, _GRAVITY = 1.0, 9.81


@dataclass(frozen=True, repr=False)
class ComparisonSheet(TableResult):
    """Laws beside a first one.

    Attributes:
        names: of the files, the first one first.
        laws: likewise, without rate factors, which are not compared.
        comparisons: of each further law with the first one.
        warnings: sentences on what the comparisons take for granted.
    """

    names: tuple[str, ...]
    laws: tuple[FrictionLaw, ...]
    comparisons: tuple[LawComparison, ...]
    warnings: tuple[str, ...] = ()

    @cached_property
    def paths(self) -> list[list[Array]]:
        """Paths in m of bodies that are launched with 1 m/s, by law and launch direction."""
        return [[_path(law, np.deg2rad(degrees)) for degrees in _LAUNCHES] for law in self.laws]

    @cached_property
    def end_distances(self) -> tuple[float, ...]:
        """How far in m the ends of paths are from those of the first law at most, by law."""
        ends = np.array([[path[-1] for path in paths] for paths in self.paths])
        far = np.linalg.norm(ends[1:] - ends[0], axis=-1).max(axis=-1)
        return tuple(far.tolist())

    def verdicts(self) -> list[tuple[str, ...]]:
        """Return for each further law whether it differs, and by how much, as a table of texts."""
        rows: list[tuple[str, ...]] = [
            ("law", "differs", "p", "p of C", "p of D", "coefficient", "deflection", "end of path")
        ]
        ends = self.end_distances
        for name, one, far in zip(self.names[1:], self.comparisons, ends, strict=True):
            mu, angle = one.coefficient.difference, np.rad2deg(one.deflection.difference)
            rows.append(
                (
                    name,
                    "yes" if one.differ else "not found",
                    *(
                        probability(p).removeprefix("= ")
                        for p in (one.p_value, one.reservoir.p_value, one.direction.p_value)
                    ),
                    f"{mu[np.abs(mu).argmax()]:+.4f}",
                    f"{angle[np.abs(angle).argmax()]:+.2f}°",
                    f"{1e3 * far:.2g} mm",
                )
            )
        return rows

    def summary(self) -> str:
        """Return what the comparisons say, in sentences."""
        parts = [
            f"{name} beside {self.names[0]}: {one.summary()}"
            for name, one in zip(self.names[1:], self.comparisons, strict=True)
        ]
        return "\n\n".join([*parts, *(f"warning: {one}" for one in self.warnings)])

    def text(self) -> str:
        """Return all there is to say as text."""
        table = aligned(self.verdicts(), right=(2, 3, 4, 5, 6, 7))
        return (
            f"Beside {self.names[0]}, the largest changes over the sliding direction, and of the "
            f"end of the path after a launch with {_SPEED:g} m/s:\n\n{table}\n\n{self.summary()}"
        )

    def __repr__(self) -> str:
        return f"<ComparisonSheet: {', '.join(self.names)}>"

    def _table(self) -> Table:
        first = self.comparisons[0]
        series = {
            f"{curve}_{word}": Series(
                np.array([getattr(getattr(one, curve), word) for one in self.comparisons]).T,
                ("phi", "law"),
                unit,
                f"{curve}, {meaning}",
            )
            for curve, unit in _UNITS.items()
            for word, meaning in (
                ("difference", "law less the first one"),
                ("half_width", "of the band of the difference"),
            )
        }
        axes = {"phi": Axis(first.phi, "rad", "direction"), "law": Axis(self.names[1:], "", "law")}
        return Table(axes, series, {"first": self.names[0], "confidence": first.confidence})

    def data(self) -> dict[str, Any]:
        """Return the same as numbers and texts, for ``--json``."""
        return {
            "first": self.names[0],
            "confidence": self.comparisons[0].confidence,
            "warnings": list(self.warnings),
            "launches": np.deg2rad(_LAUNCHES).tolist(),
            "launch_speed": _SPEED,
            "ends": [[path[-1].tolist() for path in paths] for paths in self.paths],
            "comparisons": [
                {
                    "law": name,
                    "differs": one.differ,
                    "p_value": one.p_value,
                    "p_value_reservoir": one.reservoir.p_value,
                    "p_value_direction": one.direction.p_value,
                    "end_distance": far,
                    "phi": one.phi.tolist(),
                    **{
                        f"{curve}_{word}": getattr(getattr(one, curve), word).tolist()
                        for curve in _UNITS
                        for word in ("difference", "half_width")
                    },
                    "parameters": {
                        key: dict(change._parameters) for key, change in one.parameters.items()
                    },
                }
                for name, one, far in zip(
                    self.names[1:], self.comparisons, self.end_distances, strict=True
                )
            ],
        }

    def write(self, folder: Path) -> None:
        """Write the files into a folder."""
        from matplotlib.figure import Figure

        from asperity.plot import plot_law_comparison, style
        from asperity.plot.look import png

        self.to_csv(folder / "comparison.csv")
        with style():
            changes = Figure(figsize=(9.0, 6.4), layout="constrained")
            for ax, quantity in zip(changes.subplots(2, 2).flat, _UNITS, strict=True):
                for k, one in enumerate(self.comparisons):
                    options = {"color": _color(k + 1), "label": self.names[k + 1]}
                    plot_law_comparison(one, ax=ax, quantity=quantity, **options)
                if ax.get_legend() is not None:
                    ax.get_legend().remove()
            lines = changes.axes[0].get_legend_handles_labels()
            changes.legend(*lines, loc="outside upper center", ncols=3)
            sliding = Figure(figsize=(5.6, 5.2), layout="constrained")
            ax = sliding.add_subplot(aspect="equal", xlabel="$x_1$ in m", ylabel="$x_2$ in m")
            for k, (name, paths) in enumerate(zip(self.names, self.paths, strict=True)):
                for number, path in enumerate(paths):
                    # What later lines cover is seen beside them.
                    width = 3.0 / (1 + k)
                    ax.plot(*path.T, color=_color(k), linewidth=width, label="" if number else name)
            sliding.legend(loc="outside upper center", ncols=3)
        pictures = [
            Picture("changes over the direction", png(changes, 150)),
            Picture(f"paths after a launch with {_SPEED:g} m/s", png(sliding, 150)),
        ]
        for file, picture in zip(FILES[1:3], pictures, strict=True):
            (folder / file).write_bytes(picture.png)
        header, *rows = self.verdicts()
        parts = [
            Section(
                f"{name} beside {self.names[0]}",
                Facts([("result", line) for line in one.summary().splitlines()]),
            )
            for name, one in zip(self.names[1:], self.comparisons, strict=True)
        ]
        said = [Text(one, "warning") for one in self.warnings]
        title = f"Friction laws beside {self.names[0]}"
        write_report(
            folder / FILES[3], title, [Section("", *said, Grid(header, rows), *pictures), *parts]
        )


def describe_comparison(
    files: Sequence[str | os.PathLike[str]],
    *,
    confidence: float = 0.95,
    same_calibration: bool = False,
    out: str | os.PathLike[str] | None = None,
) -> ComparisonSheet:
    """Compare identified laws with a first one; write what `FILES` lists if a folder is given.

    Args:
        files: of two laws or more, as ``asperity identify`` writes them; the first one is the one
            that the others are compared with.
        confidence: as of `identify.compare_laws`.
        same_calibration: likewise.
        out: folder; it is complete or not there.

    Raises:
        ConfigurationError: with file, line and key of what is wrong in a file.
        ParameterError: if there are fewer than two files, or if a file holds no covariance.
    """
    if len(files) < 2:
        raise ParameterError("LAW", "must be two files or more")
    folder = None if out is None else ResultFolder(Path(out), FILES, files)
    laws = [IdentifiedLaw.load(file) for file in files]
    compared = []
    for file, law in zip(files[1:], laws[1:], strict=True):
        try:
            one = compare_laws(
                laws[0], law, confidence=confidence, same_calibration=same_calibration
            )
        except ParameterError as error:
            words = {"first": os.fspath(files[0]), "second": os.fspath(file)}
            raise type(error)(words.get(error.argument, error.argument), error.message) from None
        compared.append(one)
    names = _names(files)
    sheet = ComparisonSheet(
        names,
        tuple(law.law.replace(rate=None) for law in laws),
        tuple(compared),
        tuple(_taken_for_granted(laws, names)),
    )
    if folder is not None:
        with folder.filled() as place:
            sheet.write(place)
    return sheet


def _taken_for_granted(laws: Sequence[IdentifiedLaw], names: Sequence[str]) -> Iterator[str]:
    """Yield sentences on laws that are not independent of the first one, or of another load."""
    first, known = laws[0]._loads, laws[0].provenance.files
    for law, name in zip(laws[1:], names[1:], strict=True):
        files = law.provenance.files
        if law == laws[0]:
            yield (
                f"{name} holds the same law as {names[0]}: bands are those of two independent "
                "measurements"
            )
            continue
        # The first file is that of a run, others may be of the machine.
        both = {one for one in known if one in files and one[1]}
        shared = [one[0] for one in (*known[:1], *files[:1]) if one in both]
        if shared:
            yield (
                f"{name} and {names[0]} both come from {shared[0]}: they are not independent, and "
                "the bands do not hold"
            )
        loads = law._loads
        differ = len(loads) != len(first) or any(
            max(pair) > LEAST_RATIO * min(pair)
            for pair in zip(sorted(loads), sorted(first), strict=True)
        )
        if loads and first and differ:
            under = [", ".join(f"{load:g}" for load in one) for one in (loads, first)]
            yield (
                f"{name} was recorded under {under[0]} N, {names[0]} under {under[1]} N: a "
                "difference may be that of the load"
            )
    single = [name for law, name in zip(laws, names, strict=True) if law._is_of_one_run]
    if single:
        yield (
            f"of {', '.join(dict.fromkeys(single))} one run was recorded: bands leave out what "
            "setting down the pin anew changes, and a difference may be that of the mounting"
        )


def _names(files: Sequence[str | os.PathLike[str]]) -> tuple[str, ...]:
    """Return the files without the folders that they have in common."""
    paths = [Path(os.path.abspath(file)) for file in files]
    try:
        shared = Path(os.path.commonpath([path.parent for path in paths]))
    except ValueError:
        # Drives of Windows have no folder in common.
        return tuple(path.as_posix() for path in paths)
    return tuple(path.relative_to(shared).as_posix() for path in paths)


def _color(number: int) -> str:
    return f"C{number}"


def _path(law: FrictionLaw, phi: float) -> Array:
    from asperity.runs import integrate
    from asperity.system import SlidingPoint

    least = float(np.min(law.reservoir.radius(np.linspace(0.0, 2.0 * np.pi, 73))))
    # Friction against the sliding may be less than C holds, where D turns the force.
    t_end = 10.0 * _SPEED / (least * _GRAVITY)
    motion = integrate(
        SlidingPoint(1.0, law=law, gravity=_GRAVITY),
        t_end=t_end,
        u0=_SPEED * unit_vectors(np.array(phi)),
        sample_every=t_end / 1000,
    )
    return np.asarray(motion.q)
