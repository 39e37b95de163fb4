#!/bin/sh
# Program: CalculiX ccx 2.20 (Debian 12), *FREQUENCY with SOLVER=MATRIXSTORAGE after a contact that slips
#
# A pad is pressed on a disc and slid over it by 0.1 mm in a static step; the friction of a contact that
# slips makes the stiffness unsymmetric. ccx knows: its own *FREQUENCY factors an unsymmetric matrix and
# finds a pair of modes at 17,537 Hz whose angular frequency has an imaginary part of 7,619 rad/s, one
# of them growing (mode coupling, squeal). The files of the same job with SOLVER=MATRIXSTORAGE hold the
# upper triangle only and no message; read back as symmetric they are stable, with the lowest mode at
# 17,132 Hz. Whoever writes out K and M of a brake loses what squeal comes from.
set -eu
dir=$(mktemp -d)
trap 'rm -rf "$dir"' EXIT
python3 -m venv "$dir/venv"
"$dir/venv/bin/pip" install -q --disable-pip-version-check numpy==2.4.6 scipy==1.17.1
cd "$dir"
# ccx and the libraries that it needs, unpacked here. apt must have its lists: apt-get update.
apt-cache depends --recurse --no-recommends --no-suggests --no-conflicts --no-breaks --no-replaces \
    --no-enhances calculix-ccx | grep '^[a-z]' | sort -u |
    grep -Ev ':|^(libc6|libcrypt1|debconf|dpkg|perl.*|calculix-ccx)$' > needed
# shellcheck disable=SC2046
apt-get -qq -o APT::Sandbox::User=root download calculix-ccx=2.20-1 $(cat needed)
for file in *.deb; do dpkg -x "$file" root; done
lib=$dir/root/usr/lib/x86_64-linux-gnu
export LD_LIBRARY_PATH="$lib:$lib/lapack:$lib/blas:$dir/root/lib/x86_64-linux-gnu" OMP_NUM_THREADS=1
cat > deck.py <<'PY'
def block(name, counts, low, size, first):
    """Nodes and C3D8 bricks of a block; the numbers of its nodes begin with first."""
    (nx, ny, nz), row = counts, counts[0] + 1
    layer = row * (ny + 1)
    nodes, bricks = "", f"*ELEMENT, TYPE=C3D8, ELSET={name}\n"
    for number in range(layer * (nz + 1)):
        at = number % row, number // row % (ny + 1), number // layer
        place = [a + b * i / n for a, b, i, n in zip(low, size, at, counts)]
        nodes += f"{first + number}, {place[0]:.9g}, {place[1]:.9g}, {place[2]:.9g}\n"
        if at[0] < nx and at[1] < ny and at[2] < nz:
            base = [0, 1, row + 1, row]
            corners = [first + number + k for k in base + [layer + k for k in base]]
            bricks += f"{1000 * first + number}, {', '.join(map(str, corners))}\n"
    return nodes, bricks


pad = block("PAD", (6, 3, 2), (0, 0, 0), (0.08, 0.04, 0.015), 1)
disc = block("DISC", (4, 2, 1), (-0.01, -0.01, -0.005), (0.1, 0.06, 0.005), 101)
for name, last in (("own", "*FREQUENCY\n8"), ("files", "*FREQUENCY, SOLVER=MATRIXSTORAGE")):
    with open(name + ".inp", "w") as file:
        file.write(f"""*NODE
{pad[0]}{disc[0]}{pad[1]}{disc[1]}*NSET, NSET=CONTACT, GENERATE
1, 28
*NSET, NSET=BACK, GENERATE
57, 84
*NSET, NSET=BOTTOM, GENERATE
101, 115
*ELSET, ELSET=TOP, GENERATE
1028, 1055
*SURFACE, NAME=SPAD, TYPE=NODE
CONTACT
*SURFACE, NAME=SDISC
DISC, S2
*MATERIAL, NAME=LINING
*ELASTIC
4.E9, 0.3
*DENSITY
2500.
*SOLID SECTION, ELSET=PAD, MATERIAL=LINING
*MATERIAL, NAME=IRON
*ELASTIC
120.E9, 0.26
*DENSITY
7200.
*SOLID SECTION, ELSET=DISC, MATERIAL=IRON
*SURFACE INTERACTION, NAME=SI
*SURFACE BEHAVIOR, PRESSURE-OVERCLOSURE=LINEAR
1.E12, 1.E5
*FRICTION
0.5, 1.E12
*CONTACT PAIR, INTERACTION=SI, TYPE=NODE TO SURFACE
SPAD, SDISC
*BOUNDARY
BOTTOM, 1, 3
BACK, 1, 2
*STEP, NLGEOM
*STATIC
1., 1.
*DLOAD
TOP, P2, 5.E5
*BOUNDARY
BACK, 1, 1, 1.E-4
*END STEP
*STEP, PERTURBATION
{last}
*END STEP
""")
PY
"$dir/venv/bin/python" deck.py
root/usr/bin/ccx own > own.log
root/usr/bin/ccx files > files.log
"$dir/venv/bin/python" - <<'PY'
import re
from pathlib import Path

import numpy as np
from scipy.linalg import eigh

assert "unsymmetric spooles solver" in Path("own.log").read_text(), "changed: own solver"
row = re.search(r"^ +1 +(\S+) +(\S+) +(\S+)$", Path("own.dat").read_text(), re.MULTILINE)
hertz, growth = float(row[2]), abs(float(row[3]))
print(f"ccx itself: {hertz:.0f} Hz, imaginary part of the angular frequency {growth:.0f} rad/s")
assert abs(hertz - 17537) < 5 and abs(growth - 7619) < 5, "changed: own modes"

matrices = []
for suffix in ("sti", "mas"):
    i, j, values = np.loadtxt(f"files.{suffix}").T
    upper = np.zeros((round(i.max()),) * 2)
    upper[i.astype(int) - 1, j.astype(int) - 1] = values
    print(f".{suffix}: {len(values)} entries, {(i > j).sum()} below the diagonal")
    assert not (i > j).any(), "changed: the other triangle is written"
    matrices.append(upper + np.triu(upper, 1).T)
lowest = np.sqrt(eigh(*matrices, eigvals_only=True)[0]) / 2 / np.pi
print(f"from the files: lowest mode {lowest:.0f} Hz, no growth")
assert abs(lowest - 17132) < 5, "changed: modes of the files"
told = [line for line in Path("files.log").read_text().splitlines() if "symmetric" in line.lower()]
assert not any("warning" in line.lower() for line in told), f"changed: {told}"
PY
