"""Models of the same data side by side: by BIC, and by clusters that are left out."""

from __future__ import annotations

import math
from collections.abc import Iterable, Sequence
from dataclasses import KW_ONLY
from typing import Annotated, Any

import numpy as np

from asperity._base import arrays
from asperity._base.arrays import Array
from asperity._base.quantiles import student
from asperity._base.result import Axis, Series, Table, TableResult, counted
from asperity._base.tables import aligned
from asperity._base.value import AnyArray, Fraction, Given, Positive, Record, a_tuple
from asperity.identify.models.coordinates import Estimate
from asperity.identify.models.names import name_of


class Candidate(Record):
    """One model in a comparison.

    Args:
        name: of the model; of a planar law, the names of the models of C and D.
        parameters: how many are fitted.
        rms: root mean square of the residuals, as of the fit.
        bic: Bayesian information criterion relative to the smallest one.
        left_out: root mean square error of what is predicted from the other turns or blocks,
            relative to that of the data.
        behind: by how much the square of it exceeds that of the best prediction.
        behind_error: standard error of this difference, over turns or blocks.
        models: of C and D, or of a patch.
    """

    name: str
    parameters: int
    rms: float
    bic: float
    left_out: float
    behind: float
    behind_error: float
    models: Annotated[tuple[Any, ...], arrays.several] = ()

    @property
    def reservoir(self) -> str:
        """Name of the model of C of a planar law."""
        return name_of(self.models[0]) if self.models else self.name

    @property
    def direction(self) -> str:
        """Name of the model of D of a planar law."""
        return name_of(self.models[-1]) if self.models else self.name


class Comparison(TableResult, Record):
    """Models that were fitted to the same data.

    Args:
        candidates: in the order in which they were named.
        errors: squared errors of what is predicted, summed over a turn or block that is left out,
            over the sum of squares of all data: of each model, shape ``(m, b)``.
        effective_samples: number of independent components among the data.
        confidence: level of the confidence intervals of improvements.
    """

    candidates: Annotated[Given[Iterable[Candidate], tuple[Candidate, ...]], a_tuple]
    _: KW_ONLY
    errors: AnyArray
    effective_samples: Positive
    confidence: Fraction = 0.95

    def _complete(self, given: dict[str, Any]) -> None:
        shape = len(given["candidates"]), None
        given["errors"] = arrays.array(given["errors"], "errors", shape)

    @property
    def best(self) -> Candidate:
        """The candidate of the smallest BIC."""
        return min(self.candidates, key=lambda one: one.bic)

    @property
    def best_predicting(self) -> Candidate:
        """The smallest candidate that predicts left-out data as well as the best one.

        As well means within one standard error.
        """
        good = [one for one in self.candidates if one.behind <= one.behind_error]
        return min(good, key=lambda one: one.parameters)

    def improvement(self, better: str, *, over: str) -> Estimate:
        """Return the share of the mean square error by which one model predicts better.

        Of the extended over the associated law of the same reservoir this is what the data say of
        D ≠ C within these models; where C is too simple it may be its shape.

        Args:
            better: name of the model in question.
            over: name of the one beside which it is put.

        Returns:
            1 − e²/e₀², with its confidence interval from the scatter of turns or blocks.
        """
        names = [one.name for one in self.candidates]
        one, other = (
            self.errors[names.index(arrays.choice(name, argument, names))]
            for name, argument in ((better, "better"), (over, "over"))
        )
        share = 1.0 - one.sum() / other.sum()
        # The ratio of two sums over blocks, to first order in their deviations.
        away = (one - (1.0 - share) * other) / other.mean()
        count = len(away)
        error = float(np.std(away, ddof=1)) / math.sqrt(count)
        half = student(self.confidence, count - 1) * error
        return Estimate(share, share - half, share + half, error)

    def summary(self) -> str:
        """Return the models with their errors, and which is the best."""
        rows = [("model", "parameters", "rms", "left out", "BIC")]
        rows += [
            (c.name, str(c.parameters), f"{c.rms:.4g}", f"{c.left_out:.4f}", f"{c.bic:.1f}")
            for c in self.candidates
        ]
        return "\n".join(
            [
                f"{counted(len(self.candidates), 'model')}, with the errors of the fit and, "
                "relative to the data, of what is predicted where it was left out:",
                aligned(rows, right=(1, 2, 3, 4)),
                f"The smallest BIC has {self.best.name}; the smallest model that predicts as well "
                f"as the best one is {self.best_predicting.name}; the components are worth "
                f"{self.effective_samples:.0f} independent ones.",
            ]
        )

    def __repr__(self) -> str:
        names = "; ".join(one.name for one in self.candidates)
        return f"<Comparison: {names}; best by BIC {self.best.name}>"

    def _table(self) -> Table:
        words = {
            "parameters": "number of fitted parameters",
            "rms": "root mean square of the residuals",
            "bic": "Bayesian information criterion above the smallest one",
            "left_out": "relative error of what was left out",
            "behind": "square of this above that of the best prediction",
            "behind_error": "its standard error",
        }
        series = {
            name: Series(
                np.array([getattr(one, name) for one in self.candidates]), ("model",), "", text
            )
            for name, text in words.items()
        }
        names = tuple(one.name for one in self.candidates)
        return Table(
            {"model": Axis(names, "", "model")},
            series,
            {"effective_samples": self.effective_samples},
        )


def compared(
    models: Sequence[tuple[str, tuple[Any, ...]]],
    sizes: Sequence[int],
    *,
    rms: Sequence[float],
    costs: Array,
    errors: Array,
    components: float,
    inflation: float,
    confidence: float = 0.95,
) -> Comparison:
    """Return the comparison of fits.

    Noise is correlated: n components are worth n/κ independent ones. Then
    BIC = (n/κ) ln(cost/n) + k ln(n/κ).

    Args:
        models: with their names.
        sizes: numbers of parameters k.
        rms: root mean squares of the residuals.
        costs: sums of the losses at one scale.
        errors: as of `Comparison`.
        components: n, of all data.
        inflation: κ.
        confidence: as of `Comparison`.
    """
    effective = components / inflation
    least = np.finfo(float).tiny
    bic = effective * np.log(np.maximum(costs, least) / components)
    bic += np.array(sizes) * math.log(effective)
    count = errors.shape[1]
    worse = count * (errors - errors[errors.sum(axis=1).argmin()])
    spread = worse.std(axis=1, ddof=1) / math.sqrt(count)
    left_out = np.sqrt(errors.sum(axis=1))
    behind = worse.mean(axis=1)
    bic -= bic.min()
    return Comparison(
        [
            Candidate(
                name,
                sizes[k],
                rms[k],
                bic=bic[k],
                left_out=left_out[k],
                behind=behind[k],
                behind_error=spread[k],
                models=parts,
            )
            for k, (name, parts) in enumerate(models)
        ],
        errors=errors,
        effective_samples=effective,
        confidence=confidence,
    )


def inflation(inverse: Array, gradients: Array, independent: float) -> float:
    """Return κ, at least 1: how much more coordinates scatter than with independent residuals.

    Args:
        inverse: of JᵀJ, ``(k, k)``.
        gradients: of the clusters, ``(G, k)``.
        independent: what the squares of the steps of independent residuals add up to.
    """
    if not independent > 0.0:
        return 1.0
    away = gradients - gradients.mean(axis=0)
    scatter = float(np.einsum("gi,ij,gj->", away, inverse, away))
    return max(scatter * len(away) / (len(away) - 1.0) / independent, 1.0)
