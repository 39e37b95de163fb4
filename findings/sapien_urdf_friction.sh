#!/bin/sh
# Where two meet: URDF's <dynamics friction="..."> and SAPIEN 3.0.3 (PhysX 5.3.1)
#
# The number is the Coulomb friction of the joint, in newtons for a slider. SAPIEN's loader keeps damping
# but not this number: joints read from friction="0", "0.5" and "5" all have joint.friction 0.05. That
# is not a force either, it multiplies the load on the joint: a cart of 1 kg on a horizontal slider is
# braked with 0.54 m/s^2 under 1 g, with 1.08 under 2 g and without gravity not at all. Set by hand, 0.5
# brakes with 5.4, 10.8 and 0 m/s^2. The file's 0 has friction, and its 5 N a tenth of it.
set -eu
dir=$(mktemp -d)
trap 'rm -rf "$dir"' EXIT
python3 -m venv "$dir/venv"
"$dir/venv/bin/pip" install -q --disable-pip-version-check sapien==3.0.3 numpy==2.4.6
cd "$dir"
"$dir/venv/bin/python" -W ignore - <<'PY'
from pathlib import Path

import numpy as np
import sapien
from sapien import physx

INERTIA = (
    '<inertial><mass value="1"/><inertia ixx="0.01" iyy="0.01" izz="0.01" ixy="0" ixz="0" '
    'iyz="0"/></inertial>'
)
URDF = (
    f'<robot name="r"><link name="rail">{INERTIA}</link><link name="cart">{INERTIA}</link>'
    '<joint name="slide" type="prismatic"><parent link="rail"/><child link="cart"/>'
    '<axis xyz="1 0 0"/><limit lower="-10" upper="10" effort="100" velocity="100"/>'
    '<dynamics damping="%g" friction="%g"/></joint></robot>'
)


def braked(gravity, damping=0.0, friction=0.0, by_hand=None):
    """Friction and damping of the joint, and the deceleration in 0.1 s from 2 m/s in m/s^2."""
    physx.set_scene_config(gravity=np.array([0.0, 0.0, -gravity]))
    scene = sapien.Scene([physx.PhysxCpuSystem()])
    scene.set_timestep(1e-3)
    Path("cart.urdf").write_text(URDF % (damping, friction))
    loader = scene.create_urdf_loader()
    loader.fix_root_link = True
    robot = loader.load("cart.urdf")
    (joint,) = robot.get_active_joints()
    for link in robot.links:
        link.linear_damping = 0.0
    if by_hand is not None:
        joint.friction = by_hand
    robot.set_qvel(np.array([2.0], dtype=np.float32))
    for _ in range(100):
        scene.step()
    return joint.friction, joint.damping, (2.0 - float(robot.get_qvel()[0])) / 0.1


for friction in (0.0, 0.5, 5.0):
    found = [braked(g, friction=friction) for g in (0.0, 9.81, 19.62)]
    print(f'friction="{friction:g}": joint.friction {found[0][0]:.3f}', end=", braked with ")
    print([round(one[2], 3) for one in found], "m/s^2 under 0, 1 and 2 g")
    assert abs(found[0][0] - 0.05) < 1e-6, "changed: the file's number is used"
    assert np.allclose([one[2] for one in found], [0.0, 0.539, 1.078], atol=0.01), "changed"
found = [braked(g, friction=5.0, by_hand=0.5)[2] for g in (0.0, 9.81, 19.62)]
print(f"joint.friction = 0.5: {np.round(found, 2).tolist()} m/s^2")
assert np.allclose(found, [0.0, 5.39, 10.78], atol=0.05), "changed"
assert braked(0.0, damping=2.0)[1] == 2.0, "changed: damping"
PY
