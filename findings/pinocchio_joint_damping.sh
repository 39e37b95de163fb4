#!/bin/sh
# Where two meet: URDF's <dynamics damping="..." friction="..."> and Pinocchio 4.1.0
#
# buildModelFromUrdf keeps both numbers, in model.damping and model.friction. Neither acts: forward
# dynamics (aba), inverse dynamics (rnea) and the bias (nle) of a slider of 1 kg with damping 2 N s/m and
# friction 5 N that has 2 m/s are those of a slider without: 4 N give 4 m/s^2, where damping alone would
# take all of them. The armature beside them in the model does act: 1 kg of it halves the acceleration.
set -eu
dir=$(mktemp -d)
trap 'rm -rf "$dir"' EXIT
python3 -m venv "$dir/venv"
"$dir/venv/bin/pip" install -q --disable-pip-version-check pin==4.1.0 numpy==2.4.6
"$dir/venv/bin/python" - <<'PY'
import numpy as np
import pinocchio as pin

MASS = (
    '<inertial><mass value="1"/><inertia ixx="1" iyy="1" izz="1" ixy="0" ixz="0" iyz="0"/></inertial>'
)
model = pin.buildModelFromXML(
    f'<robot name="r"><link name="rail"/><link name="cart">{MASS}</link><joint name="slide" '
    'type="prismatic"><parent link="rail"/><child link="cart"/><axis xyz="1 0 0"/><limit lower="-1" '
    'upper="1" effort="9" velocity="9"/><dynamics damping="2" friction="5"/></joint></robot>'
)
q, v, force, even = np.zeros(1), np.array([2.0]), np.array([4.0]), np.zeros(1)
print(f"model.damping {model.damping}, model.friction {model.friction}")
assert model.damping[0] == 2.0 and model.friction[0] == 5.0, "changed: numbers of the file"
data = model.createData()
found = pin.aba(model, data, q, v, force)[0], pin.rnea(model, data, q, v, even)[0]
bias = pin.nle(model, data, q, v)[0]
print(f"at 2 m/s: 4 N give {found[0]:.3f} m/s^2; rnea, speed kept, {found[1]:.3f} N; bias {bias:.3f} N")
assert abs(found[0] - 4.0) < 1e-12 and abs(found[1]) < 1e-12 and abs(bias) < 1e-12, "changed"
model.armature = np.ones(1)
found = pin.aba(model, model.createData(), q, v, force)[0]
print(f"with model.armature = 1: {found:.3f} m/s^2")
assert abs(found - 2.0) < 1e-12, "changed: armature"
PY
