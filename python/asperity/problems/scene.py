"""Rigid bodies touching at given points, and the contact problem of one time step of them."""

from __future__ import annotations

from collections.abc import Sequence
from functools import cached_property
from typing import Annotated, Any

import numpy as np
from numpy.typing import ArrayLike, NDArray
from scipy.sparse import coo_array, csr_array

from asperity._base import arrays
from asperity._base.arrays import Array
from asperity._base.value import AnyArray, Given, Record, Vector, shaped, unchecked
from asperity.contact import ContactProblem
from asperity.errors import ParameterError
from asperity.law import FrictionLaw

GROUND = -1
"""Number of the body that does not move."""


Laws = FrictionLaw | Sequence[FrictionLaw] | None
"""One law for all contacts, one each, or the default, isotropic with μ = 0.5."""


class Scene(Record):
    """Rigid bodies in space at rest, touching at n points; each body has six degrees of freedom.

    Rows of a contact are (normal, t₁, t₂), those of a body (v, ω) in the axes of the world, ω about
    the centre of mass.

    Args:
        mass: masses in kg, shape ``(bodies,)``.
        inertia: about the centres of mass in the world's axes in kg m², ``(bodies, 3, 3)``.
        center: centres of mass in m, ``(bodies, 3)``.
        lower: body below each contact, ``(n,)``; `GROUND` (−1) does not move.
        upper: body above it, ``(n,)``: the normal points from `lower` to `upper`.
        point: contact points in m, ``(n, 3)``.
        frame: rows normal, t₁, t₂ of each contact, orthonormal, ``(n, 3, 3)``.

    Raises:
        DimensionError, ParameterError: naming the argument.

    >>> from asperity.problems import scenes
    >>> scene = scenes.stack(2)
    >>> scene.directions.shape, scene.mass_matrix.shape
    ((12, 24), (12, 12))
    """

    mass: Vector
    inertia: AnyArray
    center: AnyArray
    lower: Annotated[Given[ArrayLike, NDArray[np.int64]], unchecked]
    upper: Annotated[Given[ArrayLike, NDArray[np.int64]], unchecked]
    point: Annotated[Given[ArrayLike, Array], shaped(None, 3)]
    frame: AnyArray

    def _complete(self, given: dict[str, Any]) -> None:
        if given["mass"].size == 0 or given["mass"].min() <= 0.0:
            raise ParameterError("mass", "must hold positive numbers, one per body")
        bodies, contacts = len(given["mass"]), len(given["point"])
        for name in ("lower", "upper"):
            given[name] = _bodies(given[name], name, bodies, contacts)
        if (given["lower"] == given["upper"]).any():
            raise ParameterError("upper", "must differ from lower: a body cannot touch itself")
        given["inertia"] = _inertia(given["inertia"], bodies)
        given["center"] = arrays.array(given["center"], "center", (bodies, 3))
        given["frame"] = _frames(given["frame"], contacts)

    @cached_property
    def mass_matrix(self) -> csr_array:
        """M, blocks of six rows per body, in kg and kg m²; sparse ``(6 bodies, 6 bodies)``."""
        blocks = np.zeros((len(self.mass), 6, 6))
        blocks[:, :3, :3] = self.mass[:, None, None] * np.eye(3)
        blocks[:, 3:, 3:] = self.inertia
        rows = 6 * np.arange(len(self.mass))[:, None, None] + np.arange(6)[:, None]
        columns = np.swapaxes(rows, 1, 2)
        return _sparse(blocks, rows, columns, (6 * len(self.mass),) * 2)

    @cached_property
    def directions(self) -> csr_array:
        """W, the generalized directions of the percussions; sparse ``(6 bodies, 3 n)``."""
        count = len(self.point)
        values, rows = np.zeros((2, count, 3, 6)), np.zeros((2, count, 3, 6), dtype=np.int64)
        for side, (bodies, sign) in enumerate(((self.upper, 1.0), (self.lower, -1.0))):
            lever = self.point - self.center[bodies]
            moving = sign * (bodies != GROUND)[:, None, None]
            values[side, ..., :3] = moving * self.frame
            values[side, ..., 3:] = moving * np.cross(lever[:, None], self.frame)
            rows[side] = 6 * np.maximum(bodies, 0)[:, None, None] + np.arange(6)
        columns = (3 * np.arange(count)[:, None] + np.arange(3))[:, :, None]
        return _sparse(values, rows, columns, (6 * len(self.mass), 3 * count))

    def free_motion(
        self,
        *,
        force: ArrayLike | None = None,
        velocity: ArrayLike | None = None,
        dt: float = 0.01,
        gravity: float = 9.81,
    ) -> Array:
        """Return u + Δt M⁻¹h, the bodies' velocities without percussions, shape ``(6 bodies,)``.

        Args:
            force: at the centres of mass besides gravity in N, ``(bodies, 3)``; default none.
            velocity: u before the step in m/s and rad/s, ``(bodies, 6)``; default at rest.
            dt: Δt in s.
            gravity: along −z, in m/s².
        """
        motion = np.array(self._velocity(velocity))
        pull = np.zeros(3) if force is None else arrays.array(force, "force", (len(motion), 3))
        dt = arrays.positive(dt, "dt")
        motion[:, :3] += dt * pull / self.mass[:, None]
        motion[:, 2] -= dt * arrays.number(gravity, "gravity")
        return motion.ravel()

    def problem(
        self,
        law: Laws = None,
        *,
        force: ArrayLike | None = None,
        velocity: ArrayLike | None = None,
        dt: float = 0.01,
        gravity: float = 9.81,
        normal_restitution: ArrayLike = 0.0,
    ) -> ContactProblem:
        """Return the contact problem of one step: G = WᵀM⁻¹W, b = Wᵀ(u + Δt M⁻¹h).

        b lies in the range of Wᵀ, as it does in every step of a mechanical system: percussions that
        close all contacts exist although a hyperstatic G is singular.

        Args:
            law: of dimension 2, one for all contacts or one each; default isotropic with μ = 0.5.
            force: at the centres of mass besides gravity in N, ``(bodies, 3)``.
            velocity: u before the step in m/s and rad/s, ``(bodies, 6)``.
            dt: Δt in s.
            gravity: along −z, in m/s².
            normal_restitution: e_N in [0, 1], a number or one per contact.
        """
        laws = plane_laws(law, len(self.point))
        motion = self.free_motion(force=force, velocity=velocity, dt=dt, gravity=gravity)
        return ContactProblem.from_bodies(
            self.mass_matrix,
            directions=self.directions,
            free_velocity=self.directions.T @ motion,
            laws=laws,
            normal_restitution=normal_restitution,
            initial_velocity=self.directions.T @ self._velocity(velocity).ravel(),
        )

    def pushed(self, body: int, *, push: float) -> Array:
        """Return forces that push one body along x with `push` in N, shape ``(bodies, 3)``."""
        force = np.zeros((len(self.mass), 3))
        # The last body is −1, as in a list.
        last = len(self.mass) - 1
        if not -last - 1 <= (number := arrays.count(body, "body", least=-last - 1)) <= last:
            raise ParameterError("body", f"must lie in {-last - 1}..{last}, got {number}")
        force[number, 0] = arrays.number(push, "push")
        return force

    def _velocity(self, velocity: ArrayLike | None) -> Array:
        shape = (len(self.mass), 6)
        return np.zeros(shape) if velocity is None else arrays.array(velocity, "velocity", shape)


def plane_laws(law: Laws, contacts: int) -> FrictionLaw | Sequence[FrictionLaw]:
    """Return laws for contacts that have a plane each."""
    if law is None:
        return FrictionLaw.isotropic(0.5)
    listed = (law,) if isinstance(law, FrictionLaw) else arrays.several(law, "law")
    if not isinstance(law, FrictionLaw) and len(listed) != contacts:
        raise ParameterError("law", f"must be one or one per contact ({contacts})")
    for one in listed:
        if not isinstance(one, FrictionLaw) or one.dimension != 2:
            raise ParameterError("law", f"must be a FrictionLaw of dimension 2, got {one!r}")
    return law


def _bodies(value: ArrayLike, argument: str, bodies: int, contacts: int) -> NDArray[np.int64]:
    numbers = arrays.array(value, argument, (contacts,))
    whole = numbers.astype(np.int64)
    if (whole != numbers).any() or (whole < GROUND).any() or (whole >= bodies).any():
        raise ParameterError(argument, f"must hold body numbers below {bodies}, or {GROUND}")
    return whole


def _inertia(value: ArrayLike, bodies: int) -> Array:
    inertia = arrays.array(value, "inertia", (bodies, 3, 3))
    if not np.allclose(inertia, np.swapaxes(inertia, 1, 2), atol=1e-12 * np.abs(inertia).max()):
        raise ParameterError("inertia", "must be symmetric")
    if np.linalg.eigvalsh(inertia).min() <= 0.0:
        raise ParameterError("inertia", "must be positive definite")
    return 0.5 * (inertia + np.swapaxes(inertia, 1, 2))


def _frames(value: ArrayLike, contacts: int) -> Array:
    frame = arrays.array(value, "frame", (contacts, 3, 3))
    if not np.allclose(frame @ np.swapaxes(frame, 1, 2), np.eye(3), atol=1e-12):
        raise ParameterError("frame", "must hold orthonormal rows: normal, t1, t2")
    return frame


def _sparse(
    values: Array, rows: NDArray[np.int64], columns: NDArray[np.int64], shape: tuple[int, int]
) -> csr_array:
    nonzero = np.nonzero(values)
    places = (np.broadcast_to(index, values.shape)[nonzero] for index in (rows, columns))
    return csr_array(coo_array((values[nonzero], tuple(places)), shape=shape))
