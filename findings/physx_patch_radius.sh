#!/bin/sh
# Library: PhysX 5.3.1 in SAPIEN 3.0.3
#
# A ball of radius 0.1 m with the coefficient 0.5 spins on the spot on a plane. Its torsional patch
# friction
#   - is there with min_patch_radius=0.02: a torque of 0.01 m times the weight, the coefficient times
#     that radius, whether patch_radius is set or not;
#   - is not there with patch_radius=0.02 alone: the ball keeps its 20 rad/s;
#   - is not there at all with enable_tgs=False: the ball spins on, whatever the two radii.
set -eu
dir=$(mktemp -d)
trap 'rm -rf "$dir"' EXIT
python3 -m venv "$dir/venv"
"$dir/venv/bin/pip" install -q --disable-pip-version-check sapien==3.0.3
"$dir/venv/bin/python" - <<'PY'
import warnings

import numpy as np

warnings.simplefilter("ignore")
import sapien
from sapien import physx


def torque(tgs, patch, least):
    """Torque over the weight in m that brakes the ball, whose inertia is 0.004 kg m^2."""
    physx.set_scene_config(gravity=np.array([0, 0, -9.81]), enable_tgs=tgs)
    scene = sapien.Scene([physx.PhysxCpuSystem()])
    scene.set_timestep(1e-3)
    surface = physx.PhysxMaterial(0.5, 0.5, 0.0)
    builder = scene.create_actor_builder()
    upright = sapien.Pose(q=[0.5**0.5, 0, -(0.5**0.5), 0])
    builder.add_plane_collision(upright, material=surface)
    builder.build_static("floor")
    builder = scene.create_actor_builder()
    builder.add_sphere_collision(
        radius=0.1,
        material=surface,
        density=750.0 / np.pi,
        patch_radius=patch,
        min_patch_radius=least,
    )
    builder.set_initial_pose(sapien.Pose([0, 0, 0.1]))
    ball = builder.build("ball").find_component_by_type(physx.PhysxRigidDynamicComponent)
    ball.linear_damping = ball.angular_damping = 0.0
    for _ in range(200):
        scene.step()
    ball.set_angular_velocity([0, 0, 20])
    for _ in range(50):
        scene.step()
    return (20 - ball.get_angular_velocity()[2]) / 0.05 * 0.004 / 9.81


for tgs, patch, least, expected in (
    (True, 0.0, 0.02, 0.01),
    (True, 0.02, 0.02, 0.01),
    (True, 0.02, 0.0, 0.0),
    (False, 0.0, 0.02, 0.0),
    (False, 0.02, 0.02, 0.0),
):
    found = torque(tgs, patch, least)
    print(f"enable_tgs={tgs}, patch_radius={patch}, min_patch_radius={least}: {found:.5f} m")
    assert abs(found - expected) < 2e-4, "changed"
PY
