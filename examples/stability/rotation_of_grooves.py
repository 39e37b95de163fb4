"""How far may grooves be turned before sliding shakes?
====================================================

Anisotropic friction alone makes steady sliding unstable if the reservoir is turned far enough
against the direction set. Learn how to ask for limits, directions and growth rates.
"""

import asperity as asp
import matplotlib.pyplot as plt
import numpy as np

# %%
# Is it possible at all?
# ----------------------
# ``critical_rotation`` searches for rotations that make some direction critical.

pairs = {
    "ellipses 3 : 1": (asp.Ellipse(30.0, 10.0), asp.Ellipse(3.0, 1.0)),
    "ellipses 1.3 : 1": (asp.Ellipse(13.0, 10.0), asp.Ellipse(1.3, 1.0)),
    "superellipses 3 : 1": (asp.Superellipse(30.0, 10.0, 3.0), asp.Superellipse(3.0, 1.0, 2.0)),
}
for name, (reservoir, direction) in pairs.items():
    rotations = asp.critical_rotation(reservoir, direction)
    found = ", ".join(f"{a:.1f}° to {b:.1f}°" for a, b in np.rad2deg(list(rotations)))
    print(f"{name:20} sliding can be unstable with C turned by {found or 'no angle'}")
turned = asp.Ellipse(30.0, 10.0, angle=np.deg2rad(30.0))
directions = asp.critical_directions(asp.FrictionLaw(turned, asp.Ellipse(3.0, 1.0)))
print(directions.summary())

# %%
# How fast does it grow?
# ----------------------
# ``growth_chart`` linearises about steady sliding for all directions of a belt and rotations of C.

with asp.plot.style():
    figure, axes = plt.subplots(1, 3, figsize=(12.0, 4.0), sharey=True, layout="constrained")
    for ax, (name, (reservoir, direction)) in zip(axes, pairs.items(), strict=True):
        law = asp.FrictionLaw(reservoir, direction)
        belt = asp.MassOnBelt(
            1.0, stiffness=1.0, law=law, normal_force=1.0, belt_velocity=[1.0, 0.0]
        )
        phi, zeta = (
            np.deg2rad(np.linspace(0.0, 180.0, 181)),
            np.deg2rad(np.linspace(0.0, 180.0, 91)),
        )
        chart = asp.growth_chart(belt, phi=phi, zeta=zeta)
        print(f"{name:20} grows by at most exp({chart.growth.max():.2f} t)")
        asp.plot.plot_growth_chart(chart, ax=ax, limit=8.0)
        ax.set(title=name)
        if chart.growth.max() < 1e-6:
            ax.annotate("stable everywhere", (90.0, 90.0), ha="center")
plt.show()
