"""Mocap bodies that were moved from one step to the next."""

from __future__ import annotations

from types import ModuleType
from typing import TYPE_CHECKING, NamedTuple

import numpy as np
from numpy.typing import NDArray

from asperity._base.arrays import Array
from asperity.errors import ParameterError

if TYPE_CHECKING:
    import mujoco


class Places(NamedTuple):
    """Positions in m and unit quaternions of mocap bodies."""

    position: Array
    quaternion: Array

    @classmethod
    def of(cls, mj: ModuleType, data: mujoco.MjData) -> Places:
        """Return those of `data`."""
        places = cls(data.mocap_pos.copy(), data.mocap_quat.copy())
        if not (np.isfinite(places.position).all() and np.isfinite(places.quaternion).all()):
            raise ParameterError("data", "must have finite mocap_pos and mocap_quat")
        for quaternion in places.quaternion:
            mj.mju_normalize4(quaternion)
        return places


class Guidance(NamedTuple):
    """Constant velocities in m/s and rad/s, in the world's axes, with which mocap bodies move.

    `middle` are their places halfway; `rates` the velocities of equalities.
    """

    middle: Places
    velocity: Array
    spin: Array
    rates: Array

    @classmethod
    def between(
        cls, mj: ModuleType, before: Places, after: Places, time: float, rates: Array
    ) -> Guidance:
        """Return the motion from some places to others in a time."""
        turns, halfway = np.empty_like(after.position), before.quaternion.copy()
        pairs = zip(turns, halfway, before.quaternion, after.quaternion, strict=True)
        for turn, half, old, new in pairs:
            mj.mju_subQuat(turn, new, old)
            mj.mju_quatIntegrate(half, turn, 0.5)
            mj.mju_rotVecQuat(turn, turn.copy(), old)
        middle = Places(0.5 * (before.position + after.position), halfway)
        return cls(middle, (after.position - before.position) / time, turns / time, rates)

    def of_contacts(self, hands: NDArray[np.int32], points: Array, frames: Array) -> Array:
        """Return velocities along the axes of contacts and about their normals.

        Args:
            hands: numbers of the mocap bodies of both geoms, or −1, shape ``(n, 2)``.
            points: of contact, shape ``(n, 3)``.
            frames: whose rows are normal and tangents, shape ``(n, 3, 3)``.
        """
        found = np.zeros((len(hands), 4))
        for side, sign in ((0, -1.0), (1, 1.0)):
            own = np.flatnonzero(hands[:, side] >= 0)
            hand, axes = hands[own, side], frames[own]
            arms = points[own] - self.middle.position[hand]
            velocity = self.velocity[hand] + np.cross(self.spin[hand], arms)
            found[own, :3] += sign * np.einsum("kij,kj->ki", axes, velocity)
            found[own, 3] += sign * np.einsum("kj,kj->k", axes[:, 0], self.spin[hand])
        return found
