"""One HTML file that tells all about a fit."""

from __future__ import annotations

import base64
import html
import io
import math
import os
from collections.abc import Iterable
from pathlib import Path
from typing import TYPE_CHECKING

from asperity._base.files import atomic
from asperity.errors import FitError, ParameterError
from asperity.identify.fitting.models.coordinates import Estimate

if TYPE_CHECKING:
    from matplotlib.figure import Figure

    from asperity.identify.fit import Fit

_STYLE = """
body { font: 15px/1.5 system-ui, sans-serif; color: #222; max-width: 60rem; margin: 2rem auto;
       padding: 0 1rem; }
table { border-collapse: collapse; margin: 1rem 0; }
th, td { padding: .25rem .8rem; text-align: right; border-bottom: 1px solid #ddd; }
th:first-child, td:first-child { text-align: left; }
tr.best td { font-weight: 600; }
img { max-width: 100%; }
pre { background: #f4f4f4; padding: .8rem; white-space: pre-wrap; }
"""


def write_report(fit: Fit, path: str | os.PathLike[str], title: str) -> Path:
    """Write the report of a fit; the file is complete or not there."""
    target = Path(path)
    parts = [
        f"<h1>{html.escape(title)}</h1>",
        f"<p>{_summary(fit)}</p>",
        *(f"<p><strong>{html.escape(warning)}.</strong></p>" for warning in fit.warnings),
        "<h2>Parameters</h2>",
        _parameters(fit),
        _law(fit),
        *_figures(fit),
        "<h2>Defects of the measured forces</h2>",
        _defects(fit),
        *_comparison(fit),
    ]
    head = f'<meta charset="utf-8"><title>{html.escape(title)}</title><style>{_STYLE}</style>'
    body = "\n".join(parts)
    text = f'<!DOCTYPE html>\n<html lang="en"><head>{head}</head>\n<body>\n{body}\n</body></html>\n'
    with atomic(target) as file:
        file.write(text.encode())
    return target


def _summary(fit: Fit) -> str:
    bands = "without bands" if fit.confidence is None else f"bands of {100 * fit.confidence:g} %"
    return (
        f"Reservoir C: {html.escape(fit.reservoir_model)}, direction set D: "
        f"{html.escape(fit.direction_model)}, {'jointly' if fit.joint else 'apart'}, "
        f"{fit.loss.kind} loss. {fit.samples} samples in {fit.turns} turns; residuals "
        f"{fit.rms:.4g} N (root mean square of a component); {bands}."
    )


def _parameters(fit: Fit) -> str:
    head = ["parameter", "estimate", "from", "to", "standard error"]
    rows = [
        [f"<td>{html.escape(name)}</td>", *_cells(name, parameter)]
        for name, parameter in fit.parameters.items()
    ]
    sources = ""
    if fit.covariance is not None:
        head += ["turns", "calibration", "zeros"]
        # The scale of D is the last parameter, and no coordinate.
        for row, shares in zip(rows, fit.covariance.shares(), strict=False):
            row += [
                f"<td>{100.0 * share:.0f} %</td>" if math.isfinite(share) else "<td>not known</td>"
                for share in shares.tolist()
            ]
        sources = (
            "<p>Bands hold the scatter between turns, or between three runs or more (Student's t), "
            "and the uncertainty of the calibration and of the records without load where these "
            "are known; the last columns are their shares of the variance that is known. "
            "Semi-axes are per unit normal force. The scale of D has no effect on forces.</p>"
        )
    return _table(head, [f"<tr>{''.join(row)}</tr>" for row in rows]) + sources


def _defects(fit: Fit) -> str:
    """Return what the mean forces tell about their law without any model."""
    try:
        sets = fit.measured
        direction = sets.direction
    except ParameterError as error:
        return f"<p>{html.escape(str(error))}</p>"
    lines = {
        "closure r_D(2π)/r_D(0); a direction set exists where it is 1": f"{sets.closure:.6f}",
        "largest decrease of θ(φ), where D would not be convex": f"{sets.convexity_defect:.2g} rad",
        "largest |f(φ + π) + f(φ)| in parts of the largest force": f"{sets.asymmetry:.2g}",
        "largest |ln r_D| between (125) and the support function": f"{sets.difference:.2g}",
        "change of θ that makes D convex": f"{direction.angle_change:.2g} rad",
        "relative change of h_D that makes D convex": f"{direction.support_change:.2g}",
    }
    rows = [f"<tr><td>{name}</td><td>{value}</td></tr>" for name, value in lines.items()]
    return _table(("mean forces in half degrees, no model", "noise included"), rows)


def _cells(name: str, parameter: Estimate) -> Iterable[str]:
    if not parameter.identifiable:
        return ['<td colspan="4">not identifiable</td>']
    angle = name.endswith(".angle")
    factor, unit = (180.0 / math.pi, "°") if angle else (1.0, "")
    numbers = (parameter.value, parameter.low, parameter.high, parameter.standard_error)
    return [
        f"<td>{factor * number:.5g}{unit}</td>" if math.isfinite(number) else "<td>–</td>"
        for number in numbers
    ]


def _law(fit: Fit) -> str:
    try:
        law = fit.law
    except FitError as error:
        return f"<p>{html.escape(str(error))}</p>"
    text = repr(law)
    if len(text) > 500:
        return "<p>The law is a curve through many points: take it from the fit.</p>"
    return f"<pre>{html.escape(text)}</pre>"


def _figures(fit: Fit) -> list[str]:
    from asperity.plot import identification, look

    with look.style():
        figures = {
            "Sets": identification.sets_figure(fit),
            "Forces over the sliding direction": identification.forces_figure(fit),
            "Residuals": identification.residuals_figure(fit),
        }
    return [f"<h2>{name}</h2>\n{_image(figure, name)}" for name, figure in figures.items()]


def _image(figure: Figure, name: str) -> str:
    buffer = io.BytesIO()
    figure.savefig(buffer, format="png", dpi=110)
    data = base64.b64encode(buffer.getvalue()).decode()
    return f'<img alt="{name}" src="data:image/png;base64,{data}">'


def _comparison(fit: Fit) -> list[str]:
    if fit.turns < 2:
        return []
    comparison = fit.comparison
    best, predicting = comparison.best, comparison.best_predicting
    rows = []
    for candidate in comparison.candidates:
        cells = (
            f"{candidate.reservoir}, {candidate.direction}",
            str(candidate.parameters),
            f"{candidate.rms:.4g}",
            f"{candidate.bic:.1f}",
            f"{candidate.left_out:.2g} ± {candidate.left_out_error:.2g}",
        )
        mark = ' class="best"' if candidate is best else ""
        rows.append(f"<tr{mark}>{''.join(f'<td>{html.escape(cell)}</td>' for cell in cells)}</tr>")
    head = ("C, D", "parameters", "residuals N", "ΔBIC", "turns left out")
    note = (
        f"<p>BIC prefers {best.reservoir} and {best.direction}; the smallest pair that predicts "
        "turns left out as well as the best one, within a standard error, is "
        f"{predicting.reservoir} and {predicting.direction}. The samples are worth "
        f"{comparison.effective_samples:.0f} independent components of forces.</p>"
    )
    return ["<h2>Comparison of models</h2>", _table(head, rows), note]


def _table(head: Iterable[str], rows: Iterable[str]) -> str:
    top = "".join(f"<th>{name}</th>" for name in head)
    return f"<table><tr>{top}</tr>\n" + "\n".join(rows) + "\n</table>"
