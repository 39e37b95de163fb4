"""What a minimum of the squares of paths says: parameters with intervals, launches."""

from __future__ import annotations

import math

import numpy as np

from asperity._base.arrays import Array
from asperity.identify.fitting.models.coordinates import Estimate, at_bounds
from asperity.identify.fitting.models.names import short
from asperity.identify.fitting.uncertainty.covariance import estimate
from asperity.identify.identified_law import IdentifiedLaw
from asperity.identify.paths.launch import QUANTITIES
from asperity.identify.paths.limits import SCALE, longer, not_told, speed_limit, warnings_of
from asperity.identify.paths.result import FittedPath, PathFit
from asperity.identify.paths.solution import Solution

_MOST_DEGREES = 1e9
# An angle is told from none at this level, and not of sets that differ from these by rounding.
_LEVEL, _ROUND = 0.01, 1e-9


def verdict(solution: Solution, *, confidence: float | None, length_error: float | None) -> PathFit:
    """Return the fit with its confidence intervals and what it leaves open.

    Raises:
        FitError: if the paths do not tell all parameters.
    """
    known = solution.spread
    count = len(solution.misfits.paths)
    by_length = solution.response(longer(solution))
    degrees = [known.degrees(unit) for unit in np.eye(len(solution.free))]
    between = count > 1 and confidence is not None
    scatter = known.covariance if between else None
    shared = None
    if between and length_error is not None:
        shared = length_error**2 * np.outer(by_length, by_length)
    bands = _bands(scatter, shared, degrees, confidence)
    warnings = warnings_of(solution, degrees, bands[0], by_length, length_error, between=between)
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
        parameters=_parameters(solution, scatter, degrees, bands),
        confidence=confidence,
        misfit=solution.misfit,
        slope_error=solution.slope_error,
        degrees_of_freedom=min(degrees) if between else math.nan,
        limits=(speed_limit(solution), SCALE),
        warnings=warnings,
    )


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


def _bands(
    scatter: Array | None, shared: Array | None, degrees: list[float], confidence: float | None
) -> tuple[Array, Array]:
    """Return half-widths of confidence intervals and standard errors of the free coordinates."""
    from scipy.stats import norm, t

    if scatter is None or confidence is None:
        nothing = np.full(len(degrees), np.nan)
        return nothing, nothing
    level = 0.5 + 0.5 * confidence
    own = np.diag(scatter).copy()
    square = own * t.ppf(level, np.clip(degrees, 1e-3, _MOST_DEGREES)) ** 2
    if shared is not None:
        square += np.diag(shared) * float(norm.ppf(level)) ** 2
        own += np.diag(shared)
    return np.sqrt(np.maximum(square, 0.0)), np.sqrt(np.maximum(own, 0.0))


def _parameters(
    solution: Solution, scatter: Array | None, degrees: list[float], bands: tuple[Array, Array]
) -> dict[str, Estimate]:
    stuck = at_bounds(solution.coordinates, [c for _, c in solution.structure.coordinates])
    places = {int(at): k for k, at in enumerate(solution.free)}
    angles, lost = _angles(solution, scatter), not_told(solution, bands[0])
    result: dict[str, Estimate] = {}
    for at, (name, one) in enumerate(solution.structure.coordinates):
        x = float(solution.coordinates[at])
        if at not in places:
            value = float(one.scale.natural(np.array(x)))
            result[name] = Estimate(value, value, value, 0.0)
            continue
        k = places[at]
        told = not stuck[at] and not lost[k] and angles.get(name, True)
        told = told and (scatter is None or degrees[k] > 0.0)
        width, deviation = float(bands[0][k]), float(bands[1][k])
        result[name] = estimate(x, one, width, deviation, told)
    result["direction.scale"] = Estimate(math.nan, 0.0, math.inf, math.inf, identifiable=False)
    return result


def _angles(solution: Solution, scatter: Array | None) -> dict[str, bool]:
    """Return whether sets differ from those that have no angle, for angles that were fitted.

    One of the combinations that vanish there must differ from zero, at a level that they share.
    """
    from scipy.stats import t

    result: dict[str, bool] = {}
    whole = _embedded(solution, scatter)
    split = len(solution.structure.reservoir.coordinates)
    parts = {"reservoir": slice(0, split), "direction": slice(split, len(solution.held))}
    for (name, part), model in zip(parts.items(), solution.structure, strict=True):
        roundness = model.roundness()
        if roundness is None or whole is None or not np.isnan(solution.held[part.stop - 1]):
            continue
        off = roundness.matrix @ solution.coordinates[part] - roundness.offset
        result[f"{name}.angle"] = False
        for size, row in zip(np.abs(off).tolist(), roundness.matrix, strict=True):
            direction = np.zeros(len(solution.held))
            direction[part] = row
            degrees = solution.spread.degrees(direction[solution.free])
            quantile = float(t.ppf(1.0 - 0.5 * _LEVEL / len(off), degrees)) if degrees else math.inf
            error = math.sqrt(max(float(direction @ whole @ direction), 0.0))
            if size > max(quantile * error, _ROUND) or (error == 0.0 and size > _ROUND):
                result[f"{name}.angle"] = True
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
