#!/bin/sh
# Library: pyNastran 1.4.1 (OP4, matrices of Nastran)
#
# 1. OP4.write_op4 writes binary by default. What it writes of a dense matrix, its own read_op4
#    refuses ("unpack requires a buffer of ... bytes"), and where a column has zeros at its ends, as
#    in every tridiagonal or diagonal matrix, writing fails already ("pack expected 2 items").
#    With is_binary=False the same matrices come back to the last bit.
# 2. Form 6, "symmetric", is stored and not looked at: one triangle comes back as one triangle with
#    the form 6, and so does a matrix that is not symmetric.
#
# Whoever exchanges K and M this way has to write text, and to mirror triangles with care.
set -eu
dir=$(mktemp -d)
trap 'rm -rf "$dir"' EXIT
python3 -m venv "$dir/venv"
"$dir/venv/bin/pip" install -q --disable-pip-version-check pyNastran==1.4.1 numpy==1.26.4 scipy==1.17.1
cd "$dir"
"$dir/venv/bin/python" - <<'PY'
import struct

import numpy as np
from pyNastran.op4.op4 import OP4, read_op4

full = np.array([[6.0, 1.0, 2.0], [1.0, 6.0, 1.0], [2.0, 1.0, 6.0]])
chain = np.array([[2.0, -1.0, 0.0], [-1.0, 2.0, -1.0], [0.0, -1.0, 2.0]])


def there_and_back(matrix, **options):
    OP4(debug=False).write_op4("k.op4", {"K": (6, matrix)}, **options)
    found = read_op4("k.op4", debug=False)["K"]
    return found.form, found.data


for name, matrix in (("full", full), ("tridiagonal", chain), ("identity", np.eye(3))):
    try:
        there_and_back(matrix)
    except (struct.error, MemoryError) as error:
        print(f"binary, {name}: {type(error).__name__}: {error}")
    else:
        raise SystemExit(f"changed: the binary file of the {name} matrix is read")
    assert np.array_equal(there_and_back(matrix, is_binary=False)[1], matrix), "changed: text"
    print(f"text, {name}: equal to the last bit")

for name, matrix in (("upper triangle", np.triu(full)), ("unsymmetric", full + np.triu(full, 1))):
    form, data = there_and_back(matrix, is_binary=False)
    assert form == 6 and np.array_equal(data, matrix), f"changed: {name} as form 6 gives {data}"
    print(f"form 6, {name}: comes back unchanged as form {form}, {data.tolist()}")
PY
