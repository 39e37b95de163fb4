"""Plots of what stability depends on: root loci, charts of growth rates, bifurcation diagrams."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any, Literal, Protocol

import numpy as np
from matplotlib.axes import Axes
from matplotlib.collections import LineCollection
from matplotlib.colors import CenteredNorm, LinearSegmentedColormap
from numpy.typing import ArrayLike, NDArray
from scipy.optimize import linear_sum_assignment

from asperity._base import arrays
from asperity._base.arrays import Array
from asperity.cycles import BifurcationDiagram
from asperity.errors import DimensionError, ParameterError
from asperity.plot import look
from asperity.plot.runs import chosen
from asperity.steady_sliding import GrowthChart

_Complex = NDArray[np.complex128]

_DECAY_TO_GROWTH = LinearSegmentedColormap.from_list(
    "decay to growth", [look.BLUE, look.SKY, "white", "#F2B58A", look.ORANGE]
)

_KINDS: dict[str, dict[str, Any]] = {
    "asymptotically stable": {"linestyle": "-", "label": "stable equilibrium"},
    "neutral": {"linestyle": (0, (5.0, 1.2)), "label": "neutral equilibrium"},
    "unstable": {"linestyle": ":", "label": "unstable equilibrium"},
}


# Of more eigenvalues those are picked out that grow, beside others that decay so much faster.
_FEW, _DECAY = 12, 10.0


class HasEigenvalues(Protocol):
    """A linearisation, such as `asperity.steady_sliding.Stability`."""

    @property
    def eigenvalues(self) -> _Complex:
        """Eigenvalues in 1/s."""


def plot_root_locus(
    eigenvalues: ArrayLike | Sequence[HasEigenvalues] | BifurcationDiagram,
    *,
    values: ArrayLike | None = None,
    ax: Axes | None = None,
    label: str | None = None,
    colorbar: bool = True,
    unit: Literal["1/s", "Hz"] = "1/s",
) -> Axes:
    """Draw how eigenvalues move in the complex plane while a parameter changes.

    Branches are followed from value to value by the nearest continuation; the colour is the
    parameter. The unstable half-plane is shaded. Of more than six pairs those are drawn heavily
    that become unstable, with their imaginary part where they grow fastest, and the axis ends where
    others decay ten times as fast; of conjugate pairs only one half is drawn.

    Args:
        eigenvalues: in 1/s, shape ``(n, k)``, or objects with ``.eigenvalues``, n of them; or a
            `BifurcationDiagram`, which has them where it has an equilibrium.
        values: of the parameter, ascending or descending, shape ``(n,)``, n ≥ 2; default those of
            the diagram.
        ax: axes; default new ones.
        label: name of the parameter, beside the colour bar; default that of the diagram.
        colorbar: whether to draw the colour bar.
        unit: of the imaginary part: ``"1/s"``, or ``"Hz"`` for frequencies Im Λ/2π.

    Returns:
        The axes.

    >>> import matplotlib
    >>> matplotlib.use("Agg")
    >>> import numpy as np
    >>> from asperity.plot import plot_root_locus
    >>> damping = np.linspace(-0.5, 0.5, 11)
    >>> roots = [np.roots([1.0, d, 1.0]) for d in damping]
    >>> ax = plot_root_locus(roots, values=damping, label="damping")
    >>> len(ax.collections)  # one per eigenvalue
    2
    """
    words = "parameter" if label is None else label
    if isinstance(eigenvalues, BifurcationDiagram):
        words = eigenvalues.parameter if label is None else label
        known = [one is not None for one in eigenvalues.stabilities]
        if values is None:
            values = eigenvalues.values
        values = arrays.array(values, "values", (len(eigenvalues),))[known]
        eigenvalues = [one for one in eigenvalues.stabilities if one is not None]
    elif values is None:
        raise ParameterError("values", "must be given: only a BifurcationDiagram has its own")
    parameter = arrays.array(values, "values", (None,))
    branches = _branches(_eigenvalues(eigenvalues, len(parameter)))
    arrays.choice(unit, "unit", ("1/s", "Hz"))
    turns = 2.0 * np.pi if unit == "Hz" else 1.0
    many = branches.shape[1] > _FEW
    if many and np.allclose(np.sort(branches.imag), np.sort(-branches.imag)):
        branches = branches[:, (branches.imag >= 0.0).any(axis=0)]
    grows = branches.real.max(axis=0) > 0.0
    with look.drawing(ax) as ax:
        points = np.stack([branches.real, branches.imag / turns], axis=-1)
        middle = 0.5 * (parameter[1:] + parameter[:-1])
        lines = []
        for branch, unstable in zip(points.swapaxes(0, 1), grows, strict=True):
            path = LineCollection(
                np.stack([branch[:-1], branch[1:]], axis=1).tolist(),
                array=middle,
                cmap="viridis",
                linewidths=2.2 if unstable or not many else 0.9,
                capstyle="round",
            )
            path.set_clim(parameter.min(), parameter.max())
            lines.append(ax.add_collection(path))
        ax.plot(*points[0].T, "o", color=look.INK, markersize=4.0, markerfacecolor="white")
        ax.autoscale_view()
        ax.margins(0.06)
        ax.axvline(0.0, color=look.GREY, linewidth=0.9, zorder=0.9)
        left, right = ax.get_xlim()
        if many:
            left = max(left, -_DECAY * float(branches.real.max())) if grows.any() else left
            for branch in points[:, grows].swapaxes(0, 1):
                x, y = branch[branch[:, 0].argmax()]
                ax.annotate(f"{y:.4g}", (x, y), (0.0, 4.0), textcoords="offset points", ha="right")
        reach = max(right, 0.1 * (right - left))
        ax.axvspan(0.0, reach, color=look.ORANGE, alpha=0.07, linewidth=0.0)
        ax.set_xlim(left, reach)
        height = r"Im $\Lambda$ in 1/s" if unit == "1/s" else r"Im $\Lambda/2\pi$ in Hz"
        ax.set(xlabel=r"Re $\Lambda$ in 1/s", ylabel=height)
        if colorbar:
            _colorbar(ax, lines[0], words)
        return ax


def plot_growth_chart(
    growth: GrowthChart | ArrayLike,
    *,
    x: ArrayLike | None = None,
    y: ArrayLike | None = None,
    ax: Axes | None = None,
    tolerance: float = 1e-6,
    limit: float | None = None,
    border: bool = True,
    colorbar: bool = True,
) -> Axes:
    """Draw growth rates over two parameters; the border of instability is a line.

    White means neither growth nor decay.

    Args:
        growth: what `asperity.growth_chart` returns, or largest real parts of the eigenvalues in
            1/s, shape ``(n_x, n_y)``; NaN where there is no equilibrium.
        x: values of the first parameter, shape ``(n_x,)``; default those of the chart in degrees.
        y: values of the second, shape ``(n_y,)``; likewise.
        ax: axes; default new ones.
        tolerance: growth rate in 1/s up to which a system counts as neutral.
        limit: growth rate in 1/s of the darkest colours; default the largest magnitude.
        border: whether to draw the border; between growth and a neutral plateau it follows the
            grid.
        colorbar: whether to draw the colour bar.

    Returns:
        The axes.

    >>> import matplotlib
    >>> matplotlib.use("Agg")
    >>> import numpy as np
    >>> from asperity.plot import plot_growth_chart
    >>> mu, damping = np.linspace(0.0, 1.0, 30), np.linspace(0.0, 0.5, 20)
    >>> ax = plot_growth_chart(mu[:, None] - damping, x=mu, y=damping)
    """
    across, up = "", ""
    if isinstance(growth, GrowthChart):
        if x is None:
            x, across = np.rad2deg(growth.phi), "direction of the belt in degrees"
        if y is None:
            y, up = np.rad2deg(growth.zeta), "rotation of C in degrees"
    if x is None or y is None:
        name = "x" if x is None else "y"
        raise ParameterError(name, "must be given: only a GrowthChart has its own")
    first, second = (arrays.array(values, name, (None,)) for values, name in ((x, "x"), (y, "y")))
    for values, name in ((first, "x"), (second, "y")):
        if not values.size:
            raise DimensionError(name, "must hold a value")
    rates = arrays.with_gaps(growth, "growth", (len(first), len(second)))
    if np.isinf(rates).any():
        raise ParameterError("growth", "must be finite, or NaN where there is no equilibrium")
    level = arrays.positive(tolerance, "tolerance")
    largest = float(np.nanmax(np.abs(rates), initial=level))
    scale = CenteredNorm(halfrange=largest if limit is None else arrays.positive(limit, "limit"))
    with look.drawing(ax) as ax:
        mesh = ax.pcolormesh(
            first,
            second,
            rates.T,
            cmap=_DECAY_TO_GROWTH,
            norm=scale,
            shading="nearest",
            rasterized=True,
        )
        ax.set_facecolor("#EDEDED")
        # What somebody has written on axes of his own stays where nothing is known.
        ax.set_xlabel(across or ax.get_xlabel())
        ax.set_ylabel(up or ax.get_ylabel())
        ax.grid(False)
        # Lines need two values of each parameter; without growth anywhere there is no border.
        grows, rests = bool((rates > level).any()), bool((rates <= level).any())
        if border and grows and rests and min(rates.shape) > 1:
            ax.contour(first, second, rates.T, [level], colors=look.INK, linewidths=1.2)
        if colorbar:
            beyond = limit is not None and limit < largest
            _colorbar(ax, mesh, "growth rate in 1/s", extend="both" if beyond else "neither")
        return ax


def plot_bifurcation(
    diagram: BifurcationDiagram, *, ax: Axes | None = None, coordinate: int = 0, legend: bool = True
) -> Axes:
    """Draw a coordinate of equilibria and the range of limit cycles over a parameter.

    Stable equilibria and cycles are solid, neutral equilibria broken, unstable ones dotted. Lines
    join cycles of one branch; one that is alone on its branch is a point.

    Args:
        diagram: as of `asperity.bifurcation_diagram`; with ``diagram.replace(values=…)`` in other
            units.
        ax: axes; default new ones.
        coordinate: number of the coordinate.
        legend: whether to add a legend.

    Returns:
        The axes.
    """
    if not all(hasattr(diagram, name) for name in ("values", "equilibria", "kinds")):
        raise ParameterError("diagram", f"must be a BifurcationDiagram, got {diagram!r}")
    if not diagram.equilibria.shape[1]:
        raise ParameterError("diagram", "must hold an equilibrium or a limit cycle")
    number = arrays.count(coordinate, "coordinate", 0)
    if number >= diagram.equilibria.shape[1]:
        raise DimensionError(
            "coordinate", f"must be below {diagram.equilibria.shape[1]}, got {coordinate}"
        )
    values = diagram.values
    with look.drawing(ax) as ax:
        lower, upper = diagram.cycle_minima[:, number], diagram.cycle_maxima[:, number]
        if np.isfinite(lower).any():
            filling: dict[str, Any] = {"color": look.ORANGE, "alpha": 0.15, "linewidth": 0.0}
            here, after = diagram.branches[:-1], diagram.branches[1:]
            ends = np.flatnonzero((here != after) & (here >= 0) & (after >= 0)) + 1
            apart, lower, upper = (np.insert(x, ends, np.nan) for x in (values, lower, upper))
            ax.fill_between(apart, lower, upper, **filling)
            _cycle_lines(ax, apart, lower, upper, np.insert(diagram.cycle_stable, ends, False))
        rest = diagram.equilibria[:, number]
        for kind, options in _KINDS.items():
            shown = _with_next(np.array([found == kind for found in diagram.kinds]))
            if shown.any():
                ax.plot(values, np.where(shown, rest, np.nan), color=look.BLUE, **options)
        ax.margins(x=0.0)
        name, unit = diagram.coordinate_names[number], diagram.coordinate_units[number]
        ax.set(xlabel=diagram.parameter, ylabel=chosen.titled(name, unit))
        if legend:
            ax.legend()
        return ax


def _cycle_lines(
    ax: Axes, values: Array, lower: Array, upper: Array, stable: NDArray[np.bool_]
) -> None:
    """Draw extremes of cycles, solid where stable and dotted where not."""
    for kind, style in (("stable", "-"), ("unstable", ":")):
        shown = _with_next((stable == (kind == "stable")) & np.isfinite(lower))
        for extremes, label in ((lower, f"{kind} limit cycle, extremes"), (upper, None)):
            drawn = np.where(shown, extremes, np.nan)
            if (there := np.isfinite(drawn)).any():
                beside = np.append(there[1:], False) | np.append(False, there[:-1])
                options: dict[str, Any] = {"color": look.ORANGE, "linestyle": style}
                if (alone := there & ~beside).any():
                    options |= {"marker": ".", "markevery": np.flatnonzero(alone).tolist()}
                ax.plot(values, drawn, label=label, **options)


def _eigenvalues(given: Any, n: int) -> _Complex:
    """Return the eigenvalues as rows, one per value of the parameter."""
    arrays.refuse_masked(given, "eigenvalues")
    rows = [getattr(one, "eigenvalues", one) for one in given]
    try:
        table = np.array(rows, dtype=np.complex128)
    except (TypeError, ValueError):
        raise DimensionError("eigenvalues", "must be as many complex numbers per value") from None
    if table.ndim != 2 or len(table) != n or n < 2 or table.size == 0:
        raise DimensionError(
            "eigenvalues", f"must have shape ({n}, k) with n ≥ 2 as values, got {table.shape}"
        )
    if not np.isfinite(table).all():
        raise ParameterError("eigenvalues", "must be finite")
    return table


def _branches(table: _Complex) -> _Complex:
    """Return the rows sorted such that each column is one branch."""
    sorted_rows = [table[0]]
    for row in table[1:]:
        last = sorted_rows[-1]
        expected = 2.0 * last - sorted_rows[-2] if len(sorted_rows) > 1 else last
        _, order = linear_sum_assignment(np.abs(expected[:, None] - row[None, :]))
        sorted_rows.append(row[order])
    return np.array(sorted_rows)


def _with_next(shown: NDArray[np.bool_]) -> NDArray[np.bool_]:
    """Return `shown` grown by one to the left, so that lines of different kinds touch."""
    grown = shown.copy()
    grown[:-1] |= shown[1:]
    return grown


def _colorbar(ax: Axes, mappable: Any, label: str, extend: str = "neither") -> None:
    bar = ax.figure.colorbar(mappable, ax=ax, label=label, extend=extend)
    bar.outline.set_visible(False)
