#!/bin/sh
# Library: NumPy 2.4.6 (ufunc.at with values that broadcast to two-dimensional indices)
#
# np.add.at(a, indices, values) broadcasts the values to the shape of the indices. With one-
# dimensional a, indices of shape (60, 3) and values of shape (3,) it reads beyond the end of the
# values instead: the sums hold what lies in memory there, without a word.
#
# Whoever adds one vector to many nodes has to broadcast it first: then the sums are right.
set -eu
dir=$(mktemp -d)
trap 'rm -rf "$dir"' EXIT
python3 -m venv "$dir/venv"
"$dir/venv/bin/pip" install -q --disable-pip-version-check numpy==2.4.6
"$dir/venv/bin/python" - <<'PY'
import numpy as np

places, values = np.arange(180).reshape(60, 3), np.array([0.0, 0.0, -50.0])
expected = np.tile(values, 60)
for name, given in (("broadcast by add.at", values), ("broadcast before", np.tile(values, (60, 1)))):
    sums = np.zeros(180)
    np.add.at(sums, places, given)
    wrong = int((sums != expected).sum())
    print(f"{name}: {wrong} of 180 sums are wrong")
    if (wrong > 0) != (given is values):
        raise SystemExit("changed")
PY
