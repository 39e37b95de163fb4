"""Where does a sliding disk come to rest?
=======================================

A disk is launched over a ground surface, at an angle to the grooves. Learn that it is not enough
to know the friction forces: which sliding direction belongs to a force decides where the disk
stops.
"""

import asperity as asp
import matplotlib.pyplot as plt
import numpy as np

# %%
# Three laws with one reservoir
# -----------------------------
# The reservoir :math:`C` holds the friction forces per unit normal force. The associated law
# slides along its normals, the collinear one against the force, and the extended one along the
# normals of a second set :math:`D`.

reservoir = asp.Superellipse(0.537, 0.457, 2.94)
laws = {
    "associated": asp.FrictionLaw.associated(reservoir),
    "collinear": asp.FrictionLaw.collinear(reservoir),
    "extended": asp.FrictionLaw(reservoir, asp.Superellipse(1.84, 1.19, 2.51)),
}

# %%
# Slide until rest
# ----------------
# The disk starts with 1.52 m/s, at 58° to the axis across the grooves. Its mass cancels.

angle = np.deg2rad(58.0)
start = 1.52 * np.array([np.cos(angle), np.sin(angle)])
paths = {}
for name, law in laws.items():
    disk = asp.SlidingPoint(0.018, law=law)
    paths[name] = asp.simulate(disk, dt=1e-4, t_end=1.0, u0=start, until_rest=True)
    x, y = 1e3 * paths[name].q[-1]
    print(f"{name:<11} stops after {paths[name].t[-1]:.4f} s at ({x:.2f}, {y:.2f}) mm")

# %%
# The paths
# ---------
# The collinear law takes the disk straight ahead, the other two turn it towards the grooves, the
# extended one by more than five centimetres.

with asp.plot.style():
    figure, ax = plt.subplots(figsize=(6.4, 5.2), layout="constrained")
    for name, path in paths.items():
        asp.plot.plot_path(path, ax=ax, label=name)
    ax.set(xlabel="$x$ across the grooves in m", ylabel="$y$ along the grooves in m")
    ax.legend(loc="upper left")
plt.show()
