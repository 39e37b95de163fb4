#!/bin/sh
# Where two meet: MuJoCo's model files (MJCF) and Brax 0.14.2
#
# Brax's validate_model, "compatible with brax physics pipelines", refuses elliptic cones, impratio, wind
# and more with NotImplementedError. Dry friction of a joint (frictionloss) passes, and none of the
# pipelines generalized, spring and positional uses it: an arm on a hinge that 5 N m brake from 2 to 0.09
# rad/s within 0.1 s in MuJoCo turns on as without them. The joint's damping is used by generalized
# only: the other two have the same speed, to the last bit, with damping="2" and "0".
set -eu
dir=$(mktemp -d)
trap 'rm -rf "$dir"' EXIT
python3 -m venv "$dir/venv"
"$dir/venv/bin/pip" install -q --disable-pip-version-check brax==0.14.2 mujoco==4.0.0 \
    mujoco-mjx==3.17.0 jax==0.10.2 numpy==2.4.6
JAX_PLATFORMS=cpu "$dir/venv/bin/python" -W ignore - <<'PY'
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


compiled = {}
for name in ("generalized", "spring", "positional"):
    pipeline = importlib.import_module(f"brax.{name}.pipeline")
    compiled[name] = jax.jit(pipeline.init), jax.jit(pipeline.step)


def speed(name, damping, dry):
    """Speed in rad/s after 0.1 s from 2 rad/s."""
    if name == "mujoco":
        model = mujoco.MjModel.from_xml_string(text(damping, dry))
        data = mujoco.MjData(model)
        data.qvel[0] = 2.0
        mujoco.mj_step(model, data, 100)
        return float(data.qvel[0])
    # Without the MuJoCo model the pipeline is compiled once for all numbers.
    model = mjcf.loads(text(damping, dry)).replace(mj_model=None)
    init, step = compiled[name]
    state = init(model, jnp.zeros(1), jnp.array([2.0]))
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
mjcf.validate_model(mujoco.MjModel.from_xml_string(text(2, 5)))
try:
    mjcf.validate_model(mujoco.MjModel.from_xml_string(text(0, 0, cone="elliptic")))
except NotImplementedError as error:
    print(f"cone=elliptic: {error}")
else:
    raise SystemExit("changed: elliptic cones pass")
PY
