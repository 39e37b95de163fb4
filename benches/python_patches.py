"""Time of a fit of a patch's law to 600 pairs, beside SciPy on the same residuals and Jacobian.

SciPy's `least_squares` starts from each of the places from which `fit_patch` does, with the loss
and the scale that this has found. FOLDER holds measured pairs, real_pushes.npz; without it they are
made. Times are those of the processor, in one thread: set OMP_NUM_THREADS=1.

Run: python benches/python_patches.py [FOLDER]
"""

import sys
import time
from collections.abc import Callable
from pathlib import Path
from typing import Any

import asperity as asp
import numpy as np
from asperity.identify import fit_patch
from asperity.identify.evidence.wrenches.solving import starts_of
from report import ratio
from scipy.optimize import least_squares

OPTIONS: dict[str, dict[str, Any]] = {
    "ellipsoid": {},
    "ellipsoids C and D": {"direction": "ellipsoid"},
    "round area": {"reservoir": "contensou"},
    "5 points": {"reservoir": "supports"},
    "5 points, elliptic": {"reservoir": "supports", "friction": "ellipse"},
}


def timed(work: Callable[[], Any], repeats: int = 3) -> tuple[float, Any]:
    """Return the shortest processor time and what was computed."""
    times = []
    for _ in range(repeats):
        start = time.process_time()
        result = work()
        times.append(time.process_time() - start)
    return min(times), result


def made() -> tuple[np.ndarray, np.ndarray]:
    """Return 600 pairs of five supports with noise."""
    random = np.random.default_rng(0)
    phi = 2.0 * np.pi * np.arange(5) / 5 + 0.2
    twist = random.normal(size=(600, 3))
    wrench = np.zeros((600, 3))
    places = 0.9 * np.stack([np.cos(phi), np.sin(phi)], axis=-1)
    for load, (x, y) in zip(random.uniform(0.5, 1.5, 5), places, strict=True):
        velocity = twist[:, :2] + twist[:, 2:] * [-y, x]
        force = load * velocity / np.linalg.norm(velocity, axis=1, keepdims=True)
        wrench += np.column_stack([force, x * force[:, 1] - y * force[:, 0]])
    return wrench + 0.2 * random.normal(size=wrench.shape), twist


def main(folder: str | None = None) -> None:
    """Print the ratios of times for every model."""
    sets = {"made": made()}
    if folder is not None:
        with np.load(Path(folder) / "real_pushes.npz") as file:
            for name in ("abs_hex", "plywood_hex", "plywood_rect1", "plywood_rect2"):
                sets[name] = file[f"mit/{name}_wrench"], file[f"mit/{name}_twist"]
    print(f"{'pairs':15s}{'model':20s}{'fit [s]':>9s}   times SciPy's: fastest start, median, all")
    for label, (wrench, twist) in sets.items():
        for name, options in OPTIONS.items():
            own, fit = timed(lambda w=wrench, v=twist, o=options: fit_patch(w, v, **o))
            model, pairs = fit.model, fit.pairs
            starts = starts_of(model, pairs, "soft_l1")
            if name == "5 points, elliptic":
                # Those of isotropic friction: the search for its best places is part of the fit.
                plain = starts_of(model.replace(friction="isotropic"), pairs, "soft_l1")
                starts = [np.concatenate([one, [0.0, 0.0]]) for one in plain]
            peers = [
                timed(
                    lambda p=start, m=model, q=pairs, s=fit.loss.scale: least_squares(
                        lambda x: (m.both(x, q)[0] - q.wrench).ravel(),
                        p,
                        jac=lambda x: m.both(x, q)[1].reshape(-1, m.size),
                        loss="soft_l1",
                        f_scale=s,
                        max_nfev=400,
                    )
                )[0]
                for start in starts
            ]
            ratios = (own / min(peers), own / np.median(peers), own / sum(peers))
            print(f"{label:15s}{name:20s}{own:9.3f}   " + " ".join(f"{r:6.2f}" for r in ratios))
            if label == "made":
                ratio(
                    f"a patch's law from 600 pairs: {name}",
                    ratios[2],
                    "SciPy's `least_squares` with the same starts, residuals and Jacobians",
                    "what a fit with its scale, its outliers and its intervals costs",
                )


if __name__ == "__main__":
    print(f"asperity {asp.__version__}")
    main(*sys.argv[1:])
