"""Bodies on more feet than carry them for certain: what both integrators let each of them carry.

A foot whose share of the load would pull is closed and carries nothing until its share presses
again, so that a motion depends on its state alone: neither on the order of the feet nor on what
they did before.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from itertools import pairwise

import asperity as asp
import numpy as np
import pytest
from asperity import EventKind
from numpy.typing import NDArray
from profiles import every
from scipy.integrate import solve_ivp
from scipy.linalg import null_space
from scipy.optimize import linprog, nnls

Array = NDArray[np.float64]

GRAVITY, HALF = 9.81, 0.1
TIMES = np.linspace(0.0, 1.0, 4)


@dataclass(frozen=True)
class Box:
    """A low box on feet that a load moves about, which turns it and leans on some of them."""

    mass: float
    height: float
    places: Array
    law: asp.FrictionLaw
    force: Array
    torque: Array
    u0: Array

    @classmethod
    def random(cls, rng: np.random.Generator, *, at_rest: bool, height: float = 0.05) -> Box:
        """On three to six feet, three of which never carry all that the load asks of them."""
        count = int(rng.integers(3, 7))
        mass = 10.0 ** rng.uniform(-1.0, 1.0)
        weight = mass * GRAVITY
        angles = (np.arange(count) + rng.uniform(-0.3, 0.3, count)) * 2.0 * np.pi / count
        radii = HALF * rng.uniform(0.6, 1.2, count)
        places = radii[:, None] * np.column_stack([np.cos(angles), np.sin(angles)])
        reservoir = asp.Ellipse(*rng.uniform(0.15, 0.5, 2), angle=rng.uniform(0.0, 3.0))
        direction = reservoir if rng.integers(2) else asp.Disk(1.0)
        pull = weight * rng.uniform(0.2, 1.2) * np.linspace(0.0 if at_rest else 0.3, 1.0, 4)
        phi = rng.uniform(0.0, 2.0 * np.pi)
        lever = (0.01 if at_rest else 0.05) * rng.uniform(-1.0, 1.0, (4, 2))
        speed = np.array([*rng.normal(size=2), 0.0, 0.0, 0.0, 8.0 * rng.normal()])
        return cls(
            mass,
            rng.uniform(0.1, 1.0) * height,
            places,
            asp.FrictionLaw(reservoir, direction=direction),
            np.column_stack([pull * np.cos(phi), pull * np.sin(phi), 0.0 * pull]),
            weight * np.column_stack([lever, 0.03 * rng.normal(size=4)]),
            0.0 * speed if at_rest else speed,
        )

    def system(self, order: Array | None = None) -> asp.RigidBodies:
        """The box on a floor, with its feet in another order."""
        force, torque = (
            asp.Signal(TIMES, load, interpolation="linear") for load in (self.force, self.torque)
        )
        body = asp.Body.box(
            self.mass,
            half_sizes=[HALF, HALF, self.height],
            position=[0.0, 0.0, self.height],
            force=force,
            torque=torque,
        )
        feet = [
            asp.PointPlane(0, plane=asp.Plane(), point=[*place, -self.height], law=self.law)
            for place in (self.places if order is None else self.places[order])
        ]
        return asp.RigidBodies([body], pairs=feet, gravity=(0.0, 0.0, -GRAVITY))


def compare(one: Array, two: Array, tolerance: float) -> None:
    size = np.abs(one).max()
    assert np.abs(one - two).max() <= tolerance * max(size, 1e-6)


def random_box(seed: int, *, at_rest: bool) -> tuple[Box, np.random.Generator]:
    rng = np.random.default_rng([seed, at_rest])
    return Box.random(rng, at_rest=at_rest), rng


SEEDS = every(15, range(60))


@pytest.mark.parametrize("at_rest", [False, True])
@pytest.mark.parametrize("seed", SEEDS)
def test_the_order_of_feet_leaves_the_motion(seed, at_rest):
    box, rng = random_box(seed, at_rest=at_rest)
    order = rng.permutation(len(box.places))
    one, two = (
        asp.integrate(system, t_end=1.0, u0=box.u0, sample_every=0.1)
        for system in (box.system(), box.system(order))
    )
    compare(one.u, two.u, 1e-7)
    compare(one.normal_force[:, order], two.normal_force, 1e-6)


@pytest.mark.parametrize("at_rest", [False, True])
@pytest.mark.parametrize("seed", SEEDS)
def test_a_motion_goes_on_from_any_sample_as_if_unbroken(seed, at_rest):
    box, rng = random_box(seed, at_rest=at_rest)
    system = box.system()
    whole = asp.integrate(system, t_end=1.0, u0=box.u0, sample_every=0.05)
    at = float(whole.t[rng.integers(1, len(whole.t) - 1)])
    first = asp.integrate(system, t_end=at, u0=box.u0)
    second = asp.integrate(system, t_end=1.0, start=first)
    compare(whole.u[-1], second.u[-1], 1e-7)
    compare(whole.q[-1], second.q[-1], 1e-7)


def shares(rows: Array, wrench: Array) -> Array:
    """The smallest normal forces that do not pull and have a wrench, min ‖λ‖ with W λ = w, λ ≥ 0.

    Least distance programming by nonnegative least squares, Lawson and Hanson 1974, chapter 23.
    """
    least = np.linalg.pinv(rows) @ wrench
    free = null_space(rows, rcond=1e-10)
    if least.min() >= 0.0 or free.shape[1] == 0:
        return least
    bordered = np.vstack([free.T, -least / np.abs(least).max()])
    target = np.append(np.zeros(free.shape[1]), 1.0)
    rest = bordered @ nnls(bordered, target)[0] - target
    return least - np.abs(least).max() * (free @ rest[:-1]) / rest[-1]


@pytest.mark.parametrize("seed", every(4, range(20)))
def test_feet_carry_the_least_that_holds_a_box_which_slides_and_turns_in_steps(seed):
    """Whatever load the normal forces of a step have, no others with it are smaller."""
    box = Box.random(np.random.default_rng([seed, 3]), at_rest=False, height=0.02)
    run = asp.simulate(box.system(), dt=1e-3, t_end=0.2, u0=box.u0)
    rows = np.vstack([np.ones(len(box.places)), box.places.T])
    turns = np.flatnonzero(np.abs(run.u[:, 5]) > 0.1)[1:]
    assert len(turns) > 20
    for force in run.normal_force[turns]:
        assert np.abs(shares(rows, rows @ force) - force).max() <= 1e-7 * force.sum()


def slipping_feet(box: Box, angle: float, velocity: Array) -> tuple[Array, Array]:
    """Places of the feet beside the centre, and the directions of their friction."""
    cosine, sine = np.cos(angle), np.sin(angle)
    arms = box.places @ np.array([[cosine, sine], [-sine, cosine]])
    vx, vy, omega = velocity
    slip = np.column_stack([vx - omega * arms[:, 1], vy + omega * arms[:, 0]])
    return arms, -slip / np.linalg.norm(slip, axis=1)[:, None]


def at(signal: Array, t: float) -> Array:
    return np.array([np.interp(t, TIMES, column) for column in signal.T])


def least_load(box: Box, mu: float, t: float, angle: float, velocity: Array) -> float:
    """What the foot that carries least carries at most: below zero the box must tip."""
    arms, direction = slipping_feet(box, angle, velocity)
    torque, count = at(box.torque, t), len(arms)
    # The load acts in the centre of mass, friction a height below it.
    rows = np.vstack([np.ones(count), arms.T + box.height * mu * direction.T])
    wrench = [box.mass * GRAVITY, torque[1], -torque[0]]
    found = linprog(
        np.append(np.zeros(count), -1.0),
        A_eq=np.column_stack([rows, np.zeros(3)]),
        b_eq=wrench,
        A_ub=np.column_stack([-np.eye(count), np.ones(count)]),
        b_ub=np.zeros(count),
        bounds=(None, None),
    )
    assert found.success
    return float(found.x[-1])


@pytest.mark.parametrize("seed", every(20, range(60)))
def test_feet_that_are_set_aside_and_come_back_follow_the_equations_of_motion(seed):
    """While feet slip, against DOP853 with the shares of equal compliance in every evaluation.

    A box that tips within two samples could not stand: whatever its feet carry, one would have to
    pull, or be about to.
    """
    rng = np.random.default_rng([seed, 2])
    box = Box.random(rng, at_rest=False, height=0.02)
    mu = rng.uniform(0.1, 0.3)
    box = replace(box, law=asp.FrictionLaw.isotropic(mu))
    run = asp.integrate(box.system(), t_end=1.0, u0=box.u0, sample_every=0.02)
    ends = [event.time for event in run.events if event.kind is EventKind.STICK]
    tips = run.t[np.abs(run.u[:, 2:5]).max(axis=1) > 1e-9]
    last = np.flatnonzero(run.t < min([1.0, *ends, *tips]))[-1] - 2
    weight, inertia = box.mass * GRAVITY, box.mass * (2.0 * HALF**2) / 3.0
    if last < 1:
        assert all(tips[0] <= end for end in ends)
        opens = [event.time for event in run.events if event.kind is EventKind.OPEN]
        start = min([time for time in opens if time < tips[0]], default=0.0)
        until = asp.integrate(box.system(), t_end=max(start, 1e-9), u0=box.u0)
        # The angle of the box is that of a turn about the vertical.
        angle = 2.0 * np.arctan2(until.q[-1, 6], until.q[-1, 3])
        assert least_load(box, mu, start, angle, until.u[-1, [0, 1, 5]]) <= 1e-6 * weight
        return

    def rates(t: float, state: Array) -> Array:
        angle, vx, vy, omega = state[2:]
        arms, direction = slipping_feet(box, angle, state[3:])
        unit = mu * direction
        rows = np.vstack([np.ones(len(arms)), arms.T])
        force, torque = at(box.force, t), at(box.torque, t)
        # The force of gravity and the load act in the centre of mass, friction a height below it.
        carried = np.full(len(arms), weight / len(arms))
        for _ in range(60):
            friction = (carried[:, None] * unit).sum(axis=0)
            moments = np.array([torque[1], -torque[0]]) - box.height * friction
            before, carried = carried, shares(rows, np.array([weight, *moments]))
            if np.abs(carried - before).max() <= 1e-14 * weight:
                break
        forces = carried[:, None] * unit
        moment = (arms[:, 0] * forces[:, 1] - arms[:, 1] * forces[:, 0]).sum()
        linear = (force[:2] + forces.sum(axis=0)) / box.mass
        return np.array([vx, vy, omega, *linear, (torque[2] + moment) / inertia])

    state = np.array([0.0, 0.0, 0.0, *box.u0[[0, 1, 5]]])
    pieces = [0.0, *TIMES[(TIMES > 0.0) & (run.t[last] > TIMES)], run.t[last]]
    for start, end in pairwise(pieces):
        path = solve_ivp(rates, (start, end), state, method="DOP853", rtol=1e-11, atol=1e-13)
        state = path.y[:, -1]
    actual = np.array([*run.q[last, :2], *run.u[last, [0, 1, 5]]])
    assert np.abs(actual - state[[0, 1, 3, 4, 5]]).max() <= 1e-7 * np.abs(run.u).max()


@pytest.mark.parametrize("seed", range(20))
def test_forces_of_pads_that_stick_together_lie_in_their_reservoirs_until_slip_begins(seed):
    """A spring pulls a body off a belt that pads hold, each up to its own limit."""
    rng = np.random.default_rng(seed)
    pads, dimension = int(rng.integers(2, 5)), int(rng.integers(1, 3))
    radii, loads = 10 ** rng.uniform(-0.5, 0.5, pads), 10 ** rng.uniform(-0.3, 0.3, pads)
    stiffness, belt = 10 ** rng.uniform(0, 2), np.array([1.0, 0.7])
    disks = [asp.Disk(r) if dimension == 2 else asp.Interval(-r, r) for r in radii]
    pad = [
        asp.Contact(
            asp.FrictionLaw(disk, disk),
            direction=np.eye(2)[:, :dimension],
            velocity=-belt[:dimension],
            normal_force=load,
        )
        for disk, load in zip(disks, loads, strict=True)
    ]
    system = asp.LinearSystem(np.eye(2), stiffness=stiffness * np.eye(2), contacts=pad)
    run = asp.integrate(
        system,
        t_end=2.0 * radii @ loads / stiffness + 1.0,
        u0=belt,
        tolerance=[1e-6, 1e-9][seed % 2],
    )
    kinds = [event.kind for event in run.events]
    assert EventKind.SLIP in kinds
    limits = radii * loads
    assert (np.linalg.norm(run.force, axis=-1) <= limits * (1.0 + 1e-7)).all()
    first = next(event.time for event in run.events if event.kind is EventKind.SLIP)
    sticks = run.t < first
    held = run.force.sum(axis=1)[sticks] - stiffness * run.q[sticks, :dimension]
    assert np.abs(held).max() <= 1e-6 * limits.sum()
