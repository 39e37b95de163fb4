"""Figures of laws fitted to measured paths."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np
from matplotlib.axes import Axes

from asperity._base import arrays
from asperity.plot.look import BLUE, ORANGE, drawing, line_options

if TYPE_CHECKING:
    from asperity.identify import PathFit


def plot_fitted_paths(fit: PathFit, *, ax: Axes | None = None, **kwargs: Any) -> Axes:
    """Draw the measured points and the simulated paths that are fitted to them.

    Args:
        fit: what `fit_paths` returns.
        ax: axes; default new ones.
        **kwargs: of the measured points, as for ``Axes.plot``.

    Returns:
        The axes.

    Reference: [WL19] Fig. 27.

    >>> import matplotlib
    >>> matplotlib.use("Agg")
    >>> import asperity as asp
    >>> from asperity.identify import fit_paths
    >>> from asperity.plot import plot_fitted_paths
    >>> point = asp.SlidingPoint(1.0, law=asp.FrictionLaw.isotropic(0.4))
    >>> run = asp.simulate(point, dt=0.01, t_end=0.4, u0=[1.0, 0.2])
    >>> models = {"reservoir": "circle", "direction": "circle"}
    >>> ax = plot_fitted_paths(fit_paths([run], system=point, position_error=1e-4, **models))
    >>> ax.get_xlabel()
    'x₁ in m'
    """
    from asperity.identify import PathFit

    arrays.of_kind(fit, "fit", PathFit, "a PathFit")
    look: dict[str, Any] = {"linestyle": "", "marker": "o", "markersize": 3.0, "color": ORANGE}
    with drawing(ax) as ax:
        for k, path in enumerate(fit.paths):
            names = ("simulated", "measured") if k == 0 else (None, None)
            launch = [path.launch_x1.value, path.launch_x2.value]
            # Before its launch a body rests there.
            curve = np.vstack([launch, path.simulated])
            ax.plot(*curve.T, color=BLUE, linewidth=1.2, label=names[0])
            ax.plot(*path.position.T, **{"label": names[1], **look, **line_options(kwargs)})
        ax.set_aspect("equal")
        ax.set(xlabel="x₁ in m", ylabel="x₂ in m")
        ax.legend()
        return ax
