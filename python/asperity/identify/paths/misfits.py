"""Differences of simulated and measured paths, and their derivatives by all that is unknown."""

from __future__ import annotations

from collections.abc import Callable, Sequence

import numpy as np
from numpy.typing import NDArray

from asperity._base.arrays import Array
from asperity.errors import AsperityError, FitError
from asperity.identify.paths.motions import Motions
from asperity.identify.paths.observed import Observed
from asperity.law import FrictionLaw

# Steps of the differences: of coordinates of the law, which are logarithms and angles, of the
# speed relative to it, of the direction in rad, of the time and the place relative to those that
# the path takes. A shorter step would show errors of the integration, a longer one the curvature.
_STEP = 1e-3


class Misfits:
    """Differences of simulated and measured paths in standard errors, path by path.

    The unknowns are coordinates of the law, then the unknown quantities of every launch. Rows of a
    path are its positions, component by component, and what is known of its launch.

    Args:
        paths: the measured paths.
        motions: simulates them.
        law: returns the law of coordinates.
        known: what is known of the launches, NaN of what is not, ``(G, 5)``.
        errors: its standard errors; zero where it is exact.
        size: number of coordinates of the law.
    """

    def __init__(
        self,
        paths: Sequence[Observed],
        motions: Motions,
        law: Callable[[Array], FrictionLaw],
        known: Array,
        errors: Array,
        size: int,
    ) -> None:
        self.paths, self._motions, self._law = paths, motions, law
        self.size = size
        self._known, self._errors = known, errors
        told = np.isfinite(known)
        self.free: NDArray[np.bool_] = ~told | (errors > 0.0)
        self._stated: NDArray[np.bool_] = told & (errors > 0.0)
        rows = [
            2 * len(path.time) + int(s.sum()) for path, s in zip(paths, self._stated, strict=True)
        ]
        self._ends = np.cumsum([0, *rows])
        self._columns = size + np.cumsum([0, *self.free.sum(axis=1)])
        last = np.array([np.ptp(path.time) for path in paths])
        length = np.array([np.hypot(*np.ptp(path.position, axis=0)) for path in paths])
        one = np.ones_like(last)
        # Derivatives are asked for where the squares were last.
        self._last: tuple[Array, list[Array] | None] | None = None
        self._steps = _STEP * np.stack([one, one, last, length, length], axis=1)

    def of(self, path: int) -> slice:
        """Return the rows of a path."""
        return slice(int(self._ends[path]), int(self._ends[path + 1]))

    def unknowns_of(self, path: int) -> slice:
        """Return the places of the unknowns of a launch."""
        return slice(int(self._columns[path]), int(self._columns[path + 1]))

    @property
    def count(self) -> int:
        """Number of unknowns."""
        return int(self._columns[-1])

    @property
    def rows(self) -> int:
        """Number of differences."""
        return int(self._ends[-1])

    def joined(self, coordinates: Array, launches: Array) -> Array:
        """Return the unknowns of coordinates of the law and launches."""
        return np.concatenate([coordinates, launches[self.free]])

    def launches(self, z: Array) -> Array:
        """Return the quantities of the launches, ``(G, 5)``."""
        result = self._known.copy()
        result[self.free] = z[self.size :]
        return result

    def residuals(self, z: Array) -> Array:
        """Return simulated minus measured values in standard errors; infinite without a motion."""
        launches, simulated = self.launches(z), self.simulated(z)
        if simulated is None:
            return np.full(self.rows, np.inf)
        return np.concatenate([self._rows(one, k, launches[k]) for k, one in enumerate(simulated)])

    def simulated(self, z: Array) -> list[Array] | None:
        """Return positions of all paths at the measured times."""
        if self._last is None or not np.array_equal(self._last[0], z):
            launches = self.launches(z)
            everywhere = range(len(launches))
            found = self._simulated([z[: self.size]] * len(launches), launches, everywhere)
            self._last = z.copy(), found
        return self._last[1]

    def jacobian(self, z: Array, *, factor: float = 1.0, central: bool = True) -> Array:
        """Return the derivatives of the residuals, by differences of paths.

        Args:
            z: the unknowns.
            factor: of all steps.
            central: whether steps go to both sides.
        """
        count, launches = len(self.paths), self.launches(z)
        steps = np.empty(self.count)
        steps[: self.size] = _STEP * factor
        scale = self._steps.copy()
        scale[:, 0] *= launches[:, 0]
        steps[self.size :] = factor * scale[self.free]
        # A motion for every coordinate and path, and one for every unknown of a launch.
        owner = np.repeat(np.arange(count), self.free.sum(axis=1))
        columns = np.concatenate(
            [np.repeat(np.arange(self.size), count), self.size + np.arange(len(owner))]
        )
        which = np.concatenate([np.tile(np.arange(count), self.size), owner])
        sides = (1.0, -1.0) if central else (1.0, 0.0)
        found = []
        for side in sides:
            if side == 0.0:
                found.append(self.simulated(z))
                continue
            moved = []
            for column in columns:
                at = z.copy()
                at[column] += side * steps[column]
                moved.append(at)
            found.append(
                self._simulated(
                    [at[: self.size] for at in moved],
                    np.stack([self.launches(at)[k] for at, k in zip(moved, which, strict=True)]),
                    which,
                )
            )
        result = np.zeros((self.rows, self.count))
        upper, lower = found
        if upper is None or lower is None:
            raise FitError(
                "no motions could be found for parameters close by: choose a simpler model, or "
                "give dt to simulate instead of integrating"
            )
        for m, (column, k) in enumerate(zip(columns, which, strict=True)):
            error = self.paths[k].error
            below = lower[m] if central else lower[k]
            width = (2.0 if central else 1.0) * steps[column]
            rows = self.of(k)
            slope = (upper[m] - below) / width / error
            result[rows.start : rows.start + slope.size, column] = slope.T.ravel()
        for k, path in enumerate(self.paths):
            own = np.flatnonzero(self.free[k])
            unknowns = self.unknowns_of(k)
            row = self.of(k).start + 2 * len(path.time)
            for quantity in np.flatnonzero(self._stated[k]):
                column = unknowns.start + int(np.flatnonzero(own == quantity)[0])
                result[row, column] = 1.0 / self._errors[k, quantity]
                row += 1
        return result

    def _rows(self, simulated: Array, k: int, launch: Array) -> Array:
        path, stated = self.paths[k], self._stated[k]
        off = ((simulated - path.position) / path.error).T.ravel()
        return np.concatenate([off, (launch - self._known[k])[stated] / self._errors[k][stated]])

    def _simulated(
        self, coordinates: Sequence[Array], launches: Array, which: Sequence[int] | NDArray[np.intp]
    ) -> list[Array] | None:
        laws: dict[bytes, FrictionLaw] = {}
        try:
            for at in coordinates:
                if at.tobytes() not in laws:
                    laws[at.tobytes()] = self._law(at)
        except AsperityError:
            return None
        return self._motions.paths(
            [laws[at.tobytes()] for at in coordinates], launches, list(which)
        )
