"""Plots of the modes of squeal: over one or two parameters, and damping ratios over frequency."""

from __future__ import annotations

from typing import Literal, Protocol

import numpy as np
from matplotlib.axes import Axes

from asperity._base import arrays
from asperity._base.arrays import Array
from asperity.errors import ParameterError
from asperity.plot import look
from asperity.plot.steady_sliding import plot_growth_chart
from asperity.steady_sliding import SquealMap

_WORDS = {
    "friction": "factor of friction",
    "phi": "sliding direction in degrees",
    "speed": "factor of the sliding speed",
}
_UNITS = {
    "growth_rates": "growth rate in 1/s",
    "frequencies": "frequency in Hz",
    "damping_ratios": "damping ratio",
}


class HasModes(Protocol):
    """Modes, such as `asperity.steady_sliding.ComplexModes` and `asperity.SquealMap`."""

    @property
    def frequencies(self) -> Array:
        """In Hz."""

    @property
    def damping_ratios(self) -> Array:
        """Negative where a mode grows."""


def plot_squeal_map(
    chart: SquealMap,
    *,
    ax: Axes | None = None,
    quantity: Literal["growth_rates", "frequencies", "damping_ratios"] = "growth_rates",
) -> Axes:
    """Draw the largest growth rate over two parameters, or all modes over one.

    Over one parameter modes are lines, heavy where they grow, with circles where growth begins or
    ends; over two the border of the unstable region is a line, and grey is without steady sliding.

    Args:
        chart: as of `asperity.squeal_map`.
        ax: axes; default new ones.
        quantity: what is drawn over one parameter.

    Returns:
        The axes.
    """
    axes = [
        (np.rad2deg(values) if name == "phi" else values, _WORDS[name])
        for name, values in chart.parameters.items()
    ]
    if len(axes) == 2:
        growth = np.where(np.isfinite(chart.growth_rate), chart.growth_rate, np.nan)
        # Directions across, as the friction is up.
        order = (1, 0) if next(iter(chart.parameters)) != "phi" else (0, 1)
        (x, across), (y, up) = (axes[k] for k in order)
        ax = plot_growth_chart(growth.transpose(order), x=x, y=y, ax=ax)
        ax.set(xlabel=across, ylabel=up)
        return ax
    if quantity not in _UNITS:
        raise ParameterError("quantity", f"must be one of {', '.join(_UNITS)}, got {quantity!r}")
    ((x, across),) = axes
    with look.drawing(ax) as ax:
        parts = chart.unstable, chart.growth_rates, getattr(chart, quantity)
        for grows, growth, height in zip(*parts, strict=True):
            ax.plot(x, height, color=look.BLUE, linewidth=0.9)
            ax.plot(x, np.where(grows, height, np.nan), color=look.ORANGE, linewidth=2.0)
            known = ~np.isnan(growth)
            at = np.flatnonzero((grows[1:] != grows[:-1]) & known[1:] & known[:-1])
            share = np.clip(growth[at] / (growth[at] - growth[at + 1]), 0.0, 1.0)
            place, level = ((1.0 - share) * v[at] + share * v[at + 1] for v in (x, height))
            ax.plot(place, level, "o", color=look.INK, markerfacecolor="white", markersize=4.5)
        if quantity != "frequencies":
            ax.axhline(0.0, color=look.INK, linewidth=0.6)
        ax.set(xlabel=across, ylabel=_UNITS[quantity])
        return ax


def plot_damping_ratios(modes: HasModes, *, ax: Axes | None = None) -> Axes:
    """Draw damping ratios over the frequency; those of growing modes are below zero.

    Args:
        modes: what `asperity.stability` returns with `near` or `band`, or a map.
        ax: axes; default new ones.

    Returns:
        The axes.
    """
    shown = arrays.with_gaps(modes.frequencies, "modes", (None,) * np.ndim(modes.frequencies))
    x, y = shown.ravel() / 1e3, np.asarray(modes.damping_ratios).ravel()
    with look.drawing(ax) as ax:
        for grows, colour in ((False, look.BLUE), (True, look.ORANGE)):
            chosen = (y < 0.0) == grows
            ax.plot(x[chosen], y[chosen], "o", color=colour, markersize=4.0)
        ax.axhline(0.0, color=look.INK, linewidth=0.6)
        ax.set(xlabel="frequency in kHz", ylabel="damping ratio")
        return ax
