"""Differences of simulated and measured paths, and their derivatives by all that is unknown."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from asperity._base.arrays import Array
from asperity.errors import AsperityError, FitError
from asperity.identify.evidence.paths.launch import QUANTITIES, SPEED, TIME
from asperity.identify.evidence.paths.motions import Motions, Simulated
from asperity.identify.evidence.paths.observed import Observed
from asperity.law import FrictionLaw

# Steps of the differences: of coordinates of the law, which are logarithms and angles, of the
# speed relative to it, of the direction in rad, of the place relative to the length of the path.
# A shorter step would show errors of the integration, a longer one the curvature.
_STEP = 1e-3
# Coordinates of laws are logarithms and angles: beyond, no step of a search comes back.
_FARTHEST = 50.0


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
        length = np.array([np.hypot(*np.ptp(path.position, axis=0)) for path in paths])
        one = np.ones_like(length)
        # Why a law could not be made, for messages.
        self._refused = ""
        # Derivatives are asked for where the squares were last.
        self._last: tuple[Array, list[Simulated] | None] | None = None
        self._steps = _STEP * np.stack([one, one, one, length, length], axis=1)

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

    def names_of_launches(self) -> list[str]:
        """Return what the unknowns of the launches are, in their order."""
        return [
            f"{QUANTITIES[quantity]} of the launch of {self.paths[k].name}"
            for k, quantity in zip(*np.nonzero(self.free), strict=True)
        ]

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
        return np.concatenate(
            [self._rows(one.position, k, launches[k]) for k, one in enumerate(simulated)]
        )

    def simulated(self, z: Array) -> list[Simulated] | None:
        """Return all paths at the measured times."""
        if self._last is None or not np.array_equal(self._last[0], z):
            launches = self.launches(z)
            everywhere = range(len(launches))
            found = self._simulated([z[: self.size]] * len(launches), launches, everywhere)
            self._last = z.copy(), found
        return self._last[1]

    def jacobian(self, z: Array, *, factor: float = 1.0, central: bool = True) -> Array:
        """Return the derivatives of the residuals, by differences of paths.

        Derivatives by the time of a launch are velocities.

        Args:
            z: the unknowns.
            factor: of all steps.
            central: whether steps go to both sides.
        """
        columns, which = self._moved
        steps = factor * self._steps_at(z)[columns]
        here, upper = self.simulated(z), self._beside(z, steps)
        lower = self._beside(z, -steps) if central else here
        if here is None or upper is None or lower is None:
            raise FitError(
                "the fit came to parameters beside which there are no motions: "
                f"{self._refused or 'they could not be integrated, give dt to simulate'}; choose "
                "a simpler model, or launch in more directions"
            )
        result = np.zeros((self.rows, self.count))
        for m, (column, k) in enumerate(zip(columns, which, strict=True)):
            below, width = (lower[m], 2.0 * steps[m]) if central else (lower[k], steps[m])
            self._enter(result, k, column, (upper[m].position - below.position) / width)
        for k, quantities in enumerate(self.free):
            for column, quantity in enumerate(np.flatnonzero(quantities), self._columns[k]):
                if quantity == TIME:
                    self._enter(result, k, column, -here[k].velocity)
                if self._stated[k, quantity]:
                    row = self.of(k).stop - self._stated[k, quantity:].sum()
                    result[row, column] = 1.0 / self._errors[k, quantity]
        return result

    @cached_property
    def _moved(self) -> tuple[NDArray[np.intp], NDArray[np.intp]]:
        """The unknowns by which motions are differentiated, and the paths of these motions.

        There is a motion for every coordinate of the law and path, and one for every unknown of a
        launch but its time, which shifts a path and does not change it.
        """
        count = len(self.paths)
        owner, quantity = np.nonzero(self.free)
        kept = quantity != TIME
        launched = self.size + np.flatnonzero(kept)
        columns = np.concatenate([np.repeat(np.arange(self.size), count), launched])
        which = np.concatenate([np.tile(np.arange(count), self.size), owner[kept]])
        return columns, which

    def _steps_at(self, z: Array) -> Array:
        scale = self._steps.copy()
        scale[:, SPEED] *= self.launches(z)[:, SPEED]
        return np.concatenate([np.full(self.size, _STEP), scale[self.free]])

    def _beside(self, z: Array, steps: Array) -> list[Simulated] | None:
        """Return the motions where one unknown is larger by its step."""
        columns, which = self._moved
        moved = np.tile(z, (len(columns), 1))
        moved[np.arange(len(columns)), columns] += steps
        launches = np.stack([self.launches(at)[k] for at, k in zip(moved, which, strict=True)])
        return self._simulated(moved[:, : self.size], launches, which)

    def moved(self, steps: Sequence[Array]) -> Array:
        """Return how residuals change if simulated points move by steps in m, path by path."""
        change = np.zeros((self.rows, 1))
        for k, step in enumerate(steps):
            self._enter(change, k, 0, step)
        return np.asarray(change[:, 0])

    def _enter(self, into: Array, path: int, column: int, slope: Array) -> None:
        begin = self.of(path).start
        into[begin : begin + slope.size, column] = (slope / self.paths[path].error).T.ravel()

    def _rows(self, simulated: Array, k: int, launch: Array) -> Array:
        path, stated = self.paths[k], self._stated[k]
        off = ((simulated - path.position) / path.error).T.ravel()
        return np.concatenate([off, (launch - self._known[k])[stated] / self._errors[k][stated]])

    def _simulated(
        self,
        coordinates: Sequence[Array] | Array,
        launches: Array,
        which: Sequence[int] | NDArray[np.intp],
    ) -> list[Simulated] | None:
        laws: dict[bytes, FrictionLaw] = {}
        if np.abs(coordinates).max(initial=0.0) > _FARTHEST:
            self._refused = "the parameters of the law run away"
            return None
        try:
            for at in coordinates:
                if at.tobytes() not in laws:
                    laws[at.tobytes()] = self._law(at)
        except AsperityError as error:
            self._refused = str(error)
            return None
        return self._motions.paths(
            [laws[at.tobytes()] for at in coordinates], launches, list(which)
        )
