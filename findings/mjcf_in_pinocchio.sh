#!/bin/sh
# Where two meet: MuJoCo's model files (MJCF) and Pinocchio 4.1.0
#
# buildModelFromMJCF reads joints, masses and shapes. Of a free box on a floor, without a message,
#   - friction and condim are left out: no friction is found in the model or the geometry;
#   - no pair of shapes is marked for collision, where MuJoCo has the pair of box and floor;
#   - the position of the free joint gets limits of -1.01 and 1.01, which are those of a quaternion:
#     1.01 m in space. The floating joint of a URDF file is unlimited in its position.
# A box at z = 2 m is thus outside the limits of its model.
set -eu
dir=$(mktemp -d)
trap 'rm -rf "$dir"' EXIT
python3 -m venv "$dir/venv"
"$dir/venv/bin/pip" install -q --disable-pip-version-check pin==4.1.0 mujoco==4.0.0 numpy==2.4.6
cd "$dir"
"$dir/venv/bin/python" - <<'PY'
import pathlib

import mujoco
import numpy as np
import pinocchio

pathlib.Path("box.xml").write_text(
    '<mujoco><worldbody><geom name="floor" type="plane" size="5 5 1" friction="0.9"/>'
    '<body name="box" pos="0 0 0.1"><freejoint/><geom name="box" type="box" size="0.1 0.1 0.1" '
    'mass="1" friction="0.3 0.02 0.001" condim="6"/></body></worldbody></mujoco>'
)
pathlib.Path("box.urdf").write_text(
    '<robot name="r"><link name="world"/><link name="box"><inertial><mass value="1"/><inertia '
    'ixx="1" iyy="1" izz="1" ixy="0" ixz="0" iyz="0"/></inertial></link><joint name="free" '
    'type="floating"><parent link="world"/><child link="box"/></joint></robot>'
)
original = mujoco.MjModel.from_xml_path("box.xml")
data = mujoco.MjData(original)
data.qpos[2] = 0.0999
mujoco.mj_forward(original, data)
print(f"MuJoCo: {data.ncon} contacts, friction {data.contact.friction[0].tolist()}")

model = pinocchio.buildModelFromMJCF("box.xml")
shapes = pinocchio.buildGeomFromMJCF(model, "box.xml", pinocchio.GeometryType.COLLISION)
names = [shape.name for shape in shapes.geometryObjects]
words = {word for shape in shapes.geometryObjects for word in dir(shape.physicsMaterial)}
print(f"Pinocchio: shapes {names}, {len(shapes.collisionPairs)} pairs to collide")
assert names == ["floor", "box"] and not shapes.collisionPairs, "changed: no pairs"
assert not any("friction" in word for word in words), "changed: shapes have friction"
limits = model.upperPositionLimit[:3]
urdf = pinocchio.buildModelFromUrdf("box.urdf").upperPositionLimit[:3]
print(f"upper limits of the position: MJCF {limits.tolist()}, URDF {urdf.tolist()}")
assert np.allclose(limits, 1.01) and np.isinf(urdf).all(), "changed: limits"
PY
