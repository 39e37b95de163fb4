#!/bin/sh
# Where two meet: the SDF file of Gazebo, Drake 1.51.1 and DART (dartpy 6.20.0)
#
# <mu> and <mu2> of a collision are two coefficients of friction, along two directions. Of one file,
# valid in both programs,
#   - Drake takes mu for the static and mu2 for the dynamic coefficient of an isotropic law. So
#     mu = 0.3 with mu2 = 0.6 is an error, "dynamic friction must be less than or equal to static
#     friction", and mu = 0.3 alone as well: the missing mu2 counts as 1;
#   - DART's reader leaves friction out without a message: the coefficient is 1.0 in all cases.
set -eu
dir=$(mktemp -d)
trap 'rm -rf "$dir"' EXIT
python3 -m venv "$dir/venv"
"$dir/venv/bin/pip" install -q --disable-pip-version-check drake==1.51.1 dartpy==6.20.0 numpy==2.4.6
cd "$dir"
cat > read.py <<'PY'
import pathlib
import sys

TEXT = """<sdf version="1.6"><model name="box"><link name="body"><inertial><mass>1</mass><inertia>
<ixx>1</ixx><iyy>1</iyy><izz>1</izz><ixy>0</ixy><ixz>0</ixz><iyz>0</iyz></inertia></inertial>
<collision name="c"><geometry><box><size>0.2 0.2 0.2</size></box></geometry>
<surface><friction><ode>{}</ode></friction></surface></collision></link></model></sdf>"""
path = pathlib.Path("box.sdf").resolve()

def drake():
    from pydrake.all import AddMultibodyPlantSceneGraph, DiagramBuilder, Parser

    plant, scene = AddMultibodyPlantSceneGraph(DiagramBuilder(), 1e-3)
    try:
        Parser(plant).AddModels(str(path))
    except RuntimeError as error:
        return str(error)
    (geometry,) = plant.GetCollisionGeometriesForBody(plant.GetBodyByName("body"))
    law = scene.model_inspector().GetProximityProperties(geometry)
    law = law.GetProperty("material", "coulomb_friction")
    return {"static": law.static_friction(), "dynamic": law.dynamic_friction()}

def dart():
    from dartpy.utils import SdfParser

    body = SdfParser.readSkeleton(str(path)).getBodyNode(0)
    (shape,) = (node for node in body.getShapeNodes() if node.hasDynamicsAspect())
    return shape.getDynamicsAspect().getFrictionCoeff()


refused = "dynamic friction must be less than or equal"
for text, expected in (
    ("<mu>0.6</mu><mu2>0.3</mu2>", {"static": 0.6, "dynamic": 0.3}),
    ("<mu>0.3</mu><mu2>0.6</mu2>", refused),
    ("<mu>0.3</mu>", refused),
):
    path.write_text(TEXT.format(text))
    found = {"drake": drake, "dart": dart}[sys.argv[1]]()
    print(f"{sys.argv[1]}, {text}: {found}")
    assert found == 1.0 if sys.argv[1] == "dart" else str(expected) in str(found), "changed"
PY
# One process each: the two bring libraries of their own.
"$dir/venv/bin/python" read.py drake
"$dir/venv/bin/python" read.py dart
