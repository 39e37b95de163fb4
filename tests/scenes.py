"""Random sets, laws and scenes from seeds, as data that a relation can transform.

A scene is not a system but what a system is made of, so that the same physics can be written down
turned, mirrored, in other units or in another order. Everything is of order one and well away from
overflow; what is extreme belongs to the fuzz targets.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace

import asperity as asp
import numpy as np
from asperity.contact.grading import natural_map
from numpy.typing import NDArray

Array = NDArray[np.float64]

TOUCH = 1e-7
"""Overlap in m of what touches: a gap of zero is positive or negative by rounding, and a step
without the contact moves a body by gΔt²."""


def turn(angle: float) -> Array:
    """The rotation of the plane by `angle`."""
    c, s = np.cos(angle), np.sin(angle)
    return np.array([[c, -s], [s, c]])


def log_uniform(rng: np.random.Generator, low: float, high: float) -> float:
    return float(np.exp(rng.uniform(np.log(low), np.log(high))))


# Sets


def smooth_set(rng: np.random.Generator) -> asp.StarSet:
    """A strictly convex set of the plane, also one without symmetry."""
    a, b = rng.uniform(0.2, 0.8, 2)
    angle = rng.uniform(-np.pi, np.pi)
    match rng.integers(6):
        case 0:
            return asp.Disk(a)
        case 1 | 2:
            return asp.Ellipse(a, b, angle=angle)
        case 3:
            return asp.Superellipse(a, b, rng.uniform(1.3, 4.0), angle=angle)
        case 4:
            return asp.sets.Mapped(asp.Disk(a), np.eye(2) + 0.3 * rng.uniform(-1, 1, (2, 2)))
        case _:
            return asp.Ellipse(a, b, angle=angle) + asp.Disk(0.2)


def convex_set(rng: np.random.Generator) -> asp.StarSet:
    """A convex set of the plane, with corners and flats now and then."""
    a, b = rng.uniform(0.2, 0.8, 2)
    angle = rng.uniform(-np.pi, np.pi)
    match rng.integers(8):
        case 0:
            return asp.Rectangle(a, b, angle=angle)
        case 1:
            return asp.CappedRectangle(a, b, cap=rng.uniform(0.1, 0.5), angle=angle)
        case 2:
            corners = (np.arange(6) + 0.3 * rng.uniform(-1, 1, 6)) * np.pi / 3
            return asp.Polygon(a * np.stack([np.cos(corners), np.sin(corners)], -1))
        case 3:
            return asp.Ellipse(a, b, angle=angle) & asp.Disk(0.5 * (a + b))
        case _:
            return smooth_set(rng)


def star_set(rng: np.random.Generator) -> asp.StarSet:
    """A star-shaped set of the plane, convex or not."""
    a, b = rng.uniform(0.2, 0.8, 2)
    match rng.integers(6):
        case 0:
            return asp.Superellipse(a, b, rng.uniform(0.5, 0.95), angle=rng.uniform(-3, 3))
        case 1:
            return asp.Ellipse(a, b) | asp.Ellipse(b, a, angle=rng.uniform(-3, 3))
        case 2:
            phi = np.arange(48) * np.pi / 24
            waves = 1 + 0.3 * np.cos(3 * phi + a) + 0.1 * np.cos(5 * phi)
            return asp.PolarCurve(phi, b * waves)
        case _:
            return convex_set(rng)


# Laws


def plane_law(rng: np.random.Generator, *, convex: bool = False) -> asp.FrictionLaw:
    """A law of the plane whose direction set is strictly convex.

    With `convex` its reservoir is convex too, so that two contacts that share a load hold what one
    holds.
    """
    match rng.integers(5):
        case 0:
            return asp.FrictionLaw.isotropic(rng.uniform(0.1, 0.8))
        case 1:
            return asp.FrictionLaw.associated(smooth_set(rng))
        case 2:
            return asp.FrictionLaw.collinear(convex_set(rng) if convex else star_set(rng))
        case _:
            reservoir = convex_set(rng) if convex else star_set(rng)
            return asp.FrictionLaw(reservoir, smooth_set(rng))


def associated_law(rng: np.random.Generator, dimension: int) -> asp.FrictionLaw:
    """A law of maximal dissipation."""
    if dimension == 1:
        return asp.FrictionLaw.associated(asp.Interval(*(rng.uniform(0.2, 0.8, 2) * [-1, 1])))
    if dimension == 2:
        return asp.FrictionLaw.associated(smooth_set(rng))
    sets = [asp.Ball(0.5), asp.Ellipsoid(rng.uniform(0.2, 0.8, 3))]
    return asp.FrictionLaw.associated(sets[rng.integers(len(sets))])


def mirrored(law: asp.FrictionLaw, mirror: Array) -> asp.FrictionLaw:
    """The law in a frame that is mirrored or turned by the orthogonal matrix `mirror`."""
    reservoir = law.reservoir.mapped(mirror)
    if law.is_associated:
        made = asp.FrictionLaw.associated(reservoir)
    else:
        made = asp.FrictionLaw(reservoir, law.direction.mapped(mirror))
    return made.replace(rate=law.rate)


# Masses in a plane


@dataclass(frozen=True)
class Rub:
    """A point that rubs on a belt in its plane."""

    point: int
    law: asp.FrictionLaw
    load: float
    belt: Array


@dataclass(frozen=True)
class Stop:
    """A wall that a point may run against: the gap along a normal, friction along the tangent."""

    point: int
    law: asp.FrictionLaw
    normal: Array
    tangent: Array
    gap: float
    restitution: float


@dataclass(frozen=True)
class Masses:
    """Point masses in a plane, with springs, on belts, between walls."""

    mass: Array
    stiffness: Array
    """Of all coordinates, point after point."""
    damping: float
    force: Array
    rubs: tuple[Rub, ...]
    stops: tuple[Stop, ...]
    q0: Array
    u0: Array
    dt: float
    steps: int = 40
    tolerance: float = 1e-11

    def system(self) -> asp.LinearSystem:
        """The scene as a `LinearSystem`; contacts in the order of rubs and stops."""
        n = 2 * len(self.mass)

        def rows(point: int, vectors: Array) -> Array:
            direction = np.zeros((n, vectors.shape[1]))
            direction[2 * point : 2 * point + 2] = vectors
            return direction

        contacts = [
            asp.Contact(
                rub.law,
                direction=rows(rub.point, np.eye(2)),
                normal_force=rub.load,
                velocity=-rub.belt,
            )
            for rub in self.rubs
        ] + [
            asp.Contact(
                stop.law,
                direction=rows(stop.point, stop.tangent[:, None]),
                normal=rows(stop.point, stop.normal[:, None])[:, 0],
                gap=stop.gap,
                normal_restitution=stop.restitution,
            )
            for stop in self.stops
        ]
        mass = np.repeat(self.mass, 2)
        return asp.LinearSystem(
            mass,
            stiffness=self.stiffness,
            damping=self.damping * np.diag(mass),
            force=self.force,
            contacts=contacts,
        )

    def run(self, **options: object) -> asp.Trajectory:
        """The motion by time stepping, solved tightly."""
        settings = {
            "dt": self.dt,
            "t_end": self.steps * self.dt,
            "tolerance": self.tolerance,
        } | options
        return asp.simulate(self.system(), q0=self.q0, u0=self.u0, **settings)

    def residual(self, run: asp.Trajectory, k: int, contacts: Array) -> float:
        """What is wrong with the step of a run from its sample `k`, without factors of the speed.

        The natural map of its percussions in a contact problem that is put together here, and how
        far its velocities are from what these percussions make of those before. `contacts` tells
        those that are closed.
        """
        q, u, force, push = run.q[k], run.u[k], run.force[k + 1], run.normal_force[k + 1]
        mass = np.repeat(self.mass, 2)
        forces = self.force - self.stiffness @ (q + 0.5 * self.dt * u) - self.damping * mass * u
        free = u + self.dt * forces / mass
        rows: list[Array] = []
        given: list[Array] = []
        known: list[Array] = []
        loads: list[float | None] = []
        laws: list[asp.FrictionLaw] = []
        for i, contact in enumerate((*self.rubs, *self.stops)):
            if not contacts[i]:
                continue
            at = slice(2 * contact.point, 2 * contact.point + 2)
            every = np.zeros((2, len(u)))
            if isinstance(contact, Rub):
                every[:, at], change = np.eye(2), -contact.belt
                loads.append(contact.load * self.dt)
                known.append(self.dt * force[i])
            else:
                every[:, at] = contact.normal, contact.tangent
                bounce = contact.restitution * min(0.0, float(contact.normal @ u[at]))
                change = np.array([bounce, 0.0])
                loads.append(None)
                known.append(self.dt * np.array([push[i], force[i, 0]]))
            rows.append(every)
            given.append(every @ free + change)
            laws.append(contact.law)
        directions, percussion = np.vstack(rows), np.concatenate(known)
        problem = asp.ContactProblem(
            directions / mass @ directions.T,
            free_velocity=np.concatenate(given),
            laws=laws,
            normal_force=loads,
        )
        reached = free + directions.T @ percussion / mass
        error = float(np.abs(reached - run.u[k + 1]).max()) / float(np.abs(free).max())
        return max(natural_map(problem, percussion), error)

    def moved(self, matrix: Array) -> Masses:
        """The scene turned or mirrored by an orthogonal `matrix`."""
        every = np.kron(np.eye(len(self.mass)), matrix)
        return replace(
            self,
            stiffness=every @ self.stiffness @ every.T,
            force=every @ self.force,
            rubs=tuple(
                replace(rub, law=mirrored(rub.law, matrix), belt=matrix @ rub.belt)
                for rub in self.rubs
            ),
            stops=tuple(
                replace(stop, normal=matrix @ stop.normal, tangent=matrix @ stop.tangent)
                for stop in self.stops
            ),
            q0=every @ self.q0,
            u0=every @ self.u0,
        )

    def in_units(self, kg: float, m: float, s: float) -> Masses:
        """The scene with numbers for a kilogram, metre and second worth this much."""
        force, speed = kg * m / s**2, m / s
        return replace(
            self,
            mass=self.mass * kg,
            stiffness=self.stiffness * (kg / s**2),
            damping=self.damping / s,
            force=self.force * force,
            rubs=tuple(
                replace(
                    rub, law=_timed(rub.law, speed), load=rub.load * force, belt=rub.belt * speed
                )
                for rub in self.rubs
            ),
            stops=tuple(replace(stop, gap=stop.gap * m) for stop in self.stops),
            q0=self.q0 * m,
            u0=self.u0 * speed,
            dt=self.dt * s,
        )


def _timed(law: asp.FrictionLaw, speed: float) -> asp.FrictionLaw:
    """A law with its rate factor in other units."""
    if law.rate is None:
        return law
    rate = law.rate.replace(speed=law.rate.speed * speed, viscous=law.rate.viscous / speed)
    return law.replace(rate=rate)


def masses(
    rng: np.random.Generator,
    *,
    law: Callable[[np.random.Generator], asp.FrictionLaw] = plane_law,
    free: bool = False,
    walls: bool = True,
) -> Masses:
    """Random masses; `free` ones are held by springs among themselves only."""
    n = int(rng.integers(1, 4))
    points = np.arange(n)
    stiffness = np.zeros((2 * n, 2 * n))
    for i in points:
        others = points[:i] if free else np.append(points[:i], -1)
        for j in others:
            if rng.random() < 0.7:
                factor = rng.uniform(-1, 1, (2, 2))
                spring = np.zeros((2, 2 * n))
                spring[:, 2 * i : 2 * i + 2] = factor
                if j >= 0:
                    spring[:, 2 * j : 2 * j + 2] = -factor
                stiffness += 10.0 * spring.T @ spring
    one_law = law(rng)
    rubs = tuple(
        Rub(
            point=int(i),
            law=one_law if rng.random() < 0.5 else law(rng),
            load=rng.uniform(0.5, 3.0),
            belt=rng.uniform(-1, 1, 2) if rng.random() < 0.5 else np.zeros(2),
        )
        for i in points
        if rng.random() < 0.9
    )
    q0 = rng.uniform(-0.5, 0.5, 2 * n)
    stops = []
    for i in points if walls else []:
        if rng.random() < 0.4:
            normal = turn(rng.uniform(-np.pi, np.pi))[0]
            touching = -TOUCH if rng.random() < 0.3 else rng.uniform(0.001, 0.3)
            stops.append(
                Stop(
                    point=int(i),
                    law=associated_law(rng, 1),
                    normal=normal,
                    tangent=turn(np.pi / 2) @ normal,
                    gap=touching - float(normal @ q0[2 * i : 2 * i + 2]),
                    restitution=float(rng.choice([0.0, 0.5])),
                )
            )
    rate = asp.Stribeck(rng.uniform(0.2, 1.0), ratio=rng.uniform(0.3, 1.0))
    if rubs and rng.random() < 0.2:
        rubs = (replace(rubs[0], law=rubs[0].law.replace(rate=rate)), *rubs[1:])
    return Masses(
        mass=rng.uniform(0.5, 3.0, n),
        stiffness=stiffness,
        damping=0.0 if free else float(rng.choice([0.0, 0.3])),
        force=rng.uniform(-2, 2, 2 * n),
        rubs=rubs,
        stops=tuple(stops),
        q0=q0,
        u0=rng.uniform(-1, 1, 2 * n),
        dt=log_uniform(rng, 2e-3, 2e-2),
    )


# Rigid bodies on a plane


@dataclass(frozen=True)
class Bodies:
    """Boxes and balls on one plane that may carry a belt, far enough from each other."""

    parts: tuple[tuple[asp.Body, Array | float, asp.FrictionLaw], ...]
    """Bodies with half sizes of boxes or radii of balls, and the laws of their contacts."""
    plane: asp.Plane
    gravity: Array
    dt: float
    feet: bool = False
    """Whether boxes have a foot more, in the middle of the face on the plane."""
    restitution: float = 0.0
    steps: int = 30
    tolerance: float = 1e-11

    def system(self) -> asp.RigidBodies:
        pairs: list[object] = []
        for i, (_, size, law) in enumerate(self.parts):
            options = {"normal_restitution": self.restitution}
            if np.ndim(size) == 0:
                pairs.append(
                    asp.SpherePlane(i, radius=float(size), plane=self.plane, law=law, **options)
                )
                continue
            pairs.append(asp.BoxPlane(i, half_sizes=size, plane=self.plane, law=law, **options))
            if self.feet:
                foot = [0.0, 0.0, -size[2]]
                pairs.append(asp.PointPlane(i, point=foot, plane=self.plane, law=law, **options))
        return asp.RigidBodies(
            [body for body, _, _ in self.parts], pairs=pairs, gravity=self.gravity
        )

    def run(self, **options: object) -> asp.Trajectory:
        settings = {
            "dt": self.dt,
            "t_end": self.steps * self.dt,
            "tolerance": self.tolerance,
        } | options
        system = self.system()
        # Bodies that touch overlap by `TOUCH`, as states do and bodies that are placed must not.
        return asp.simulate(system, start=asp.State(system.q0, system.u0), **settings)


def bodies(
    rng: np.random.Generator, *, spin: float = 1.0, balls: bool = True, count: int = 3
) -> Bodies:
    """Random bodies that start on the plane or above it, with the plane's normal upwards."""
    parts = []
    for i in range(int(rng.integers(1, count + 1))):
        place = np.array([3.0 * i, rng.uniform(-1, 1), 0.0])
        above = -TOUCH if rng.random() < 0.7 else rng.uniform(0.001, 0.02)
        motion = {
            "velocity": [*rng.uniform(-1, 1, 2), 0.0],
            "angular_velocity": spin * rng.uniform(-1, 1, 3) * ([0, 0, 1] if above < 0 else 1),
        }
        mass = rng.uniform(0.3, 3.0)
        if balls and rng.random() < 0.5:
            size = rng.uniform(0.05, 0.3)
            place[2] = size + above
            law = plane_law(rng, convex=True)
            parts.append((asp.Body.ball(mass, radius=size, position=place, **motion), size, law))
            continue
        half = rng.uniform(0.1, 0.4, 3)
        half[2] = min(half[2], 0.5 * min(half[:2]))
        place[2] = half[2] + above
        inertia = mass / 3 * (np.sum(half**2) - half**2)
        parts.append(
            (
                asp.Body(mass, inertia=inertia, position=place, **motion),
                half,
                plane_law(rng, convex=True),
            )
        )
    belt = rng.uniform(-1, 1, 2) if rng.random() < 0.5 else np.zeros(2)
    return Bodies(
        parts=tuple(parts),
        plane=asp.Plane(velocity=belt),
        gravity=np.array([*rng.uniform(-2, 2, 2), -9.81]),
        dt=log_uniform(rng, 1e-3, 5e-3),
    )


# Contact problems


@dataclass(frozen=True)
class Problem:
    """A contact problem as data: W, M⁻¹ as a diagonal, free velocities, laws."""

    delassus: Array
    free_velocity: Array
    laws: tuple[asp.FrictionLaw, ...]
    loads: tuple[float | None, ...]

    def problem(self) -> asp.ContactProblem:
        return asp.ContactProblem(
            self.delassus,
            free_velocity=self.free_velocity,
            laws=list(self.laws),
            normal_force=list(self.loads),
        )

    def slices(self) -> list[slice]:
        """The rows of each contact."""
        sizes = [
            law.dimension + (load is None) for law, load in zip(self.laws, self.loads, strict=True)
        ]
        ends = np.cumsum(sizes)
        return [slice(end - size, end) for end, size in zip(ends, sizes, strict=True)]


def problem(rng: np.random.Generator, *, prescribed: bool | None = None) -> Problem:
    """A problem of associated laws with `G` of full rank.

    With all normal forces `prescribed` its solution is unique, for friction is monotone there.
    """
    count = int(rng.integers(1, 5))
    laws = tuple(associated_law(rng, int(rng.integers(1, 4))) for _ in range(count))
    given = [rng.random() < 0.5 if prescribed is None else prescribed for _ in laws]
    loads = tuple(rng.uniform(0.3, 3.0) if one else None for one in given)
    rows = sum(law.dimension + (load is None) for law, load in zip(laws, loads, strict=True))
    factor = rng.normal(size=(rows + 4, rows))
    free = 2.0 * rng.normal(size=rows)
    return Problem(factor.T @ factor / (rows + 4), free, laws, loads)
