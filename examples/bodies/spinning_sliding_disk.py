"""Does spin bend the path of a sliding disk?
==========================================

A point has no spin, a disk on three pads has. Learn when a point mass is a sufficient model, and
how two paths are compared.
"""

import asperity as asp
import matplotlib.pyplot as plt
import numpy as np

# %%
# A point and a disk
# ------------------
# Without spin the disk moves as the point does, although its front pad carries most of the weight.

law = asp.FrictionLaw(asp.Superellipse(0.537, 0.457, 2.94), asp.Superellipse(1.84, 1.19, 2.51))
start = 1.52 * np.array([np.cos(np.deg2rad(45.0)), np.sin(np.deg2rad(45.0))])
point = asp.simulate(
    asp.SlidingPoint(0.018, law=law), dt=1e-4, t_end=1.0, u0=start, until_rest=True
)
runs = {}
for spin in (0.0, 20.0, 40.0, 60.0):
    disk = asp.SlidingDisk(law, velocity=start, spin=spin)
    # Three pads share the load: a small tolerance makes sure that rest is seen as rest.
    runs[spin] = asp.simulate(disk, dt=2e-4, t_end=1.0, until_rest=True, tolerance=1e-13)
    comparison = asp.compare_path(runs[spin], point)
    print(f"{spin:2.0f} rad/s: ends {1e3 * comparison.end_distance:6.2f} mm from the point's path")

# %%
# Paths and loads
# ---------------
# Spin makes the disk slide farther, and as its pads slide in different directions, friction leads
# it off the point's path. The pad that is in front carries most.

with asp.plot.style():
    figure, (left, right) = plt.subplots(1, 2, figsize=(10.0, 4.4), layout="constrained")
    for spin, run in runs.items():
        left.plot(*1e3 * run.q[:, :2].T, label=f"{spin:.0f} rad/s")
        right.plot(run.t, run.normal_force[:, 0])
    left.plot(*1e3 * point.q.T, "k:", label="point")
    left.set(xlabel="$x$ across the grooves in mm", ylabel="$y$ along the grooves in mm")
    left.set(title="Paths", aspect="equal")
    left.legend(title="spin")
    right.set(xlabel="time in s", ylabel="load in N", title="Load of the first pad")
plt.show()
