"""Many sliding points in one call, with and without lanes, beside `mujoco.rollout` on sliders.

A block of 1 kg is pushed with up to 1.4 m/s on a plane with μ = 0.3 and slides for half a second at
most. Printed are microseconds per step and slider on so many threads, the best of three turns, the
largest error of the paths against v²/(2μg), which is exact, and how fast the blocks still are.
MuJoCo is asked where it is installed (``pip install mujoco``): its contacts are soft, and its
rollout keeps the states of all steps.
"""

import sys
import time
from importlib.util import find_spec

import asperity as asp
import numpy as np
from report import ratio

MU, GRAVITY, DT, STEPS, COUNT = 0.3, 9.81, 2e-3, 500, 2000
SPEEDS = np.linspace(0.05, 1.4, COUNT)
ANGLES = np.linspace(0.0, 2.0 * np.pi, COUNT)
VELOCITIES = SPEEDS[:, None] * np.stack([np.cos(ANGLES), np.sin(ANGLES)], axis=-1)
PATHS = SPEEDS**2 / (2.0 * MU * GRAVITY)
XML = f"""<mujoco><option timestep="{DT}" gravity="0 0 -{GRAVITY}" cone="elliptic"/>
<worldbody><geom type="plane" size="9 9 .1" friction="{MU} 0 0"/>
<body pos="0 0 .01"><joint type="slide" axis="1 0 0"/><joint type="slide" axis="0 1 0"/>
<joint type="slide" axis="0 0 1"/>
<geom type="box" size=".02 .02 .01" mass="1" friction="{MU} 0 0" condim="3"/></body>
</worldbody></mujoco>"""


def asperity(threads: int, *, lanes: bool) -> tuple[np.ndarray, np.ndarray]:
    """Return the last positions and velocities."""
    block = asp.SlidingPoint(1.0, law=asp.FrictionLaw.isotropic(MU), gravity=GRAVITY)
    many = asp.simulate_many(
        block, dt=DT, t_end=STEPS * DT, u0=VELOCITIES, threads=threads, lanes=lanes
    )
    return many.q, many.u


def rollout(threads: int) -> tuple[np.ndarray, np.ndarray]:
    """Return the same of MuJoCo."""
    import mujoco
    from mujoco import rollout as many

    model = mujoco.MjModel.from_xml_string(XML)
    states = np.zeros((COUNT, 1 + model.nq + model.nv))
    states[:, 4:6] = VELOCITIES
    data = [mujoco.MjData(model) for _ in range(threads)]
    found, _ = many.rollout(model, data, states, nstep=STEPS)
    return found[:, -1, 1:3], found[:, -1, 4:6]


def main() -> None:
    """Print the table."""
    engines = {
        "asperity, simulate_many": lambda threads: asperity(threads, lanes=False),
        "asperity, with lanes": lambda threads: asperity(threads, lanes=True),
    }
    if find_spec("mujoco") is None:
        print("without MuJoCo: pip install mujoco", file=sys.stderr)
    else:
        engines["mujoco.rollout"] = rollout
    print(f"{COUNT} sliders, {STEPS} steps   threads   us/step   path error   speed left")
    costs = {}
    for name, engine in engines.items():
        for threads in (1, 2):
            best = np.inf
            for _ in range(3):
                start = time.perf_counter()
                q, u = engine(threads)
                best = min(best, time.perf_counter() - start)
            error = np.abs(np.linalg.norm(q, axis=-1) - PATHS).max()
            left = np.linalg.norm(u, axis=-1).max()
            cost = costs[name, threads] = best / (COUNT * STEPS) * 1e6
            print(f"{name:26} {threads:8} {cost:9.3f} {error:10.1e} m {left:8.1e} m/s")
    plain, lanes, peer = "asperity, simulate_many", "asperity, with lanes", "mujoco.rollout"
    ratio(
        f"{COUNT:,} sliding points on two threads",
        costs[plain, 2] / costs[plain, 1],
        "the same on one thread",
        "what a second core saves from Python",
    )
    ratio(
        f"{COUNT:,} sliding points in lanes, on one thread",
        costs[lanes, 1] / costs[plain, 1],
        "the same without lanes",
        "what `lanes=True` saves with isotropic friction",
    )
    if (peer, 1) in costs:
        ratio(
            f"{COUNT:,} sliding points, on one thread",
            costs[plain, 1] / costs[peer, 1],
            "`mujoco.rollout` of as many blocks, which detects contacts and keeps all steps",
            "what exact stick costs beside a soft contact of another engine",
        )


if __name__ == "__main__":
    main()
