"""Normal equations of a law's coordinates, summed turn by turn.

D gives the direction of the force, C its magnitude in that direction: −λ = λ_N r_C(θ) e(θ) with
θ = θ_D(φ). Derivatives are taken along the force and across it.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from asperity._base.arrays import Array
from asperity._base.pool import threads_to_use
from asperity._base.threads import Stop, in_threads
from asperity._base.value import Value
from asperity.identify.estimator.descent import Sums
from asperity.identify.estimator.loss import Loss
from asperity.identify.evidence.forces.samples import Samples
from asperity.identify.models.coordinates import TINY, Coordinate
from asperity.identify.models.directions import DirectionModel
from asperity.identify.models.reservoirs import ReservoirModel
from asperity.identify.models.structure import PlanarStructure

# Samples that models are evaluated at one after the other.
_CHUNK = 2**16
# Threads cost more than they bring for fewer chunks of 8192 samples.
_FEW_CHUNKS = 32


class Family(Value):
    """Laws that have a reservoir of one model and a direction set of another.

    Args:
        reservoir: model of C.
        direction: model of D.
        joint: whether C and D are fitted to the forces together; else C to their magnitudes over
            their directions, and D to these over the sliding directions.
    """

    reservoir: ReservoirModel
    direction: DirectionModel
    joint: bool

    def __init__(
        self, reservoir: ReservoirModel, direction: DirectionModel, *, joint: bool
    ) -> None:
        self._set(reservoir=reservoir, direction=direction, joint=joint)
        coordinates = (*reservoir.coordinates, *direction.coordinates)
        self._keep(
            structure=PlanarStructure(reservoir, direction),
            coordinates=coordinates,
            split=len(reservoir.coordinates),
            size=len(coordinates),
        )

    structure: PlanarStructure
    coordinates: tuple[Coordinate, ...]
    split: int
    size: int

    @property
    def is_symmetric(self) -> bool:
        """Whether forces turn round with the sliding direction: f(φ + π) = −f(φ)."""
        return self.reservoir.is_symmetric and self.direction.is_symmetric

    def forces(self, phi: Array, p: Array) -> tuple[Array, Array]:
        """Return −λ/λ_N at sliding directions, ``(n, 2)``, and its derivatives, ``(k, n, 2)``."""
        cos, sin, turn = self.direction.force_direction(np.cos(phi), np.sin(phi), p[self.split :])
        log_radius, slope, by = self.reservoir.log_radius(cos, sin, p[: self.split])
        radius = np.exp(log_radius)
        along = radius * np.stack([cos, sin])
        across = radius * np.stack([-sin, cos])
        derivative = np.concatenate(
            [
                by[:, None] * along,
                (slope * turn)[:, None] * along + turn[:, None] * across,
            ]
        )
        return along.T.copy(), np.moveaxis(derivative, 1, 2).copy()

    def responses(self, phi: Array, p: Array) -> tuple[Array, Array]:
        """Return the derivatives of Jᵀe, per unit normal force, by forces and normal forces.

        Their shapes are ``(k, n, 2)`` and ``(k, n)``.
        """
        force, derivative = self.forces(phi, p)
        if self.joint:
            return derivative, -np.einsum("knc,nc->kn", derivative, force)
        cos, sin, turn = self.direction.force_direction(np.cos(phi), np.sin(phi), p[self.split :])
        log_radius, slope, by = self.reservoir.log_radius(cos, sin, p[: self.split])
        radius = np.exp(log_radius)
        along, across = np.stack([cos, sin], axis=-1), np.stack([-sin, cos], axis=-1)
        # A force across the other turns the direction in which the radius is looked up.
        by_c = (by * radius)[..., None] * (along - slope[:, None] * across)
        by_d = (turn * radius)[..., None] * across
        on_normal = np.concatenate([-by * radius**2, np.zeros_like(turn)])
        return np.concatenate([by_c, by_d]), on_normal

    def residuals(
        self, phi: Array, force: Array, normal: Array, p: Array
    ) -> tuple[Array, Array, Array, Array]:
        """Return residuals along and across the force, in N, and their derivatives.

        Those along the force are by p, those across it by the coordinates of D.
        """
        cos, sin, turn = self.direction.force_direction(np.cos(phi), np.sin(phi), p[self.split :])
        x, y = force[:, 0], force[:, 1]
        along, across = x * cos + y * sin, y * cos - x * sin
        jacobian_along = np.empty((self.size, phi.size))
        if self.joint:
            log_radius, slope, by = self.reservoir.log_radius(cos, sin, p[: self.split])
            size = normal * np.exp(log_radius)
            along -= size
            jacobian_across = turn * size
            np.multiply(jacobian_across, slope, out=jacobian_along[self.split :])
        else:
            length = np.maximum(np.hypot(x, y), TINY)
            log_radius, _, by = self.reservoir.log_radius(x / length, y / length, p[: self.split])
            size = normal * np.exp(log_radius)
            along = length - size
            jacobian_across = turn * size
            jacobian_along[self.split :] = 0.0
        np.multiply(by, size, out=jacobian_along[: self.split])
        return along, across, jacobian_along, jacobian_across

    def left(self, samples: Samples, p: Array) -> Samples:
        """Return all samples, in turns or not, with what the model leaves of their forces."""
        left = np.empty_like(samples.force)
        for start in range(0, len(left), _CHUNK):
            part = slice(start, start + _CHUNK)
            model = self.forces(samples.phi[part], p)[0]
            left[part] = samples.force[part] - samples.normal[part, None] * model
        return replace(samples, force=left)

    def sums(self, samples: Samples, p: Array, loss: Loss) -> Sums:
        """Return the normal equations at p, to the bit the same for any number of threads."""
        cost = np.zeros(samples.turns)
        gradient = np.zeros((samples.turns, self.size))
        matrix = np.zeros((samples.turns, self.size, self.size))
        chunks = list(samples.chunks())
        threads = threads_to_use() if len(chunks) > _FEW_CHUNKS else 1

        def added(chunk: tuple[slice, int], _: Stop | None) -> tuple[int, float, Array, Array]:
            return chunk[1], *self._added(samples, chunk[0], p, loss)

        found = (added(one, None) for one in chunks)
        for turn, *parts in found if threads == 1 else in_threads(added, chunks, threads):
            for whole, part in zip((cost, gradient, matrix), parts, strict=True):
                whole[turn] += part
        return Sums(cost, gradient, matrix)

    def _added(
        self, samples: Samples, part: slice, p: Array, loss: Loss
    ) -> tuple[float, Array, Array]:
        """Return what a chunk of samples adds to cost, gradient and matrix."""
        d = slice(self.split, None)
        along, across, by_along, by_across = self.residuals(
            samples.phi[part], samples.force[part], samples.normal[part], p
        )
        weighted_along, weighted_across = by_along, by_across
        if loss.is_linear:
            cost = along @ along + across @ across
        else:
            value, weight, curvature = loss.at(along * along + across * across)
            cost, along, across = value.sum(), along * weight, across * weight
            weighted_along, weighted_across = by_along * curvature, by_across * curvature
        gradient, matrix = by_along @ along, weighted_along @ by_along.T
        gradient[d] += by_across @ across
        matrix[d, d] += weighted_across @ by_across.T
        return float(cost), gradient, matrix
