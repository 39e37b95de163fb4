"""Cost per point of batched set operations from Python as a ratio to the same loop in Rust.

10⁵ points per call; allowed: twice the cost in Rust. Run after `cargo bench`, whose binary gives
the floor: `python benches/python_sets.py`.
"""

import subprocess
import sys
import time

import asperity as asp
import asperity._core as _core
import numpy as np
from report import ratio

POINTS = 100_000
MEANING = "what arrays lose between NumPy and Rust"
PACKAGE = ["-p", "asperity-set", "--bench", "sets"]
RUST = ["cargo", "bench", "--quiet", "--locked", *PACKAGE, "--", "points"]
ANGLE = 2.0 * np.pi * np.arange(60) / 60
WAVE = 1.0 + 0.1 * np.cos(2.0 * ANGLE)
HEXAGON = np.stack([np.cos(1.05 * np.arange(6)), np.sin(1.05 * np.arange(6))], axis=-1)
CROSS = (asp.Ellipse(3.0, 1.0), asp.Ellipse(1.0, 3.0))
SETS = {
    "ellipse": asp.Ellipse(3.0, 1.0),
    "rectangle": asp.Rectangle(3.0, 1.0),
    "superellipse": asp.Superellipse(3.0, 1.0, 2.94),
    "capped rectangle": asp.CappedRectangle(1.0, 0.5, cap=0.7),
    "polygon": asp.Polygon(HEXAGON),
    "wedge asperity": asp.WedgeAsperity(0.8, beta=0.6),
    "polar curve": asp.PolarCurve(ANGLE, WAVE),
    "support curve": asp.SupportCurve(ANGLE, WAVE),
    "intersection": CROSS[0] & CROSS[1],
    "Minkowski sum": CROSS[0] + CROSS[1],
    "ellipsoid": asp.Ellipsoid([3.0, 1.0, 2.0]),
    "Coulomb–Contensou": asp.CoulombContensou(0.5),
}


def rust() -> dict[tuple[str, str], float]:
    """Return nanoseconds per point for each set and operation."""
    done = subprocess.run(RUST, check=True, capture_output=True, text=True)
    rows = [line.split("\t") for line in done.stdout.splitlines() if line.count("\t") == 2]
    return {(name, operation): float(cost) for name, operation, cost in rows}


def points(convex: asp.StarSet) -> np.ndarray:
    """Return the points of benches/sets.rs: 1.05 to 4 times the boundary, in all directions."""
    k = np.arange(1.0, POINTS + 1.0)

    def part(shift: float) -> np.ndarray:
        return np.modf(0.618_033_988_749_895 * k * shift)[0]

    directions = np.stack([part(s) for s in (1.0, 1.7, 2.3)[: convex.dimension]], axis=-1) - 0.5
    return directions * ((1.05 + 2.95 * part(3.1)) / convex.gauge(directions))[:, None]


def python(convex: asp.StarSet, operation: str) -> float:
    """Return nanoseconds per point, the best of several calls."""
    x, method, best = points(convex), getattr(convex, operation), np.inf
    for _ in range(7):
        start = time.perf_counter()
        method(x)
        best = min(best, time.perf_counter() - start)
    return best / POINTS * 1e9


def main() -> None:
    """Print the ratios; every cost is the best of three alternating measurements."""
    if _core.build_profile != "release":
        sys.exit("the extension module is a debug build: install with `make .venv/.installed`")
    floors = [rust()]
    keys = list(floors[0])
    costs = [{key: python(SETS[key[0]], key[1]) for key in keys}]
    for _ in range(2):
        floors.append(rust())
        costs.append({key: python(SETS[key[0]], key[1]) for key in keys})
    print("set, operation                           Rust    Python    ratio   allowed")
    ratios = []
    for key in keys:
        floor = min(found[key] for found in floors)
        cost = min(found[key] for found in costs)
        text = f"{key[0]}, {key[1]}"
        ratios.append(cost / floor)
        print(f"{text:36} {floor:8.1f}  {cost:8.1f}  {cost / floor:7.2f}   2.00")
    beside = "the same loop in Rust"
    calls = "gauges, support points and projections of 100,000 points in one call"
    ratio(f"{calls}, the median of all sets", float(np.median(ratios)), beside, MEANING)
    ratio(f"{calls}, the slowest set", max(ratios), beside, MEANING)


if __name__ == "__main__":
    main()
