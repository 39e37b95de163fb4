"""Islands: walls side by side beside single ones, piles that step, and what is at rest.

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
from report import ratio
from scipy.sparse import block_diag

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


def main() -> None:
    """Print all of it."""
    walls()
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
