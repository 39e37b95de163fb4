#!/bin/sh
# Library: PyBullet 3.2.7 (Bullet 3), getContactPoints
#
# getContactPoints(A, B) has the normal, "on B, pointing towards A", and two friction directions with
# the forces along them. Asked for (box, floor) and for (floor, box), the normal changes its sign; the
# friction vectors do not. So with one of the two orders normal and friction force are of different
# bodies. A box that slides along +x on a box is braked by -4.9 N and held by +9.81 N; what is reported
# is (+4.9, +9.8) for (box, floor) and (+4.9, -9.8) for (floor, box): the pair of forces on the box
# itself is in neither. If the floor is GEOM_PLANE, it is (-4.9, +9.8) and (-4.9, -9.8), so the right
# order depends on the shape of the floor.
set -eu
dir=$(mktemp -d)
trap 'rm -rf "$dir"' EXIT
python3 -m venv "$dir/venv"
"$dir/venv/bin/pip" install -q --disable-pip-version-check pybullet==3.2.7 numpy==1.26.4
"$dir/venv/bin/python" - <<'PY'
import numpy as np
import pybullet as bullet

bullet.connect(bullet.DIRECT)


def total(points):
    """Sum over the contact points of normal and friction force along x and z."""
    force = np.zeros(3)
    for point in points:
        for size, along in ((9, 7), (10, 11), (12, 13)):
            force += point[size] * np.array(point[along])
    return force[[0, 2]]


for name, place in (("box", -1.0), ("plane", 0.0)):
    bullet.resetSimulation()
    bullet.setGravity(0, 0, -9.81)
    bullet.setTimeStep(1e-3)
    floor = {
        "box": lambda: bullet.createCollisionShape(bullet.GEOM_BOX, halfExtents=[20, 20, 1]),
        "plane": lambda: bullet.createCollisionShape(bullet.GEOM_PLANE),
    }[name]()
    floor = bullet.createMultiBody(0, floor, basePosition=[0, 0, place])
    box = bullet.createCollisionShape(bullet.GEOM_BOX, halfExtents=[0.1, 0.1, 0.1])
    box = bullet.createMultiBody(1.0, box, basePosition=[0, 0, 0.1])
    bullet.changeDynamics(floor, -1, lateralFriction=1.0)
    bullet.changeDynamics(box, -1, lateralFriction=0.5, linearDamping=0, angularDamping=0)
    for _ in range(200):
        bullet.stepSimulation()
    bullet.resetBaseVelocity(box, [2, 0, 0], [0, 0, 0])
    rows = np.zeros((2, 2))
    for _ in range(50):
        bullet.stepSimulation()
        rows += [total(bullet.getContactPoints(*two)) for two in ((box, floor), (floor, box))]
    rows /= 50
    braked = (bullet.getBaseVelocity(box)[0][0] - 2) / 0.05
    print(f"floor {name}: force on the box {braked:.2f} N along x, 9.81 N along z; reported")
    print(f"  for (box, floor) {rows[0].round(2).tolist()}, for (floor, box) {rows[1].round(2).tolist()}")
    sign = 1.0 if name == "box" else -1.0
    assert abs(braked + 4.9) < 0.2, "changed"
    assert np.abs(rows - np.array([[4.9 * sign, 9.8], [4.9 * sign, -9.8]])).max() < 0.3, "changed"
PY
