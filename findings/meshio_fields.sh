#!/bin/sh
# Library: meshio 5.3.5
#
# 1. Complex modes, one number per node, cannot be written to .vtu, .vtk and .ply: KeyError, without a
#    word on complex numbers. A Tecplot file (.dat) is written without any message and holds the
#    text (1+2j), which meshio itself cannot read: ValueError.
# 2. Real fields are dropped without an error or a Python warning in .msh and .inp: the mesh alone comes
#    back. The ending .msh is taken for ANSYS's format; with file_format="gmsh" the field is kept.
set -eu
dir=$(mktemp -d)
trap 'rm -rf "$dir"' EXIT
python3 -m venv "$dir/venv"
"$dir/venv/bin/pip" install -q --disable-pip-version-check meshio==5.3.5 numpy==1.26.4
cd "$dir"
"$dir/venv/bin/python" -W error - <<'PY'
import meshio
import numpy as np

points = np.array([[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]])
real = np.array([1.0, 2.0, 3.0])


def mesh(values):
    return meshio.Mesh(points, [("triangle", [[0, 1, 2]])], point_data={"mode": values})


for ending in ("vtu", "vtk", "ply"):
    mesh(real).write(f"real.{ending}")
    assert np.array_equal(meshio.read(f"real.{ending}").point_data["mode"], real), "changed: real"
    try:
        mesh(real * 1j).write(f"complex.{ending}")
    except KeyError as error:
        print(f".{ending}: real values come back, complex ones: KeyError: {error}")
    else:
        raise SystemExit(f"changed: complex values are written to .{ending}")

mesh(real + 2j).write("complex.dat")
try:
    meshio.read("complex.dat")
except ValueError as error:
    print(f".dat: complex values are written; read again: ValueError: {error}")
else:
    raise SystemExit("changed: complex values are read from .dat")

for ending in ("msh", "inp"):
    mesh(real).write(f"real.{ending}")
    found = meshio.read(f"real.{ending}")
    print(f".{ending}: {len(found.points)} points come back, point data {found.point_data}")
    assert len(found.points) == 3 and not found.point_data, f"changed: .{ending} holds fields"
mesh(real).write("gmsh.msh", file_format="gmsh")
assert np.array_equal(meshio.read("gmsh.msh").point_data["mode"], real), "changed: gmsh"
print('.msh with file_format="gmsh": the field comes back')
PY
