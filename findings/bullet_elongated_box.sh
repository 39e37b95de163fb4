#!/bin/sh
# Library: PyBullet 3.2.7 (Bullet 3), rigid bodies of createMultiBody
#
# With enableConeFriction=1 a cube has Coulomb's isotropic friction, opposite to the slip. A box of
# 0.4 m x 0.2 m x 0.2 m on its long side has not, though it slides without turning: where it slips along
# 15, 30, 45, 60 and 75 degrees, friction is along 7.1, 15.1, 25.2, 39.5 and 60.9 degrees, with the right
# size, 0.5 of the weight. Steps of 0.2 ms do not change it (25.2 at 45). The shape of the body, which
# has no part in Coulomb's law, turns the force by up to 20 degrees. Without the cone (the default) both
# have the corner of a square: 45 degrees and 0.707 of the weight.
set -eu
dir=$(mktemp -d)
trap 'rm -rf "$dir"' EXIT
python3 -m venv "$dir/venv"
"$dir/venv/bin/pip" install -q --disable-pip-version-check pybullet==3.2.7 numpy==1.26.4
"$dir/venv/bin/python" - <<'PY'
import numpy as np
import pybullet as bullet

bullet.connect(bullet.DIRECT)


def friction(angle, half, cone, dt=1e-3):
    """Direction in degrees and size over the weight of the mean braking force in 50 ms."""
    bullet.resetSimulation()
    bullet.setGravity(0, 0, -9.81)
    bullet.setPhysicsEngineParameter(enableConeFriction=cone, fixedTimeStep=dt)
    ground = bullet.createCollisionShape(bullet.GEOM_BOX, halfExtents=[20, 20, 1])
    ground = bullet.createMultiBody(0, ground, basePosition=[0, 0, -1])
    box = bullet.createCollisionShape(bullet.GEOM_BOX, halfExtents=half)
    box = bullet.createMultiBody(1.0, box, basePosition=[0, 0, half[2]])
    bullet.changeDynamics(box, -1, lateralFriction=0.5, linearDamping=0, angularDamping=0)
    bullet.changeDynamics(ground, -1, lateralFriction=1.0)
    for _ in range(200):
        bullet.stepSimulation()
    start = 2.0 * np.array([np.cos(np.radians(angle)), np.sin(np.radians(angle)), 0.0])
    bullet.resetBaseVelocity(box, start.tolist(), [0, 0, 0])
    for _ in range(round(0.05 / dt)):
        bullet.stepSimulation()
    assert np.linalg.norm(bullet.getBaseVelocity(box)[1]) < 0.05, "the box turns"
    x, y, _ = (start - bullet.getBaseVelocity(box)[0]) / (0.05 * 9.81)
    return np.degrees(np.arctan2(y, x)), np.hypot(x, y)


angles = [15.0, 30.0, 45.0, 60.0, 75.0]
for name, half, cone, expected, size in (
    ("cube, cone", [0.1, 0.1, 0.1], 1, angles, 0.5),
    ("long box, cone", [0.2, 0.1, 0.1], 1, [7.1, 15.1, 25.2, 39.5, 60.9], 0.5),
    ("long box, no cone", [0.2, 0.1, 0.1], 0, [45.0] * 5, 0.7071),
):
    found, sizes = np.transpose([friction(angle, half, cone) for angle in angles])
    print(f"{name}: slip {angles}, friction {found.round(1).tolist()}, {sizes.round(3).tolist()}")
    assert np.abs(found - expected).max() < 0.2, f"changed: {expected} degrees expected"
    assert np.abs(sizes - size).max() < 2e-3, f"changed: {size} of the weight expected"
assert abs(friction(45.0, [0.2, 0.1, 0.1], 1, dt=2e-4)[0] - 25.2) < 0.3, "changed with the step"
PY
