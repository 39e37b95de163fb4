"""Islands: walls side by side, piles that step, what is at rest, bodies that `integrate` follows.

Every ratio is one of processor times in one run, but for the one of two threads, which is one of
times on the clock and asks for an idle machine.

Run: python benches/python_islands.py
"""

import time
from collections.abc import Callable
from typing import Any

import asperity as asp
import numpy as np
from asperity import problems
from numpy.typing import NDArray
from report import ratio
from scipy.sparse import block_diag

Floats = NDArray[np.float64]
WALLS = 50
RADIUS, HEIGHT = 0.1, 10
STEPS = 40


def timed(work: Callable[[], Any], clock: Callable[[], float], repeats: int = 3) -> float:
    """Return the shortest time in s."""
    times = []
    for _ in range(repeats):
        start = clock()
        work()
        times.append(clock() - start)
    return min(times)


def side_by_side(parts: list[asp.ContactProblem]) -> asp.ContactProblem:
    """Return one problem of several that have bodies."""
    return asp.ContactProblem.from_bodies(
        block_diag([part.mass for part in parts], format="csr"),
        directions=block_diag([part.directions for part in parts], format="csr"),
        free_velocity=np.concatenate([part.free_velocity for part in parts]),
        laws=[law for part in parts for law in part.laws],
    )


def compared(
    parts: list[asp.ContactProblem], yard: asp.ContactProblem, measure: Any
) -> list[float]:
    """Return the time of all islands over that of single ones, on one thread and on two.

    Single ones are solved one after the other, as a user would: whoever solves the same small one
    again and again finds all of it in the processor's cache.
    """
    one, two = asp.Auto(), asp.Auto(threads=2)

    def one_by_one() -> None:
        for part in parts:
            part.solve(one, measure=measure)

    def together(solver: asp.Auto) -> Callable[[], Any]:
        return lambda: yard.solve(solver, measure=measure)

    return [
        timed(together(solver), clock) / timed(one_by_one, clock)
        for solver, clock in ((one, time.process_time), (two, time.perf_counter))
    ]


def walls() -> None:
    """Compare walls side by side with the sum of single ones."""
    random = np.random.default_rng(0)
    parts = [problems.wall(6, columns=5, push=1.0 + 0.1 * random.random()) for _ in range(WALLS)]
    yard = side_by_side(parts)
    print(
        f"{WALLS} walls of {len(parts[0].laws)} contacts, their time over the sum of single ones:"
    )
    for measure in ("contact", "global"):
        one, two = compared(parts, yard, measure)
        print(f"  measure {measure:8} {one:5.2f}, on two threads {two:5.2f}")
        if measure == "contact":
            case, beside = f"{WALLS} walls solved as one problem", "the sum of single walls"
            ratio(case, one, beside, "what islands that know nothing of each other cost together")
            ratio(f"{case}, on two threads", two, beside, "what a second core saves")
    solution = yard.solve()
    kept = timed(lambda: yard.solve(start=solution), time.process_time, repeats=20)
    solved = timed(yard.solve, time.process_time, repeats=20)
    ratio(
        f"{WALLS} walls whose solution is given as the start",
        kept / solved,
        "the same solved anew",
        "what it costs to find that nothing is to be done",
    )
    print(f"  solved already over solved anew: {kept / solved:5.2f}")


def piles(number: int, moving: bool) -> asp.RigidBodies:
    """Return columns of balls, far from each other; the uppermost ones may move."""
    law = asp.FrictionLaw.isotropic(0.4)
    bodies, pairs = [], []
    for k in range(number):
        for j in range(HEIGHT):
            height = RADIUS * (1.0 + 2.0 * j * (1.0 - 1e-9))
            spot = (0.5 * (k % 100), 0.5 * (k // 100), height)
            push = (0.3, 0.0, 0.0) if moving and j == HEIGHT - 1 else (0.0, 0.0, 0.0)
            bodies.append(asp.Body.ball(1.0, radius=RADIUS, position=spot, velocity=push))
            b = k * HEIGHT + j
            below: Any = (
                asp.SpherePlane(b, radius=RADIUS, plane=asp.Plane(), law=law)
                if j == 0
                else asp.SphereSphere(b - 1, radius=RADIUS, other=b, other_radius=RADIUS, law=law)
            )
            pairs.append(below)
    return asp.RigidBodies(bodies, pairs=pairs)


def per_step(number: int, *, moving: bool = False) -> float:
    """Return the time of a step in µs per ball."""
    system, runs = piles(number, moving), max(1, 200 // number)

    def steps(count: int) -> None:
        for _ in range(runs):
            asp.simulate(system, dt=1e-3, t_end=count * 1e-3, sample_every=count * 1e-3)

    first, more = (timed(lambda n=n: steps(n), time.process_time) for n in (2, 2 + STEPS))
    return 1e6 * (more - first) / (runs * STEPS * number * HEIGHT)


def boxes(spins: Floats) -> asp.RigidBodies:
    """Return boxes that slide and turn on four corners, far from each other."""
    law, height = asp.FrictionLaw.isotropic(0.3), 0.02
    bodies, pairs = [], []
    for b, spin in enumerate(spins):
        body = asp.Body.box(
            1.0,
            half_sizes=[0.1, 0.1, height],
            position=[float(b), 0.0, height],
            velocity=[1.0, 0.2, 0.0],
            angular_velocity=[0.0, 0.0, spin],
        )
        bodies.append(body)
        pairs += [
            asp.PointPlane(b, point=[x, y, -height], plane=asp.Plane(), law=law)
            for x in (-0.1, 0.1)
            for y in (-0.1, 0.1)
        ]
    return asp.RigidBodies(bodies, pairs=pairs)


def belts(speeds: Floats) -> asp.LinearSystem:
    """Return masses on belts of Fig. 17 with these speeds, not connected."""
    count = len(speeds)
    law = asp.FrictionLaw(asp.Ellipse(30.0, 10.0, angle=np.pi / 6), asp.Ellipse(3.0, 1.0))
    along = np.array([np.cos(np.deg2rad(50.0)), np.sin(np.deg2rad(50.0))])
    contacts = []
    for k, speed in enumerate(speeds):
        direction = np.zeros((2 * count, 2))
        direction[2 * k : 2 * k + 2] = np.eye(2)
        velocity = -speed * along
        contacts.append(asp.Contact(law, direction=direction, normal_force=1.0, velocity=velocity))
    mass = np.eye(2 * count)
    return asp.LinearSystem(mass, stiffness=mass, contacts=contacts)


def rods(spins: Floats) -> asp.RigidBodies:
    """Return rods that tumble above the ground."""
    law = asp.FrictionLaw.isotropic(0.3)
    bodies, pairs = [], []
    for b, spin in enumerate(spins):
        body = asp.Body(
            1.0,
            inertia=[0.01, 0.02, 0.03],
            position=[float(b), 0.0, 20.0],
            angular_velocity=[0.3, spin, 1.0],
        )
        bodies.append(body)
        pairs.append(asp.PointPlane(b, point=[0.0, 0.0, 0.2], plane=asp.Plane(), law=law))
    return asp.RigidBodies(bodies, pairs=pairs)


def separate(name: str, of: Callable[[Floats], asp.System], t_end: float) -> None:
    """Compare bodies that do not touch each other with the sum of single ones."""
    row = []
    for count in (4, 16, 64):
        values = np.linspace(0.8, 1.2, count)
        yard, single = of(values), [of(values[k : k + 1]) for k in range(count)]

        def run(systems: list[asp.System]) -> None:
            for system in systems:
                asp.integrate(system, t_end=t_end, sample_every=t_end / 10)

        together = timed(lambda yard=yard: run([yard]), time.process_time)
        row.append(together / timed(lambda single=single: run(single), time.process_time))
    print(f"  {name:6}" + "".join(f" {value:6.2f}" for value in row), flush=True)
    ratio(
        f"{count} separate {name}, event-driven",
        row[-1],
        f"the sum of {count} single ones",
        "whether bodies that do not touch each other cost each other time",
    )


def main() -> None:
    """Print all of it."""
    walls()
    print("4, 16 and 64 bodies that do not touch, `integrate`, over the sum of single ones:")
    separate("boxes", boxes, 0.2)
    separate("belts", belts, 10.0)
    separate("rods", rods, 1.0)
    print(f"piles of {HEIGHT} balls, µs per ball and step:")
    print("  piles   at rest   moving")
    found = {}
    for number in (1, 10, 100, 1000):
        rest, moving = per_step(number), per_step(number, moving=True)
        print(f"  {number:5d} {rest:9.2f} {moving:8.2f}", flush=True)
        found[number] = rest
    ratio(
        f"a step of 1,000 piles of {HEIGHT} balls at rest, per ball",
        found[1000] / found[1],
        "the same of one pile",
        "how cost grows with the number of piles: 1 is in proportion",
    )


if __name__ == "__main__":
    main()
