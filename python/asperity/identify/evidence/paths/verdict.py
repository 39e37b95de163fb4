"""What a minimum of the squares of paths says: parameters with intervals, launches."""

from __future__ import annotations

import math

import numpy as np

from asperity.identify.estimator.covariance import estimates, widths
from asperity.identify.estimator.identified_law import identified
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
    covariance = None
    alone = np.zeros(len(at), dtype=np.bool_)
    units = np.eye(len(solution.held))
    if len(solution.misfits.paths) > 1 and confidence is not None:
        covariance = solution.covariance(None if length_error is None else length_error * by_length)
        assert covariance.leverage is not None
        alone = ~covariance.leverage.compares(units[at])
    half = np.where(alone, math.inf, widths(covariance, units[at], confidence)[0])
    told = ~at_bounds(solution.coordinates, [one for _, one in structure.coordinates])
    told[at] &= ~not_told(solution, half)
    law, rate = structure.law(solution.coordinates), solution.motions.law.rate
    return PathFit(
        _fitted_paths(solution, confidence),
        found=identified(
            law if rate is None else law.replace(rate=rate),
            structure,
            solution.coordinates,
            covariance,
        ),
        parameters=estimates(
            structure,
            solution.coordinates,
            told,
            covariance=covariance,
            confidence=confidence,
            fixed=~np.isnan(solution.held),
        ),
        loss=solution.loss,
        confidence=confidence,
        misfit=solution.misfit,
        slope_error=solution.slope_error,
        degrees_of_freedom=math.nan if covariance is None else covariance.degrees[0],
        limits=(speed_limit(solution), SCALE),
        warnings=warnings_of(solution, alone, half, by_length, length_error),
    )


def _fitted_paths(solution: Solution, confidence: float | None) -> tuple[FittedPath, ...]:
    """Return the paths with their launches, whose errors follow from those of the positions."""
    from scipy.special import ndtri

    misfits = solution.misfits
    columns = solution.jacobian * solution.weights[0][:, None]
    scale = np.linalg.norm(columns, axis=0)
    inverse = np.linalg.pinv(columns / scale)
    errors = np.zeros((len(misfits.paths), len(QUANTITIES)))
    errors[misfits.free] = (np.linalg.norm(inverse, axis=1) / scale)[misfits.size :]
    quantile = math.nan if confidence is None else float(ndtri(0.5 + 0.5 * confidence))
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
