#!/bin/sh
# Library: pyuff 2.5.8 (universal files .uff, .unv of modal analysis), binary data set 58
#
# UFF.write_sets(sets, mode="overwrite") with a binary function (58b) as the first set writes nothing of
# it: a file of one function is 7 bytes long and is read as a file without sets. Two more behind it are
# written, but the reader finds the data of none. There is no message. mode="add" to a new file keeps
# all three, and so does "overwrite" if the first set is text (binary=0), whatever follows.
set -eu
dir=$(mktemp -d)
trap 'rm -rf "$dir"' EXIT
python3 -m venv "$dir/venv"
"$dir/venv/bin/pip" install -q --disable-pip-version-check pyuff==2.5.8 numpy==2.4.6
cd "$dir"
"$dir/venv/bin/python" - <<'PY'
from pathlib import Path

import numpy as np
import pyuff


def response(node, binary):
    return pyuff.prepare_58(
        func_type=4, binary=binary, rsp_node=node, rsp_dir=1, ref_node=1, ref_dir=1,
        data=node * np.array([1.0 + 2.0j, 3.0, -4.0j, 0.5]), x=np.arange(4.0), abscissa_spacing=1,
        abscissa_spec_data_type=18, ordinate_spec_data_type=12, orddenom_spec_data_type=13,
    )  # fmt: skip


def nodes(mode, binary):
    """Nodes of the functions that come back with their four values."""
    file = Path("frf.uff")
    file.unlink(missing_ok=True)
    sets = [response(node, one) for node, one in enumerate(binary, 1)]
    pyuff.UFF(str(file)).write_sets(sets, mode)
    reader = pyuff.UFF(str(file))
    found = [reader.read_sets(k) for k in range(reader.get_n_sets())]
    whole = [int(one["rsp_node"]) for one in found if np.size(one.get("data")) == 4]
    print(f"mode={mode}, binary={binary}: {file.stat().st_size} bytes, functions of nodes {whole}")
    return whole


assert nodes("add", (1,)) == [1], "changed: add"
assert nodes("add", (1, 1, 1)) == [1, 2, 3], "changed: add"
assert nodes("overwrite", (0, 1, 1)) == [1, 2, 3], "changed: text first"
assert nodes("overwrite", (1,)) == [], "changed: a binary function alone is kept"
assert nodes("overwrite", (1, 1, 1)) == [], "changed: some of three are read"
PY
