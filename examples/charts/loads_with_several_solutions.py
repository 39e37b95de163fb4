"""Which loads have several solutions?
===================================

A block is loaded so that it can stick, and can slip just as well. Learn which loads these are.
"""

import asperity as asp
import matplotlib.pyplot as plt
import numpy as np

SIZE, C, D = 72, asp.Ellipse(0.6, 0.2), asp.Ellipse(3.0, 1.0)
block = asp.SlidingPoint(1.0, law=asp.FrictionLaw(C, D), gravity=1.0)
zeta, theta = np.linspace([10.0, 0.0], [80.0, 60.0], SIZE).T  # of C and of the load in degrees
size, half = np.linspace(0.9, 1.2, SIZE), SIZE // 2  # of the load, 1 on the boundary of C

# %%
# A step of 1 s with unit mass and weight is a contact problem. Its load is the start velocity.
rays = np.stack([np.cos(np.deg2rad(theta)), np.sin(np.deg2rad(theta))], axis=-1)
largest = np.array([rays / C.rotated(a).gauge(rays)[:, None] for a in np.deg2rad(zeta)])
run = {"dt": 1.0, "t_end": 1.0, "u0": largest[:, :, None] * size[:, None]}
turn = {"law.reservoir.angle": np.deg2rad(zeta)[:, None, None]}
found = asp.simulate_many(block, **run, replace=turn)
several = found.ambiguous
print(f"{several.sum()} of {several.size} loads have several solutions")
with asp.plot.style():
    figure, (left, right) = plt.subplots(1, 2, figsize=(10.0, 4.4), layout="constrained")
    filled = left.contourf(zeta, theta, 30.0 * several.mean(-1).T, levels=np.arange(0.5, 8, 0.5))
    figure.colorbar(filled, label="width of the loads with several solutions in %")
    left.vlines(np.rad2deg(asp.critical_rotation(C, D)[0]), *theta[[0, -1]], "black", "--")
    left.set(xlabel="rotation of $C$ in °", ylabel="direction of the load in °")
    side = several[half].T * np.sign(1.0 - size)[:, None]
    right.contourf(theta, size, side, [-1.5, -0.5, 0.5, 1.5], colors=["#D55E00", "none", "#56B4E9"])
    # Two slips become one where their load γ − λ is stationary in the direction φ of sliding.
    law, phi = found.system((half, 0, 0)).law, np.linspace(0.0, np.pi, 5000)
    gamma, speed = np.stack([np.cos(phi), np.sin(phi)], axis=-1), -law.trace_criterion(phi)
    load = (speed[:, None] * gamma - law.force(gamma))[speed > 0.0]
    right.plot(np.rad2deg(np.arctan2(*load.T[::-1])), law.reservoir.gauge(load), "k-")
    right.set_title("Below 1 stick and two slips, above 1 three slips")
    right.set(xlabel="direction of the load in °", ylabel="load, 1 on the boundary of $C$")
plt.show()
