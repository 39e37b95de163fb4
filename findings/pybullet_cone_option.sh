#!/bin/sh
# Library: PyBullet 3.2.7 (Bullet 3), setPhysicsEngineParameter(enableConeFriction=0)
#
# Friction is a cone by default; enableConeFriction=0 limits it along two axes instead. It changes
# more than that:
#   - spinningFriction then does nothing: a ball that spins on the spot keeps its 20 rad/s, where the
#     cone stops it with a torque of 0.005 m times the weight. rollingFriction acts in both modes;
#   - a cube that slides at 30 degrees is braked with 0.5 of its weight along each axis in steps of
#     1 ms, as its coefficient says, but with 0.62 in steps of 0.1 or 0.2 ms. With the cone the step
#     has no such effect;
#   - resetSimulation switches the cone on again without a message.
set -eu
dir=$(mktemp -d)
trap 'rm -rf "$dir"' EXIT
python3 -m venv "$dir/venv"
"$dir/venv/bin/pip" install -q --disable-pip-version-check pybullet==3.2.7 numpy==1.26.4
"$dir/venv/bin/python" - <<'PY'
import numpy as np
import pybullet as bullet

bullet.connect(bullet.DIRECT)


def world(shape, dt, cone, **surface):
    """A body of 1 kg at rest on a floor; `cone` is left as resetSimulation leaves it if None."""
    bullet.resetSimulation()
    bullet.setGravity(0, 0, -9.81)
    bullet.setTimeStep(dt)
    if cone is not None:
        bullet.setPhysicsEngineParameter(enableConeFriction=cone)
    floor = bullet.createCollisionShape(bullet.GEOM_BOX, halfExtents=[20, 20, 1])
    floor = bullet.createMultiBody(0, floor, basePosition=[0, 0, -1])
    body = bullet.createMultiBody(1.0, shape(), basePosition=[0, 0, 0.1])
    bullet.changeDynamics(floor, -1, lateralFriction=1.0, spinningFriction=0, rollingFriction=0)
    free = {"linearDamping": 0, "angularDamping": 0}
    bullet.changeDynamics(body, -1, lateralFriction=0.5, **free, **surface)
    for _ in range(round(0.2 / dt)):
        bullet.stepSimulation()
    return body


def cube():
    return bullet.createCollisionShape(bullet.GEOM_BOX, halfExtents=[0.1, 0.1, 0.1])


def ball():
    return bullet.createCollisionShape(bullet.GEOM_SPHERE, radius=0.1)


def spun(cone):
    """Torque over the weight in m that brakes a spinning ball, whose inertia is 0.004 kg m^2."""
    body = world(ball, 1e-3, cone, spinningFriction=0.005)
    bullet.resetBaseVelocity(body, [0, 0, 0], [0, 0, 20])
    for _ in range(50):
        bullet.stepSimulation()
    return (20 - bullet.getBaseVelocity(body)[1][2]) / 0.05 * 0.004 / 9.81


def braked(cone, dt):
    """Mean braking force over the weight along both axes in 50 ms."""
    body = world(cube, dt, cone)
    start = 2.0 * np.array([np.cos(np.pi / 6), 0.5, 0.0])
    bullet.resetBaseVelocity(body, start.tolist(), [0, 0, 0])
    for _ in range(round(0.05 / dt)):
        bullet.stepSimulation()
    return (start - bullet.getBaseVelocity(body)[0])[:2] / (0.05 * 9.81)


for cone, expected in ((1, 0.005), (0, 0.0)):
    print(f"enableConeFriction={cone}: spinning ball, torque {spun(cone):.5f} m times the weight")
    assert abs(spun(cone) - expected) < 1e-5, "changed"
for cone, dt, expected in (
    (None, 1e-3, (0.433, 0.25)),
    (1, 1e-3, (0.433, 0.25)),
    (1, 1e-4, (0.433, 0.25)),
    (0, 1e-3, (0.5, 0.5)),
    (0, 2e-4, (0.625, 0.625)),
    (0, 1e-4, (0.615, 0.615)),
    # After runs without the cone.
    (None, 1e-3, (0.433, 0.25)),
):
    found = braked(cone, dt)
    what = "as resetSimulation leaves it" if cone is None else cone
    print(f"enableConeFriction {what}, step {dt}: {found.round(3).tolist()} of the weight")
    assert np.abs(found - expected).max() < 8e-3, "changed"
PY
