"""What a minimum of the squares of paths says: parameters with intervals, launches."""

from __future__ import annotations

import math

import numpy as np

from asperity.identify.estimator.covariance import estimates, known_angles
from asperity.identify.estimator.identified_law import IdentifiedLaw
from asperity.identify.evidence.paths.launch import QUANTITIES
from asperity.identify.evidence.paths.limits import (
    SCALE,
    longer,
    not_told,
    speed_limit,
    warnings_of,
)
from asperity.identify.evidence.paths.result import FittedPath, PathFit
from asperity.identify.evidence.paths.solution import Solution
from asperity.identify.models.coordinates import Estimate, at_bounds


def verdict(solution: Solution, *, confidence: float | None, length_error: float | None) -> PathFit:
    """Return the fit with its confidence intervals and what it leaves open.

    Raises:
        FitError: if the paths do not tell all parameters.
    """
    structure, at = solution.structure, solution.free
    by_length = solution.response(longer(solution))
    units = np.eye(len(solution.held))
    widths, deviations = np.full((2, len(units)), np.nan)
    covariance = None
    alone = np.zeros(len(at), dtype=np.bool_)
    if len(solution.misfits.paths) > 1 and confidence is not None:
        covariance = solution.covariance(None if length_error is None else length_error * by_length)
        assert covariance.leverage is not None
        alone = ~covariance.leverage.compares(units[at])
        widths = covariance.half_widths(units, confidence)
        widths[at[alone]] = math.inf
        deviations = np.sqrt(np.maximum(np.diag(covariance.total), 0.0))
    told = ~at_bounds(solution.coordinates, [one for _, one in structure.coordinates])
    told[at] &= ~not_told(solution, widths[at])
    angles = known_angles(structure, solution.coordinates, covariance)
    told &= [angles.get(name, True) for name in structure.names]
    fixed = ~np.isnan(solution.held)
    widths[fixed], deviations[fixed], told[fixed] = 0.0, 0.0, True
    degrees = math.inf if covariance is None else covariance.degrees[0]
    law = IdentifiedLaw(
        structure.law(solution.coordinates),
        reservoir_model=structure.reservoir,
        direction_model=structure.direction,
        values=structure.values(solution.coordinates),
        turns=None if covariance is None else covariance.scatter,
        calibration=None if covariance is None else covariance.calibration,
        degrees_of_freedom=((max(degrees, 1.0), math.inf, math.inf)),
    )
    rate = solution.motions.law.rate
    if rate is not None:
        law = law.replace(law=law.law.replace(rate=rate))
    return PathFit(
        _fitted_paths(solution, confidence),
        identified_law=law,
        parameters=estimates(
            structure,
            solution.coordinates,
            told,
            half_widths=widths,
            standard_errors=deviations,
        ),
        loss=solution.loss,
        confidence=confidence,
        misfit=solution.misfit,
        slope_error=solution.slope_error,
        degrees_of_freedom=math.nan if covariance is None else degrees,
        limits=(speed_limit(solution), SCALE),
        warnings=warnings_of(solution, alone, widths[at], by_length, length_error),
    )


def _fitted_paths(solution: Solution, confidence: float | None) -> tuple[FittedPath, ...]:
    """Return the paths with their launches, whose errors follow from those of the positions."""
    from scipy.stats import norm

    misfits = solution.misfits
    columns = solution.jacobian * solution.weights[0][:, None]
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
