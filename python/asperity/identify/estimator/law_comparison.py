"""Two identified laws side by side: where they differ by more than their uncertainty."""

from __future__ import annotations

import math
import os
from collections.abc import Mapping
from dataclasses import KW_ONLY, dataclass
from typing import Literal

import numpy as np

from asperity._base.arrays import Array, unit_vectors
from asperity._base.quantiles import student
from asperity._base.result import NO_UNIT, Axis, Series, Table, TableResult
from asperity._base.value import AnyArray, Fraction, Record
from asperity.errors import AsperityError, DimensionError, ParameterError
from asperity.identify.estimator.covariance import level_of
from asperity.identify.estimator.identified_law import IdentifiedLaw, root_of
from asperity.identify.estimator.result import LawFit
from asperity.identify.models.coordinates import Estimate
from asperity.identify.models.structure import PlanarStructure
from asperity.law import FrictionLaw

CurveName = Literal["coefficient", "deflection", "reservoir", "direction"]
"""The curves of a `LawComparison`."""

_PHI = np.deg2rad(np.arange(0.0, 360.0, 4.0))
# Step of differences in coordinates, which are logarithms and angles.
_STEP = 1e-5
# Draws of the largest of correlated deviations: p-values are known to 0.2 %.
_DRAWS, _AT_ONCE = 20_000, 4_000
# Differences between laws that are less than this share of the coefficients are rounding.
_ROUNDING = 1e-9
# Digits of deflections in rad that are more than the rounding of a collinear law.
_DIGITS = 12


class CurveDifference(Record):
    """A curve of two laws over the direction, and where they differ.

    Args:
        first: of the first law, ``(n,)``.
        second: of the second law, ``(n,)``.
        half_width: of the band of the difference, which holds it in all directions at once.
        standard_error: of the difference in each direction.
        p_value: probability that laws that are equal differ as much somewhere.
    """

    first: AnyArray
    _: KW_ONLY
    second: AnyArray
    half_width: AnyArray
    standard_error: AnyArray
    p_value: Fraction

    @property
    def difference(self) -> Array:
        """Second less first, ``(n,)``."""
        return self.second - self.first


class LawComparison(TableResult, Record):
    """How two identified laws differ, with simultaneous bands over the direction.

    Args:
        phi: directions in rad, ``(n,)``: of sliding, and for the sets the polar angle.
        coefficient: ‖λ‖/λ_N over the sliding direction.
        deflection: angle in rad from the sliding direction to −λ.
        reservoir: radius of C over the polar angle.
        direction: radius of D over the polar angle, relative to its mean.
        p_value: probability that equal laws differ as much in their forces in some direction.
        parameters: differences of the parameters by name; empty for laws of different models.
        degrees_of_freedom: of the standard errors, the fewest of all directions.
        confidence: level of the bands and intervals.
    """

    _picture = "plot_law_comparison"

    phi: AnyArray
    _: KW_ONLY
    coefficient: CurveDifference
    deflection: CurveDifference
    reservoir: CurveDifference
    direction: CurveDifference
    p_value: Fraction
    parameters: Mapping[str, Estimate]
    degrees_of_freedom: float
    confidence: Fraction = 0.95

    @property
    def differ(self) -> bool:
        """Whether the laws differ at the level of `confidence`."""
        return self.p_value < 1.0 - self.confidence

    def summary(self) -> str:
        """Return whether the laws differ, by how much, and in which set."""
        verdict = "The laws differ" if self.differ else "No difference of the laws was found"
        lines = [
            f"{verdict} (p {probability(self.p_value)}, p {probability(self.reservoir.p_value)} "
            f"for C alone, p {probability(self.direction.p_value)} for D alone)."
        ]
        level = f"{self.confidence:.0%}"
        for name, curve, scale, unit in (
            ("friction coefficient", self.coefficient, 1.0, ""),
            ("deflection of the force", self.deflection, math.degrees(1.0), "°"),
        ):
            change = curve.difference * scale
            at = int(np.abs(change).argmax())
            half = float(curve.half_width[at]) * scale
            lines.append(
                f"The {name} changes most by {change[at]:+.4g}{unit} ± {half:.2g}{unit}, sliding "
                f"at {math.degrees(self.phi[at]):.0f}°; the {level} band holds all directions."
            )
        lines += [
            f"{name} changes by {_shown(name, one)}." for name, one in self.parameters.items()
        ]
        return "\n".join(lines)

    def __repr__(self) -> str:
        word = "different" if self.differ else "no difference found"
        return f"<LawComparison: {word}, p {probability(self.p_value)}>"

    def _table(self) -> Table:
        words = {
            "first": "of the first law",
            "second": "of the second law",
            "half_width": "of the band of the difference",
            "standard_error": "of the difference",
        }
        curves = {
            "coefficient": (self.coefficient, NO_UNIT),
            "deflection": (self.deflection, "rad"),
            "reservoir": (self.reservoir, NO_UNIT),
            "direction": (self.direction, NO_UNIT),
        }
        series = {
            f"{name}_{word}": Series(getattr(curve, word), ("phi",), unit, f"{name} {meaning}")
            for name, (curve, unit) in curves.items()
            for word, meaning in words.items()
        }
        facts = {"p_value": self.p_value, "confidence": self.confidence}
        return Table({"phi": Axis(self.phi, "rad", "direction")}, series, facts)


def compare_laws(
    first: LawFit | IdentifiedLaw | str | os.PathLike[str],
    second: LawFit | IdentifiedLaw | str | os.PathLike[str],
    *,
    confidence: float = 0.95,
    same_calibration: bool = False,
) -> LawComparison:
    """Compare two laws that were identified from measurements that are independent.

    Differences are taken direction by direction, whatever the models are: x₂(φ) − x₁(φ) of the
    friction coefficient, of the deflection, of the radii of C and D. Their covariance is
    J₁Σ₁J₁ᵀ + J₂Σ₂J₂ᵀ with the derivatives J by the coordinates of the laws; bands contain the
    whole curve, by the largest of correlated deviations t with the degrees of freedom of Welch and
    Satterthwaite. Laws are called different where zero leaves the band of λ/λ_N as a vector. Rate
    factors, of which no covariance is known, are left out.

    Args:
        first: a fit, a law with its covariance, or the file of one.
        second: likewise.
        confidence: level of bands and intervals; 1 − confidence is the level of the tests.
        same_calibration: whether one calibration served both, as before and after wear in one
            tribometer: its errors change both laws alike and are left out of the difference.

    Raises:
        ParameterError: if a covariance is not known.
        DimensionError: if a law is not planar.

    Reference: Hotelling 1931 and Welch 1947 for two means; Monte Carlo quantiles of the largest
    deviation.

    >>> import numpy as np
    >>> from asperity import Disk, FrictionLaw
    >>> from asperity.identify import IdentifiedLaw, compare_laws
    >>> def specimen(mu):
    ...     law, spread = FrictionLaw.isotropic(mu), np.array([[1e-4]])
    ...     models = {"reservoir_model": "circle", "direction_model": "circle"}
    ...     return IdentifiedLaw(law, values=[mu], turns=spread, **models)
    >>> compare_laws(specimen(0.50), specimen(0.51)).differ
    False
    >>> compare_laws(specimen(0.50), specimen(0.53)).differ
    True
    """
    level = level_of(confidence)
    if level is None:
        raise ParameterError("confidence", "must lie between 0 and 1, got None")
    laws = [_identified(one, name) for one, name in ((first, "first"), (second, "second"))]
    sides = [_Side.of(law, same_calibration=same_calibration) for law in laws]
    found = [
        _curve(sides, slice(k * _PHI.size, (k + 1) * _PHI.size), level)
        for k in range(len(sides[0].values) // _PHI.size)
    ]
    coefficient, deflection, reservoir, direction, *_ = found
    force = slice(4 * _PHI.size, 6 * _PHI.size)
    largest = _largest(sides, force)
    return LawComparison(
        _PHI,
        coefficient=coefficient,
        deflection=deflection,
        reservoir=reservoir,
        direction=direction,
        p_value=largest.p_value(sides, force),
        parameters=_parameters(laws, sides, level),
        degrees_of_freedom=largest.degrees,
        confidence=level,
    )


def _identified(given: LawFit | IdentifiedLaw | str | os.PathLike[str], name: str) -> IdentifiedLaw:
    if isinstance(given, str | os.PathLike):
        given = IdentifiedLaw.load(given)
    law = given.identified_law if isinstance(given, LawFit) else given
    if not isinstance(law, IdentifiedLaw):
        raise ParameterError(
            name, f"must be a fit, an IdentifiedLaw or the file of one, got {type(law).__name__}"
        )
    if law.law.dimension != 2:
        raise DimensionError(name, f"must be planar, its dimension is {law.law.dimension}")
    if law.turns is None:
        raise ParameterError(name, "has no covariance: fit it with bands, from two turns or more")
    return law


def _curves(law: FrictionLaw) -> Array:
    """Return coefficient, deflection, radii of C and D, and both components of −λ/λ_N."""
    force = -law.replace(rate=None).force(unit_vectors(_PHI))
    radius = law.direction.radius(_PHI)
    return np.concatenate(
        [
            np.linalg.norm(force, axis=-1),
            np.round(law.deflection(_PHI), _DIGITS),
            law.reservoir.radius(_PHI),
            radius / radius.mean(),
            *force.T,
        ]
    )


@dataclass(frozen=True)
class _Side:
    """Curves of one law, and what its uncertainty does to them: by cause a factor F, Σ = F Fᵀ."""

    values: Array
    factors: tuple[Array, ...]
    coordinates: tuple[Array, ...]
    degrees: tuple[float, ...]

    @classmethod
    def of(cls, law: IdentifiedLaw, *, same_calibration: bool) -> _Side:
        known = law.covariances
        kept = [
            (part, degrees)
            for k, (part, degrees) in enumerate(zip(known.parts, known.degrees, strict=True))
            if part is not None and not (k == 1 and same_calibration)
        ]
        roots = tuple(root_of(part) for part, _ in kept)
        values = _curves(law.law)
        slopes = np.column_stack([_slope(law, k, values) for k in range(len(law.values))])
        factors = tuple(slopes @ root for root in roots)
        return cls(values, factors, roots, tuple(degrees for _, degrees in kept))


def _slope(law: IdentifiedLaw, k: int, values: Array) -> Array:
    """Return the derivative of the curves by a coordinate, from one side at a bound of a model."""
    ends = []
    for step in (_STEP, -_STEP):
        steps = np.zeros(len(law.values))
        steps[k] = step
        try:
            ends.append((step, _curves(law.moved(steps))))
        except AsperityError:
            ends.append((0.0, values))
    (up, above), (down, below) = ends
    if up == down:
        raise ParameterError("laws", f"{law.names[k]} can be changed in neither direction")
    return np.asarray((above - below) / (up - down))


@dataclass(frozen=True)
class _Largest:
    """The distribution of the largest deviation of several differences in standard errors."""

    errors: Array
    degrees: float
    draws: Array

    def quantile(self, level: float) -> float:
        return float(np.quantile(self.draws, level))

    def p_value(self, sides: list[_Side], part: slice) -> float:
        change = np.abs(sides[1].values[part] - sides[0].values[part])
        scale = max(np.abs(side.values[part]).max() for side in sides)
        counts = change > _ROUNDING * scale
        if not counts.any():
            return 1.0
        errors = self.errors[counts]
        off = np.divide(change[counts], errors, out=np.full(errors.shape, np.inf), where=errors > 0)
        return float((1 + np.count_nonzero(self.draws >= off.max())) / (1 + len(self.draws)))


def _largest(sides: list[_Side], part: slice) -> _Largest:
    factors = [factor[part] for side in sides for factor in side.factors]
    degrees = np.array([one for side in sides for one in side.degrees])
    variances = np.array([(factor**2).sum(axis=1) for factor in factors])
    errors = np.sqrt(variances.sum(axis=0))
    told = errors > _ROUNDING * errors.max(initial=0.0)
    freedom = _welch(variances[:, told], degrees).min(initial=math.inf)
    random = np.random.default_rng(0)
    whole = np.concatenate(factors, axis=1)[told] / errors[told][:, None]
    draws = []
    for _ in range(0, _DRAWS, _AT_ONCE):
        normal = whole @ random.normal(size=(whole.shape[1], _AT_ONCE))
        scale = np.ones(_AT_ONCE)
        if math.isfinite(freedom):
            scale = np.sqrt(random.chisquare(freedom, _AT_ONCE) / freedom)
        draws.append(np.abs(normal).max(axis=0, initial=0.0) / scale)
    return _Largest(errors, freedom, np.concatenate(draws))


def _welch(variances: Array, degrees: Array) -> Array:
    """Return the degrees of freedom of sums of variances (Welch 1947, Satterthwaite 1946)."""
    with np.errstate(divide="ignore", invalid="ignore"):
        shares = (variances**2 / degrees[:, None]).sum(axis=0)
        return np.asarray(variances.sum(axis=0) ** 2 / shares)


def _curve(sides: list[_Side], part: slice, level: float) -> CurveDifference:
    largest = _largest(sides, part)
    return CurveDifference(
        sides[0].values[part],
        second=sides[1].values[part],
        half_width=largest.quantile(level) * largest.errors,
        standard_error=largest.errors,
        p_value=largest.p_value(sides, part),
    )


def _parameters(laws: list[IdentifiedLaw], sides: list[_Side], level: float) -> dict[str, Estimate]:
    """Return the differences of the parameters, one by one, of laws of the same models."""
    if laws[0].coordinates != laws[1].coordinates:
        return {}
    at, turn = _axes_of(*laws)
    structure = laws[1]._structure
    change = structure.values(at) - structure.values(laws[0]._at)
    slopes = [
        float(one.scale.slope(x)) for x, (_, one) in zip(at, structure.coordinates, strict=True)
    ]
    steps = np.diag(laws[0].slopes), np.array(slopes)[:, None] * turn
    variances = np.array(
        [
            ((step @ root) ** 2).sum(axis=1)
            for step, side in zip(steps, sides, strict=True)
            for root in side.coordinates
        ]
    )
    degrees = np.array([one for side in sides for one in side.degrees])
    freedom = np.minimum(np.nan_to_num(_welch(variances, degrees), nan=1e9), 1e9)
    errors = np.sqrt(variances.sum(axis=0))
    half = student(level, freedom) * errors
    return {
        name: Estimate(float(d), float(d - h), float(d + h), float(e))
        for name, d, h, e in zip(laws[0].names, change, half, errors, strict=True)
    }


def _axes_of(first: IdentifiedLaw, second: IdentifiedLaw) -> tuple[Array, Array]:
    """Return coordinates of the second law with its axes named as the nearest of the first law.

    A quarter turn swaps the axes of a set, a half turn changes nothing; second, the derivatives by
    the coordinates as they were.
    """
    structure = second._structure
    assert isinstance(structure, PlanarStructure)

    def named(at: Array) -> Array:
        at = at.copy()
        for _, model, part in structure.models:
            if model.roundness() is not None:
                zero = first._at[part.stop - 1]
                at[part.stop - 1] -= zero
                at[part] = model.folded(at[part])
                at[part.stop - 1] += zero
        return at

    found, steps = named(second._at), np.eye(second._at.size)
    turn = steps.copy()
    for k, unit in enumerate(second.units):
        # The map is linear but for the angles, which move by whole quarter turns.
        if unit != "rad":
            turn[:, k] = named(second._at + steps[k]) - found
    return found, turn


def _shown(name: str, change: Estimate) -> str:
    """Return the change of a parameter with its interval, of angles in degrees."""
    if not name.endswith(".angle"):
        return str(change)
    scale = math.degrees(1.0)
    low, high = (f"{scale * end:.4g}°" for end in (change.low, change.high))
    return f"{scale * change.value:.4g}° ({low} … {high})"


def probability(p: float) -> str:
    """Return "= p", or "< p" where draws give a bound only."""
    least = 1.0 / (1 + _DRAWS)
    return f"= {p:.3g}" if p > least else f"< {2.0 * least:.1g}"
