"""Growth, frequency and damping of all modes in a band over friction, direction and speed."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from asperity._base import arrays
from asperity._base.arrays import Array
from asperity._base.progress import Progress, reporter
from asperity._base.result import Axis, Result, Series, Table, TableResult, counted
from asperity._base.value import keep_views
from asperity.errors import ConvergenceError, ParameterError
from asperity.steady_sliding.linearised.pencil import Complex
from asperity.steady_sliding.sparse.reduced_system import ReducedSystem, checked_full
from asperity.steady_sliding.sparse.reduction import (
    Point,
    Reduction,
    checked_parameters,
    point_of,
)
from asperity.steady_sliding.sparse.sliding_state import eigenpairs

if TYPE_CHECKING:
    import pandas
    import xarray

_AXES = {
    "friction": ("-", "factor of the reservoirs C"),
    "phi": ("rad", "turn of the sliding velocity"),
    "speed": ("-", "factor of the sliding speed"),
}
# Least |xᴴy|² of the shapes of a mode at neighbouring points, and the weight of the distance of
# eigenvalues beside it.
_ALIKE, _NEAR = 0.2, 3.0
# Growth relative to |s| that is an error of Arnoldi's method.
_ROUNDING = 1e-8
# Share of the work that samples take, about.
_SAMPLING = 0.4


@dataclass(frozen=True, eq=False, repr=False)
class SquealMap(Result):
    """Eigenvalues s of the modes of steady sliding over one or two parameters.

    Modes are followed from point to point by their shapes, and sorted by their largest growth rate;
    where many contacts open between two points, a mode may go on as another one.

    Attributes:
        parameters: values of each parameter, as of `LinearSystem.varied`.
        eigenvalues: s in 1/s, shape ``(modes, …)`` with an axis per parameter; NaN where a mode is
            not in the band, or nothing slides steadily.
        open_contacts: number of contacts that are open; −1 where nothing slides steadily.
        reduced: the system on the basis with which all of this was found.
        samples: points whose modes are in the basis.
        estimates: points at which residuals of the whole system were examined, with the largest
            estimated error of a growth rate over the one that was allowed.
    """

    parameters: Mapping[str, Array]
    eigenvalues: Complex
    open_contacts: NDArray[np.intp]
    reduced: ReducedSystem = field(repr=False)
    samples: tuple[Point, ...]
    estimates: Mapping[tuple[float, ...], float]

    _picture = "plot_squeal_map"

    def __post_init__(self) -> None:
        keep_views(self)

    @property
    def frequencies(self) -> Array:
        """Im s/2π in Hz."""
        return self.eigenvalues.imag / (2.0 * np.pi)

    @property
    def growth_rates(self) -> Array:
        """Re s in 1/s."""
        return self.eigenvalues.real

    @property
    def damping_ratios(self) -> Array:
        """−Re s/|s|, negative where the mode grows."""
        return -self.eigenvalues.real / np.abs(self.eigenvalues)

    @property
    def growth_rate(self) -> Array:
        """Largest growth rate in 1/s at each point, −∞ without modes."""
        return np.where(np.isnan(self.growth_rates), -np.inf, self.growth_rates).max(
            axis=0, initial=-np.inf
        )

    @property
    def unstable(self) -> NDArray[np.bool_]:
        """Which modes grow, and not by errors of the eigenvalues alone, shape ``(modes, …)``."""
        return self.growth_rates > _ROUNDING * np.abs(self.eigenvalues)

    def __repr__(self) -> str:
        over = " × ".join(f"{len(values)} {name}" for name, values in self.parameters.items())
        return f"<SquealMap: {counted(len(self.eigenvalues), 'mode')} over {over}>"

    def summary(self) -> str:
        """Return where modes grow, how fast, and how exact that is."""
        growth, over = self.growth_rate, " and ".join(self.parameters)
        unstable = self.unstable.any(axis=0)
        lines = [
            f"{counted(len(self.eigenvalues), 'mode')} over {counted(growth.size, 'point')} of "
            f"{over}; steady sliding is unstable at {float(unstable.mean()):.1%} of them."
        ]
        if unstable.any():
            mode, *rest = np.unravel_index(
                int(np.nanargmax(self.growth_rates)), self.growth_rates.shape
            )
            at = tuple(rest)
            where = ", ".join(
                f"{name} = {values[i]:.6g}"
                for (name, values), i in zip(self.parameters.items(), at, strict=True)
            )
            lines.append(
                f"{self.frequencies[(mode, *at)]:.6g} Hz grows fastest, with {growth[at]:.6g} 1/s "
                f"at {where}."
            )
        if (self.open_contacts > 0).any():
            lines.append(f"Up to {int(self.open_contacts.max())} contacts open.")
        if (self.open_contacts < 0).any():
            share = float((self.open_contacts < 0).mean())
            lines.append(f"At {share:.1%} of the points nothing slides steadily.")
        worst = max(self.estimates.values(), default=0.0)
        lines.append(
            f"{counted(len(self.samples), 'full solve')} made a basis of {self.reduced.dof} for "
            f"{self.reduced.full.dof} coordinates; errors of growth rates, estimated at "
            f"{counted(len(self.estimates), 'point')}, are at most {worst:.2g} of those allowed."
        )
        return "\n".join(lines)

    def to_pandas(self) -> pandas.DataFrame:
        """Return a row per mode and point.

        Raises:
            ImportError: without pandas, which ``pip install "asperity[pandas]"`` installs.
        """
        return _Rows(self).to_pandas()

    def to_csv(self, path: Any) -> None:
        """Write a row per mode and point as text; titles hold names and units.

        Args:
            path: of the file, which is complete or not there.
        """
        _Rows(self).to_csv(path)

    def to_xarray(self) -> xarray.Dataset:
        """Return the arrays, with an axis for the modes and one for each parameter.

        Raises:
            ImportError: without xarray, which ``pip install "asperity[xarray]"`` installs.
        """
        return _Grid(self).to_xarray()

    def _series(self) -> dict[str, tuple[Array, str, str]]:
        return {
            "frequency": (self.frequencies, "Hz", "imaginary part over 2π"),
            "growth_rate": (self.growth_rates, "1/s", "real part"),
            "damping_ratio": (self.damping_ratios, "-", "of critical damping"),
        }


@dataclass(frozen=True, eq=False)
class _Rows(TableResult):
    """The table of a map with a row per mode and point."""

    of: SquealMap

    def _table(self) -> Table:
        found = np.flatnonzero(~np.isnan(self.of.eigenvalues.ravel()))
        mode, *places = np.unravel_index(found, self.of.eigenvalues.shape)
        row = {"row": Axis(np.arange(len(found)))}
        series = {"mode": Series(mode, ("row",))}
        for (name, values), i in zip(self.of.parameters.items(), places, strict=True):
            series[name] = Series(values[i], ("row",), _AXES[name][0])
        for name, (values, unit, _) in self.of._series().items():
            series[name] = Series(values.ravel()[found], ("row",), unit)
        return Table(row, series, {})


@dataclass(frozen=True, eq=False)
class _Grid(TableResult):
    """The arrays of a map."""

    of: SquealMap

    def _table(self) -> Table:
        axes = {"mode": Axis(np.arange(len(self.of.eigenvalues)), "", "by falling growth rate")}
        for name, values in self.of.parameters.items():
            axes[name] = Axis(values, *_AXES[name])
        grid = tuple(self.of.parameters)
        series = {
            name: Series(values, ("mode", *grid), unit, words)
            for name, (values, unit, words) in self.of._series().items()
        }
        opened = self.of.open_contacts
        series["open_contacts"] = Series(opened, grid, "", "−1: no steady sliding")
        return Table(axes, series, {})


def squeal_map(
    system: object,
    *,
    parameters: Mapping[str, ArrayLike],
    band: tuple[float, float],
    accuracy: float = 0.01,
    progress: Progress = None,
) -> SquealMap:
    """Find the modes in a band over one or two parameters, on one reduced basis.

    The basis is that of `reduce`: modes of the whole system at samples, to which others are added
    where residuals of the whole system ask for them. Contacts open and close at every point as in
    the whole system.

    Args:
        system: `LinearSystem` with sparse matrices and a symmetric stiffness.
        parameters: rising values of one or two of ``"friction"``, a factor of the reservoirs C
            that may begin at 0, ``"phi"``, the turn of the sliding velocity in rad, and
            ``"speed"``, a factor of it, as of `LinearSystem.varied`.
        band: lowest and highest angular frequency in rad/s; modes that grow or decay with more than
            a fifth of the highest are left out.
        accuracy: estimated error of growth rates, relative to them, or a thousandth of it relative
            to the frequency.
        progress: ``True`` for a bar of tqdm, or a function of (done, all).

    Returns:
        The map.

    Raises:
        ParameterError, ConvergenceError: as `reduce`; of points without steady sliding only if a
            sample is one.

    Reference: [WL19] (85)–(88); Gräbner et al., ZAMM 96 (2016), 1388–1405.
    """
    grid = checked_parameters(parameters)
    if not grid:
        raise ParameterError("parameters", "must name one or two")
    shape = tuple(len(values) for values in grid.values())
    whole = int(np.prod(shape))
    with reporter(progress, "point") as report:
        reduction = Reduction(checked_full(system), band)
        reduced = reduction.refine(
            grid,
            arrays.positive(accuracy, "accuracy"),
            None
            if report is None
            else lambda done, of: report(_SAMPLING * whole * done / of, whole),
        )
        followed, opened = _Followed(shape, reduced.mass), np.full(shape, -1, dtype=np.intp)
        guess = None
        for done, at in enumerate(_walk(shape)):
            try:
                state = reduced.states.at(guess, **point_of(grid, at))
            except (ParameterError, ConvergenceError):
                continue
            guess, opened[at] = state.closed, int((~state.closed).sum())
            s, shapes = eigenpairs(state, reduction.centre, reduction.radius, reduction.count)
            followed.add(at, s, state.spread(shapes))
            if report is not None:
                report((_SAMPLING + (1.0 - _SAMPLING) * (done + 1) / whole) * whole, whole)
    eigenvalues = followed.chosen(reduction.wanted)
    return SquealMap(
        grid, eigenvalues, opened, reduced, tuple(reduction.points), reduction.estimates
    )


def _walk(shape: tuple[int, ...]) -> Iterator[tuple[int, ...]]:
    """Yield all places of a grid, each beside the one before."""
    *rows, length = shape
    for number, row in enumerate(np.ndindex(*rows)):
        for k in range(length):
            yield (*row, length - 1 - k if number % 2 else k)


class _Followed:
    """Modes of the points of a grid, named alike where their shapes are."""

    def __init__(self, shape: tuple[int, ...], mass: Array) -> None:
        # Shapes are compared by the kinetic energy of their product.
        self._shape, self._root = shape, np.linalg.cholesky(mass).T
        self._count = 0
        self._values: dict[tuple[int, ...], dict[int, complex]] = {}
        # Of the last points only: a row of the grid.
        self._shapes: dict[tuple[int, ...], Complex] = {}

    def add(self, at: tuple[int, ...], s: Complex, shapes: Complex) -> None:
        """Name the modes of a point by those of the points beside it."""
        shapes = self._root @ shapes
        shapes /= np.linalg.norm(shapes, axis=0)
        names = np.full(len(s), -1)
        for k in reversed(range(len(at))):
            for step in (-1, 1):
                near = (*at[:k], at[k] + step, *at[k + 1 :])
                if near in self._shapes:
                    self._match(names, s, shapes, near)
        new = names < 0
        names[new] = self._count + np.arange(new.sum())
        self._count += int(new.sum())
        self._values[at] = dict(zip(names.tolist(), s.tolist(), strict=True))
        self._shapes[at] = shapes.astype(np.complex64)
        while len(self._shapes) > 2 * self._shape[-1]:
            del self._shapes[next(iter(self._shapes))]

    def _match(
        self, names: NDArray[np.intp], s: Complex, shapes: Complex, near: tuple[int, ...]
    ) -> None:
        from scipy.optimize import linear_sum_assignment

        known = self._values[near]
        free = np.flatnonzero(names < 0)
        olds = [k for k, name in enumerate(known) if name not in names]
        alike = np.abs(self._shapes[near][:, olds].conj().T @ shapes[:, free]) ** 2
        former, listed = np.array(list(known.values()))[olds], np.array(list(known))[olds]
        far = np.abs(former[:, None] - s[free]) / np.abs(s[free])
        # Of pairs that do not belong together none is worse than another.
        cost = np.where(alike > _ALIKE, np.minimum(_NEAR * far, 1.0) - alike, 1.0)
        rows, columns = linear_sum_assignment(cost)
        good = alike[rows, columns] > _ALIKE
        names[free[columns[good]]] = listed[rows[good]]

    def chosen(self, wanted: Callable[[Complex], NDArray[np.bool_]]) -> Complex:
        """Return those eigenvalues that are wanted by mode and point, by falling growth, else NaN.

        Args:
            wanted: says which.
        """
        found = np.full((self._count, *self._shape), complex(np.nan, np.nan))
        for at, modes in self._values.items():
            for name, s in modes.items():
                found[(name, *at)] = s
        found[~wanted(found)] = complex(np.nan, np.nan)
        growth = np.where(np.isnan(found.real), -np.inf, found.real)
        largest = growth.reshape(self._count, -1).max(axis=1, initial=-np.inf)
        order = np.argsort(-largest, kind="stable")
        return found[order[largest[order] > -np.inf]]
