"""Table 1 of [WL19]: least-squares sets of PVC on surface ground steel.

Measured at a normal load of 9.3 N; the first semi-axis lies across the grinding grooves. All sets
are per unit normal force.
"""

import asperity as asp

NORMAL_FORCE = 9.3
"""Normal load of the measurement in N."""

ELLIPSE_C = asp.Ellipse(5.00, 4.49).scaled(1.0 / NORMAL_FORCE)
"""Force reservoir, fitted by an ellipse."""

SUPERELLIPSE_C = asp.Superellipse(4.99, 4.25, 2.94).scaled(1.0 / NORMAL_FORCE)
"""Force reservoir, fitted by a superellipse."""

SUPERELLIPSE_D = asp.Superellipse(1.84, 1.19, 2.51)
"""Direction set, of arbitrary scale, fitted by a superellipse."""

LAWS = {
    "associated, ellipse C": asp.FrictionLaw.associated(ELLIPSE_C),
    "associated, superellipse C": asp.FrictionLaw.associated(SUPERELLIPSE_C),
    "collinear, superellipse C": asp.FrictionLaw.collinear(SUPERELLIPSE_C),
    "extended, superellipses C, D": asp.FrictionLaw(SUPERELLIPSE_C, SUPERELLIPSE_D),
}
"""The four laws of Fig. 27 by name."""
