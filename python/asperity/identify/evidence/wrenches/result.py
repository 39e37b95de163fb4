"""Fitted laws of patches: parameters with bands by blocks, residuals, comparison."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import KW_ONLY
from functools import cached_property
from typing import Annotated, Any, ClassVar

import numpy as np
from numpy.typing import ArrayLike, NDArray

from asperity._base import arrays
from asperity._base.arrays import Array
from asperity._base.result import counted
from asperity._base.storage import data as stored
from asperity._base.value import Positive, View, unchecked
from asperity.identify.estimator.comparison import Comparison
from asperity.identify.estimator.covariance import Covariance, level_of, widths
from asperity.identify.estimator.descent import Found, Sums
from asperity.identify.estimator.leverage import Leverage, leverage_of
from asperity.identify.estimator.loss import Loss
from asperity.identify.estimator.mistakes import Mistake
from asperity.identify.estimator.result import LawFit
from asperity.identify.evidence.wrenches.comparison import compare
from asperity.identify.evidence.wrenches.mistakes import mistake
from asperity.identify.evidence.wrenches.pairs import Pairs
from asperity.identify.evidence.wrenches.solving import Labels, sums
from asperity.identify.models.coordinates import Estimate, Scale
from asperity.identify.models.patches import (
    PATCH_KINDS,
    SPOT,
    EllipsoidPatch,
    ExtendedPatch,
    ExtendedPoints,
    PatchModel,
    PointsPatch,
    Reported,
)
from asperity.identify.models.structure import PatchStructure
from asperity.law import FrictionLaw
from asperity.sets import StarSet

# Level of the test whether there is any anisotropy, and the step of derivatives of parameters.
_LEVEL, _STEP = 0.01, 1e-5
# Laws that are so near to the wrench leave nothing to be explained; those that are so far do not
# fit, relative to the wrench.
_CLOSE, _FAR_OFF = 0.1, 0.5
# A parameter that is known to a factor of ten is not known.
_DECADE = math.log(10.0)
# Spots of support points that are larger than this part of the lever of torques are no points.
_THICK = 0.1
# Supports beyond so many radii of the patch are no places of it.
_FAR = 4.0
# Points whose share of the load is below this have no place.
_LIGHT = 1e-3


def _says_nothing(one: Reported) -> float:
    """Return the half-width of an interval that holds all that a parameter may be."""
    if one.scale is Scale.LOG:
        return _DECADE
    # Correlations lie within ±1; places may be anywhere.
    return 1.0 if one.scale is Scale.PLAIN and not one.is_length else math.inf


class BlockFit(LawFit):
    """What fits of wrenches have in common.

    What `save` writes holds the pairs, the model and where its coordinates ended: intervals and
    comparisons follow from them.

    Args:
        pairs: wrenches and twists.
        model: the law's family.
        found: where its coordinates ended.
        loss: of the components of the wrench, with the scale of those that are no outliers.
        blocks: which block each pair is in.
        folds: which part each pair is in, of those that are left out in turn.
        length: ℓ in m, or in whatever unit places are in.
        confidence: level of the confidence intervals; None for none.
    """

    pairs: Pairs
    _: KW_ONLY
    model: PatchModel
    found: Found
    loss: Loss
    blocks: Annotated[Labels, unchecked]
    folds: Annotated[Labels, unchecked]
    length: Positive
    confidence: Annotated[float | None, level_of]

    # Those of forces, loads and lengths are the user's.
    _unit = ""
    _rms_unit = "1"
    _in_ground: ClassVar[bool] = False
    """Whether wrenches and twists were given in the axes of the ground."""

    def _complete(self, given: dict[str, Any]) -> None:
        for name in ("blocks", "folds"):
            labels = arrays.array(given[name], name, (len(given["pairs"]),))
            given[name] = labels.astype(np.intp)

    @property
    def coordinates(self) -> Array:
        """Where the search ended, in the order of the model's coordinates."""
        return self.found.p

    @property
    def _structure(self) -> PatchStructure:
        return PatchStructure(self.model)

    @cached_property
    def residuals(self) -> Array:
        """Measured wrench minus that of the law, ``(n, 3)``."""
        return self.pairs.wrench - self.model.both(self.coordinates, self.pairs)[0]

    @property
    def rms(self) -> float:
        """Root mean square of the residual wrench relative to that of the wrench."""
        return math.sqrt(float((self.residuals**2).sum() / (self.pairs.wrench**2).sum()))

    @property
    def _typical(self) -> float:
        """Median residual relative to the median component, which outliers hardly move."""
        usual = float(np.median(np.abs(self.pairs.wrench)))
        return float(np.median(np.abs(self.residuals))) / usual if usual > 0.0 else math.inf

    @property
    def converged(self) -> bool:
        """Whether the search has ended by itself, not at its longest."""
        return self.found.converged

    @property
    def evaluations(self) -> int:
        """How often wrenches were computed."""
        return self.found.evaluations

    @cached_property
    def law(self) -> FrictionLaw:
        """The friction law; in the axes of the ground or of the body, as the fit was told.

        A law of a patch in the ground's axes is that of a body with the angle 0. That of known
        support points is the law of one point in the plane, per unit of its normal force.
        """
        return self.model.law(self.coordinates)

    @cached_property
    def _sums(self) -> Sums:
        return sums(self.model, self.pairs, self.found, self.loss, self.blocks)[0]

    @cached_property
    def _leverage(self) -> Leverage:
        matrices = self._sums.matrix
        return leverage_of(matrices.sum(axis=0), matrices, without_single=True)

    @cached_property
    def covariance(self) -> Covariance | None:
        """Covariance of the coordinates from blocks that are left out in turn.

        It has one degree of freedom less than there are blocks. Combinations of coordinates that
        the pairs do not tell have no part in it.
        """
        if self.confidence is None:
            return None
        scatter = self._leverage.jackknife(self._sums.gradient)
        return Covariance(scatter, None, None, (float(self.blocks.max()), math.inf, math.inf))

    @cached_property
    def mistake(self) -> Mistake | None:
        """A wrong sign, unit, frame or point of reference that explains a large misfit, or None."""
        if self.rms <= _CLOSE:
            return None
        return mistake(
            self.model,
            self.coordinates,
            self.pairs,
            self.loss.kind,
            length=self.length,
            in_ground=self._in_ground,
        )

    @cached_property
    def parameters(self) -> Mapping[str, Estimate]:
        """Estimates with confidence intervals by name, lengths in the unit of ``length``.

        Intervals are Student's with one degree of freedom less than there are blocks. A ratio of
        axes and their angle are identifiable if the friction differs from isotropic friction at
        the level 0.01.
        """
        reported, by, untold = self._reported
        half, error = widths(self.covariance, by, self.confidence)
        values = zip(reported, error.tolist(), half.tolist(), untold.tolist(), strict=True)
        return View({one.name: self._estimate(one, *rest) for one, *rest in values})

    @cached_property
    def _reported(self) -> tuple[list[Reported], Array, NDArray[np.bool_]]:
        """Parameters, their derivatives by the coordinates, and which the data do not tell."""
        p, reported = self.coordinates, self.model.reported(self.coordinates)
        # Entries of matrices are in the unit of forces: no step changes wrenches by a larger part.
        whole = float(np.linalg.norm(self.pairs.wrench))
        steps = _STEP * np.minimum(np.maximum(1.0, np.abs(p)), whole / self._leverage.scale)
        by = np.empty((len(reported), p.size))
        for k, step in enumerate(steps):
            away = np.zeros_like(p)
            away[k] = step
            ends = [self.model.reported(p + sign * away) for sign in (1.0, -1.0)]
            by[:, k] = [
                _difference(one, other) / (2.0 * step) for one, other in zip(*ends, strict=True)
            ]
        untold = np.array([not self._leverage.tells(row) for row in by])
        half = widths(self.covariance, by, self.confidence)[0]
        untold |= half > [_says_nothing(one) for one in reported]
        return reported, by, untold

    def _estimate(self, one: Reported, error: float, half: float, untold: bool) -> Estimate:
        # The interval of what the data do not tell may reach beyond the range of numbers.
        with np.errstate(over="ignore"):
            value, low, high = one.scale.natural(np.array([one.at, one.at - half, one.at + half]))
        error *= float(one.scale.slope(np.array(one.at)))
        told = not untold
        if one.angle_of:
            told = told and self._is_anisotropic(one.angle_of)
            if one.scale is Scale.LOG:
                # A ratio is that of the longer to the shorter axis.
                low = 1.0 if not told else max(low, 1.0)
            elif not told:
                low, high = -0.5 * math.pi, 0.5 * math.pi
        unit = self.length if one.is_length else 1.0
        return Estimate(unit * value, unit * low, unit * high, unit * error, identifiable=told)

    def _is_anisotropic(self, at: tuple[int, ...]) -> bool:
        """Return whether coordinates that vanish for isotropic friction do not, by Wald's test.

        Unlike intervals of each, it does not depend on the axes.
        """
        from scipy.special import fdtri

        q = self.coordinates[list(at)]
        if self.covariance is None:
            return bool(q.any())
        spread = self.covariance.scatter[np.ix_(at, at)]
        if not spread.any():
            return bool(q.any())
        count, degrees = len(at), int(self.blocks.max())
        left = degrees - count + 1
        statistic = float(q @ np.linalg.lstsq(spread, q, rcond=None)[0])
        return bool(statistic * left / (count * degrees) > fdtri(count, left, 1.0 - _LEVEL))

    @property
    def warnings(self) -> tuple[str, ...]:
        """Sentences on what the data cannot tell."""
        found = []
        if not self.converged:
            found.append(
                "The search has ended at its longest: parameters that hardly change the wrench "
                "are not at their best values"
            )
        reported, _, untold = self._reported
        vague = [one.name for one, lost in zip(reported, untold, strict=True) if lost]
        if vague:
            found.append(f"The data do not tell {', '.join(vague)}")
        if self.mistake is not None:
            found.append(
                f"The model does not fit: the wrench differs from it by {self.rms:.1%}; with "
                f"{self.mistake.words}, it would differ by {self.mistake.misfit:.1%}: check it"
            )
        elif min(self.rms, self._typical) > _FAR_OFF:
            found.append(
                f"The model does not fit: the wrench differs from it by {self.rms:.0%}; no wrong "
                "sign, unit, frame or point of reference that is known here explains it"
            )
        return tuple(found)

    def compare(self, models: dict[str, PatchModel]) -> Comparison:
        """Return models of the same pairs side by side, by BIC and by parts left out.

        Args:
            models: by the names they shall have.
        """
        return compare(
            models,
            self.pairs,
            loss=self.loss.kind,
            blocks=self.blocks,
            folds=self.folds,
            confidence=0.95 if self.confidence is None else self.confidence,
            known={self.model: self.found},
        )

    def _words(self) -> tuple[str, str, str]:
        pairs, blocks = counted(len(self.pairs), "pair"), int(self.blocks.max()) + 1
        scatter = f"Confidence intervals follow from the scatter of {blocks} blocks."
        return (
            f"The law of {self.model.words} is fitted to {pairs} of wrench and twist; the wrench "
            f"differs from it by {self.rms:.2%} (root mean square, relative).",
            scatter if self.confidence is not None else "",
            f"{self.model.words}, {pairs}, rms {self.rms:.3g}",
        )

    @classmethod
    def _known(cls) -> stored.Kinds:
        return _KNOWN


class PatchFit(BlockFit):
    """The law in R³ of a contact patch, fitted to pairs of wrench and twist by `fit_patch`.

    Its slip is (v₁, v₂, ω ℓ), its force (λ₁, λ₂, τ/ℓ): a contact of `RigidBodies` takes it with
    ``patch_radius=fit.length``.
    """

    @property
    def reservoir(self) -> StarSet:
        """The force reservoir C; of a law in the ground's axes, for a body that has the angle 0."""
        return self.model.reservoir(self.coordinates)

    def wrench(self, twist: ArrayLike, *, angle: ArrayLike | None = None) -> Array:
        """Return the wrench (F₁, F₂, τ/ℓ) = −λ of twists (v₁, v₂, ω ℓ), ``(n, 3)``.

        Args:
            twist: shape ``(n, 3)``, none of them zero.
            angle: of the body from the ground in rad, ``(n,)``; default 0.
        """
        motions = arrays.array(twist, "twist", (None, 3))
        pairs = Pairs(np.zeros_like(motions), motions, angle=angle)
        return self.model.both(self.coordinates, pairs)[0]

    @property
    def warnings(self) -> tuple[str, ...]:
        """Sentences on what the data cannot tell."""
        found = list(super().warnings)
        squares = (self.pairs.wrench**2).mean(axis=0)
        lever = math.sqrt(squares[2] / squares[:2].sum()) if squares[:2].any() else math.inf
        if self.model.spot > _THICK * lever > 0.0:
            found.append(
                f"Spots of the radius {self.model.spot * self.length:.2g} are no points beside "
                f"torques with a lever of {lever * self.length:.2g}: give a length of about that, "
                "which the radius is a part of"
            )
        far = self.model.far(self.coordinates, _FAR, _LIGHT)
        if far:
            names = ", ".join(f"point_{i + 1}" for i in far)
            found.append(
                f"What {names} stands for is no place of the patch, it is too far outside or "
                "carries hardly any load: C is that of the data, its points are not"
            )
        return tuple(found)

    @cached_property
    def comparison(self) -> Comparison:
        """The model beside ellipsoids, a round area and support points.

        ``"ellipsoid"`` and ``"ellipsoids C and D"`` are the associated and the extended law, and
        ``comparison.improvement`` says how much better the second one predicts.
        """
        frame = self.model.frame
        models: dict[str, PatchModel] = {
            "ellipsoid": EllipsoidPatch(frame=frame),
            "ellipsoids C and D": ExtendedPatch(EllipsoidPatch(frame=frame)),
            "round area": PointsPatch(1, radius=None, frame=frame),
            "3 points": PointsPatch(3, radius=0.01, frame=frame),
            "5 points": PointsPatch(5, radius=0.01, frame=frame),
        }
        if self.model not in models.values():
            models["this model"] = self.model
        return self.compare(models)


class SupportsFit(BlockFit):
    """The law in the plane of the friction at known support points, by `fit_supports`."""

    _in_ground = True

    @cached_property
    def comparison(self) -> Comparison:
        """Isotropic friction beside ellipses in the ground's and in the body's axes."""

        def points(**options: Any) -> PointsPatch:
            return PointsPatch(self.pairs.points, radius=SPOT, known=True, **options)

        return self.compare(
            {
                "isotropic": points(),
                "ellipse in the ground": points(friction="ellipse", frame="ground"),
                "ellipse in the body": points(friction="ellipse", frame="body"),
                "ellipses C and D in the ground": ExtendedPoints(frame="ground"),
            }
        )

    @cached_property
    def anisotropic(self) -> bool:
        """Whether the pushes say that the friction of the ground is anisotropic.

        It is where BIC prefers the ellipse in the ground's axes to isotropic friction and to an
        ellipse in the body's axes, which is not of the ground, and where its prediction of parts
        that are left out is better than that of isotropic friction by more than its band.
        """
        found = self.comparison
        beside = {one.name: one.bic for one in found.candidates}
        own = beside.pop("ellipse in the ground")
        rivals = (beside["isotropic"], beside["ellipse in the body"])
        better = found.improvement("ellipse in the ground", over="isotropic")
        return own < min(rivals) and better.low > 0.0


def _difference(one: Reported, other: Reported) -> float:
    off = one.at - other.at
    # Axes have no sign: their angles differ by less than a quarter turn.
    return off - math.pi * round(off / math.pi) if one.scale is Scale.ANGLE else off


_KNOWN: stored.Kinds = {
    **PATCH_KINDS,
    **{one.__name__: one for one in (PatchFit, SupportsFit, Pairs, Found, Loss)},
}
