"""Figures of laws fitted to measured forces."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from asperity._base import arrays
from asperity.errors import FitError
from asperity.plot.look import (
    BLUE,
    DIRECTION,
    GREY,
    INK,
    ORANGE,
    RESERVOIR,
    drawing,
    line_options,
    style,
)
from asperity.plot.sets import draw_set

if TYPE_CHECKING:
    from asperity.identify import Fit, LawComparison
    from asperity.identify.estimator.law_comparison import CurveName

_DIRECTIONS = np.linspace(0.0, 2.0 * np.pi, 721)
_DEGREES = np.rad2deg(_DIRECTIONS)
_TICKS = np.arange(0, 361, 45)


def plot_fitted_sets(fit: Fit, *, ax: Axes | None = None, **kwargs: Any) -> Axes:
    """Draw the mean measured forces −λ/λ_N, the fitted C with its band, and D inside it.

    Args:
        fit: what `fit_law` returns.
        ax: axes; default new ones.
        **kwargs: of the points of the measured forces, as for ``Axes.plot``.

    Returns:
        The axes.

    >>> import matplotlib
    >>> matplotlib.use("Agg")
    >>> import numpy as np
    >>> from asperity.identify import fit_law
    >>> from asperity.plot import plot_fitted_sets
    >>> phi = np.linspace(0.0, 4.0 * np.pi, 500, endpoint=False)
    >>> data = phi, 0.3 * np.stack([np.cos(phi), np.sin(phi)], axis=-1)
    >>> ax = plot_fitted_sets(fit_law(data, reservoir="circle", direction="circle"))
    """
    _check(fit)
    with drawing(ax) as ax:
        _, means = fit.means
        look: dict[str, Any] = {"linestyle": "", "marker": ".", "markersize": 2.5, "color": GREY}
        ax.plot(*means.T, label="measured", **{**look, **line_options(kwargs)})
        e = arrays.unit_vectors(_DIRECTIONS)
        _, low, high = fit.radius_band(_DIRECTIONS)
        if np.isfinite(low).all():
            ring = np.concatenate([low[:, None] * e, (high[:, None] * e)[::-1]])
            ax.fill(*ring.T, color=RESERVOIR, alpha=0.3, linewidth=0.0, label="band of C")
        draw_set(ax, fit.reservoir, color=RESERVOIR, label="C")
        try:
            draw_set(ax, fit.law.direction, color=DIRECTION, linestyle="--", label="D")
        except FitError:
            ax.set_title("D is not convex")
        ax.set(
            aspect="equal",
            xlabel=r"friction coefficient $-\lambda_1/\lambda_N$",
            ylabel=r"friction coefficient $-\lambda_2/\lambda_N$",
        )
        ax.legend(loc="center")
        return ax


def plot_fitted_forces(fit: Fit, *, ax: Axes | None = None, **kwargs: Any) -> Axes:
    """Draw l_t and l_p, the parts of −λ/λ_N against the sliding and across it, over φ.

    Args:
        fit: what `fit_law` returns.
        ax: axes; default new ones.
        **kwargs: of the points of the measured forces, as for ``Axes.plot``.

    Returns:
        The axes.
    """
    _check(fit)
    with drawing(ax) as ax:
        phi, means = fit.means
        measured = arrays.along_and_across(means, phi)
        bands = fit.bands(_DIRECTIONS)
        look: dict[str, Any] = {"linestyle": "", "marker": ".", "markersize": 2.5, "color": GREY}
        for column, (name, color) in enumerate(
            (("$l_t$, against sliding", BLUE), ("$l_p$, across", ORANGE))
        ):
            ax.plot(np.rad2deg(phi), measured[column], **{**look, **line_options(kwargs)})
            middle, width = bands.resistance[:, column], bands.resistance_half_width[:, column]
            ax.plot(_DEGREES, middle, color=color, label=name)
            if np.isfinite(width).all():
                ax.fill_between(
                    _DEGREES, middle - width, middle + width, color=color, alpha=0.3, linewidth=0.0
                )
        _over_directions(ax, r"friction coefficient $-\lambda/\lambda_N$")
        ax.legend()
        return ax


def plot_residuals(fit: Fit, *, ax: Axes | None = None, **kwargs: Any) -> Axes:
    """Draw the mean of the residual forces over φ: what the model cannot follow stands out.

    Args:
        fit: what `fit_law` returns.
        ax: axes; default new ones.
        **kwargs: of the lines, as for ``Axes.plot``.

    Returns:
        The axes.
    """
    _check(fit)
    with drawing(ax) as ax:
        phi, means = fit.means
        parts = arrays.along_and_across(means - fit.forces(phi), phi)
        names = (("against sliding", BLUE), ("across sliding", ORANGE))
        for values, (name, color) in zip(parts, names, strict=True):
            look: dict[str, Any] = {"color": color, "linewidth": 0.8, "label": name}
            ax.plot(np.rad2deg(phi), values, **{**look, **line_options(kwargs)})
        ax.axhline(0.0, color=INK, linewidth=0.6)
        _over_directions(ax, r"mean residual of the coefficient $-\lambda/\lambda_N$")
        ax.legend()
        return ax


def plot_law_comparison(
    comparison: LawComparison,
    *,
    ax: Axes | None = None,
    quantity: CurveName = "coefficient",
    **kwargs: Any,
) -> Axes:
    """Draw by how much a curve of two laws differs over the direction, with its band.

    Where the band leaves zero, the laws differ.

    Args:
        comparison: what `identify.compare_laws` returns.
        ax: axes; default new ones.
        quantity: which curve: the friction coefficient, the deflection in degrees, the radius of C,
            or that of D relative to its mean.
        **kwargs: of the line, as for ``Axes.plot``.

    Returns:
        The axes.
    """
    arrays.choice(quantity, "quantity", tuple(_CURVES))
    curve, name = getattr(comparison, quantity), _CURVES[quantity]
    scale = np.rad2deg(1.0) if quantity == "deflection" else 1.0
    degrees, change = np.rad2deg(comparison.phi), scale * curve.difference
    half = scale * curve.half_width
    with drawing(ax) as ax:
        label = f"second less first, {comparison.confidence:.0%} band"
        look: dict[str, Any] = {"color": BLUE, "label": label, **line_options(kwargs)}
        (line,) = ax.plot(degrees, change, **look)
        ax.fill_between(
            degrees, change - half, change + half, color=line.get_color(), alpha=0.25, linewidth=0.0
        )
        ax.axhline(0.0, color=INK, linewidth=0.8)
        _over_directions(ax, name)
        ax.legend()
        return ax


_CURVES: dict[CurveName, str] = {
    "coefficient": "change of the friction coefficient",
    "deflection": "change of the deflection in degrees",
    "reservoir": "change of the radius of C",
    "direction": "change of the radius of D over its mean",
}


def report_figures(fit: Fit) -> dict[str, Figure]:
    """Return the figures of a report by their headings."""
    figures = {}
    with style():
        for name, size, plot in (
            ("Sets", (6.4, 5.6), plot_fitted_sets),
            ("Forces over the sliding direction", (8.0, 4.0), plot_fitted_forces),
            ("Residuals", (8.0, 3.2), plot_residuals),
        ):
            figures[name] = Figure(figsize=size, layout="constrained")
            plot(fit, ax=figures[name].add_subplot())
    return figures


def _check(fit: Fit) -> None:
    from asperity.identify import Fit

    arrays.of_kind(fit, "fit", Fit, "a Fit, as of fit_law")


def _over_directions(ax: Axes, label: str) -> None:
    ax.set_xlim(0.0, 360.0)
    ax.set_xticks(_TICKS)
    ax.set(xlabel="sliding direction φ in °", ylabel=label)
