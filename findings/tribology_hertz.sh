#!/bin/sh
# Library: tribology 0.5.16, formulas of Hertz
#
# 1. eeff returns twice the contact modulus E* of Johnson's textbook, and ahertz and phertz are right
#    with it; dhertz, with the same parameter e_eff, is right with E* only. Fed with eeff, it makes the
#    approach of a ball and a plane 0.63 of what it is (2 to the power of -2/3).
# 2. With curvatures of 10 and 50 mm dhertz is wrong with either modulus: 0.28 and 0.45 of the approach.
# 3. ahertz returns "half axes in x- and y-direction", but the short one is always the first: for a body
#    of 50 mm along x and 10 mm along y the same two numbers as for 10 and 50 mm.
set -eu
dir=$(mktemp -d)
trap 'rm -rf "$dir"' EXIT
python3 -m venv "$dir/venv"
# Without its own requirements: they ask for a NumPy older than the Python of today.
"$dir/venv/bin/pip" install -q --disable-pip-version-check --no-deps tribology==0.5.16
"$dir/venv/bin/pip" install -q --disable-pip-version-check numpy==1.26.4 scipy==1.11.4 \
    numexpr==2.14.2 matplotlib==3.8.4 opencv-python-headless==4.10.0.84 setuptools==65.5.0 2> /dev/null
"$dir/venv/bin/python" -W ignore - <<'PY'
from math import inf, pi, sqrt

import tribology
from scipy.optimize import brentq
from scipy.special import ellipe, ellipk

E, NU, LOAD, R = 206e9, 0.3, 100.0, 0.01
STAR = E / 2 / (1 - NU**2)
EFFECTIVE = tribology.eeff(E, NU, E, NU)


def by_hand(long, short):
    """Half axes and approach of a plane and a body with two radii of curvature."""
    if long == short:
        a = (0.75 * LOAD * long / STAR) ** (1 / 3)
        return a, a, a**2 / long

    def ratio(m):
        return (ellipk(m) - ellipe(m)) * (1 - m) / (ellipe(m) - (1 - m) * ellipk(m)) - short / long

    m = brentq(ratio, 1e-9, 1 - 1e-9)
    a = (3 * LOAD * long * (ellipk(m) - ellipe(m)) / (pi * STAR * m)) ** (1 / 3)
    b = a * sqrt(1 - m)
    return a, b, 1.5 * LOAD / (pi * a * STAR) * ellipk(m)


print(f"eeff: {EFFECTIVE / STAR:.3f} E*")
assert abs(EFFECTIVE / STAR - 2) < 1e-12, "changed: eeff"
for x, y, factors in ((R, R, (0.630, 1.0)), (R, 5 * R, (0.284, 0.451))):
    a, b, approach = by_hand(max(x, y), min(x, y))
    axes = tribology.ahertz(*tribology.reff(x, y, inf, inf), EFFECTIVE, LOAD)[:2]
    found = [tribology.dhertz(e, x, y, inf, inf, LOAD) / approach for e in (EFFECTIVE, STAR)]
    print(f"radii {x:g}, {y:g} m: half axes {axes[0]:.4e}, {axes[1]:.4e} m, by hand {b:.4e}, {a:.4e}")
    print(f"  dhertz {found[0]:.3f} of the approach with eeff's modulus, {found[1]:.3f} with E*")
    assert abs(axes[0] / b - 1) < 5e-3 and abs(axes[1] / a - 1) < 5e-3, "changed: ahertz"
    assert max(abs(one - old) for one, old in zip(found, factors)) < 2e-3, "changed: dhertz"
turned = tribology.ahertz(*tribology.reff(5 * R, R, inf, inf), EFFECTIVE, LOAD)[:2]
print(f"radii {5 * R:g}, {R:g} m: half axes {turned[0]:.4e}, {turned[1]:.4e} m")
assert turned[0] == axes[0] < turned[1] == axes[1], "changed: the axes turn with the body"
PY
