"""Friction coefficient and deflection over the sliding direction."""

from __future__ import annotations

from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.ticker import MaxNLocator

from asperity.law import FrictionLaw
from asperity.plot import look

_DIRECTIONS = np.linspace(0.0, 2.0 * np.pi, 721)


def plot_friction_coefficient(
    law: FrictionLaw,
    *,
    ax: Axes | None = None,
    polar: bool = False,
    across: bool = True,
    **kwargs: Any,
) -> Axes:
    """Draw the friction coefficients l_t and l_p over the sliding direction φ.

    l_t opposes the sliding; l_p, at right angles to it, deflects the body: −λ = λ_N (l_t e(φ) +
    l_p e⊥(φ)).

    Args:
        law: planar law.
        ax: axes; polar ones give a polar plot. Default new ones.
        polar: whether new axes are polar, with φ around and the coefficient outwards. There |l_p|
            is drawn, broken where l_p > 0 and dotted where l_p < 0.
        across: whether to draw l_p, as a broken line.
        **kwargs: of both lines, as for ``Axes.plot``; a line style is that of l_t.

    Returns:
        The axes.

    Raises:
        DimensionError: if the law is not planar.

    Reference: [WL19] (119).

    >>> import matplotlib
    >>> matplotlib.use("Agg")
    >>> from asperity import Ellipse, FrictionLaw
    >>> from asperity.plot import plot_friction_coefficient
    >>> law = FrictionLaw.associated(Ellipse(0.6, 0.2))
    >>> along, across = plot_friction_coefficient(law).lines
    >>> float(along.get_ydata().max())
    0.6
    """
    phi = _DIRECTIONS
    opposing, deflecting = look.planar_law(law).resistance(phi)
    with look.drawing(ax, projection="polar" if polar else None) as ax:
        options = look.line_options(kwargs)
        label = options.pop("label", None)
        suffix = "" if label is None else f", {label}"
        round_axes = ax.name == "polar"
        angle = phi if round_axes else np.rad2deg(phi)
        (line,) = ax.plot(angle, opposing, label=f"$l_t${suffix}", **options)
        if across:
            parts = [(deflecting, "--", f"$l_p${suffix}")]
            if round_axes:
                parts = [
                    (np.where(deflecting >= 0.0, deflecting, np.nan), "--", f"$l_p > 0${suffix}"),
                    (np.where(deflecting <= 0.0, -deflecting, np.nan), ":", f"$l_p < 0${suffix}"),
                ]
            for values, dashes, text in parts:
                # Where the law is isotropic l_p is 0 within rounding, and a dot in polar axes.
                own = {**options, "color": line.get_color(), "linestyle": dashes}
                ax.plot(angle, values, label=text, **own)
        _label(ax, "friction coefficient")
        ax.legend(**({"loc": "upper left", "bbox_to_anchor": (1.0, 1.05)} if round_axes else {}))
        return ax


def plot_deflection(
    law: FrictionLaw, *, ax: Axes | None = None, polar: bool = False, **kwargs: Any
) -> Axes:
    """Draw the angle θ − φ between the force −λ and the sliding direction over φ.

    A positive angle turns the path of a freely sliding body clockwise.

    Args:
        law: planar law.
        ax: axes; polar ones give a polar plot. Default new ones.
        polar: whether new axes are polar, with φ around and the angle outwards: a thin circle is
            zero, outside it the path turns clockwise.
        **kwargs: as for ``Axes.plot``.

    Returns:
        The axes.

    Raises:
        DimensionError: if the law is not planar.

    Reference: [WL19] (71), Fig. 12c.

    >>> import matplotlib
    >>> matplotlib.use("Agg")
    >>> from asperity import Disk, FrictionLaw
    >>> from asperity.plot import plot_deflection
    >>> (line,) = plot_deflection(FrictionLaw.collinear(Disk(0.3))).lines
    >>> float(abs(line.get_ydata()).max()) < 1e-9
    True
    """
    phi = _DIRECTIONS
    theta = np.rad2deg(look.planar_law(law).deflection(phi))
    with look.drawing(ax, projection="polar" if polar else None) as ax:
        round_axes = ax.name == "polar"
        ax.plot(phi if round_axes else np.rad2deg(phi), theta, **look.line_options(kwargs))
        if round_axes:
            ax.plot(phi, np.zeros_like(phi), color=look.INK, linewidth=0.8, zorder=1.9)
            drawn = np.concatenate([np.asarray(line.get_ydata(), dtype=float) for line in ax.lines])
            reach = max(float(np.abs(drawn).max()), 1.0)
            # The centre lies as far below zero as the largest angle reaches above, and a bit more.
            ax.set_ylim(-1.25 * reach, 1.05 * reach)
        _label(ax, r"$\theta - \varphi$ in degrees")
        return ax


def _label(ax: Axes, what: str) -> None:
    if ax.name == "polar":
        ax.set_xticks(np.deg2rad(np.arange(0.0, 360.0, 45.0)))
        ax.set_xlabel(f"{what}\n" + r"over the sliding direction $\varphi$")
        ax.yaxis.set_major_locator(MaxNLocator(4))
        return
    ax.set_xticks(np.arange(0.0, 361.0, 45.0))
    ax.set_xlim(0.0, 360.0)
    ax.set(xlabel=r"sliding direction $\varphi$ in degrees", ylabel=what)
