"""A minimum of the squares of paths, and what follows from it there."""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from asperity._base.arrays import Array
from asperity.errors import FitError
from asperity.identify.fitting.models.coordinates import Coordinate, at_bounds
from asperity.identify.identified_law import Structure
from asperity.identify.paths.misfits import Misfits
from asperity.identify.paths.motions import Motions
from asperity.identify.paths.spread import Spread, shared_parts, spread

# A logarithm with a larger standard error is not known.
_UNKNOWN = 1.0
# Directions of sliding within fewer degrees are few; those of slower motions are not counted.
_NARROW, _SLOW = 80.0, 1e-2


@dataclass(frozen=True, eq=False)
class Solution:
    """A minimum of the squares of paths.

    Attributes:
        structure: the models.
        held: coordinates that are known, NaN of the others.
        misfits: of the paths.
        motions: simulates them.
        z: the unknowns.
        others: free coordinates of other minima that are about as good.
    """

    structure: Structure
    held: Array
    misfits: Misfits
    motions: Motions
    z: Array
    others: tuple[Array, ...]

    @cached_property
    def free(self) -> NDArray[np.intp]:
        """Places of the coordinates that were fitted."""
        return np.flatnonzero(np.isnan(self.held))

    @cached_property
    def coordinates(self) -> Array:
        """All coordinates of the law."""
        full = self.held.copy()
        full[self.free] = self.z[: self.misfits.size]
        return full

    @cached_property
    def jacobian(self) -> Array:
        """Derivatives of the residuals by central differences."""
        return self.misfits.jacobian(self.z)

    @cached_property
    def residuals(self) -> Array:
        """Differences in standard errors."""
        return self.misfits.residuals(self.z)

    @cached_property
    def slope_error(self) -> float:
        """How much derivatives differ at two step sizes, relative to them, at most."""
        twice = self.misfits.jacobian(self.z, factor=2.0)
        off = np.linalg.norm(twice - self.jacobian, axis=0)
        sizes = np.maximum(np.linalg.norm(self.jacobian, axis=0), np.finfo(float).tiny)
        return float(np.max(off / sizes, initial=0.0))

    @cached_property
    def misfit(self) -> float:
        """Root mean square of the residuals, corrected for what was fitted."""
        left = self.misfits.rows - self.misfits.count
        return math.sqrt(float(self.residuals @ self.residuals) / left)

    @cached_property
    def spread(self) -> Spread:
        """The scatter between paths.

        Raises:
            FitError: if the paths do not tell all parameters.
        """
        if not np.isfinite(self.jacobian).all():
            raise FitError(
                "derivatives of the paths are not finite where the fit ended: check the launches "
                "and the errors that are stated, or choose a simpler model"
            )
        columns = self.jacobian[:, : self.misfits.size]
        names = [self.structure.names[at] for at in self.free]
        dead = [n for n, c in zip(names, columns.T, strict=True) if not c.any()]
        found = None if dead else spread(self.misfits, self.residuals, self.jacobian)
        if found is None:
            raise FitError(
                f"the paths do not tell {', '.join(dead or names)} apart: choose a simpler model, "
                f"or fix parameters that are known; {self.remedy}"
            )
        # A body that is launched the wrong way fits best at rest, and then tells nothing.
        launched = self.jacobian[:, self.misfits.size :].T
        listed_launches = self.misfits.names_of_launches()
        idle = [n for n, c in zip(listed_launches, launched, strict=True) if not c.any()]
        if idle:
            raise FitError(
                f"the fit ended where the paths do not tell {', '.join(idle)}: check what "
                "is stated of the launches (directions are in rad, places in m), or state its error"
            )
        wide = np.sqrt(np.diag(found.stated)) > _UNKNOWN
        wide &= ~at_bounds(self.z[: self.misfits.size], self._listed)
        if wide.any():
            listed = ", ".join(n for n, one in zip(names, wide, strict=True) if one)
            raise FitError(
                f"the paths do not tell {listed}: choose a simpler model, or fix parameters that "
                f"are known; {self.remedy}"
            )
        return found

    @property
    def _listed(self) -> list[Coordinate]:
        return [self.structure.coordinates[at][1] for at in self.free]

    @cached_property
    def remedy(self) -> str:
        """What would tell more, in words."""
        symmetric = all(model.is_symmetric for model in self.structure)
        turn = 180.0 if symmetric else 360.0
        phi = np.sort(self._sliding % turn)
        if not len(phi):
            return "no body slides where it was measured, check what is stated of the launches"
        apart = np.diff(phi, append=phi[0] + turn)
        last = int(apart.argmax())
        width = turn - float(apart[last])
        if width >= _NARROW:
            return "launch more bodies, in directions between those that there are"
        first = float(phi[(last + 1) % len(phi)])
        return (
            f"the bodies slide at {first:.0f}° to {first + width:.0f}° only, launch in more "
            "directions"
        )

    @property
    def _sliding(self) -> Array:
        """Directions in degrees in which bodies slide where they were measured."""
        angles = [np.empty(0)]
        for one in self.misfits.simulated(self.z) or ():
            speed = np.hypot(*one.velocity.T)
            moving = one.velocity[speed > _SLOW * speed.max(initial=0.0)]
            angles.append(np.rad2deg(np.arctan2(moving[:, 1], moving[:, 0])))
        return np.concatenate(angles)

    def response(self, change: Array) -> Array:
        """Return by how much the free coordinates move if residuals change by this, `(k,)`."""
        pull = sum(
            part.T @ change[self.misfits.of(k)]
            for k, part in enumerate(shared_parts(self.misfits, self.jacobian))
        )
        return -self.spread.stated @ np.asarray(pull)
