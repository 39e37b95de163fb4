#!/bin/sh
# Where two meet: MuJoCo's model files (MJCF) and Brax 0.14.2
#
# Brax reads MJCF with MuJoCo and refuses much of it with NotImplementedError: elliptic cones, impratio,
# priorities, wind. Dry friction of a joint (frictionloss) it neither refuses nor uses: an arm that turns
# about a hinge and has 2 rad/s is stopped by 5 N m in 0.11 s in MuJoCo and turns on as without it in the
# pipelines generalized, spring and positional. The joint's damping is used by generalized only: the
# other two have the same speed, to the last bit, with damping="2" and "0".
set -eu
dir=$(mktemp -d)
trap 'rm -rf "$dir"' EXIT
python3 -m venv "$dir/venv"
"$dir/venv/bin/pip" install -q --disable-pip-version-check brax==0.14.2 mujoco==4.0.0 \
    mujoco-mjx==3.17.0 jax==0.10.2 numpy==2.4.6
JAX_PLATFORMS=cpu "$dir/venv/bin/python" -W ignore - <<'PY' 2> /dev/null
import importlib

import jax
import mujoco
from brax.io import mjcf
from jax import numpy as jnp


def text(damping, dry, cone="pyramidal"):
    return (
        f'<mujoco><option timestep="0.001" gravity="0 0 0" cone="{cone}"/><worldbody><body>'
        f'<joint type="hinge" axis="0 0 1" damping="{damping}" frictionloss="{dry}"/>'
        '<geom type="sphere" pos="0.5 0 0" size="0.1" mass="1" contype="0" conaffinity="0"/>'
        "</body></worldbody></mujoco>"
    )


def speed(name, damping, dry):
    """Speed in rad/s after 0.1 s from 2 rad/s."""
    if name == "mujoco":
        model = mujoco.MjModel.from_xml_string(text(damping, dry))
        data = mujoco.MjData(model)
        data.qvel[0] = 2.0
        mujoco.mj_step(model, data, 100)
        return float(data.qvel[0])
    pipeline, model = importlib.import_module(f"brax.{name}.pipeline"), mjcf.loads(text(damping, dry))
    state, step = pipeline.init(model, jnp.zeros(1), jnp.array([2.0])), jax.jit(pipeline.step)
    for _ in range(100):
        state = step(model, state, jnp.zeros(0))
    return float(state.qd[0])


for name, dry_counts, damping_counts in (
    ("mujoco", True, True),
    ("generalized", False, True),
    ("spring", False, False),
    ("positional", False, False),
):
    free, dry, damped = (speed(name, *values) for values in ((0, 0), (0, 5), (2, 0)))
    print(f"{name}: free {free:.4f}, frictionloss=5 {dry:.4f}, damping=2 {damped:.4f} rad/s")
    for value, counts in ((dry, dry_counts), (damped, damping_counts)):
        if (value != free) != counts or (counts and value > free - 0.5):
            raise SystemExit("changed")
try:
    mjcf.loads(text(0, 0, cone="elliptic"))
except NotImplementedError as error:
    print(f"cone=elliptic: {error}")
else:
    raise SystemExit("changed: elliptic cones are read")
PY
