"""Why some problems are hard: is there a solution, is it regular, do iterations contract?

    python benches/hard_problems.py [--problems pile7,pile8] [--files a.npz b.npz] [--time-limit 60]
    python benches/hard_problems.py --piles [--files a.npz]
    python benches/hard_problems.py --wide

For unilateral contacts with isotropic friction, p = 2, between bodies. Columns, in units in which
the mean of the diagonal of G and of the loads of a contact are 1:

- margin: largest t ≤ 1 with ξ_N ≥ μ‖ξ_T‖ + t at all contacts for some velocities of the bodies
  (a linear program; ‖ξ_T‖ by an octagon around it). Where it is positive, there is a solution;
- sizes: ‖P‖ against ρ‖b‖;
- open, stick, slip, and the contacts that are within 10⁻⁶ of another state;
- selfstress: combinations of percussions of closed contacts that bring no velocities; weakest: the
  smallest singular value of the others, against the largest;
- map: De Saxcé's shift μ‖ξ_T‖ as a function of itself, by way of the convex problem with a given
  shift. Its derivative at the solution, by the eigenvalues beyond 1: iterations that take the shift
  from the last iterate converge where there is none, with small steps where none is to the right.

With `--piles`: times of `Auto` on 52 piles and columns of spheres, where factorisations are
expensive, each of 4 s at most. With `--wide`: the same on 195 others of 4 to 8 layers and 12 to
60 columns, each of 6 s at most.
"""

import argparse
import time

import asperity as asp
import numpy as np
from asperity import problems
from numpy.linalg import norm
from scipy.linalg import cholesky, eigvals, solve_triangular, svdvals
from scipy.optimize import linprog
from scipy.sparse import (
    block_array,
    csc_array,
    csr_array,
    diags_array,
    eye_array,
    hstack,
    vstack,
)
from scipy.sparse.linalg import splu

SIDES = 8
"""Of the polygon around the disk of the linear program."""
NEAR = 1e-6
"""Distance to another state within which a contact counts as near to it."""
RANK = 1e-9
"""Largest ratio of singular values that counts as none."""
REGULAR = 1e-7
"""Compliance of percussions that are not determined; 10⁻⁵ shows the same eigenvalues to 5 %."""
SLOW = 0.3
"""Time in s from which on a problem is named."""
LARGEST = 3000
"""Rows of closed contacts beyond which singular values take minutes."""


class Scaled:
    """A problem in units of its own."""

    def __init__(self, problem: asp.ContactProblem) -> None:
        """Take the matrices of the bodies."""
        self.mu = np.array([float(law.reservoir.radius(0.0)) for law in problem.laws])
        diagonal = problem.delassus.diagonal()
        rho = len(diagonal) / diagonal.sum()
        self.speed = norm(problem.free_velocity) / len(self.mu) ** 0.5
        self.unit = rho * self.speed
        self.load = problem.free_velocity / self.speed
        self.mass = csr_array(problem.mass)
        self.rows = csr_array(np.sqrt(rho) * csr_array(problem.directions).T)


def margin(scaled: Scaled) -> float:
    """Return how far velocities can be inside of all dual cones."""
    normal, first, second = (scaled.rows[k::3] for k in range(3))
    b, mu = scaled.load.reshape(-1, 3), scaled.mu
    rows, right = [], []
    for angle in 2.0 * np.pi * np.arange(SIDES) / SIDES:
        c, s = np.array([np.cos(angle), np.sin(angle)]) / np.cos(np.pi / SIDES)
        slope = normal - diags_array(c * mu) @ first - diags_array(s * mu) @ second
        rows.append(hstack([-slope, np.ones((len(mu), 1))]))
        right.append(b[:, 0] - mu * (c * b[:, 1] + s * b[:, 2]))
    velocities = scaled.rows.shape[1]
    done = linprog(
        np.r_[np.zeros(velocities), -1.0],
        A_ub=csr_array(vstack(rows)),
        b_ub=np.concatenate(right),
        bounds=[(-1e4, 1e4)] * velocities + [(None, 1.0)],
        method="highs-ipm",
    )
    return -done.fun if done.status == 0 else np.nan


def linearised(scaled: Scaled, solution: asp.contact.ContactSolution) -> str:
    """Return states, redundancy and the derivative of the map of shifts at a solution."""
    mu = scaled.mu
    p = solution.percussion.reshape(-1, 3) / scaled.unit
    xi = solution.velocity.reshape(-1, 3) / scaled.speed
    speed, inside = norm(xi[:, 1:], axis=1), mu * p[:, 0] - norm(p[:, 1:], axis=1)
    gone = p[:, 0] <= 0.0
    stick = ~gone & (inside > speed)
    slip = ~gone & ~stick
    near = (gone & (xi[:, 0] < NEAR)) | (slip & (speed < NEAR))
    near |= (~gone & (p[:, 0] < NEAR)) | (stick & (inside < NEAR * p[:, 0]))
    sliding = np.flatnonzero(slip)
    direction = xi[sliding, 1:] / speed[sliding, None]
    first, second = scaled.rows[3 * sliding + 1], scaled.rows[3 * sliding + 2]
    along = diags_array(direction[:, 0]) @ first + diags_array(direction[:, 1]) @ second
    across = diags_array(direction[:, 0]) @ second - diags_array(direction[:, 1]) @ first
    along = diags_array(mu[sliding]) @ along
    turning = diags_array(mu[sliding] * p[sliding, 0] / speed[sliding])
    sticking = (3 * np.flatnonzero(stick)[:, None] + np.arange(3)).ravel()
    held = csr_array(vstack([scaled.rows[3 * sliding] - along, scaled.rows[sticking]]))
    text = f"sizes {norm(p) / norm(scaled.load):.3g}; {gone.sum()} open, {stick.sum()} stick, "
    text += f"{slip.sum()} slip, {near.sum()} near another state"
    if held.shape[0] <= LARGEST:
        factor = cholesky(scaled.mass.toarray(), lower=True)
        values = svdvals(solve_triangular(factor, held.T.toarray(), lower=True))
        rank = int(np.sum(values > RANK * values[0]))
        text += f"; selfstress {held.shape[0] - rank}, weakest {values[rank - 1] / values[0]:.0e}"
    else:
        text += "; selfstress not computed"
    if not len(sliding):
        return text
    stiffness = scaled.mass + across.T @ turning @ across
    system = block_array([[stiffness, -held.T], [held, REGULAR * eye_array(held.shape[0])]])
    right = np.zeros((system.shape[0], len(sliding)))
    right[stiffness.shape[0] + np.arange(len(sliding)), np.arange(len(sliding))] = -1.0
    change = splu(csc_array(system)).solve(right)[: stiffness.shape[0]]
    found = eigvals(along @ change)
    beyond = found[np.abs(found) > 1.0]
    largest = found[np.argmax(np.abs(found))]
    text += f"; map: {len(beyond)} beyond 1, {np.sum(beyond.real > 1.0)} of them to the right"
    return f"{text}, largest {largest:.3g}"


def piles_and_columns() -> list[tuple[str, asp.ContactProblem]]:
    """Return 36 piles and 16 packings of columns, with three frictions, by name."""
    cases = [
        pile(layers, friction, speed)
        for layers in range(3, 9)
        for friction in (0.1, 0.3, 0.5)
        for speed in (0.0, 0.3)
    ]
    counts = (3, 6, 12, 18, 26, 36, 46, 70)
    return cases + [columns(count, friction) for count in counts for friction in (0.1, 0.5)]


def more_piles_and_columns() -> list[tuple[str, asp.ContactProblem]]:
    """Return 165 piles and 30 packings of columns, of frictions between 0.1 and 0.7, by name."""
    frictions = (0.1, 0.15, 0.2, 0.25, 0.3, 0.35, 0.4, 0.45, 0.5, 0.6, 0.7)
    cases = [
        pile(layers, friction, speed)
        for layers in range(4, 9)
        for friction in frictions
        for speed in (0.0, 0.1, 0.3)
    ]
    counts = (12, 18, 26, 36, 46, 60)
    return cases + [
        columns(count, friction, seed=1)
        for count in counts
        for friction in (0.2, 0.3, 0.4, 0.6, 0.7)
    ]


def pile(layers: int, friction: float, speed: float) -> tuple[str, asp.ContactProblem]:
    """Return the name of a pile, and it."""
    law = asp.FrictionLaw.isotropic(friction)
    name = f"pile {layers}, friction {friction}, {speed} m/s"
    return name, problems.pile(layers, law=law, speed=speed)


def columns(count: int, friction: float, *, seed: int = 0) -> tuple[str, asp.ContactProblem]:
    """Return the name of columns of ten spheres, and them."""
    law = asp.FrictionLaw.isotropic(friction)
    name = f"{count} columns, friction {friction}"
    return name, problems.columns(count, height=10, law=law, seed=seed)


def times_of(cases: list[tuple[str, asp.ContactProblem]], *, limit: float) -> None:
    """Print the time of `Auto` on problems, and those that it does not solve or takes long for."""
    times = []
    for name, problem in cases:
        start = time.process_time()
        solution = problem.solve(
            tolerance=1e-8, measure="global", time_limit=limit, on_failure="record"
        )
        times.append(time.process_time() - start)
        if times[-1] > SLOW or not solution.converged:
            end = f"{solution.status}, {solution.natural_map:.1e}"
            print(f"{name}: {times[-1]:.2f} s, {end}", flush=True)
    mean = 1e3 * np.exp(np.log(times).mean())
    print(f"{len(cases)} problems: {sum(times):.2f} s, geometric mean {mean:.2f} ms", flush=True)


def main() -> None:
    """Print some lines per problem."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--problems", default="pile5,pile7,pile8", help="layers of piles")
    parser.add_argument("--files", nargs="*", default=[])
    parser.add_argument("--time-limit", type=float, default=60.0, help="s per solve")
    parser.add_argument("--piles", action="store_true", help="times of piles and columns")
    parser.add_argument("--wide", action="store_true", help="times of more of them")
    options = parser.parse_args()
    if options.piles:
        others = [(file, asp.ContactProblem.load(file)) for file in options.files]
        times_of(others + piles_and_columns(), limit=4.0)
    if options.wide:
        times_of(more_piles_and_columns(), limit=6.0)
    if options.piles or options.wide:
        return
    piles = [name for name in options.problems.split(",") if name]
    cases = [(name, problems.pile(int(name.removeprefix("pile")))) for name in piles]
    cases += [(file, asp.ContactProblem.load(file)) for file in options.files]
    for name, problem in cases:
        start = time.process_time()
        solution = problem.solve(
            tolerance=1e-8,
            measure="global",
            time_limit=options.time_limit,
            on_failure="record",
        )
        took = time.process_time() - start
        scaled = Scaled(problem)
        velocities = scaled.mass.shape[0]
        print(f"{name}: {len(problem.laws)} contacts, {velocities} velocities of bodies")
        stages = ", ".join(
            f"{stage.method} {stage.iterations} ({stage.factorizations}) {stage.residual:.0e}"
            for stage in solution.stages
        )
        print(f"  {solution.status} in {took:.2f} s, {solution.natural_map:.1e}: {stages}")
        print(f"  margin {margin(scaled):.3g}; {linearised(scaled, solution)}", flush=True)


if __name__ == "__main__":
    main()
