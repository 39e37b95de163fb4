#!/bin/sh
# Library: slippy 0.5.2 (tribology), formulas of Hertz in slippy.contact
#
# 1. hertz_full takes the four radii of two bodies and the angle between them. Two cylinders of 10 mm
#    that cross at 90 degrees touch in a circle of radius 0.187 mm, like a ball on a plane; given as
#    equal bodies with angle = pi/2, it has an ellipse of 0.277 mm x 0.134 mm. With 10 and 20 mm as well
#    the axes are 27 and 16 per cent off. Only where one body is a plane or a ball, or at 45 degrees,
#    does it agree with the elliptic integrals.
# 2. Where it speaks of von Mises' stress it divides by the number that it should multiply with: 1.79
#    of the highest pressure for a line contact (hertz_full) and 1.61 for a ball (solve_hertz_point),
#    0.56 and 0.62 by hand. solve_hertz_line has 0.56 of the same line contact.
# 3. The mean pressure of a line contact is higher than its highest pressure: pi/2 of it, not pi/4.
set -eu
dir=$(mktemp -d)
trap 'rm -rf "$dir"' EXIT
python3 -m venv "$dir/venv"
# Without its own requirements: they ask for a NumPy older than the Python of today.
"$dir/venv/bin/pip" install -q --disable-pip-version-check --no-deps slippy==0.5.2
"$dir/venv/bin/pip" install -q --disable-pip-version-check numpy==1.26.4 scipy==1.11.4 \
    numba==0.60.0 sympy==1.14.0 tinydb==4.9.0 2> /dev/null
"$dir/venv/bin/python" -W ignore - <<'PY'
from math import inf, pi, sqrt

import numpy as np
import slippy.contact as slippy
from scipy.optimize import brentq
from scipy.special import ellipe, ellipk

E, NU, LOAD, R = 210e9, 0.3, 100.0, 0.01
STIFF = E / 2 / (1 - NU**2)


def by_hand(long, short):
    """Half axes of the contact of a plane and a body with two radii of curvature."""
    if long == short:
        return [(0.75 * LOAD * long / STIFF) ** (1 / 3)] * 2

    def ratio(m):
        return (ellipk(m) - ellipe(m)) * (1 - m) / (ellipe(m) - (1 - m) * ellipk(m)) - short / long

    m = brentq(ratio, 1e-9, 1 - 1e-9)
    a = (3 * LOAD * long * (ellipk(m) - ellipe(m)) / (pi * STIFF * m)) ** (1 / 3)
    return [a, a * sqrt(1 - m)]


for name, first, second, angle, hand, factors in (
    ("ball on plane", R, inf, 0.0, (R, R), (1, 1)),
    ("body of 50 and 10 mm on plane", (R, 5 * R), inf, 0.0, (5 * R, R), (1, 1)),
    ("10 across 10 mm", (R, inf), (R, inf), pi / 2, (R, R), (1.486, 0.717)),
    ("10 across 20 mm", (R, inf), (2 * R, inf), pi / 2, (2 * R, R), (1.267, 0.841)),
):
    expected = by_hand(*hand)
    found = slippy.hertz_full(first, second, E, NU, LOAD, angle=angle)["contact_radii"]
    print(f"{name}: half axes {np.multiply(found, 1e3).round(4)} mm, by hand", end=" ")
    print(f"{np.multiply(expected, 1e3).round(4)} mm")
    assert np.allclose(np.divide(sorted(found)[::-1], expected), factors, atol=2e-3), "changed"

ROLLER = {"v1": NU, "v2": NU, "e1": E, "e2": E, "r_rel": R}
line = slippy.hertz_full((R, inf), inf, E, NU, 1e5, line=True)
other = slippy.solve_hertz_line(load=1e5, **ROLLER)
ball = slippy.solve_hertz_point(load=LOAD, **ROLLER)
top = sqrt(1e5 * STIFF / pi / R)
assert abs(line["max_pressure"] / top - 1) < 1e-9 and abs(other.max_pressure / top - 1) < 1e-9
for name, found, expected in (
    ("line, hertz_full: von Mises", line["max_von_mises_stress"][0] / top, 1.795),
    ("line, solve_hertz_line: von Mises", other.max_von_mises / top, 0.557),
    ("ball, solve_hertz_point: von Mises", ball.max_von_mises / ball.max_pressure, 1.613),
    ("line, hertz_full: mean pressure", line["mean_pressure"] / top, pi / 2),
):
    print(f"{name} {found:.3f} of the highest pressure")
    assert abs(found - expected) < 1e-3, "changed"
PY
