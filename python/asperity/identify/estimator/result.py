"""What all fits have in common: parameters, covariance, warnings, a law to save, text, a table."""

from __future__ import annotations

import os
from collections.abc import Mapping
from pathlib import Path
from typing import TYPE_CHECKING, ClassVar

import numpy as np

from asperity._base.arrays import Array
from asperity._base.result import Axis, Series, Table
from asperity._base.storage.result_file import SavedResult
from asperity._base.value import Record
from asperity.identify.estimator.covariance import Covariance
from asperity.identify.estimator.identified_law import IdentifiedLaw, identified
from asperity.identify.models.coordinates import Estimate
from asperity.identify.models.names import name_of
from asperity.identify.models.structure import PlanarStructure, Structure
from asperity.law import FrictionLaw, Provenance


class LawFit(SavedResult, Record):
    """A law that was fitted to measurements, with its uncertainty."""

    _unit: ClassVar[str] = "-"
    """Of parameters that are no angles."""
    _rms_unit: ClassVar[str] = "N"

    # The kinds of evidence give what follows, as fields or properties.
    if TYPE_CHECKING:

        @property
        def confidence(self) -> float | None:
            """Level of the confidence intervals; None for none."""

        @property
        def law(self) -> FrictionLaw:
            """The friction law."""

        @property
        def parameters(self) -> Mapping[str, Estimate]:
            """Estimates with confidence intervals by name."""

        @property
        def covariance(self) -> Covariance | None:
            """Covariance of the coordinates by its causes."""

        @property
        def rms(self) -> float:
            """Root mean square of forces in N or of distances in m, of wrenches relative."""

        @property
        def warnings(self) -> tuple[str, ...]:
            """Sentences on what the data cannot tell."""

        @property
        def coordinates(self) -> Array:
            """What was fitted, in the order of the models."""

    @property
    def _structure(self) -> Structure:
        """What the coordinates are."""
        raise NotImplementedError

    def _words(self) -> tuple[str, str, str]:
        """Return what is fitted to what and how well, what follows the parameters, a short name."""
        raise NotImplementedError

    @property
    def identified_law(self) -> IdentifiedLaw:
        """The law with the values of its parameters and their covariance, to sample and to save.

        Raises:
            FitError: if the fitted D is not convex.
        """
        return identified(self.law, self._structure, self.coordinates, self.covariance)

    def save_law(
        self, path: str | os.PathLike[str], *, provenance: Provenance | None = None
    ) -> Path:
        """Write the law, its parameters and their covariance to a readable TOML file.

        ``FrictionLaw.load`` reads the law in it, `IdentifiedLaw.load` all of it, and
        ``asperity simulate --bands`` takes it.

        Args:
            path: of the file; it is complete or not there.
            provenance: where the measurement comes from, to keep with the law.

        Returns:
            The path.

        Raises:
            FitError: if the fitted D is not convex.
        """
        law = self.identified_law
        (law if provenance is None else law.replace(provenance=provenance)).save(path)
        return Path(path)

    def summary(self) -> str:
        """Return the models, their parameters with confidence intervals, and warnings."""
        fitted, more, _ = self._words()
        level = "" if self.confidence is None else f" with {self.confidence:.0%} intervals"
        lines = [fitted, f"The parameters{level} are"]
        lines += [
            f"{name}{' in rad' if name.endswith('.angle') else ''}: {one}."
            for name, one in self.parameters.items()
        ]
        sentences = [f"{one[0].upper()}{one[1:]}." for one in self.warnings]
        return "\n".join([*lines, *([more] if more else []), *sentences])

    def __repr__(self) -> str:
        return f"<{type(self).__name__}: {'; '.join([self._words()[2], *self.warnings])}>"

    def _table(self) -> Table:
        words = {
            "unit": "of the estimate",
            "value": "estimate, angles in rad",
            "low": "lower end of the confidence interval",
            "high": "upper end of the confidence interval",
            "standard_error": "standard deviation of the estimate",
            "identifiable": "whether the data determine it",
        }
        listed = list(self.parameters.values())
        columns = {name: [getattr(one, name) for one in listed] for name in words if name != "unit"}
        columns["unit"] = [
            "rad" if name.endswith(".angle") else self._unit for name in self.parameters
        ]
        series = {
            name: Series(np.array(columns[name]), ("parameter",), "", text)
            for name, text in words.items()
        }
        axis = Axis(tuple(self.parameters), "", "parameter")
        return Table({"parameter": axis}, series, {"rms": self.rms, "rms_unit": self._rms_unit})


class PlanarFit(LawFit):
    """A law in the plane, with models of C and of D."""

    if TYPE_CHECKING:

        @property
        def _structure(self) -> PlanarStructure: ...

    @property
    def reservoir_model(self) -> str:
        """Name of the model of C."""
        return name_of(self._structure.reservoir)

    @property
    def direction_model(self) -> str:
        """Name of the model of D."""
        return name_of(self._structure.direction)
