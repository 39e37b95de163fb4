"""Models of a patch side by side: by BIC, and by blocks of pairs that are left out."""

from __future__ import annotations

import math
from collections.abc import Iterable

import numpy as np

from asperity._base import arrays
from asperity._base.arrays import Array
from asperity._base.result import Axis, Series, Table, TableResult, counted
from asperity._base.tables import aligned
from asperity._base.value import Record, Value
from asperity.errors import ParameterError
from asperity.identify.evidence.wrenches.pairs import Pairs
from asperity.identify.evidence.wrenches.solving import (
    Found,
    Labels,
    LossName,
    fitted,
    inflation,
    left_out,
    scores,
    starts_of,
)
from asperity.identify.models.coordinates import Estimate
from asperity.identify.models.patches import PatchModel


class PatchCandidate(Record):
    """One model in a comparison.

    Args:
        name: of the model.
        parameters: how many are fitted.
        rms: root mean square of the residual wrench relative to that of the wrench.
        left_out: the same of wrenches that are predicted from the other blocks.
        bic: Bayesian information criterion relative to the smallest one.
    """

    name: str
    parameters: int
    rms: float
    left_out: float
    bic: float


class PatchComparison(TableResult, Value):
    """Models that were fitted to the same pairs of wrench and twist.

    Args:
        candidates: in the order in which they were named.
        errors: sums of squared errors of predicted wrenches over their sum of squares, of each
            model and block, shape ``(m, b)``; a block is predicted without the part it lies in.
        effective_samples: number of independent components among those of the wrenches.
        confidence: level of the confidence intervals of improvements.
    """

    candidates: tuple[PatchCandidate, ...]
    errors: Array
    effective_samples: float
    confidence: float

    def __init__(
        self,
        candidates: Iterable[PatchCandidate],
        *,
        errors: Array,
        effective_samples: float,
        confidence: float = 0.95,
    ) -> None:
        listed = tuple(candidates)
        self._set(
            candidates=listed,
            errors=arrays.array(errors, "errors", (len(listed), None)),
            effective_samples=arrays.positive(effective_samples, "effective_samples"),
            confidence=arrays.fraction(confidence, "confidence"),
        )

    @property
    def best(self) -> PatchCandidate:
        """The candidate of the smallest BIC."""
        return min(self.candidates, key=lambda one: one.bic)

    @property
    def best_predicting(self) -> PatchCandidate:
        """The candidate with the smallest error of the wrenches that were left out."""
        return min(self.candidates, key=lambda one: one.left_out)

    def improvement(self, better: str, *, over: str) -> Estimate:
        """Return the share of the mean square error by which one model predicts better.

        Of the extended over the associated law of the same reservoir this is what the data say of
        D ≠ C within these models; where C is too simple for the patch it may be its shape.

        Args:
            better: name of the model in question.
            over: name of the one beside which it is put.

        Returns:
            1 − e²/e₀², with its confidence interval from the scatter of the blocks.
        """
        from scipy.stats import t

        one, other = self.errors[self._row(better, "better")], self.errors[self._row(over, "over")]
        share = 1.0 - one.sum() / other.sum()
        # The ratio of two sums over blocks, to first order in their deviations.
        away = (one - (1.0 - share) * other) / other.mean()
        count = len(away)
        error = float(np.std(away, ddof=1)) / math.sqrt(count)
        half = float(t.ppf(0.5 + 0.5 * self.confidence, count - 1)) * error
        return Estimate(share, share - half, share + half, error)

    def _row(self, name: str, argument: str) -> int:
        names = [one.name for one in self.candidates]
        return names.index(arrays.choice(name, argument, names))

    def summary(self) -> str:
        """Return the models with their errors, and which is the best."""
        rows = [("model", "parameters", "rms", "left out", "BIC")]
        rows += [
            (
                one.name,
                str(one.parameters),
                f"{one.rms:.4f}",
                f"{one.left_out:.4f}",
                f"{one.bic:.1f}",
            )
            for one in self.candidates
        ]
        return "\n".join(
            [
                f"{counted(len(self.candidates), 'model')} of a patch, with relative errors of the "
                "wrench as fitted and in blocks that were left out:",
                aligned(rows, right=(1, 2, 3, 4)),
                f"The smallest BIC has {self.best.name}, the smallest error of left-out blocks "
                f"{self.best_predicting.name}; the components are worth "
                f"{self.effective_samples:.0f} independent ones.",
            ]
        )

    def __repr__(self) -> str:
        names = ", ".join(one.name for one in self.candidates)
        return f"<PatchComparison: {names}; best by BIC {self.best.name}>"

    def _table(self) -> Table:
        rows = ("model",)
        words = {
            "parameters": "number of fitted parameters",
            "rms": "relative error of the wrench",
            "left_out": "relative error of the wrench in blocks that were left out",
            "bic": "Bayesian information criterion above the smallest one",
        }
        series = {
            name: Series(np.array([getattr(one, name) for one in self.candidates]), rows, "", text)
            for name, text in words.items()
        }
        names = tuple(one.name for one in self.candidates)
        return Table(
            {"model": Axis(names, "", "model")},
            series,
            {"effective_samples": self.effective_samples},
        )


def compared(
    models: dict[str, PatchModel],
    pairs: Pairs,
    *,
    loss: LossName,
    scale: float | None,
    blocks: Labels,
    folds: Labels,
    confidence: float,
    known: dict[PatchModel, Found] | None = None,
) -> PatchComparison:
    """Fit models to the same pairs and compare them; `known` ones are fitted already.

    The criterion compares losses of one scale: that of the model that fits best.
    """
    if not models:
        raise ParameterError("models", "must name at least one model")
    found = {}
    for name, model in models.items():
        pairs.check(model.size)
        if model.frame == "ground" and pairs.angle is None:
            raise ParameterError("angle", f"must be given: {name!r} is a model of the ground")
        if known is not None and model in known:
            found[name] = known[model]
        else:
            found[name] = fitted(model, pairs, starts_of(model, pairs, loss, scale), loss, scale)
    residuals = {
        name: model.both(found[name].p, pairs)[0] - pairs.wrench for name, model in models.items()
    }
    least = min(one.scale for one in found.values())
    at_one_scale = {name: _cost(one, least) for name, one in residuals.items()}
    best = min(at_one_scale, key=lambda name: at_one_scale[name])
    components = float(pairs.wrench.size)
    effective = components / inflation(scores(models[best], pairs, found[best], blocks))
    bic = {
        name: effective * math.log(max(cost, np.finfo(float).tiny) / components)
        + models[name].size * math.log(effective)
        for name, cost in at_one_scale.items()
    }
    whole = float((pairs.wrench**2).sum())
    errors, candidates = [], []
    for name, model in models.items():
        squared = left_out(model, pairs, found[name], folds, loss)
        errors.append(np.bincount(blocks, weights=squared) / whole)
        candidates.append(
            PatchCandidate(
                name,
                model.size,
                math.sqrt(float((residuals[name] ** 2).sum()) / whole),
                math.sqrt(float(squared.sum()) / whole),
                bic[name] - min(bic.values()),
            )
        )
    return PatchComparison(
        candidates, errors=np.array(errors), effective_samples=effective, confidence=confidence
    )


def _cost(residuals: Array, scale: float) -> float:
    """Return the sum of the losses, as SciPy defines the soft one."""
    squares = residuals**2
    if scale > 0.0:
        squares = 2.0 * scale**2 * (np.sqrt(1.0 + squares / scale**2) - 1.0)
    return float(squares.sum())
