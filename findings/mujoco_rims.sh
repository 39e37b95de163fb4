#!/bin/sh
# Library: MuJoCo 4.0.0, collision of a cylinder with a capsule
#
# A rod lies along a radius over the rim of a disk, tilted by 4 degrees and 0.1 mm too low. MuJoCo makes
# several contacts of edges that nearly lie on each other (multiccd, on unless a model disables it), and
# takes the rim as a polygon of 16 corners for them: with the disk turned by 0 and 3 degrees its deepest
# contact is 0.100 and 0.038 mm deep, by 7 and 11.25 degrees even that is 0.015 and 0.034 mm apart, as a
# polygon is r (1 - cos(pi/16)) sin 4 degrees = 0.134 mm farther away at the middle of a side. With
# multiccd disabled, and by mj_geomDistance, it is 0.0998 mm deep in all four.
#
# What holds gaps at zero lets the rod into the disk, in and out again as the disk turns.
set -eu
dir=$(mktemp -d)
trap 'rm -rf "$dir"' EXIT
python3 -m venv "$dir/venv"
"$dir/venv/bin/pip" install -q --disable-pip-version-check mujoco==4.0.0 numpy==1.26.4
"$dir/venv/bin/python" - <<'PY'
import mujoco
import numpy as np

TILT, RADIUS, HALF, ROD, LOW = np.deg2rad(4.0), 0.1, 0.004, 0.02, 1e-4


def distances(turn, more=""):
    """Least distance in mm, of contacts and by mj_geomDistance."""
    height = HALF + ROD / np.cos(TILT) - LOW
    model = mujoco.MjModel.from_xml_string(
        f"<mujoco><option>{more}</option><worldbody>"
        f'<geom type="cylinder" size="{RADIUS} {HALF}" margin="1e-4" euler="0 0 {turn}"/>'
        f'<body pos="{-RADIUS} 0 {height}"><freejoint/><geom type="capsule" size="{ROD} .08"'
        ' margin="1e-4" euler="0 86 0"/></body></worldbody></mujoco>'
    )
    data = mujoco.MjData(model)
    mujoco.mj_forward(model, data)
    nearest = mujoco.mj_geomDistance(model, data, 0, 1, 1.0, None)
    return 1e3 * data.contact.dist.min(), 1e3 * nearest


true = -1e3 * LOW * np.cos(TILT)
for turn, seen in [(0.0, -0.1002), (3.0, -0.0376), (7.0, 0.0152), (11.25, 0.0341)]:
    several, nearest = distances(turn)
    one, _ = distances(turn, '<flag multiccd="disable"/>')
    print(
        f"disk turned by {turn:g} degrees: {several:.4f} mm by contacts, {one:.4f} mm without"
        f" multiccd, {nearest:.4f} mm by mj_geomDistance, {true:.4f} mm true"
    )
    assert abs(one - true) < 1e-3 and abs(nearest - true) < 1e-3
    assert abs(several - seen) < 1e-3, "changed: rims are no polygons of 16 corners any more"
PY
