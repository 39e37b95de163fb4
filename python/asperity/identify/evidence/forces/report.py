"""One HTML file that tells all about a fit."""

from __future__ import annotations

import math
import os
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import TYPE_CHECKING

from asperity._base import report
from asperity._base.report import Block, Facts, Grid, Picture, Section, Text
from asperity.errors import FitError, ParameterError
from asperity.identify.evidence.coefficient.dependence import several_loads
from asperity.identify.evidence.forces.diagnostics import SETS
from asperity.identify.forces.processing import ProcessedData
from asperity.identify.models.coordinates import Estimate

if TYPE_CHECKING:
    from matplotlib.figure import Figure

    from asperity.identify.evidence.forces.result import Fit

# A law of more characters is a curve through points, of no use in print.
_LONGEST_LAW = 500


def write_report(
    fit: Fit,
    path: str | os.PathLike[str],
    title: str,
    figures: Mapping[str, Figure] | None = None,
    further: Sequence[Section] = (),
) -> Path:
    """Write the report of a fit with further sections; the file is complete or not there."""
    from asperity.plot.identification import report_figures
    from asperity.plot.look import png

    drawn = report_figures(fit) if figures is None else figures
    sections = [
        Section("", Text(_summary(fit)), *(Text(one, "warning") for one in fit.warnings)),
        Section("Parameters", *_parameters(fit), _law(fit)),
        *(Section(name, Picture(name, png(figure))) for name, figure in drawn.items()),
        Section("Is D = C?", _associativity(fit)),
        Section("Defects of the measured forces", _defects(fit)),
        *_comparison(fit),
        *further,
    ]
    return report.write_report(path, title, sections)


def _summary(fit: Fit) -> str:
    bands = (
        "without confidence intervals"
        if fit.confidence is None
        else f"confidence intervals of {100 * fit.confidence:g} %"
    )
    load = f" Normal force {loads_of(fit.data)}." if isinstance(fit.data, ProcessedData) else ""
    return (
        f"Reservoir C: {fit.reservoir_model}, direction set D: {fit.direction_model}, "
        f"{'jointly' if fit.joint else 'apart'}, {fit.loss.kind} loss. "
        f"{fit.samples} samples in {fit.turns} turns; residuals "
        f"{fit.rms:.4g} N (root mean square of a component); {bands}. "
        f"Forces in {fit.coverage}.{load}"
    )


def loads_of(data: ProcessedData) -> str:
    """Return the normal force, that of each run where they differ."""
    loads = several_loads(data)
    if not loads:
        return f"{data.usual_load:.4g} N"
    return f"{', '.join(f'{one:.4g}' for one in loads)} N, run by run"


def _parameters(fit: Fit) -> list[Block]:
    head = ["parameter", "estimate", "from", "to", "standard error"]
    rows = [[name, *cells(name, parameter)] for name, parameter in fit.parameters.items()]
    if fit.covariance is None:
        return [Grid(head, rows)]
    # The scale of D is the last parameter, and no coordinate.
    for row, shares in zip(rows, fit.covariance.shares(), strict=False):
        row += [
            f"{100.0 * share:.0f} %" if math.isfinite(share) else "not known"
            for share in shares.tolist()
        ]
    sources = (
        f"{SETS} Confidence intervals include the scatter between turns, or between runs if there "
        "are three or more, or two that differ by more than their turns (Student's t), and the "
        "uncertainty of the calibration and of the records without load where these are known; the "
        "last columns are their shares of the variance that is known. Semi-axes are per unit "
        "normal force. The scale of D has no effect on forces."
    )
    return [Grid([*head, "turns", "calibration", "zeros"], rows), Text(sources)]


def cells(name: str, parameter: Estimate) -> list[str]:
    """Return estimate, ends of the interval and standard error, with angles in degrees."""
    if not parameter.identifiable:
        return ["not identifiable"]
    factor, unit = (180.0 / math.pi, "°") if name.endswith(".angle") else (1.0, "")
    numbers = (parameter.value, parameter.low, parameter.high, parameter.standard_error)
    return [f"{factor * n:.5g}{unit}" if math.isfinite(n) else "–" for n in numbers]


def _associativity(fit: Fit) -> Block:
    """Return what the fit says about the relation between C and D."""
    found = fit.associativity
    defect = f"{found.defect:.2%}"
    if math.isfinite(found.defect_error):
        defect += f" (standard error {found.defect_error:.2%})"
    more = found.shortfall
    shortfall = f"{more.value:.2%}"
    if math.isfinite(more.low):
        shortfall += f" ({more.low:.2%} … {more.high:.2%})"
    return Facts(
        [
            (
                "force across the sliding over the derivative of the force along it; "
                "1 if D = C (associated), 0 if friction is opposite to sliding (collinear)",
                str(found.slope),
            ),
            ("difference of the two, root mean square relative to the force", defect),
            (
                "what another admissible force would dissipate more, in some direction; 0 for a "
                "law that is maximal monotone",
                shortfall,
            ),
        ]
    )


def _defects(fit: Fit) -> Block:
    """Return what the mean forces tell about their law without any model."""
    try:
        sets = fit.measured
        direction = sets.direction
    except ParameterError as error:
        return Text(str(error))
    return Facts(
        [
            ("mean forces in half degrees, no model", "noise included"),
            (
                "closure r_D(2π)/r_D(0); a direction set exists where it is 1",
                f"{sets.closure:.6f}",
            ),
            (
                "largest decrease of θ(φ), where D would not be convex",
                f"{sets.convexity_defect:.2g} rad",
            ),
            ("largest |f(φ + π) + f(φ)| relative to the largest force", f"{sets.asymmetry:.2g}"),
            ("largest |ln r_D| between (125) and the support function", f"{sets.difference:.2g}"),
            ("change of θ that makes D convex", f"{direction.angle_change:.2g} rad"),
            ("relative change of h_D that makes D convex", f"{direction.support_change:.2g}"),
        ]
    )


def _law(fit: Fit) -> Block:
    try:
        text = repr(fit.law)
    except FitError as error:
        return Text(str(error))
    if len(text) > _LONGEST_LAW:
        return Text("The law is a curve through many points, which Fit.save_law writes to a file.")
    return Text(text, "code")


def _comparison(fit: Fit) -> list[Section]:
    if fit.turns < 2:
        return []
    comparison = fit.comparison
    best, predicting = comparison.best, comparison.best_predicting
    rows = [
        (
            f"{one.reservoir}, {one.direction}",
            str(one.parameters),
            f"{one.rms:.4g}",
            f"{one.bic:.1f}",
            f"{one.behind:.2g} ± {one.behind_error:.2g}",
        )
        for one in comparison.candidates
    ]
    note = (
        "By the Bayesian information criterion (BIC), which weighs fit against the number of "
        f"parameters, {best.reservoir} and {best.direction} are best; the smallest pair that "
        "predicts left-out turns as well as the best one, within a standard error, is "
        f"{predicting.reservoir} and {predicting.direction}. The samples are worth "
        f"{comparison.effective_samples:.0f} independent components of forces."
    )
    head = ("C, D", "parameters", "residuals N", "ΔBIC", "cross-validation")
    marked = comparison.candidates.index(best)
    return [Section("Comparison of models", Grid(head, rows, marked), Text(note))]
