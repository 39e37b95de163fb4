"""A minimum of the squares of paths, and what follows from it there."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from asperity._base.arrays import Array
from asperity.errors import FitError
from asperity.identify.estimator.covariance import Covariance
from asperity.identify.estimator.leverage import Leverage, leverage_of
from asperity.identify.estimator.loss import Loss
from asperity.identify.evidence.paths.misfits import Misfits
from asperity.identify.evidence.paths.motions import Motions
from asperity.identify.models.coordinates import at_bounds
from asperity.identify.models.structure import PlanarStructure

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
        loss: of the residuals.
        z: the unknowns.
        others: free coordinates of other minima that are about as good.
    """

    structure: PlanarStructure
    held: Array
    misfits: Misfits
    motions: Motions
    loss: Loss
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
        """Root mean square of the residuals, corrected for what was fitted, or a loss's scale."""
        if not self.loss.is_linear:
            return self.loss.scale
        left = self.misfits.rows - self.misfits.count
        return math.sqrt(float(self.residuals @ self.residuals) / left)

    @cached_property
    def weights(self) -> tuple[Array, Array]:
        """Factors of the derivatives and of the residuals, with which both are of least squares."""
        _, weight, bend = self.loss.at(self.residuals**2)
        root = np.sqrt(weight * bend.mean() / weight.mean())
        return root, weight / root

    @cached_property
    def parts(self) -> list[Array]:
        """Derivatives by the law that changes of the launch do not mimic, path by path."""
        parts = []
        weighted = self.jacobian * self.weights[0][:, None]
        for k in range(len(self.misfits.paths)):
            rows = weighted[self.misfits.of(k)]
            shared, own = rows[:, : self.misfits.size], rows[:, self.misfits.unknowns_of(k)]
            scale = np.linalg.norm(own, axis=0)
            basis = np.linalg.qr(own / np.where(scale > 0.0, scale, 1.0))[0]
            parts.append(shared - basis @ (basis.T @ shared))
        return parts

    @cached_property
    def leverage(self) -> Leverage:
        """What single paths decide, their launches projected out.

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
        matrices = np.array([part.T @ part for part in self.parts])
        found = leverage_of(matrices.sum(axis=0), matrices, without_single=True)
        if dead or found.rank < len(names):
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
        wide = np.sqrt(np.diag(found.inverse)) > _UNKNOWN
        coordinates = [self.structure.coordinates[at][1] for at in self.free]
        wide &= ~at_bounds(self.z[: self.misfits.size], coordinates)
        if wide.any():
            listed = ", ".join(n for n, one in zip(names, wide, strict=True) if one)
            raise FitError(
                f"the paths do not tell {listed}: choose a simpler model, or fix parameters that "
                f"are known; {self.remedy}"
            )
        return found

    @cached_property
    def remedy(self) -> str:
        """What would tell more, in words."""
        symmetric = all(model.is_symmetric for _, model, _ in self.structure.models)
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
        return -self.leverage.inverse @ self._pulls(self.weights[0] * change).sum(axis=0)

    def covariance(self, shared: Array | None) -> Covariance:
        """Return the covariance of all coordinates; those that are known do not scatter.

        It is unbiased if the errors of the positions are as stated, and holds whatever else is
        common to the points of one path.

        Args:
            shared: what all paths share moves the free coordinates by, per standard error.
        """
        unit = np.eye(len(self.held))[:, self.free]
        scatter = self.leverage.covariance(self._pulls(self.weights[1] * self.residuals))
        whole = replace(self.leverage, root=unit @ self.leverage.root)
        known = np.where(whole.compares(unit.T), whole.degrees(unit.T), 0.0)
        degrees = float(known.min())
        common = None if shared is None else np.outer(unit @ shared, unit @ shared)
        return Covariance(
            unit @ scatter @ unit.T, common, None, (degrees, math.inf, math.inf), whole
        )

    def _pulls(self, change: Array) -> Array:
        """Return the gradients of the paths for residuals, ``(G, k)``."""
        return np.array([x.T @ change[self.misfits.of(k)] for k, x in enumerate(self.parts)])
