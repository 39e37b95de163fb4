"""Least-squares fits of a friction law to measured paths."""

from __future__ import annotations

import math
import os
from collections.abc import Mapping, Sequence
from typing import Any, TypeAlias

import numpy as np
from numpy.typing import NDArray

from asperity._base import arrays
from asperity._base.arrays import Array
from asperity._base.log import log
from asperity._base.storage.toml import advice_on
from asperity.errors import DimensionError, FitError, ParameterError
from asperity.identify.estimator.covariance import level_of
from asperity.identify.estimator.descent import Found, search
from asperity.identify.estimator.loss import Loss, LossName
from asperity.identify.evidence.paths.launch import DIRECTION, Launch, known_of
from asperity.identify.evidence.paths.misfits import Misfits
from asperity.identify.evidence.paths.motions import Motions
from asperity.identify.evidence.paths.observed import FEWEST, Observed, observed
from asperity.identify.evidence.paths.result import PathFit
from asperity.identify.evidence.paths.solution import Solution
from asperity.identify.evidence.paths.starts import Ellipses, best_size, first_launches
from asperity.identify.evidence.paths.verdict import verdict
from asperity.identify.models.names import (
    DirectionName,
    ReservoirName,
    direction_model,
    name_of,
    reservoir_model,
)
from asperity.identify.models.structure import PlanarStructure
from asperity.law import FrictionLaw
from asperity.runs.comparison import TimedPath
from asperity.runs.model import Model
from asperity.runs.run import Run

AnyPath: TypeAlias = TimedPath | Run | str | os.PathLike[str]
"""A measured path, as an object or in a file."""

# A descent ends where the squares change by less than this share: a start, and the fit.
_NEAR, _CLOSE = 1e-2, 1e-6
# A path leaves its launch by less than this angle in rad: friction turns it slowly.
_ASTRAY = 0.6
_MOST_TRIALS = 100
# Laws that a fit only begins at need no exact paths.
_ROUGH = 1e-4
# Descents from turned superellipses end where the squares change by less than this share.
_SIFTED = 1e-3
# Minima with squares in standard errors that differ by less than this cannot be told apart.
_ALIKE = 10.0
# When the scale of a robust loss has settled.
_SETTLED, _ROUNDS = 0.05, 4


def fit_paths(
    paths: Sequence[AnyPath] | AnyPath,
    *,
    system: Model,
    reservoir: ReservoirName = "superellipse",
    direction: DirectionName = "superellipse",
    launch: Launch | Sequence[Launch] | None = None,
    fixed: Mapping[str, float] | None = None,
    position_error: float | None = None,
    length_error: float | None = None,
    loss: LossName = "linear",
    confidence: float | None = 0.95,
    tolerance: float = 1e-6,
    dt: float | None = None,
) -> PathFit:
    """Fit a law's sets C and D to measured paths: least squares of the positions over time.

    Simulated paths start where and as the measured ones are launched; what of the launches is not
    known is estimated with the law. Positions are weighted by their standard errors. Confidence
    intervals follow from what differs between paths, as points of one path share errors; they
    include the error of the length scale if it is stated.

    Paths tell the shape and the size of both sets but for the scale of D, if their launches point
    in directions all around, or in a quarter of the circle between the axes of the sets if the
    angles of these are `fixed`.

    Args:
        paths: what `track.Track.path` gives, other objects with `time` and `position`, runs, or
            CSV files with columns ``t [s]``, ``x1 [m]``, ``x2 [m]`` and, if known,
            ``x1 error [m]``, ``x2 error [m]``, such as those of ``asperity track``.
        system: what slides, such as `SlidingPoint` or `SlidingDisk`; its first two coordinates are
            those of the paths. The law of all its contacts is fitted; its rate factor is kept.
        reservoir: model of C, as for `fit_law`, without ``"best"``.
        direction: model of D, likewise.
        launch: what is known of the launches, one for all or one for each path; default nothing.
        fixed: values of parameters that are known, by name, such as ``"reservoir.angle"`` in rad.
        position_error: standard error of the positions in m, of all paths instead of their own.
        length_error: relative standard error of all lengths, which the paths share.
        loss: of the components in standard errors, ``"linear"``, or ``"soft_l1"``, ``"huber"`` or
            ``"cauchy"`` against points that were tracked wrongly.
        confidence: level of the confidence intervals; None for none.
        tolerance: of the integration, see `integrate`.
        dt: step in s of `simulate`, which then takes the place of `integrate`.

    Raises:
        ParameterError: naming the argument.
        RecordError: if a file cannot be used.
        FitError: if the paths do not tell the parameters, or nothing fits.

    Reference: [WL19] §5.3, Fig. 27.

    >>> import numpy as np
    >>> import asperity as asp
    >>> from asperity.identify import Launch, fit_paths
    >>> from asperity.track import MeasuredPath
    >>> point = asp.SlidingPoint(0.018, law=asp.FrictionLaw.isotropic(0.4))
    >>> paths = []
    >>> for k, speed in enumerate((1.0, 1.3, 1.5)):
    ...     run = asp.simulate(point, dt=1e-3, t_end=0.6, u0=[speed, 0.1 * k])
    ...     noise = 1e-4 * np.random.default_rng(k).normal(size=run.q.shape)
    ...     paths.append(MeasuredPath(run.t, run.q + noise, np.full(noise.shape, 1e-4)))
    >>> fit = fit_paths(paths, system=point, reservoir="circle", direction="circle")
    >>> fit.parameters["reservoir.radius"].covers(0.4)
    True
    """
    confidence = level_of(confidence)
    if length_error is not None:
        length_error = arrays.non_negative(length_error, "length_error")
    tolerance = arrays.positive(tolerance, "tolerance")
    step = None if dt is None else arrays.positive(dt, "dt")
    measure = Loss(loss, components=1)
    structure = PlanarStructure(reservoir_model(reservoir), direction_model(direction))
    given = observed(paths, position_error)
    launches = _launches(launch, len(given))
    given = tuple(_after(path, one) for path, one in zip(given, launches, strict=True))
    pairs = [known_of(one, float(p.time[0])) for one, p in zip(launches, given, strict=True)]
    known, errors = (np.stack(part) for part in zip(*pairs, strict=True))
    _refuse_degrees(given, known[:, DIRECTION])
    search = _Search(
        structure, _held(fixed, structure), given, system, known, errors, tolerance, step, measure
    )
    solution = search.solved()
    return verdict(solution, confidence=confidence, length_error=length_error)


def _launches(launch: Any, count: int) -> tuple[Launch, ...]:
    one = Launch() if launch is None else launch
    launches = (one,) * count if isinstance(one, Launch) else arrays.several(one, "launch")
    if len(launches) != count:
        raise DimensionError(
            "launch", f"must be one, or one for each of the {count} paths, got {len(launches)}"
        )
    for k, each in enumerate(launches):
        arrays.of_kind(each, f"launch[{k}]", Launch, "a Launch")
    return launches


def _after(path: Observed, launch: Launch) -> Observed:
    """Return the points of a path after a launch that is where the body is at a given time."""
    if launch.place is not None or launch.time is None:
        return path
    kept = path.time >= launch.time
    if kept.sum() < FEWEST:
        raise ParameterError(
            "launch", f"of {path.name} at {launch.time:.6g} s leaves {kept.sum()} points after it"
        )
    return Observed(path.name, path.time[kept], path.position[kept], path.error[kept])


def _refuse_degrees(paths: Sequence[Observed], stated: Array) -> None:
    """Refuse directions that are those of the paths if they are read in degrees."""
    off = []
    for path, direction in zip(paths, stated, strict=True):
        x, y = path.position[len(path.time) // 2] - path.position[0]
        turned = np.array([direction, np.deg2rad(direction)]) - np.arctan2(y, x)
        off.append(np.abs((turned + np.pi) % (2.0 * np.pi) - np.pi))
    radians, degrees = np.array(off)[np.isfinite(stated)].reshape(-1, 2).T
    if (radians > _ASTRAY).any() and (degrees < _ASTRAY).all():
        raise FitError(
            "directions of the launches must be in rad; those given are those of the paths if they "
            "are read in degrees: np.deg2rad converts them"
        )


def _held(fixed: Mapping[str, float] | None, structure: PlanarStructure) -> Array:
    """Return the coordinates that are known, NaN of the others."""
    names = structure.names
    held = np.full(len(names), np.nan)
    for name, value in (fixed or {}).items():
        if name not in names:
            raise ParameterError(
                "fixed",
                f"{name!r} is no parameter of these models{advice_on(str(name), names)}: they have "
                f"{', '.join(names)}",
            )
        at = names.index(name)
        number = arrays.number(value, f"fixed[{name!r}]")
        filled = np.full(len(names), 2.0)
        filled[at] = number
        try:
            held[at] = structure.of_values(filled)[at]
        except ParameterError as error:
            raise ParameterError("fixed", error.message) from None
    return held


class _Search:
    """Looks for the law and the launches of paths."""

    def __init__(
        self,
        structure: PlanarStructure,
        held: Array,
        paths: Sequence[Observed],
        system: Model,
        known: Array,
        errors: Array,
        tolerance: float,
        dt: float | None,
        loss: Loss,
    ) -> None:
        self._loss = loss
        self._structure, self._held = structure, held
        self._free: NDArray[np.bool_] = np.isnan(held)
        self._paths, self._known, self._errors = paths, known, errors
        times = [path.time for path in paths]
        self._rough = Motions(system, times, max(tolerance, _ROUGH), dt)
        self._motions = Motions(system, times, tolerance, dt)
        if not self._free.any():
            raise ParameterError("fixed", "leaves no parameter to be fitted")

    def solved(self) -> Solution:
        """Return the best law, and whether others are as good."""
        starts, launches = self._starts()
        size = int(self._free.sum())
        rough, misfits = (
            Misfits(self._paths, motions, self._law, self._known, self._errors, size)
            for motions in (self._rough, self._motions)
        )
        if misfits.rows <= misfits.count:
            raise FitError(
                f"{misfits.rows} measured numbers cannot tell {misfits.count} unknowns: choose a "
                "simpler model, or measure more points"
            )
        z = [misfits.joined(one[self._free], launches) for one in starts]
        near = [self._tried(rough, one) for one in z] if len(z) > 1 else []
        best = min(near, key=lambda d: d.cost).p if near else z[0]
        for _ in range(0 if self._loss.is_linear else _ROUNDS):
            best = self._descend(misfits, best, _SIFTED).p
            before = self._loss.scale
            self._loss = self._loss.scaled_by(np.abs(misfits.residuals(best)))
            if abs(self._loss.scale - before) <= _SETTLED * self._loss.scale:
                break
        found = self._descend(misfits, best, _CLOSE)
        if not (found.converged and np.isfinite(found.cost)):
            names = " and ".join(name_of(model) for _, model, _ in self._structure.models)
            raise FitError(
                f"no minimum of {names} was found: choose a simpler model, or launch in more "
                "directions"
            )
        others = [d for d in near if 2.0 * d.cost < 2.0 * found.cost + _ALIKE]
        log.info("fit_paths: %d paths, squares %.6g", len(self._paths), 2.0 * found.cost)
        return Solution(
            structure=self._structure,
            held=self._held,
            misfits=misfits,
            motions=self._motions,
            loss=self._loss,
            z=self._folded(found.p, misfits),
            others=tuple(self._folded(d.p, misfits)[: misfits.size] for d in others),
        )

    def _starts(self) -> tuple[list[Array], Array]:
        """Return coordinates of laws to start from, and launches."""
        held = dict(zip(self._structure.names, self._held.tolist(), strict=True))
        angles = [
            None if np.isnan(held.get(f"{part}.angle", np.nan)) else held[f"{part}.angle"]
            for part in ("reservoir", "direction")
        ]
        ellipses = Ellipses(
            self._structure.reservoir, self._structure.direction, (angles[0], angles[1])
        )
        launches = first_launches(self._paths, self._known)
        rough = Misfits(
            self._paths, self._rough, ellipses.law, self._known, self._errors, ellipses.size
        )
        y = np.zeros(ellipses.size)
        y[0] = best_size(rough, self._rough, launches)
        found = self._descend(rough, rough.joined(y, launches), _NEAR, bounded=False)
        starts = ellipses.starts(found.p[: ellipses.size])
        if not self._turns():
            starts = starts[:1]
        full = [np.where(self._free, one, self._held) for one in starts]
        return full, rough.launches(found.p)

    def _turns(self) -> bool:
        """Return whether C may be a superellipse at any angle, of which there are false ones."""
        names = [n for n, free in zip(self._structure.names, self._free, strict=True) if free]
        return {"reservoir.exponent", "reservoir.angle"} <= set(names)

    def _law(self, free: Array) -> FrictionLaw:
        return self._structure.law(self._full(free))

    def _full(self, free: Array) -> Array:
        full = self._held.copy()
        full[self._free] = free
        return full

    def _folded(self, z: Array, misfits: Misfits) -> Array:
        """Return unknowns of the same law with the angles of its sets within ±45°."""
        full = self._full(z[: misfits.size])
        for _, model, part in self._structure.models:
            # The axes of a set that are told by name keep their names; half a turn changes nothing.
            last = part.stop - 1
            if self._free[part].all():
                full[part] = model.folded(full[part])
            elif model.roundness() is not None and self._free[last]:
                full[last] -= math.pi * round(full[last] / math.pi)
        return np.concatenate([full[self._free], z[misfits.size :]])

    def _tried(self, misfits: Misfits, z: Array) -> Found:
        """Descend from a start that may lead nowhere."""
        try:
            return self._descend(misfits, z, _SIFTED)
        except FitError:
            return Found(z, np.inf, 0, converged=False)

    def _descend(self, misfits: Misfits, z: Array, close: float, *, bounded: bool = True) -> Found:
        """Descend with differences to one side: their errors hardly move the minimum."""

        def slopes(at: Array) -> Array:
            return misfits.jacobian(at, central=False)

        low, high = (np.full(misfits.count, side * np.inf) for side in (-1.0, 1.0))
        if bounded:
            bounds = [(one.low, one.high) for _, one in self._structure.coordinates]
            ends = np.array(bounds)[self._free]
            low[: misfits.size], high[: misfits.size] = ends.T
            z = np.clip(z, low + 1e-6, high - 1e-6)
        if not np.isfinite(misfits.residuals(z)).all():
            return Found(z, np.inf, 0, converged=False)
        return search(
            misfits.residuals,
            slopes,
            z,
            loss=self._loss,
            close=close,
            most=_MOST_TRIALS,
            bounds=(low, high),
            shortest=1e-10,
        )
