"""Does my surface slide along the normals of its reservoir?
=========================================================

Many theories assume so, and a record of forces over the sliding direction can tell. Learn how C and
D are measured without a model, and how to test whether they are alike.
"""

import asperity as asp
import matplotlib.pyplot as plt
import numpy as np
from asperity import identify

# %%
# Two surfaces with the same friction coefficients along the axes
# ---------------------------------------------------------------

reservoir = asp.Ellipse(0.54, 0.40)
surfaces = {
    "associated surface": asp.FrictionLaw.associated(reservoir),
    "surface with a D of its own": asp.FrictionLaw(reservoir, asp.Ellipse(1.8, 1.0)),
}
records = {
    name: identify.process(
        identify.VirtualTribometer(
            law, normal_force=9.3, turns=4, sample_rate=300.0, seed=7
        ).record()
    )
    for name, law in surfaces.items()
}

# %%
# The factor between the forces
# -----------------------------
# For an associated law the force across the sliding is the derivative of the force along it. The
# record gives the factor between the two, with its interval: 1 if D = C, 0 if friction is opposite
# to sliding.

for name, data in records.items():
    fit = identify.fit_law(data, reservoir="ellipse", direction="ellipse")
    found = fit.associativity
    print(f"{name}: factor {found.slope}, may be associated: {found.may_be_associated}")

# %%
# Measured sets
# -------------
# D follows, up to its size, from the deflection of the force. It is drawn as large as fits into C.

with asp.plot.style():
    figure, axes = plt.subplots(1, 2, figsize=(10.0, 4.6), layout="constrained")
    for ax, (name, data) in zip(axes, records.items(), strict=True):
        sets = data.sets
        convex = sets.direction
        print(f"{name}: angles changed by {np.rad2deg(convex.angle_change):.2f}° to make D convex")
        ax.plot(*sets.reservoir_points.T, ".", markersize=3.0, label="$C$, mean forces")
        ax.plot(*sets.direction_by_support.T, ".", markersize=3.0, label="$D$")
        asp.plot.plot_set(surfaces[name].direction, ax=ax, color="black", linewidth=0.8, alpha=0.6)
        ax.set(title=name, xlim=(-0.65, 0.65), ylim=(-0.5, 0.62))
        ax.legend(loc="upper center", ncols=2, markerscale=3.0)
plt.show()
