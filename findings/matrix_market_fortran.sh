#!/bin/sh
# Library: SciPy 1.17.1 and fast-matrix-market 1.7.6 (Matrix Market, as Fortran programs write it)
#
# Fortran writes double precision with the exponent letter D: 1.0D+03. Readers of Matrix Market in
# Python take the number in front of the letter and leave out the exponent, without a word: of a
# stiffness of 1.0D+03 they make 1.0, of 2.5D-02 they make 2.5. With the letter E they are right.
#
# Whoever reads matrices of a finite-element program has to look for the letter first.
set -eu
dir=$(mktemp -d)
trap 'rm -rf "$dir"' EXIT
python3 -m venv "$dir/venv"
"$dir/venv/bin/pip" install -q --disable-pip-version-check numpy==2.4.6 scipy==1.17.1 fast-matrix-market==1.7.6
cd "$dir"
"$dir/venv/bin/python" - <<'PY'
from pathlib import Path

import fast_matrix_market
import scipy.io

head = "%%MatrixMarket matrix coordinate real general\n2 2 2\n"
entries = {"D": "1 1 1.0D+03\n2 2 2.5D-02\n", "E": "1 1 1.0E+03\n2 2 2.5E-02\n"}
expected = {"D": [1.0, 2.5], "E": [1000.0, 0.025]}
for letter, lines in entries.items():
    Path("k.mtx").write_text(head + lines)
    for name, read in (("scipy", scipy.io.mmread), ("fast_matrix_market", fast_matrix_market.mmread)):
        try:
            found = read("k.mtx").toarray().diagonal().tolist()
        except ValueError as error:
            found = str(error)
        print(f"{name}, exponents with {letter}: {found}")
        if found != expected[letter]:
            raise SystemExit("changed")
PY
