#!/bin/sh
# Library: omi-physics 0.4.0, Material(staticFriction=..., dynamicFriction=...)
#
# The static coefficient is not used. A flat box at rest, of 1 kg, with staticFriction=0.9 and
# dynamicFriction=0.3 is pushed with half of its weight, which static friction holds. It starts at
# once and has 0.98 m/s after 0.5 s, exactly what dynamic friction alone leaves: (0.5 - 0.3) g t. With
# 0.9 for both it stays at rest.
set -eu
dir=$(mktemp -d)
trap 'rm -rf "$dir"' EXIT
python3 -m venv "$dir/venv"
"$dir/venv/bin/pip" install -q --disable-pip-version-check omi-physics==0.4.0 numpy==2.4.6
"$dir/venv/bin/python" - <<'PY'
import omi_physics
from omi_physics.model import Collider, Material, Motion, Shape


def speed(static, dynamic):
    """Speed in m/s after half a second under half of the weight."""
    world = omi_physics.PhysicsWorld(
        sleep_enabled=False, fixed_dt=1e-3, backend=omi_physics.NumpyBackend()
    )
    surface = world.add_material(Material(static, dynamic))
    floor, box = (world.add_shape(Shape.box(size)) for size in ((40, 2, 40), (0.4, 0.1, 0.4)))
    world.add_body(Motion(type="static"), Collider(floor, surface), position=(0, -1, 0))
    moves = Motion(type="dynamic", mass=1.0)
    body = world.add_body(moves, Collider(box, surface), position=(0, 0.05, 0))
    for _ in range(200):
        world.step(1e-3)
    for _ in range(500):
        world.set_force(body, (0.5 * 9.81, 0, 0))
        world.step(1e-3)
    return float(world.linear_velocity[body][0])


for static, dynamic, expected in ((0.9, 0.3, 0.2 * 9.81 * 0.5), (0.9, 0.9, 0.0)):
    found = speed(static, dynamic)
    print(f"staticFriction={static}, dynamicFriction={dynamic}: {found:.3f} m/s")
    assert abs(found - expected) < 5e-3, "changed"
PY
