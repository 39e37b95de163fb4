"""A law fitted to measured paths: its parameters with their uncertainty, launches, residuals."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import KW_ONLY
from typing import Annotated, Any, TypeAlias

import numpy as np

from asperity import law, sets
from asperity._base.arrays import Array
from asperity._base.result import counted
from asperity._base.storage import data as stored
from asperity._base.value import Given, Record, View, a_tuple, field
from asperity.identify.estimator.covariance import Covariance
from asperity.identify.estimator.identified_law import IdentifiedLaw
from asperity.identify.estimator.loss import Loss
from asperity.identify.estimator.result import PlanarFit
from asperity.identify.evidence.paths.launch import QUANTITIES, UNITS
from asperity.identify.models.coordinates import Estimate
from asperity.identify.models.names import DIRECTION_KINDS, RESERVOIR_KINDS
from asperity.identify.models.structure import PlanarStructure
from asperity.law import FrictionLaw


class FittedPath(Record):
    """A measured path beside the simulated one, and how it was launched.

    Args:
        name: of the path: its place in the sequence, or its file.
        time: in s, ``(n,)``.
        position: measured, in m, ``(n, 2)``.
        position_error: its standard errors in m, ``(n, 2)``.
        simulated: positions of the fitted law in m, ``(n, 2)``.
        launch_speed: in m/s, with its interval from the errors of the positions.
        launch_direction: in rad.
        launch_time: in s, in the time of the path.
        launch_x1: place in m.
        launch_x2: place in m.
    """

    name: str
    _: KW_ONLY
    time: Array
    position: Array
    position_error: Array
    simulated: Array
    launch_speed: Estimate
    launch_direction: Estimate
    launch_time: Estimate
    launch_x1: Estimate
    launch_x2: Estimate

    @property
    def launch(self) -> Mapping[str, Estimate]:
        """The launch by name: ``speed``, ``direction``, ``time``, ``x1``, ``x2``."""
        return View({name: getattr(self, f"launch_{name}") for name in QUANTITIES})

    @property
    def rms(self) -> float:
        """Root mean square of the distances of simulated and measured points in m."""
        return float(np.sqrt(np.mean(np.sum((self.simulated - self.position) ** 2, axis=1))))


_Sentences: TypeAlias = Annotated[Given[Sequence[str], tuple[str, ...]], a_tuple]


class PathFit(PlanarFit):
    """A law fitted to measured paths, with its uncertainty; made by `fit_paths`.

    What `save` writes holds the measured and the simulated paths and all that follows from them;
    the law alone, a small file to read, is written by `save_law`.

    Attributes:
        paths: measured and simulated, with their launches.
        found: the law with the covariance of its parameters: the scatter between paths takes the
            place of that between turns, the error of the length scale that of the calibration.
        parameters: estimates with confidence intervals by name, as those of `Fit`.
        loss: of the components of the residuals in standard errors.
        misfit: root mean square of these, corrected for the number of unknowns, or the scale of a
            robust loss: 1 if the law and the stated errors are right.
        slope_error: by how much the derivatives by differences of paths differ between two step
            sizes, relative to them.
        degrees_of_freedom: of the scatter between paths, the least of all parameters; NaN without
            confidence intervals.
        limits: sentences on what no such paths tell.
        warnings: sentences on what these paths do not tell or the models do not hold.
    """

    _rms_unit = "m"

    paths: Annotated[Given[Sequence[FittedPath], tuple[FittedPath, ...]], a_tuple]
    _: KW_ONLY
    found: IdentifiedLaw
    parameters: Mapping[str, Estimate]
    loss: Loss
    confidence: float | None
    misfit: float
    slope_error: float
    degrees_of_freedom: float
    limits: _Sentences = field(default=())
    warnings: _Sentences = field(default=())

    _picture = "plot_fitted_paths"

    @classmethod
    def _known(cls) -> stored.Kinds:
        return _KNOWN

    def __len__(self) -> int:
        return len(self.paths)

    @property
    def law(self) -> FrictionLaw:
        """The friction law; D has the largest scale inside C."""
        return self.found.law

    @property
    def identified_law(self) -> IdentifiedLaw:
        """The law with the values of its parameters and their covariance, to sample and to save."""
        return self.found

    @property
    def covariance(self) -> Covariance | None:
        """Covariance of the coordinates by its causes; None without confidence intervals."""
        return None if self.found.turns is None else self.found.covariances

    @property
    def _structure(self) -> PlanarStructure:
        structure = self.found._structure
        assert isinstance(structure, PlanarStructure)
        return structure

    @property
    def points(self) -> int:
        """Number of measured points."""
        return sum(len(path.time) for path in self.paths)

    @property
    def rms(self) -> float:
        """Root mean square of the distances of simulated and measured points in m."""
        squares = sum(len(path.time) * path.rms**2 for path in self.paths)
        return float(np.sqrt(squares / self.points))

    def launch_columns(self) -> dict[str, Any]:
        """Return the launches as columns by title, a row per path."""
        columns: dict[str, Any] = {"path": [path.name for path in self.paths]}
        for name, unit in zip(QUANTITIES, UNITS, strict=True):
            own = [path.launch[name] for path in self.paths]
            columns[f"{name} [{unit}]"] = np.array([one.value for one in own])
            columns[f"{name} error [{unit}]"] = np.array([one.standard_error for one in own])
        columns["points"] = np.array([len(path.time) for path in self.paths])
        columns["rms [m]"] = np.array([path.rms for path in self.paths])
        return columns

    def _words(self) -> tuple[str, str, str]:
        what = f"{counted(self.points, 'point')} of {counted(len(self), 'path')}"
        speeds = [path.launch_speed.value for path in self.paths]
        lines = [f"Launch speeds are {min(speeds):.4g} to {max(speeds):.4g} m/s."]
        if np.isfinite(self.degrees_of_freedom):
            lines.append(
                "Confidence intervals follow from the scatter between paths, with "
                f"{self.degrees_of_freedom:.2g} degrees of freedom or more: more paths narrow them."
            )
        lines += [f"{one[0].upper()}{one[1:]}." for one in self.limits]
        models = f"reservoir={self.reservoir_model!r}, direction={self.direction_model!r}"
        return (
            f"The models {self.reservoir_model} for C and {self.direction_model} for D are fitted "
            f"to {what}; simulated paths are {1e3 * self.rms:.4g} mm from them (root mean square), "
            f"{self.misfit:.3g} times what their standard errors say.",
            "\n".join(lines),
            f"{models}, {what}",
        )


_KNOWN: stored.Kinds = {
    **stored.classes(sets, law),
    **RESERVOIR_KINDS,
    **DIRECTION_KINDS,
    **{one.__name__: one for one in (PathFit, FittedPath, Estimate, IdentifiedLaw, Loss, dict)},
}
