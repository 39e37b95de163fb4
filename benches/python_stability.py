"""Time of a stability chart and of a bifurcation diagram with limit cycles.

Run: python benches/python_stability.py
"""

import time

import asperity as asp
import numpy as np
from report import ratio

PHI = np.deg2rad(50.0)
DIRECTIONS, ROTATIONS, VALUES = 181, 91, 200


def belt(phi: float, zeta: float = np.pi / 6) -> asp.MassOnBelt:
    """Return the mass on a belt of Fig. 17 with the belt along φ."""
    law = asp.FrictionLaw(asp.Ellipse(30.0, 10.0, angle=zeta), asp.Ellipse(3.0, 1.0))
    return asp.MassOnBelt(
        1.0, stiffness=1.0, law=law, normal_force=1.0, belt_velocity=[np.cos(phi), np.sin(phi)]
    )


def best(run, repeat: int = 3) -> float:
    """Return the shortest time of a few runs in s."""
    times = []
    for _ in range(repeat):
        start = time.perf_counter()
        run()
        times.append(time.perf_counter() - start)
    return min(times)


def chart() -> None:
    """Compare a chart with the eigenvalues of as many matrices, NumPy's alone."""
    phi, zeta = np.linspace(0.0, np.pi, DIRECTIONS), np.linspace(0.0, np.pi, ROTATIONS)
    whole = best(lambda: asp.growth_chart(belt(0.0, 0.0), phi=phi, zeta=zeta))
    matrices = np.random.default_rng(1).normal(size=(DIRECTIONS * ROTATIONS, 4, 4))
    floor = best(lambda: np.linalg.eigvals(matrices))
    print(f"growth chart {DIRECTIONS} x {ROTATIONS}: {whole:.3f} s", end="")
    print(f", {whole / floor:.2f} times the eigenvalues of as many full matrices")
    ratio(
        f"a growth chart of {DIRECTIONS} × {ROTATIONS} belts",
        whole / floor,
        "the eigenvalues of as many full 4 × 4 matrices by NumPy",
        "what steady sliding, linearisation and eigenvalues cost together",
    )


def cycles() -> None:
    """Compare shooting with as many periods of time stepping at Δt = 1 ms."""
    period = asp.limit_cycle(belt(PHI)).period
    stepping = best(lambda: asp.simulate(belt(PHI), dt=1e-3, t_end=period, sample_every=0.1))
    flow = best(lambda: asp.integrate(belt(PHI), t_end=period, q0=[25.96, 15.03]))
    shooting = best(lambda: asp.limit_cycle(belt(PHI)))
    print(f"one period: {1e3 * flow:.2f} ms, {flow / stepping:.2f} times 28,703 time steps")
    print(f"limit cycle from rest: {1e3 * shooting:.1f} ms, {shooting / flow:.1f} periods")
    ratio(
        "a period of stick and slip, event-driven",
        flow / stepping,
        "28,703 time steps of the same period, Δt = 1 ms",
        "what located events cost; time stepping of that Δt has errors of its order",
    )
    ratio(
        "a limit cycle from rest, with its multipliers",
        shooting / flow,
        "one period, event-driven",
        "how many periods the search for a cycle takes",
    )
    values = np.deg2rad(np.linspace(44.2, 75.8, VALUES))
    start = time.perf_counter()
    diagram = asp.bifurcation_diagram(belt, parameter="phi", values=values)
    seconds = time.perf_counter() - start
    found = sum(cycle is not None for cycle in diagram.cycles)
    print(f"bifurcation diagram of {VALUES} values, {found} limit cycles: {seconds:.2f} s", end="")
    print(f", {seconds / VALUES / flow:.1f} periods per value")
    ratio(
        f"a bifurcation diagram of {VALUES} values, per value",
        seconds / VALUES / flow,
        "one period, event-driven",
        "what a diagram costs: equilibrium, cycle and stability of every value",
    )


if __name__ == "__main__":
    chart()
    cycles()
