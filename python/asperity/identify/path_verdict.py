"""What a minimum of the squares of paths says: intervals, and what they leave open."""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from asperity._base.arrays import Array
from asperity.errors import FitError
from asperity.identify.diagnostics import at_bounds
from asperity.identify.fitting.models.coordinates import Coordinate, Estimate, Scale
from asperity.identify.fitting.models.names import short
from asperity.identify.fitting.uncertainty.covariance import Covariance, estimate, has_angle
from asperity.identify.identified_law import IdentifiedLaw, Structure
from asperity.identify.path_fit import FittedPath, PathFit
from asperity.identify.paths.launch import QUANTITIES, SPEED
from asperity.identify.paths.misfits import Misfits
from asperity.identify.paths.motions import Motions
from asperity.identify.paths.spread import Spread, shared_parts, spread
from asperity.law import Stribeck

# A logarithm with a larger standard error is not known.
_UNKNOWN = 1.0
# Differences at two step sizes agree to this share of a column.
_SAME_SLOPE = 1e-2
# Points that are so many times farther from the paths than their errors are not explained.
_MISFIT = 1.5
# Angles of two laws that differ by less are the same.
_SAME_ANGLE = math.radians(5.0)
_MOST_DEGREES = 1e9


@dataclass(frozen=True, eq=False)
class Solution:
    """A minimum of the squares of paths.

    Attributes:
        structure: the models.
        held: coordinates that are known, NaN of the others.
        misfits: of the paths.
        motions: simulates them.
        z: the unknowns.
        others: free coordinates of other minima that are about as good.
    """

    structure: Structure
    held: Array
    misfits: Misfits
    motions: Motions
    z: Array
    others: tuple[Array, ...]

    @cached_property
    def free(self) -> NDArray[np.intp]:
        """Places of the coordinates that were fitted."""
        return np.flatnonzero(np.isnan(self.held))

    @cached_property
    def coordinates(self) -> Array:
        """All coordinates of the law."""
        full = self.held.copy()
        full[self.free] = self.z[: self.misfits.size]
        return full

    @cached_property
    def jacobian(self) -> Array:
        """Derivatives of the residuals by central differences."""
        return self.misfits.jacobian(self.z)

    @cached_property
    def residuals(self) -> Array:
        """Differences in standard errors."""
        return self.misfits.residuals(self.z)

    @cached_property
    def slope_error(self) -> float:
        """How much derivatives differ at two step sizes, relative to them, at most."""
        twice = self.misfits.jacobian(self.z, factor=2.0)
        off = np.linalg.norm(twice - self.jacobian, axis=0)
        sizes = np.maximum(np.linalg.norm(self.jacobian, axis=0), np.finfo(float).tiny)
        return float(np.max(off / sizes, initial=0.0))

    @cached_property
    def misfit(self) -> float:
        """Root mean square of the residuals, corrected for what was fitted."""
        left = self.misfits.rows - self.misfits.count
        return math.sqrt(float(self.residuals @ self.residuals) / left)

    @cached_property
    def spread(self) -> Spread:
        """The scatter between paths.

        Raises:
            FitError: if the paths do not tell all parameters.
        """
        columns = self.jacobian[:, : self.misfits.size]
        names = [self.structure.names[at] for at in self.free]
        dead = [n for n, c in zip(names, columns.T, strict=True) if not c.any()]
        found = None if dead else spread(self.misfits, self.residuals, self.jacobian)
        if found is None:
            raise FitError(
                f"the paths do not tell {', '.join(dead or names)} apart: choose a simpler model, "
                "fix parameters that are known, or launch in more directions"
            )
        wide = np.sqrt(np.diag(found.stated)) > _UNKNOWN
        wide &= ~at_bounds(self.z[: self.misfits.size], self._listed)
        if wide.any():
            listed = ", ".join(n for n, one in zip(names, wide, strict=True) if one)
            raise FitError(
                f"the paths do not tell {listed}: choose a simpler model, fix parameters that are "
                "known, or launch in more directions"
            )
        return found

    @property
    def _listed(self) -> list[Coordinate]:
        return [self.structure.coordinates[at][1] for at in self.free]

    def response(self, change: Array) -> Array:
        """Return by how much the free coordinates move if residuals change by this, `(k,)`."""
        pull = sum(
            part.T @ change[self.misfits.of(k)]
            for k, part in enumerate(shared_parts(self.misfits, self.jacobian))
        )
        return -self.spread.stated @ np.asarray(pull)


def verdict(solution: Solution, *, confidence: float | None, length_error: float | None) -> PathFit:
    """Return the fit with its confidence intervals and what it leaves open.

    Raises:
        FitError: if the paths do not tell all parameters.
    """
    known = solution.spread
    count = len(solution.misfits.paths)
    by_length = solution.response(_longer(solution))
    degrees = [known.degrees(unit) for unit in np.eye(len(solution.free))]
    between = count > 1 and confidence is not None
    scatter = known.covariance if between else None
    shared = None
    if between and length_error is not None:
        shared = length_error**2 * np.outer(by_length, by_length)
    warnings = _warnings(solution, degrees, by_length, length_error, between=between)
    law = IdentifiedLaw(
        solution.structure.law(solution.coordinates),
        reservoir_model=short(solution.structure.reservoir),
        direction_model=short(solution.structure.direction),
        values=_values(solution),
        turns=_embedded(solution, scatter),
        calibration=_embedded(solution, shared),
        degrees_of_freedom=(max(min(degrees), 1.0), math.inf, math.inf),
    )
    rate = solution.motions.law.rate
    if rate is not None:
        law = law.replace(law=law.law.replace(rate=rate))
    return PathFit(
        _fitted_paths(solution, confidence),
        identified_law=law,
        parameters=_parameters(solution, scatter, shared, degrees, confidence),
        confidence=confidence,
        misfit=solution.misfit,
        slope_error=solution.slope_error,
        degrees_of_freedom=min(degrees) if between else math.nan,
        limits=(_speed_limit(solution), _SCALE),
        warnings=warnings,
    )


_SCALE = "paths determine the shape of D, not its size: direction.scale has no value"


def _values(solution: Solution) -> list[float]:
    return [
        float(one.scale.natural(x))
        for x, (_, one) in zip(solution.coordinates, solution.structure.coordinates, strict=True)
    ]


def _embedded(solution: Solution, part: Array | None) -> Array | None:
    """Return a covariance of all coordinates; those that are known do not scatter."""
    if part is None:
        return None
    whole = np.zeros((len(solution.held), len(solution.held)))
    whole[np.ix_(solution.free, solution.free)] = part
    return whole


def _parameters(
    solution: Solution,
    scatter: Array | None,
    shared: Array | None,
    degrees: list[float],
    confidence: float | None,
) -> dict[str, Estimate]:
    from scipy.stats import norm, t

    stuck = at_bounds(solution.coordinates, [c for _, c in solution.structure.coordinates])
    places = {int(at): k for k, at in enumerate(solution.free)}
    angles = _angles(solution, scatter, degrees)
    result: dict[str, Estimate] = {}
    for at, (name, one) in enumerate(solution.structure.coordinates):
        x = float(solution.coordinates[at])
        if at not in places:
            value = float(one.scale.natural(np.array(x)))
            result[name] = Estimate(value, value, value, 0.0)
            continue
        k = places[at]
        width, deviation, told = math.nan, math.nan, not stuck[at]
        if scatter is not None and confidence is not None:
            told = told and degrees[k] > 0.0
            level = 0.5 + 0.5 * confidence
            own = scatter[k, k]
            square = own * float(t.ppf(level, min(max(degrees[k], 1e-3), _MOST_DEGREES))) ** 2
            if shared is not None:
                square += shared[k, k] * float(norm.ppf(level)) ** 2
                own += shared[k, k]
            width, deviation = math.sqrt(max(square, 0.0)), math.sqrt(max(own, 0.0))
        told = told and angles.get(name, True)
        result[name] = estimate(x, one, width, deviation, told)
    result["direction.scale"] = Estimate(math.nan, 0.0, math.inf, math.inf, identifiable=False)
    return result


def _angles(solution: Solution, scatter: Array | None, degrees: list[float]) -> dict[str, bool]:
    """Return whether sets differ from those that have no angle, for angles that were fitted."""
    result: dict[str, bool] = {}
    split = len(solution.structure.reservoir.coordinates)
    whole = _embedded(solution, scatter)
    models = (
        ("reservoir", solution.structure.reservoir, slice(0, split)),
        ("direction", solution.structure.direction, slice(split, len(solution.held))),
    )
    for name, model, part in models:
        roundness = model.roundness()
        if roundness is None or whole is None or not np.isnan(solution.held[part.stop - 1]):
            continue
        least = max(min(degrees), 1.0)
        known = Covariance(whole[part, part], None, None, (least, math.inf, math.inf))
        result[f"{name}.angle"] = has_angle(solution.coordinates[part], roundness, known)
    return result


def _fitted_paths(solution: Solution, confidence: float | None) -> tuple[FittedPath, ...]:
    """Return the paths with their launches, whose errors follow from those of the positions."""
    from scipy.stats import norm

    misfits = solution.misfits
    columns = solution.jacobian
    scale = np.linalg.norm(columns, axis=0)
    inverse = np.linalg.pinv(columns / scale)
    errors = np.zeros((len(misfits.paths), len(QUANTITIES)))
    errors[misfits.free] = (np.linalg.norm(inverse, axis=1) / scale)[misfits.size :]
    quantile = math.nan if confidence is None else float(norm.ppf(0.5 + 0.5 * confidence))
    launches, places = misfits.launches(solution.z), misfits.simulated(solution.z)
    assert places is not None
    return tuple(
        FittedPath(
            path.name,
            time=path.time,
            position=path.position,
            position_error=path.error,
            simulated=places[k].position,
            **{
                f"launch_{name}": Estimate(value, value - wide, value + wide, error)
                for name, value, error, wide in zip(
                    QUANTITIES,
                    launches[k].tolist(),
                    errors[k].tolist(),
                    (quantile * errors[k]).tolist(),
                    strict=True,
                )
            },
        )
        for k, path in enumerate(misfits.paths)
    )


def _longer(solution: Solution) -> Array:
    """Return how residuals change, per unit, if all measured lengths are longer by a factor."""
    misfits = solution.misfits
    launches = misfits.launches(solution.z)
    change = np.zeros(misfits.rows)
    for k, path in enumerate(misfits.paths):
        away = (path.position - launches[k, 3:5]) / path.error
        begin = misfits.of(k).start
        change[begin : begin + away.size] = -away.T.ravel()
    return change


def _faster(solution: Solution) -> tuple[Array, float] | None:
    """Return how residuals change, per unit, with a factor of friction that grows with the speed.

    The factor is larger by that unit at the median of the launch speeds, which is returned too.
    """
    misfits = solution.misfits
    launches = misfits.launches(solution.z)
    speed, part = float(np.median(launches[:, SPEED])), 0.01
    law = solution.structure.law(solution.coordinates)
    known = solution.motions.law.rate or Stribeck(speed, ratio=1.0)
    faster = known.replace(viscous=known.viscous + part / speed)
    count = len(launches)
    found = solution.motions.paths([law] * count, launches, range(count), rate=faster)
    usual = solution.motions.paths([law] * count, launches, range(count))
    if found is None or usual is None:
        return None
    change = np.zeros(misfits.rows)
    for k, path in enumerate(misfits.paths):
        off = (found[k].position - usual[k].position) / path.error / part
        begin = misfits.of(k).start
        change[begin : begin + off.size] = off.T.ravel()
    return change, speed


def _speed_limit(solution: Solution) -> str:
    """Return a sentence on what paths cannot tell: the size of C from a dependence on the speed."""
    taken = (
        "friction is taken as independent of the speed"
        if solution.motions.law.rate is None
        else "the dependence of friction on the speed is taken from the system"
    )
    found = _faster(solution)
    if found is None:
        return f"{taken}: paths tell it hardly apart from the size of C"
    change, speed = found
    left = [change[solution.misfits.of(k)] for k in range(len(solution.misfits.paths))]
    # What no change of the launches or of the law mimics.
    scale = np.linalg.norm(solution.jacobian, axis=0)
    basis = np.linalg.qr(solution.jacobian / scale)[0]
    rest = np.concatenate(left) - basis @ (basis.T @ np.concatenate(left))
    told = 1.0 / max(float(np.linalg.norm(rest)), 1e-12)
    launched = solution.misfits.launches(solution.z)[:, SPEED]
    moved = _changes(solution, 0.01 * solution.response(change), signed=True)
    fell = "it fell by 1 %" if solution.motions.law.rate is None else "it fell by another 1 %"
    return (
        f"{taken}: if {fell} from rest to {speed:.3g} m/s, the fit would change "
        f"{moved}; fitted as well, such a fall would have a standard error of "
        f"{100.0 * told:.2g} %, with launches at {launched.min():.3g} to {launched.max():.3g} m/s"
    )


def _changes(solution: Solution, step: Array, *, signed: bool = False) -> str:
    """Return by how much steps of the free coordinates change the parameters."""
    texts = []
    sign = "+" if signed else ""
    for at, moved in zip(solution.free, step.tolist(), strict=True):
        name, one = solution.structure.coordinates[at]
        size = moved if signed else abs(moved)
        if one.scale is Scale.ANGLE:
            text = f"{math.degrees(size):{sign}.2g}°"
        elif one.scale is Scale.PLAIN:
            text = f"{size:{sign}.2g}"
        else:
            x = solution.coordinates[at]
            share = float(one.scale.slope(x)) / float(one.scale.natural(x))
            text = f"{100.0 * size * share:{sign}.2g} %"
        texts.append(f"{name} by {text}")
    return ", ".join(texts)


def _warnings(
    solution: Solution,
    degrees: list[float],
    by_length: Array,
    length_error: float | None,
    *,
    between: bool,
) -> tuple[str, ...]:
    """Return sentences on what the paths cannot tell or the models cannot hold."""
    sentences = []
    names = [solution.structure.names[at] for at in solution.free]
    if len(solution.misfits.paths) == 1:
        sentences.append(
            "there are no confidence intervals: one path has no scatter between paths; measure at "
            "least 3 paths (10 are better)"
        )
    if between:
        alone = [n for n, d in zip(names, degrees, strict=True) if d == 0.0]
        if alone:
            sentences.append(
                f"{', '.join(alone)} is told by one path alone, with nothing to compare it with: "
                "launch in more directions"
            )
    if length_error is None:
        sentences.append(
            "the error of the length scale is not known: 1 % would change "
            f"{_changes(solution, 0.01 * by_length)}; the confidence intervals do not include "
            "this: state length_error"
        )
    if solution.misfit > _MISFIT:
        sentences.append(
            f"the model does not fit: points are {solution.misfit:.2g} times as far from the paths "
            "as their standard errors say; the law, the system, the launches or the errors are not "
            "as stated"
        )
    if solution.slope_error > _SAME_SLOPE:
        sentences.append(
            f"derivatives by differences of paths differ by {solution.slope_error:.2g} between two "
            "step sizes: paths jump with the parameters, and the confidence intervals are not exact"
        )
    stuck = at_bounds(
        solution.z[: solution.misfits.size],
        [solution.structure.coordinates[at][1] for at in solution.free],
    )
    for name, at, one in zip(names, solution.free, stuck, strict=True):
        if one:
            scale = solution.structure.coordinates[at][1].scale
            value = float(scale.natural(solution.coordinates[at]))
            sentences.append(f"{name} is not identifiable: it ended at its bound {value:.4g}")
    sentences += _other_minima(solution)
    return tuple(sentences)


def _other_minima(solution: Solution) -> list[str]:
    """Return a sentence if another law is as near to the paths."""
    at = solution.structure.names.index("reservoir.angle") if solution.others else 0
    mine = solution.coordinates[at]
    for other in solution.others:
        full = solution.held.copy()
        full[solution.free] = other
        off = abs((full[at] - mine + 0.25 * math.pi) % (0.5 * math.pi) - 0.25 * math.pi)
        if off < _SAME_ANGLE:
            continue
        values = solution.structure.values(full)
        listed = ", ".join(
            f"{name} = {value:.4g}"
            for name, value in zip(solution.structure.names, values.tolist(), strict=True)
            if name.startswith("reservoir")
        )
        return [
            f"another set C is as near to the paths: {listed}; launch in directions all around, or "
            "fix the angles of the sets if they are known"
        ]
    return []
