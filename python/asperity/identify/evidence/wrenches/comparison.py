"""Models of a patch side by side: fitted to all pairs, and without blocks of these in turn."""

from __future__ import annotations

import math

import numpy as np

from asperity.errors import ParameterError
from asperity.identify.estimator.comparison import Comparison, compared, inflation
from asperity.identify.estimator.descent import Found
from asperity.identify.estimator.leverage import leverage_of
from asperity.identify.estimator.loss import Loss, LossName
from asperity.identify.evidence.wrenches.pairs import Pairs
from asperity.identify.evidence.wrenches.solving import (
    Labels,
    fitted,
    left_out,
    starts_of,
    sums,
)
from asperity.identify.models.patches import PatchModel


def compare(
    models: dict[str, PatchModel],
    pairs: Pairs,
    *,
    loss: LossName,
    blocks: Labels,
    folds: Labels,
    confidence: float,
    known: dict[PatchModel, Found],
) -> Comparison:
    """Fit models to the same pairs and compare them; `known` ones are fitted already.

    The criterion compares losses of one scale: that of the model that fits best.
    """
    if not models:
        raise ParameterError("models", "must name at least one model")
    found = []
    for name, model in models.items():
        pairs.check(model.size)
        if model.frame == "ground" and pairs.angle is None:
            raise ParameterError("angle", f"must be given: {name!r} is a model of the ground")
        found.append(known.get(model) or fitted(model, pairs, starts_of(model, pairs, loss), loss))
    listed = list(zip(models.values(), found, strict=True))
    squares = [(model.both(one.p, pairs)[0] - pairs.wrench) ** 2 for model, one in listed]
    # A fit without a misfit has no scale.
    measure = Loss(loss, min(one.scale for one in found) or 1.0, components=1)
    costs = np.array([measure.at(one)[0].sum() for one in squares])
    model, best = listed[int(costs.argmin())]
    own = measure.replace(scale=best.scale or 1.0)
    parts, single = sums(model, pairs, best, own, blocks)
    inverse = leverage_of(parts.total()[2], parts.matrix).inverse
    whole = float((pairs.wrench**2).sum())
    return compared(
        [(name, (model,)) for name, model in models.items()],
        [model.size for model in models.values()],
        rms=[math.sqrt(float(one.sum()) / whole) for one in squares],
        costs=costs,
        errors=np.array(
            [
                np.bincount(blocks, left_out(model, pairs, one, folds, loss)) / whole
                for model, one in listed
            ]
        ),
        components=float(pairs.wrench.size),
        inflation=inflation(inverse, parts.gradient, float(np.trace(inverse @ single))),
        confidence=confidence,
    )
