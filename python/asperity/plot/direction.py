"""Friction coefficient and deflection over the sliding direction."""

from __future__ import annotations

from typing import Any

import numpy as np
from matplotlib.artist import Artist
from matplotlib.axes import Axes

from asperity._base.arrays import Array
from asperity.law import FrictionLaw
from asperity.plot import look

_NODES = 721


def plot_friction_coefficient(
    law: FrictionLaw, ax: Axes | None = None, *, across: bool = True, **kwargs: Any
) -> list[Artist]:
    """Draw the friction coefficients l_t and l_p over the sliding direction φ.

    l_t opposes the sliding; l_p, at right angles to it, deflects the body: −λ = λ_N (l_t e(φ) +
    l_p e⊥(φ)).

    Args:
        law: planar law.
        ax: axes; default new ones.
        across: whether to draw l_p, as a broken line.
        **kwargs: of both lines, as for ``Axes.plot``; a line style is that of l_t.

    Returns:
        The line of l_t, and that of l_p.

    Raises:
        DimensionError: if the law is not planar.

    Reference: [WL19] (119).

    >>> import matplotlib
    >>> matplotlib.use("Agg")
    >>> from asperity import Ellipse, FrictionLaw
    >>> from asperity.plot import plot_friction_coefficient
    >>> law = FrictionLaw.associated(Ellipse(0.6, 0.2))
    >>> along, across = plot_friction_coefficient(law)
    >>> float(along.get_ydata().max())
    0.6
    """
    phi = _directions()
    opposing, deflecting = look.planar_law(law).resistance(phi)
    ax, options = look.axes_or_new(ax), look.line_options(kwargs)
    label = options.pop("label", None)
    suffix = "" if label is None else f", {label}"
    (line,) = ax.plot(np.rad2deg(phi), opposing, label=f"$l_t${suffix}", **options)
    artists: list[Artist] = [line]
    if across:
        dashed = {**options, "color": line.get_color(), "linestyle": "--"}
        artists += ax.plot(np.rad2deg(phi), deflecting, label=f"$l_p${suffix}", **dashed)
    ax.set_ylabel("friction coefficient")
    ax.legend(frameon=False)
    _label_directions(ax)
    return artists


def plot_deflection(law: FrictionLaw, ax: Axes | None = None, **kwargs: Any) -> list[Artist]:
    """Draw the angle θ − φ between the force −λ and the sliding direction over φ.

    A positive angle turns the path of a freely sliding body clockwise.

    Args:
        law: planar law.
        ax: axes; default new ones.
        **kwargs: as for ``Axes.plot``.

    Returns:
        The line.

    Raises:
        DimensionError: if the law is not planar.

    Reference: [WL19] (71), Fig. 12c.

    >>> import matplotlib
    >>> matplotlib.use("Agg")
    >>> from asperity import Disk, FrictionLaw
    >>> from asperity.plot import plot_deflection
    >>> (line,) = plot_deflection(FrictionLaw.collinear(Disk(0.3)))
    >>> float(abs(line.get_ydata()).max()) < 1e-9
    True
    """
    phi = _directions()
    theta = look.planar_law(law).deflection(phi)
    ax = look.axes_or_new(ax)
    artists: list[Artist] = []
    artists += ax.plot(np.rad2deg(phi), np.rad2deg(theta), **kwargs)
    ax.set_ylabel(r"$\theta - \varphi$ in degrees")
    _label_directions(ax)
    return artists


def _directions() -> Array:
    return np.linspace(0.0, 2.0 * np.pi, _NODES)


def _label_directions(ax: Axes) -> None:
    ax.set_xticks(np.arange(0.0, 361.0, 45.0))
    ax.set_xlim(0.0, 360.0)
    ax.set_xlabel(r"sliding direction $\varphi$ in degrees")
