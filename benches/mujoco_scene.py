"""What a step of a Scene costs against MuJoCo's own of the same model, in one run.

Then what `ContactStepper` costs for the four contacts from dense G, without a step before.

    python benches/mujoco_scene.py [--root FOLDER] [--profile]

Both take the same steps from the same state with the same controls, MuJoCo by Euler and, where the
model says so, by Runge–Kutta. Ant and humanoid need gymnasium, or a folder that has it. The pile is
100 boxes that have settled.
"""

import argparse
import cProfile
import pstats
import sys
import time
from importlib.util import find_spec
from pathlib import Path

import mujoco
import numpy as np
from asperity import ContactStepper
from asperity.mujoco import Scene
from report import ratio

BOX = """<mujoco><option timestep="0.001"/><worldbody><geom type="plane" size="5 5 .1"/>
<body pos="0 0 .005"><freejoint/><geom type="box" size=".02 .02 .005" mass=".018"/></body>
</worldbody></mujoco>"""


def pile(columns=5, layers=4):
    """Return boxes in columns, each layer turned against the one below."""
    boxes = "".join(
        f'<body pos="{0.5 * i} {0.5 * j} {0.1 + 0.2 * k}" euler="0 0 {20 * k}"><freejoint/>'
        '<geom type="box" size=".1 .1 .1"/></body>'
        for i in range(columns)
        for j in range(columns)
        for k in range(layers)
    )
    return (
        '<mujoco><option timestep="0.002"/><worldbody><geom type="plane" size="9 9 .1"/>'
        f"{boxes}</worldbody></mujoco>"
    )


def compare(case, model, *, settle, steps, integrators=("mjINT_EULER",), tolerance=1e-10):
    """Print the ratios of a model."""
    data = mujoco.MjData(model)
    scene = Scene(model, starts="project", tolerance=tolerance)
    for _ in range(settle):
        scene.step(data)
    rng, spent = np.random.default_rng(0), {}
    others = {name: mujoco.MjData(model) for name in integrators}
    for other in others.values():
        other.qpos[:], other.qvel[:] = data.qpos, data.qvel
    for _ in range(steps):
        controls = 0.3 * rng.uniform(-1.0, 1.0, model.nu)
        for name, other in (("scene", data), *others.items()):
            other.ctrl[:] = controls
            if name != "scene":
                model.opt.integrator = getattr(mujoco.mjtIntegrator, name)
            start = time.perf_counter()
            if name == "scene":
                scene.step(other)
            else:
                mujoco.mj_step(model, other)
            spent.setdefault(name, []).append(time.perf_counter() - start)
    own = np.median(spent["scene"])
    print(f"# {case}: {1e6 * own:.0f} µs, {len(scene.contacts(data))} contacts", file=sys.stderr)
    for name in integrators:
        words = name.removeprefix("mjINT_")
        beside = f"mj_step, {words}"
        ratio(case, own / np.median(spent[name]), beside, "rigid contacts instead of soft ones")
    return scene, data


def compare_stepper(scene, data):
    """Print the ratio of a cold solve of the rows of a step."""
    problem, spent = scene.problem(data), []
    stepper, other = ContactStepper(problem.laws), mujoco.MjData(scene._rows.user)
    for _ in range(2000):
        stepper.forget()
        start = time.perf_counter()
        stepper.solve(
            problem.delassus,
            free_velocity=problem.free_velocity,
            items=problem.items,
            keys=problem.keys,
        )
        middle = time.perf_counter()
        mujoco.mj_step(scene._rows.user, other)
        spent.append((middle - start, time.perf_counter() - middle))
    own, step = np.median(spent, axis=0)
    print(f"# ContactStepper: {1e6 * own:.1f} µs", file=sys.stderr)
    ratio("ContactStepper, four contacts, cold", own / step, "mj_step, EULER", "from dense G")


def main():
    """Print the ratios."""
    parser = argparse.ArgumentParser(description=(__doc__ or "").splitlines()[0])
    parser.add_argument("--root", help="a folder with gymnasium")
    parser.add_argument("--profile", action="store_true", help="of the step of a box")
    options = parser.parse_args()
    scene, data = compare(
        "box on four contacts", mujoco.MjModel.from_xml_string(BOX), settle=200, steps=500
    )
    if options.profile:
        with cProfile.Profile() as profile:
            for _ in range(2000):
                scene.step(data)
        pstats.Stats(profile).sort_stats("tottime").print_stats(25)
        return 0
    compare_stepper(scene, data)
    spec = find_spec("gymnasium")
    base = Path(options.root) / "gymnasium" if options.root else spec and Path(spec.origin).parent
    for name in ("ant", "humanoid") if base else ():
        model = mujoco.MjModel.from_xml_path(str(base / f"envs/mujoco/assets/{name}.xml"))
        both = ("mjINT_EULER", "mjINT_RK4")
        compare(name, model, settle=200, steps=300, integrators=both)
    for tolerance in (1e-8, 1e-6):
        model = mujoco.MjModel.from_xml_string(pile())
        case = f"settled pile of 100 boxes, tolerance {tolerance:.0e}"
        compare(case, model, settle=20, steps=20, tolerance=tolerance)
    return 0


if __name__ == "__main__":
    sys.exit(main())
