"""A law fitted to measured forces: sets, parameters with their uncertainty, residuals, report."""

from __future__ import annotations

import os
from collections.abc import Mapping
from dataclasses import KW_ONLY
from functools import cached_property
from pathlib import Path
from typing import Annotated, Any, ClassVar

import numpy as np
from numpy.typing import ArrayLike, NDArray

from asperity._base import arrays
from asperity._base.arrays import Array
from asperity._base.result import counted
from asperity._base.storage import data as stored
from asperity._base.value import View, field
from asperity.identify.estimator.associativity import Associativity, associativity_of
from asperity.identify.estimator.comparison import Candidate, Comparison
from asperity.identify.estimator.covariance import Bands, Covariance, estimates, widths
from asperity.identify.estimator.descent import Descent, Sums
from asperity.identify.estimator.loss import Loss
from asperity.identify.estimator.mistakes import Mistake
from asperity.identify.estimator.result import PlanarFit
from asperity.identify.evidence.forces import defects
from asperity.identify.evidence.forces.bins import Bins, grouped
from asperity.identify.evidence.forces.causes import Causes, means_of, weighty
from asperity.identify.evidence.forces.coverage import Coverage, coverage
from asperity.identify.evidence.forces.defects import Defect
from asperity.identify.evidence.forces.diagnostics import UNITS_AND_SCALE, gaps, warnings_of
from asperity.identify.evidence.forces.drift import Drift, drift
from asperity.identify.evidence.forces.mistakes import mistake
from asperity.identify.evidence.forces.mountings import Mountings
from asperity.identify.evidence.forces.normal_equations import Family
from asperity.identify.evidence.forces.outliers import Outliers, outliers
from asperity.identify.evidence.forces.samples import (
    Samples,
    channels_turn,
    frozen,
    is_angled,
    runs_of,
    samples_of,
)
from asperity.identify.evidence.forces.selection import compare_models
from asperity.identify.forces.measured_sets import MeasuredSets
from asperity.identify.forces.processing import ProcessedData
from asperity.identify.models.coordinates import Estimate, at_bounds
from asperity.identify.models.names import DIRECTION_KINDS, RESERVOIR_KINDS
from asperity.identify.models.structure import PlanarStructure
from asperity.identify.records.calibration import Calibration
from asperity.identify.records.record import Processing, RawData, Recording
from asperity.identify.records.resolution import Steps, coarse_channels
from asperity.law import FrictionLaw
from asperity.sets import StarSet

# Means for figures are taken over half a degree.
_WIDTH = 5


class Fit(PlanarFit):
    """A law fitted to measured forces, with its uncertainty; made by `fit_law`.

    What `save` writes holds all readings of the measurement with calibration and records without
    load, 40 bytes per sample before compression: intervals, residuals, means and the comparison of
    models follow from them, and those of a loaded fit are the same to the bit. The law alone, a
    small file to read, is written by `save_law`.

    Args:
        data: as for `fit_law`.
        family: the models.
        descent: where their coordinates ended.
        loss: of the residuals, with its scale.
        confidence: level of the confidence intervals; None for none.
        compared: with other models, where they were.
        held: whether samples on the axes of D hold its angle.
        samples: of `data`, if they are at hand.
        bins: means of these, likewise.

    Attributes:
        coordinates: of the models, ``(k,)``.
        covariance: of these by its causes; None without confidence intervals.
    """

    data: Annotated[Any, frozen]
    family: Family
    descent: Descent
    loss: Loss
    confidence: float | None
    compared: Comparison | None = None
    _: KW_ONLY
    held: bool = False
    coordinates: Array = field(init=False)
    covariance: Covariance | None = field(init=False)

    _picture = "plot_fitted_sets"
    _samples: ClassVar[Samples]
    _causes: ClassVar[Causes]

    def __init__(
        self, *args: Any, samples: Samples | None = None, bins: Bins | None = None, **kwargs: Any
    ) -> None:
        super().__init__(*args, **kwargs)
        # What follows from the data is no parameter: it is neither compared nor kept by pickle.
        own = samples_of(self.data) if samples is None else samples
        means = means_of(own, self.loss) if bins is None else bins
        causes = Causes(self.family, self.descent, self.loss, self.data, own, means)
        self._keep(
            coordinates=arrays.read_only(self.descent.p),
            covariance=None if self.confidence is None else causes.covariance(held=self.held),
            _samples=own,
            _causes=causes,
        )

    @property
    def _structure(self) -> PlanarStructure:
        return self.family.structure

    def _words(self) -> tuple[str, str, str]:
        models = f"reservoir={self.reservoir_model!r}, direction={self.direction_model!r}"
        return (
            f"The models {self.reservoir_model} for C and {self.direction_model} for D are fitted "
            f"to {counted(self.samples, 'sample')} in {counted(self.turns, 'turn')}; forces differ "
            f"from the model by {self.rms:.4g} N (root mean square). There are forces in "
            f"{self.coverage}.",
            UNITS_AND_SCALE,
            f"{models}, {self.samples} samples, {self.turns} turns",
        )

    @classmethod
    def _known(cls) -> stored.Kinds:
        return _KNOWN

    @property
    def samples(self) -> int:
        """Number of samples in complete turns."""
        return len(self._samples)

    @property
    def turns(self) -> int:
        """Number of complete turns."""
        return self._samples.turns

    @cached_property
    def reservoir(self) -> StarSet:
        """The force reservoir C, per unit normal force."""
        return self.family.reservoir.reservoir(self.coordinates[: self.family.split])

    @cached_property
    def direction(self) -> StarSet:
        """The direction set D, of any scale."""
        return self.family.direction.direction(self.coordinates[self.family.split :])

    @cached_property
    def law(self) -> FrictionLaw:
        """The friction law; D has the largest scale inside C.

        A law knows nothing of its uncertainty: `save_law` writes it with the covariance of its
        parameters, which bands of motions need, and ``fit.law.save`` without.

        Raises:
            FitError: if the fitted D is not convex.
        """
        return FrictionLaw(self.reservoir, self.direction)

    @cached_property
    def parameters(self) -> Mapping[str, Estimate]:
        """Estimates with confidence intervals by name: ``reservoir.a``, ``direction.ratio`` ….

        Semi-axes are per unit normal force, angles in rad within ±45°. An angle is identifiable if
        the set differs from one that has none (at the level 0.01); the scale of D never is. Nor is
        what ended at a bound of its model or strokes in few directions leave open, nor the shape of
        C where forces leap over 30° and more of their directions; `warnings` says so.
        """
        told = ~(self.at_bounds | self.undetermined)
        if self.gaps:
            told[: self.family.split] = False
        return View(
            estimates(
                self.family.structure,
                self.coordinates,
                told,
                covariance=self.covariance,
                confidence=self.confidence,
            )
        )

    @cached_property
    def warnings(self) -> tuple[str, ...]:
        """Sentences on what the data cannot tell or the models cannot hold."""
        return warnings_of(self)

    @cached_property
    def missing(self) -> Mapping[str, tuple[str, Array]]:
        """Causes of error that no record tells, with what is missing and what is at stake.

        These are ``"calibration"`` and ``"zeros"``; what is at stake is how far an error of 1 % of
        the normal force, or of a gain, in one channel would move the coordinates. There are none
        where forces are given as arrays: what is known of their errors is not known here.
        """
        return View(self._causes.missing())

    @cached_property
    def at_bounds(self) -> NDArray[np.bool_]:
        """Which coordinates ended at a bound of their model, in the order of the parameters."""
        return at_bounds(self.coordinates, self.family.coordinates)

    @cached_property
    def gaps(self) -> tuple[tuple[float, float], ...]:
        """Arcs of directions θ in rad that the force leaps over, where C has a shape to be told."""
        has_shape = len(self.family.reservoir.coordinates) > 1
        return tuple(gaps(*self.means)) if has_shape else ()

    @cached_property
    def coverage(self) -> Coverage:
        """The sliding directions that hold forces, and the gaps between them."""
        return coverage(self.means[0], is_symmetric=self.family.is_symmetric)

    @cached_property
    def undetermined(self) -> NDArray[np.bool_]:
        """Which coordinates strokes in few directions leave open, in the order of the parameters.

        Without intervals, none are known to be.
        """
        if self.covariance is None or not self.coverage.gaps:
            return np.zeros(self.family.size, dtype=np.bool_)
        return self._causes.undetermined(self._width(np.eye(self.family.size)))

    @cached_property
    def defects(self) -> Mapping[str, Defect]:
        """Asymmetry, closure and lack of fit with whether they matter; none if data are sparse."""
        samples = weighty(self._samples, self.loss)
        left = self.family.left(samples, self.coordinates)
        return View(defects.all_of(samples, left, self.data))

    @cached_property
    def mistake(self) -> Mistake | None:
        """A wrong sign or swapped channels that explain a lack of fit; None if none does."""
        found = self.defects.get("lack of fit")
        if found is None or not found.matters:
            return None
        means = grouped(weighty(self._samples, self.loss), 1).bins(width=_WIDTH)
        turning = channels_turn(self.data)
        return mistake(self.family, means, found.size, turning=turning, angled=is_angled(self.data))

    @cached_property
    def associativity(self) -> Associativity:
        """Whether the force across is the derivative of the force along, that is, D = C.

        A number with its confidence interval, beside the verdict ``law.is_maximal_monotone`` on the
        fitted law, which knows nothing of uncertainty.

        Reference: [WL19] Def. 12, Prop. 2–4.
        """

        def force(phi: Array, p: Array) -> Array:
            return self.family.forces(phi, p)[0]

        return associativity_of(
            force, self.coordinates, self.covariance, confidence=self.confidence
        )

    @cached_property
    def outliers(self) -> Outliers:
        """Samples that are farther from the model than noise explains."""
        return outliers(self._samples, self.residuals)

    @property
    def mountings(self) -> Mountings | None:
        """How the second of two runs differs from the first; None for one run and for many."""
        return self._causes.mountings

    @cached_property
    def drift(self) -> Drift:
        """The trend of the forces over the turns of a run."""
        samples = self._samples
        return drift(samples, samples.force - self.residuals, runs_of(samples, self.data))

    @cached_property
    def coarse_channels(self) -> tuple[Steps, ...]:
        """Channels of the sensor whose steps are not small beside their noise."""
        raw = getattr(self.data, "raw", None)
        return () if raw is None else tuple(coarse_channels(raw))

    @cached_property
    def residuals(self) -> Array:
        """Measured minus model force of all samples, in N, ``(n, 2)``; in turns or not."""
        return self.family.left(self._samples, self.coordinates).force

    @cached_property
    def means(self) -> tuple[Array, Array]:
        """Sliding directions φ in rad and mean forces −λ/λ_N there, ``(n,)`` and ``(n, 2)``."""
        bins = grouped(weighty(self._samples, self.loss), 1).bins(width=_WIDTH)
        return bins.phi, bins.force

    @cached_property
    def measured(self) -> MeasuredSets:
        """The points of bdry C and of D that follow from the mean forces without a model."""
        return MeasuredSets(*self.means)

    @property
    def joint(self) -> bool:
        """Whether C and D were fitted together."""
        return self.family.joint

    @property
    def rms(self) -> float:
        """Root mean square of a component of the residuals in N, or the scale of a robust loss."""
        if not self.loss.is_linear:
            return self.loss.scale
        return float(np.sqrt(max(self.descent.cost, 0.0) / (2 * self.samples)))

    def forces(self, phi: ArrayLike) -> Array:
        """Return −λ/λ_N of the model while sliding along φ in rad, ``(n, 2)``."""
        angles = arrays.array(phi, "phi", (None,))
        return self.family.forces(angles, self.coordinates)[0]

    def bands(self, phi: ArrayLike) -> Bands:
        """Return the model forces at sliding directions φ in rad with confidence bands."""
        angles = arrays.array(phi, "phi", (None,))
        force, derivative = self.family.forces(angles, self.coordinates)
        e = arrays.unit_vectors(angles)
        turned = np.stack([-e[:, 1], e[:, 0]], axis=-1)

        def both(first: Array, second: Array) -> Array:
            return np.stack([self._width(first.T), self._width(second.T)], axis=-1)

        against, across = (np.einsum("knc,nc->kn", derivative, axis) for axis in (e, turned))
        resistance = np.stack([(force * e).sum(axis=-1), (force * turned).sum(axis=-1)], axis=-1)
        return Bands(
            angles,
            force,
            both(derivative[..., 0], derivative[..., 1]),
            resistance,
            both(against, across),
        )

    def radius_band(self, theta: ArrayLike) -> tuple[Array, Array, Array]:
        """Return r_C at angles θ in rad and the ends of its confidence band, each ``(n,)``."""
        angles = arrays.array(theta, "theta", (None,))
        part = slice(0, self.family.split)
        log_radius, _, by = self.family.reservoir.log_radius(
            np.cos(angles), np.sin(angles), self.coordinates[part]
        )
        directions = np.zeros((angles.size, self.family.size))
        directions[:, part] = by.T
        width = self._width(directions)
        return np.exp(log_radius), np.exp(log_radius - width), np.exp(log_radius + width)

    @cached_property
    def comparison(self) -> Comparison:
        """Other models of the same data, by BIC and by leave-one-turn-out cross-validation."""
        return self.compared or compare_models(self.data, loss=self.loss.kind)

    def report(self, path: str | os.PathLike[str], *, title: str = "Friction law") -> Path:
        """Write one HTML file with parameters, figures and the comparison of models.

        Args:
            path: of the file, ending in .html; it is complete or not there.
            title: heading.

        Returns:
            The path.

        Raises:
            ParameterError: if the path has another ending.
        """
        from asperity.identify.evidence.forces.report import write_report

        return write_report(self, path, title)

    def _width(self, directions: Array) -> Array:
        return widths(self.covariance, directions, self.confidence)[0]


_KNOWN: stored.Kinds = {
    one.__name__: one
    for one in (
        Fit,
        ProcessedData,
        RawData,
        Recording,
        Calibration,
        Processing,
        Family,
        *RESERVOIR_KINDS.values(),
        *DIRECTION_KINDS.values(),
        Descent,
        Sums,
        Loss,
        Comparison,
        Candidate,
    )
}
