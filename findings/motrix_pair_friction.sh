#!/bin/sh
# Library: motrixsim-core 0.10.1, MJCF <pair friction="a b ...">
#
# The first two numbers of a contact pair are the coefficients along its two tangents. motrixsim reads
# the pair but not its second number: a box that slides with friction "0.9 0.3" is braked with 0.9 of
# its weight along both axes, and with "0.3 0.9" with 0.3 along both. There is no message about it,
# though the reader warns of other fields that it ignores, such as cone.
set -eu
dir=$(mktemp -d)
trap 'rm -rf "$dir"' EXIT
python3 -m venv "$dir/venv"
"$dir/venv/bin/pip" install -q --disable-pip-version-check motrixsim-core==0.10.1 numpy==2.4.6
"$dir/venv/bin/python" - <<'PY'
import motrixsim
import numpy as np


def braked(friction, axis):
    """Mean braking force over the weight in 50 ms along an axis."""
    model = motrixsim.load_mjcf_str(
        '<mujoco><option timestep="0.001" gravity="0 0 -9.81"/><worldbody>'
        '<geom name="floor" type="plane" size="5 5 1"/><body pos="0 0 .1"><freejoint/>'
        '<geom name="box" type="box" size=".1 .1 .1" mass="1"/></body></worldbody><contact>'
        f'<pair geom1="floor" geom2="box" friction="{friction} .005 .0001 .0001"/>'
        "</contact></mujoco>"
    )
    data = motrixsim.SceneData(model)
    for _ in range(200):
        motrixsim.step(model, data)
    start = 2.0 * np.eye(6)[axis]
    data.set_dof_vel(start.astype(data.dof_vel.dtype))
    for _ in range(50):
        motrixsim.step(model, data)
    return float(start[axis] - data.dof_vel[axis]) / (0.05 * 9.81)


for friction, expected in (("0.9 0.3", 0.9), ("0.3 0.9", 0.3)):
    found = [braked(friction, axis) for axis in (0, 1)]
    print(f'friction="{friction} ...": {np.round(found, 3).tolist()} of the weight along x and y')
    assert np.abs(np.array(found) - expected).max() < 5e-3, "changed"
PY
