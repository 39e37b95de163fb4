"""Systems of rigid bodies, and what a trajectory of theirs holds."""

from __future__ import annotations

from collections import Counter
from collections.abc import Sequence
from typing import TYPE_CHECKING, Any, Literal, NamedTuple, Self, TypeVar

import numpy as np
from numpy.typing import ArrayLike

import asperity._core as _core
from asperity._base import arrays
from asperity._base.arrays import Array
from asperity._base.value import Value
from asperity.errors import DimensionError, ParameterError
from asperity.law import FrictionLaw
from asperity.system import labels, time_functions
from asperity.system.contacts import relawed
from asperity.system.labels import Labels
from asperity.system.reactions import row_forces, states
from asperity.system.rigid import rotation
from asperity.system.rigid.bodies import Body, PlanarBody
from asperity.system.rigid.joints import Joint
from asperity.system.rigid.pairs import Pair, PlanePair, SphereSphere
from asperity.system.rigid.springs import Spring
from asperity.system.rigid.surfaces import Line

if TYPE_CHECKING:
    from asperity.runs.run import Run


_Part = TypeVar("_Part", Pair, Spring, Joint)


# Coordinates and velocities of a body, with their units.
_SPATIAL = {
    "q": {"x": "m", "y": "m", "z": "m", "qw": "-", "qx": "-", "qy": "-", "qz": "-"},
    "u": {
        **{"vx": "m/s", "vy": "m/s", "vz": "m/s"},
        **{"omega1": "rad/s", "omega2": "rad/s", "omega3": "rad/s"},
    },
}
_PLANAR = {
    "q": {"x": "m", "y": "m", "phi": "rad"},
    "u": {"vx": "m/s", "vy": "m/s", "omega": "rad/s"},
}


class ContactLabel(NamedTuple):
    """Where a contact comes from.

    Attributes:
        pair: number of the pair.
        corner: number of the corner of a box; 0 for pairs with one contact.
    """

    pair: int
    corner: int


class RigidBodies(Value):
    """Rigid bodies in space or in a plane, with contacts, joints, springs and gravity.

    In space a body has 7 coordinates, position and unit quaternion (w, x, y, z), and 6 velocities,
    v of the centre of mass in the world's axes and the angular velocity Ω in the body's. In a plane
    it has the coordinates (x, y, φ) and their rates.

    Args:
        bodies: all `Body` or all `PlanarBody`; `simulate` starts from their states.
        pairs: which parts of bodies may touch what.
        springs: springs and dampers.
        joints: `Hinge`, `Slider` and `Weld`, placed as the bodies are given; they may repeat each
            other. `simulate` holds them to 1e-9 m and rad; `integrate` refuses them.
        gravity: in m/s², shape ``(3,)``, planar ``(2,)``. Default 9.81 downwards, against the last
            axis.

    Raises:
        DimensionError, ParameterError: naming the argument.

    Reference: [WL19] (16), (19).

    >>> from asperity import Body, FrictionLaw, Plane, RigidBodies, SpherePlane, simulate
    >>> ball = Body.ball(1.0, radius=0.1, position=(0.0, 0.0, 0.1), velocity=(0.7, 0.0, 0.0))
    >>> table = SpherePlane(0, radius=0.1, plane=Plane(), law=FrictionLaw.isotropic(0.3))
    >>> motion = simulate(RigidBodies([ball], pairs=[table]), dt=1e-3, t_end=1.0)
    >>> float(motion.u[-1, 0].round(9))  # rolls with 5/7 of its velocity
    0.5
    """

    bodies: tuple[Body, ...] | tuple[PlanarBody, ...]
    pairs: tuple[Pair, ...]
    springs: tuple[Spring, ...]
    joints: tuple[Joint, ...]
    gravity: Array
    contacts: tuple[ContactLabel, ...]
    """Where each contact comes from, in the order of a trajectory's contacts."""
    labels: Labels
    """Names and units of coordinates, velocities and contacts."""
    _core: _core.RigidBodies

    def __init__(
        self,
        bodies: Sequence[Body] | Sequence[PlanarBody],
        *,
        pairs: Sequence[Pair] = (),
        springs: Sequence[Spring] = (),
        joints: Sequence[Joint] = (),
        gravity: ArrayLike | None = None,
    ) -> None:
        listed = _bodies(bodies)
        planar = isinstance(listed[0], PlanarBody)
        down = [0.0, -9.81] if planar else [0.0, 0.0, -9.81]
        self._set(
            bodies=listed,
            pairs=_parts(pairs, "pairs", Pair, listed),
            springs=_parts(springs, "springs", Spring, listed),
            joints=_parts(joints, "joints", Joint, listed),
            gravity=arrays.array(down if gravity is None else gravity, "gravity", (len(down),)),
        )
        core = _core.RigidBodies(
            planar,
            np.array([body.mass for body in listed]),
            np.array([np.ravel(body.inertia) for body in listed]),
            np.array([_constant_load(body, planar) for body in listed]),
            [
                (number, time_functions.core(body.force), time_functions.core(body.torque))
                for number, body in enumerate(listed)
                if _is_timed(body)
            ],
            [pair._core_data() for pair in self.pairs],
            [spring._core_data() for spring in self.springs],
            [joint._core_data() for joint in self.joints],
            self.gravity,
            self.q0,
        )
        contacts = tuple(
            ContactLabel(number, corner)
            for number, pair in enumerate(self.pairs)
            for corner in range(pair.contacts)
        )
        self._keep(_core=core, contacts=contacts, labels=self._labels())

    @property
    def body_names(self) -> tuple[str, ...]:
        """Names of the bodies; those without one are called by their numbers."""
        bodies: tuple[Body | PlanarBody, ...] = self.bodies
        return tuple(
            f"body {number}" if body.name is None else body.name
            for number, body in enumerate(bodies)
        )

    def _labels(self) -> Labels:
        names = self.body_names
        labels.unique(names, "bodies")
        q, u = (_PLANAR if self.planar else _SPATIAL).values()
        contacts = [
            f"{pair} corner {corner}" if one.contacts > 1 else pair
            for one, pair in zip(self.pairs, self._pair_names(), strict=True)
            for corner in range(one.contacts)
        ]
        labels.unique(contacts, "pairs")
        return Labels(
            [f"{name} {part}" for name in names for part in q],
            [*q.values()] * len(names),
            [f"{name} {part}" for name in names for part in u],
            [*u.values()] * len(names),
            contacts,
        )

    def _pair_names(self) -> list[str]:
        """Return the pairs' names; those without one say what touches what, with a number."""
        given = [pair.name for pair in self.pairs if pair.name is not None]
        labels.unique(given, "pairs")
        bodies = self.body_names
        own = [_touching(pair, bodies) if pair.name is None else pair.name for pair in self.pairs]
        alike = Counter(own)
        used: Counter[str] = Counter()
        names = []
        for pair, name in zip(self.pairs, own, strict=True):
            if pair.name is None and alike[name] > 1:
                used[name] += 1
                name = f"{name} {used[name] - 1}"
            names.append(name)
        return names

    def with_law(
        self, law: FrictionLaw, *, pairs: int | str | Sequence[int | str] | None = None
    ) -> Self:
        """Return the same system with another friction law at pairs.

        Args:
            law: of the dimension of the pairs' laws.
            pairs: numbers or names of the pairs; default all.

        >>> from asperity import Body, BoxPlane, FrictionLaw, Plane, RigidBodies
        >>> half = (0.1, 0.1, 0.1)
        >>> table = BoxPlane(0, half_sizes=half, plane=Plane(), law=FrictionLaw.isotropic(0.3))
        >>> system = RigidBodies([Body.box(1.0, half_sizes=half)], pairs=[table])
        >>> system.with_law(FrictionLaw.isotropic(0.1)).pairs[0].law
        FrictionLaw(Disk(0.1), Disk(0.1))
        """
        return self.replace(pairs=relawed(self.pairs, law, pairs, "pairs"))

    @property
    def planar(self) -> bool:
        """Whether the bodies are planar."""
        return len(self.gravity) == 2

    @property
    def dof(self) -> int:
        """Number of velocities: 6, planar 3, per body."""
        return len(self.bodies) * (3 if self.planar else 6)

    @property
    def coordinates(self) -> int:
        """Number of coordinates: 7, planar 3, per body."""
        return len(self.bodies) * (3 if self.planar else 7)

    @property
    def depends_on_time(self) -> bool:
        """Whether loads, lengths of springs or surfaces depend on time."""
        return self._core.depends_on_time

    @property
    def q0(self) -> Array:
        """Initial coordinates, shape ``(coordinates,)``."""
        return np.concatenate([body.coordinates for body in self.bodies])

    @property
    def u0(self) -> Array:
        """Initial velocities, shape ``(dof,)``."""
        return np.concatenate([body.velocities for body in self.bodies])

    def positions(self, trajectory: Run) -> Array:
        """Return the centres of mass in m, shape ``(n_t, n_body, 3)``, planar ``(n_t, n_body, 2)``.

        Args:
            trajectory: of this system.
        """
        return self._states(trajectory)[0][..., : self._space].copy()

    def rotations(self, trajectory: Run) -> Array:
        """Return the matrices that turn the bodies' axes into the world's.

        Args:
            trajectory: of this system.

        Returns:
            Shape ``(n_t, n_body, 3, 3)``, planar ``(n_t, n_body, 2, 2)``.
        """
        return self._rotations(self._states(trajectory)[0])

    def angular_velocities(self, trajectory: Run) -> Array:
        """Return ω in rad/s in the world's axes, shape ``(n_t, n_body, 3)``; planar the numbers.

        Args:
            trajectory: of this system.
        """
        q, u = self._states(trajectory)
        if self.planar:
            return u[..., 2].copy()
        return _turned(self._rotations(q), u[..., 3:])

    def energy(self, trajectory: Run) -> Array:
        """Return the kinetic energy plus that of the loads in J, shape ``(n_t,)``.

        Loads with a potential are the weight and constant forces, zero for centres of mass at the
        origin, and springs with the lengths of the time; torques, and forces that depend on time,
        have none.

        Args:
            trajectory: of this system.

        >>> from asperity import Body, RigidBodies, simulate
        >>> flight = RigidBodies([Body.ball(2.0, radius=0.1, velocity=(0.0, 3.0, 4.0))])
        >>> flight.energy(simulate(flight, dt=0.1, t_end=1.0)).round(9)[[0, -1]].tolist()
        [25.0, 25.0]
        """
        self._states(trajectory)
        return self._core.energy(trajectory.t, trajectory.q, trajectory.u)

    def momentum(self, trajectory: Run) -> Array:
        """Return Σ m v in N s, shape ``(n_t, 3)``, planar ``(n_t, 2)``.

        Args:
            trajectory: of this system.
        """
        self._states(trajectory)
        return self._core.momentum(trajectory.u)[:, : self._space]

    def angular_momentum(self, trajectory: Run, *, about: ArrayLike | None = None) -> Array:
        """Return Σ (x − o) × m v + J ω in N m s, shape ``(n_t, 3)``, planar ``(n_t,)``.

        Args:
            trajectory: of this system.
            about: the point o, at rest, in m. Default the origin.
        """
        self._states(trajectory)
        point = np.zeros(3)
        if about is not None:
            point[: self._space] = arrays.array(about, "about", (self._space,))
        momentum = self._core.angular_momentum(trajectory.q, trajectory.u, point)
        return momentum[:, 2] if self.planar else momentum

    def contact_points(self, trajectory: Run) -> Array:
        """Return where the contacts are in m, shape ``(n_t, n_contact, 3)``, planar ``(…, 2)``.

        An open contact with a plane is at the nearest point of the body, one between spheres
        halfway between them.

        Args:
            trajectory: of this system.
        """
        self._states(trajectory)
        return self._core.contact_geometry(trajectory.t, trajectory.q)[0][..., : self._space]

    def contact_forces(
        self,
        trajectory: Run,
        *,
        frame: Literal["surface", "world", "body"] = "surface",
    ) -> Array:
        """Return the forces of the contacts on their (first) bodies in N.

        World and body axes are those of the midpoint of the step, where the force acted; of a
        motion those of the sample. The torque
        about the normal in a contact with drilling is not among these forces: it is `patch_radius`
        times the third component of ``trajectory.force``.

        Args:
            trajectory: of this system.
            frame: ``"surface"``: along e₁, e₂, n; ``"world"``; ``"body"``: the first body's axes.

        Returns:
            Shape ``(n_t, n_contact, 3)``; planar ``(n_t, n_contact, 2)``, along e₁, n. NaN for the
            initial state.

        >>> from asperity import Body, BoxPlane, FrictionLaw, Plane, RigidBodies, simulate
        >>> half = (0.1, 0.1, 0.1)
        >>> block = Body.box(2.0, half_sizes=half, position=(0.0, 0.0, 0.1))
        >>> table = BoxPlane(0, half_sizes=half, plane=Plane(), law=FrictionLaw.isotropic(0.3))
        >>> system = RigidBodies([block], pairs=[table])
        >>> motion = simulate(system, dt=1e-3, t_end=1e-2)
        >>> system.contact_forces(motion, frame="world")[-1].sum(axis=0).round(6)[2].item()
        19.62
        """
        arrays.choice(frame, "frame", ["surface", "world", "body"])
        self._states(trajectory)
        tangential = trajectory.force[..., : self._space - 1]
        forces = np.concatenate([tangential, trajectory.normal_force[..., None]], axis=-1)
        if frame == "surface":
            return forces
        # Of a motion, which has no steps of its own, forces are those of the sample.
        half = 0.5 * getattr(trajectory, "dt", 0.0)
        middle = self._core.advance(trajectory.q, trajectory.u, -half)
        times = trajectory.t - half
        axes = self._core.contact_geometry(times, middle)[1][..., self._rows, : self._space]
        forces = _turned(np.swapaxes(axes, -1, -2), forces)
        if frame == "world":
            return forces
        touching = [self.pairs[label.pair].body for label in self.contacts]
        attitude = self._rotations(self._per_body(middle))[:, touching]
        return _turned(np.swapaxes(attitude, -1, -2), forces)

    def joint_reactions(self, trajectory: Run) -> tuple[Array, Array]:
        """Return the forces in N and torques in N m of the joints on their (first) bodies.

        They act at the anchors, of welds at the body's centre of mass, in the world's axes. They
        are those in the middle of the step that ends at a sample, and follow from its state and the
        forces of its contacts with an error of the order of Δt²; in a step with an impact, whose
        forces are percussions over Δt, it does not vanish with Δt. Of directions in which joints
        repeat each other only one transmits anything here.

        Args:
            trajectory: of this system.

        Returns:
            Shape ``(n_t, n_joint, 3)`` each; planar ``(n_t, n_joint, 2)`` and ``(n_t, n_joint)``.
            NaN for the initial state if there are contacts.

        >>> from asperity import Body, RigidBodies, Weld, simulate
        >>> bracket = Body.box(2.0, half_sizes=(0.3, 0.1, 0.1), position=(0.3, 0.0, 0.0))
        >>> system = RigidBodies([bracket], joints=[Weld(0)])
        >>> forces, torques = system.joint_reactions(simulate(system, dt=1e-3, t_end=0.01))
        >>> (forces[-1].round(9) + 0.0).tolist()
        [[0.0, 0.0, 19.62]]
        """
        self._states(trajectory)
        given = row_forces(trajectory, [self.pairs[label.pair] for label in self.contacts])
        times, dt = trajectory.t, getattr(trajectory, "dt", 0.0)
        both = self._core.joint_reactions(times, dt, trajectory.q, trajectory.u, given)
        forces, torques = both[:, :, 0, : self._space], both[:, :, 1]
        return forces, torques[..., 2] if self.planar else torques

    @property
    def _space(self) -> int:
        return len(self.gravity)

    @property
    def _rows(self) -> list[int]:
        """Which of e₁, e₂, n there are."""
        return [0, 2] if self.planar else [0, 1, 2]

    def _per_body(self, values: Array) -> Array:
        return values.reshape(len(values), len(self.bodies), -1)

    def _states(self, trajectory: Run) -> tuple[Array, Array]:
        """Return coordinates and velocities per body of a trajectory that may be this system's."""
        q, u = states(trajectory, (self.coordinates, self.dof, len(self.contacts)))
        return self._per_body(q), self._per_body(u)

    def _rotations(self, q: Array) -> Array:
        if self.planar:
            return rotation.planar_matrices(q[..., 2])
        return rotation.matrices(q[..., 3:])


def _touching(pair: Pair, names: Sequence[str]) -> str:
    """Return what touches what, given the names of the bodies."""
    body = names[pair.body]
    if isinstance(pair, SphereSphere):
        return f"{body} on {names[pair.other]}"
    assert isinstance(pair, PlanePair)
    if pair.plane.body is not None:
        return f"{body} on {names[pair.plane.body]}"
    return f"{body} on {'line' if isinstance(pair.plane, Line) else 'plane'}"


def _is_timed(body: Body | PlanarBody) -> bool:
    return callable(body.force) or callable(body.torque)


def _constant_load(body: Any, planar: bool) -> Array:
    """Return force and torque, zeros if one of them depends on time."""
    if _is_timed(body):
        return np.zeros(3 if planar else 6)
    return np.append(np.ravel(body.force), np.ravel(body.torque))


def _turned(matrices: Array, vectors: Array) -> Array:
    return np.einsum("...ij,...j->...i", matrices, vectors)


def _bodies(bodies: Sequence[Any]) -> tuple[Any, ...]:
    listed = arrays.several(bodies, "bodies")
    if not listed:
        raise DimensionError("bodies", "must not be empty")
    kind = PlanarBody if isinstance(listed[0], PlanarBody) else Body
    for body in listed:
        if not isinstance(body, kind):
            raise ParameterError("bodies", f"must all be Body or all PlanarBody, got {body!r}")
    return listed


def _parts(
    parts: Sequence[_Part], argument: str, kind: type[_Part], bodies: Sequence[Body | PlanarBody]
) -> tuple[_Part, ...]:
    """Return pairs, springs or joints that fit the bodies."""
    listed, planar = arrays.several(parts, argument), isinstance(bodies[0], PlanarBody)
    for number, part in enumerate(listed):
        if not isinstance(part, kind):
            raise ParameterError(argument, f"must hold {kind.__name__} objects, got {part!r}")
        if part.planar not in (planar, None):
            where = ("space", "a plane")
            raise DimensionError(
                argument,
                f"number {number} is for {where[part.planar]}, the bodies are in {where[planar]}",
            )
        plane = getattr(part, "plane", None)
        named = {"body": part.body, "other": getattr(part, "other", None)}
        for name, body in {**named, "plane.body": plane and plane.body}.items():
            if body is not None and body >= len(bodies):
                raise ParameterError(
                    f"{argument}[{number}].{name}",
                    f"must be below {len(bodies)}, the number of bodies, got {body}",
                )
    return listed
