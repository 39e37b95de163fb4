#!/bin/sh
# Library: SciPy 1.17.1, scipy.sparse.linalg.eigs with a real matrix and a complex shift
#
# Modes of a damped structure near a frequency are asked for as the eigenvalues of its real state matrix
# nearest to a complex sigma. With return_eigenvectors=False all six that come back are 0, without a
# warning, for both values of OPpart. With eigenvectors they are eigenvalues, but three of the six
# nearest and their complex conjugates. The same matrix cast to complex gives the six nearest both ways.
set -eu
dir=$(mktemp -d)
trap 'rm -rf "$dir"' EXIT
python3 -m venv "$dir/venv"
"$dir/venv/bin/pip" install -q --disable-pip-version-check numpy==2.4.6 scipy==1.17.1
"$dir/venv/bin/python" -W error - <<'PY'
import numpy as np
from scipy.sparse import block_array, diags_array, eye_array
from scipy.sparse.linalg import eigs

N, SHIFT = 20, -10.0 + 700.0j
K = diags_array([np.full(N - 1, -1e6), np.full(N, 2e6), np.full(N - 1, -1e6)], offsets=[-1, 0, 1])
A = block_array([[None, eye_array(N)], [-K, -1e-5 * K]], format="csc")
every = np.linalg.eigvals(A.toarray())
nearest = every[np.argsort(abs(every - SHIFT))][:6]
print("the six nearest:", np.sort_complex(nearest).round(2).tolist())

for vectors in (False, True):
    for part in ("r", "i"):
        found = eigs(A, k=6, sigma=SHIFT, OPpart=part, return_eigenvectors=vectors)
        found = found[0] if vectors else found
        print(f"real, {vectors=}, OPpart={part}: {np.sort_complex(found).round(2).tolist()}")
        if vectors:
            hits = [np.isclose(found, one, rtol=1e-6).any() for one in nearest]
            assert sum(hits) == 3 and np.isclose(sum(found).imag, 0, atol=1e-6), "changed"
        else:
            assert (found == 0).all(), "changed: the values are not 0"
    found = eigs(A.astype(complex), k=6, sigma=SHIFT, return_eigenvectors=vectors)
    found = found[0] if vectors else found
    assert np.allclose(np.sort_complex(found), np.sort_complex(nearest), rtol=1e-8), "changed"
    print(f"complex, {vectors=}: the six nearest")
PY
