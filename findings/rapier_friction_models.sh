#!/bin/sh
# Library: Rapier (rapier3d 0.36.1 from PyPI), FrictionModel.SIMPLIFIED (default) and COULOMB
#
# The friction of a box of 1 kg that slides without turning, with the coefficient 0.5, depends on its
# shape and, with COULOMB, on the direction of sliding, though Coulomb's law knows neither:
#   - along 15, 30, 45, 60 and 75 degrees, the force on a box of 0.4 m x 0.2 m x 0.2 m is along 10.0,
#     20.8, 33.3, 48.8 and 68.0 degrees (COULOMB: 5.6, 12.6, 23.1, 41.4 and 67.9);
#   - with COULOMB the force on a cube is along 11.2, 25.9, 45.0, 64.2 and 79.3 degrees, and sliding
#     along an axis it has 0.468 of the weight instead of 0.5. SIMPLIFIED has both right for the cube.
# Steps of 0.2 ms instead of 1 ms change these numbers by less than 0.1 degrees (box, SIMPLIFIED).
set -eu
dir=$(mktemp -d)
trap 'rm -rf "$dir"' EXIT
python3 -m venv "$dir/venv"
"$dir/venv/bin/pip" install -q --disable-pip-version-check rapier3d==0.36.1 numpy==2.4.6
"$dir/venv/bin/python" - <<'PY'
import numpy as np
from rapier3d import Collider, FrictionModel, PhysicsWorld, RigidBody

CUBE, LONG = (0.1, 0.1, 0.1), (0.2, 0.1, 0.1)


def friction(model, half, angle, dt=1e-3):
    """Direction in degrees and size over the weight of the mean braking force in 50 ms."""
    world = PhysicsWorld(gravity=(0, 0, -9.81))
    world.integration_parameters.dt = dt
    world.integration_parameters.friction_model = model
    floor = Collider.cuboid(50, 50, 1, friction=0.5)
    world.add_body(RigidBody.fixed(translation=(0, 0, -1)), colliders=[floor])
    box = Collider.cuboid(*half, density=0.125 / np.prod(half), friction=0.5)
    body = RigidBody.dynamic(translation=(0, 0, half[2]), can_sleep=False)
    handle = world.add_body(body, colliders=[box])
    for _ in range(round(0.2 / dt)):
        world.step()
    start = 2.0 * np.array([np.cos(np.radians(angle)), np.sin(np.radians(angle))])
    world.rigid_bodies[handle].linvel = (*start, 0.0)
    world.rigid_bodies[handle].angvel = (0.0, 0.0, 0.0)
    for _ in range(round(0.05 / dt)):
        world.step()
    end = world.rigid_bodies[handle].linvel
    x, y = (start - [end.x, end.y]) / (0.05 * 9.81)
    return np.degrees(np.arctan2(y, x)), np.hypot(x, y)


angles = [15.0, 30.0, 45.0, 60.0, 75.0]
for model, name, half, expected in (
    (FrictionModel.SIMPLIFIED, "cube", CUBE, angles),
    (FrictionModel.SIMPLIFIED, "long box", LONG, [9.96, 20.75, 33.35, 48.83, 67.98]),
    (FrictionModel.COULOMB, "cube", CUBE, [11.21, 25.92, 45.0, 64.15, 79.31]),
    (FrictionModel.COULOMB, "long box", LONG, [5.59, 12.63, 23.10, 41.38, 67.88]),
):
    found = np.array([friction(model, half, angle)[0] for angle in angles])
    print(f"{model}, {name}: slip {angles}, friction {found.round(1).tolist()} degrees")
    assert np.abs(found - expected).max() < 0.2, "changed"
for model, expected in ((FrictionModel.SIMPLIFIED, 0.5), (FrictionModel.COULOMB, 0.468)):
    size = friction(model, CUBE, 0.0)[1]
    print(f"{model}, cube along an axis: {size:.3f} of the weight")
    assert abs(size - expected) < 2e-3, "changed"
small = friction(FrictionModel.SIMPLIFIED, LONG, 45.0, dt=2e-4)[0]
print(f"long box at 45 degrees in steps of 0.2 ms: {small:.1f} degrees")
assert abs(small - 33.35) < 0.1, "changed with the step"
PY
