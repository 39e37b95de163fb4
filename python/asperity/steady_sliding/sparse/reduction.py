"""Bases of static, real and complex modes for a band, and the reduced system on them."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from itertools import product
from typing import TypeAlias

import numpy as np
from numpy.typing import ArrayLike, NDArray

from asperity._base import arrays
from asperity._base.arrays import Array
from asperity._base.progress import Progress, Report, reporter
from asperity.errors import ParameterError
from asperity.steady_sliding.linearised.pencil import Complex
from asperity.steady_sliding.sparse.nearest import approximate, within
from asperity.steady_sliding.sparse.pencil import SmallMotions, SparsePencil
from asperity.steady_sliding.sparse.reduced_system import (
    ReducedSystem,
    checked_full,
    estimated_errors,
    projected,
)
from asperity.steady_sliding.sparse.sliding_state import eigenpairs
from asperity.steady_sliding.sparse.static_modes import StaticModes
from asperity.system import SparseLinearSystem

Point: TypeAlias = dict[str, float]
_NAMES = ("friction", "phi", "speed")
# Shares of their length above which the parts of modes, and of static responses, enter a basis.
_SMALL, _DEPENDENT = 3e-4, 1e-6
# A guess of the number of modes in a band, and how many beside it are taken, as friction moves
# others into it.
_GUESS, _MARGIN = 16, 4
# Largest |Re s| of modes in a band, as a share of its upper end.
_GROWTH = 0.2
# Points of a grid along its shorter and longer parameter at which residuals are examined, or along
# its only one; rounds of corrections, and the share that a round leaves where it is of use.
_EXAMINED, _ALONE, _ROUNDS, _SLOW = (5, 9), 13, 10, 0.5
# Share of the allowed error at points that are examined, as it is larger between them.
_BETWEEN = 0.5
# Share of an estimated error that is not known.
_DOUBT = 0.1
# Accuracy of the rate of growth relative to |s|, as a share of that relative to itself.
_FLOOR = 1e-3


def reduce(
    system: object,
    *,
    band: tuple[float, float],
    parameters: Mapping[str, ArrayLike] | None = None,
    accuracy: float = 0.01,
    sticking: bool = False,
    progress: Progress = None,
) -> ReducedSystem:
    """Reduce a sparse system to few displacement shapes, for a band of frequencies.

    The basis holds a static mode of each unilateral contact, which gives steady sliding the loads
    and open contacts of the whole system, real modes in the band, and complex modes in the band at
    samples of the parameters, of which proper orthogonal decomposition keeps what counts. Samples
    are added where residuals of the whole system say that growth rates are not exact enough.

    Args:
        system: `LinearSystem` with sparse matrices and a symmetric stiffness.
        band: lowest and highest angular frequency in rad/s; modes that grow or decay with more than
            a fifth of the highest are left out.
        parameters: rising values of one or two of ``"friction"``, ``"phi"`` and ``"speed"`` between
            which the reduced system is to be good, as of `squeal_map`. Default: as it is.
        accuracy: estimated error of growth rates, relative to them, or a thousandth of it relative
            to the frequency.
        sticking: whether contacts will stick: two more static modes of each.
        progress: ``True`` for a bar of tqdm, or a function of (done, all) samples.

    Returns:
        The reduced system, which runs wherever a dense `LinearSystem` does.

    Raises:
        ParameterError, ConvergenceError: as `equilibrium`; if the stiffness is not symmetric or
            singular where all contacts are closed.

    Reference: Gräbner, Mehrmann, Quraishi, Schröder, von Wagner, ZAMM 96 (2016), 1388–1405.
    """
    grid = checked_parameters(parameters or {})
    with reporter(progress, "sample") as report:
        margin = _MARGIN if grid else 0
        reduction = Reduction(checked_full(system), band, sticking=sticking, margin=margin)
        reduction.refine(grid, arrays.positive(accuracy, "accuracy"), report)
    return reduction.system


def checked_parameters(parameters: Mapping[str, ArrayLike]) -> dict[str, Array]:
    """Return the values of each parameter."""
    if not isinstance(parameters, Mapping):
        raise ParameterError("parameters", f"must map names to values, got {parameters!r}")
    wrong = set(parameters) - set(_NAMES)
    if wrong or len(parameters) > 2:
        raise ParameterError(
            "parameters", f"must be one or two of {', '.join(_NAMES)}, got {list(parameters)}"
        )
    made = {}
    for name, values in parameters.items():
        made[name] = arrays.constant(np.atleast_1d(values), name, (None,))
        if not len(made[name]):
            raise ParameterError(name, "must hold a value")
        if name == "speed" and not (made[name] > 0.0).all():
            raise ParameterError(name, "must be positive")
        if name == "friction" and not (made[name] >= 0.0).all():
            raise ParameterError(name, "must not be negative")
        if not (np.diff(made[name]) > 0.0).all():
            raise ParameterError(name, "must rise from value to value")
    return made


def point_of(grid: Mapping[str, Array], at: Sequence[int]) -> Point:
    """Return the parameters at a place of a grid."""
    return _named(grid, [float(values[i]) for values, i in zip(grid.values(), at, strict=True)])


def _named(grid: Mapping[str, Array], place: Sequence[float]) -> Point:
    return dict(zip(grid, place, strict=True))


class Reduction:
    """A basis of a sparse system for a band, and the reduced system on it."""

    def __init__(
        self,
        full: SparseLinearSystem,
        band: tuple[float, float],
        *,
        sticking: bool = False,
        margin: int = _MARGIN,
    ) -> None:
        low, high = (arrays.number(end, "band") for end in arrays.pair(band, "band"))
        if not 0.0 <= low < high:
            raise ParameterError("band", f"must be 0 ≤ lo < hi in rad/s, got {(low, high)}")
        self.full, self.band = full, (low, high)
        # Those within the band that grow or decay with at most `growth` lie in this circle.
        self.growth = _GROWTH * high
        self.centre = 0.5j * (low + high)
        self.radius = float(np.hypot(0.5 * (high - low), self.growth))
        self.statics = StaticModes(full)
        self.points: list[Point] = []
        self.estimates: dict[tuple[float, ...], float] = {}
        self._within = np.zeros((full.dof, 0))
        pushed = full.columns.tangents.toarray() if sticking else np.zeros((full.dof, 0))
        self._extend(self.statics.responses(np.column_stack([pushed, full.force])), _DEPENDENT)
        self._loaded = self.system
        self.count, self._margin = _GUESS, margin
        modes = np.asarray(self.statics.constraint.Z @ self._modes(self.statics.pencil))
        self._extend(modes, _SMALL)
        self.count = modes.shape[1] + _MARGIN

    @property
    def system(self) -> ReducedSystem:
        """The reduced system."""
        return projected(self.statics, self._within)

    def sample(self, point: Point) -> None:
        """Add the complex modes of a point, and its displacements by friction."""
        # Static modes have the loads of the whole system.
        state = self._loaded.states.at(None, **point)
        columns = self.full.columns
        closed = np.flatnonzero(columns.unilateral)[state.closed]
        small = SmallMotions(self.full, state.contacts, closed, state.jacobian, 0 * state.jacobian)
        self._extend(np.asarray(small.constraint.Z @ self._modes(small.pencil)), _SMALL)
        friction = np.asarray(columns.tangents @ (state.contacts.unit_force @ state.load))
        self._extend(self.statics.responses(friction[:, None]), _SMALL)
        self.points.append(point)

    def refine(
        self, grid: Mapping[str, Array], accuracy: float, report: Report | None
    ) -> ReducedSystem:
        """Sample corners and centre of a grid, then correct where residuals ask for it."""
        # Real modes stand for little friction.
        ends = [
            [float(values.max())] if name == "friction" else np.unique(values[[0, -1]]).tolist()
            for name, values in grid.items()
        ]
        centre = [float(values[len(values) // 2]) for values in grid.values()]
        first = dict.fromkeys([*product(*ends), tuple(centre)])
        rounds = len(first) + _ROUNDS
        for done, place in enumerate(first):
            self.sample(_named(grid, place))
            if report is not None:
                report(done + 1, rounds)
        left, between = _examined(grid)
        former = dict[tuple[float, ...], float]()
        for done in range(_ROUNDS):
            reduced = self.system
            found = {
                place: self._estimate(reduced, _named(grid, place), accuracy) for place in left
            }
            self.estimates |= {place: largest for place, (largest, _) in found.items()}
            left = [place for place in left if self.estimates[place] > _BETWEEN]
            if not left:
                # What is good enough there is checked half-way.
                left, between = between, []
                if left:
                    continue
                break
            self._extend(np.concatenate([found[place][1] for place in left], axis=1), 1.0)
            worst = max(left, key=lambda place: self.estimates[place])
            if self.estimates[worst] > _SLOW * former.get(worst, np.inf):
                self.sample(_named(grid, worst))
            former = dict(self.estimates)
            if report is not None:
                report(len(first) + done + 1, rounds)
        return self.system

    def wanted(self, s: Complex) -> NDArray[np.bool_]:
        """Return which eigenvalues are in the band."""
        # Arnoldi's method is exact relative to the distance from the centre.
        return within(s, *self.band, self.growth, size=self.radius)

    def _modes(self, pencil: SparsePencil) -> Complex:
        """Return the modes within the band, and some beside it."""
        values, modes = approximate(pencil, self.centre, self.radius, self.count)
        order = np.argsort(np.abs(values - self.centre))
        inside = int((np.abs(values - self.centre) <= self.radius).sum())
        return modes[:, order[: inside + self._margin]]

    def _estimate(
        self, reduced: ReducedSystem, point: Point, accuracy: float
    ) -> tuple[float, Complex]:
        """Return the largest estimated error of a growth rate over the one that is allowed.

        Also what modes lack that exceed their share of it, of the length √ of how far, as errors
        are of second order.
        """
        state = reduced.states.at(None, **point)
        s, shapes = eigenpairs(state, self.centre, self.radius, self.count)
        inside = self.wanted(s)
        s, shapes = s[inside], shapes[:, inside]
        if not len(s):
            return 0.0, np.zeros((self.full.dof, 0), dtype=np.complex128)
        errors, lacking = estimated_errors(reduced, self.statics, state, s, shapes)
        growth = np.abs(errors.real) + _DOUBT * np.abs(errors)
        ratio = growth / (accuracy * np.maximum(np.abs(s.real), _FLOOR * np.abs(s)))
        over = ratio > _BETWEEN
        lengths = np.linalg.norm(lacking[:, over], axis=0) / np.sqrt(ratio[over] / _BETWEEN)
        return float(ratio.max(initial=0.0)), lacking[:, over] / lengths

    def _extend(self, vectors: Complex | Array, least: float) -> None:
        """Add what vectors have beside the basis: left singular vectors above a least value."""
        parts = [vectors.real, vectors.imag] if np.iscomplexobj(vectors) else [vectors]
        columns = np.concatenate(parts, axis=1)
        if least < 1.0:
            sizes = np.linalg.norm(columns, axis=0)
            columns = columns[:, sizes > 0.0] / sizes[sizes > 0.0]
        columns = self._beside(self.statics.without(columns))
        squares, turn = np.linalg.eigh(columns.T @ columns)
        kept = squares > least**2
        new = np.linalg.qr(self._beside(columns @ (turn[:, kept] / np.sqrt(squares[kept]))))[0]
        self._within = np.concatenate([self._within, new], axis=1)

    def _beside(self, columns: Array) -> Array:
        return columns - self._within @ (self._within.T @ columns)


def _examined(
    grid: Mapping[str, Array],
) -> tuple[list[tuple[float, ...]], list[tuple[float, ...]]]:
    """Return points of a grid at which residuals are examined, and others between them.

    There are more along the longer parameter.
    """
    sizes = dict.fromkeys(grid, _ALONE)
    if len(grid) == 2:
        short, long = sorted(grid, key=lambda name: len(grid[name]))
        sizes = {short: _EXAMINED[0], long: _EXAMINED[1]}
    lines, between = [], []
    for name, values in grid.items():
        at = np.unique(np.linspace(0, len(values) - 1, min(sizes[name], len(values))).astype(int))
        lines.append(values[at].tolist())
        between.append(values[np.unique((at[1:] + at[:-1]) // 2) if len(at) > 1 else at].tolist())
    first = list(product(*lines))
    return first, [place for place in product(*between) if place not in set(first)]
