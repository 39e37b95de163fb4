"""Sliding paths of a disk under laws with the same reservoir but different direction sets.

Run: python sliding_path.py paths.png
"""

import sys

import asperity as asp
import numpy as np

reservoir = asp.Superellipse(0.537, 0.457, 2.94)
laws = {
    "associated": asp.FrictionLaw.associated(reservoir),
    "collinear": asp.FrictionLaw.collinear(reservoir),
    "extended": asp.FrictionLaw(reservoir, asp.Superellipse(1.84, 1.19, 2.51)),
}
angle = np.deg2rad(58.0)
with asp.plot.style():
    import matplotlib.pyplot as plt

    figure, ax = plt.subplots(layout="constrained")
for name, law in laws.items():
    path = asp.simulate(
        asp.SlidingPoint(0.018, law=law),
        dt=1e-4,
        t_end=1.0,
        u0=[1.52 * np.cos(angle), 1.52 * np.sin(angle)],
        until_rest=True,
    )
    x, y = 1e3 * path.q[-1]
    print(f"{name:<11} stops after {path.t[-1]:.4f} s at ({x:.2f}, {y:.2f}) mm")
    asp.plot.plot_path(path, ax=ax, label=name)
ax.legend()
asp.plot.save_figure(figure, sys.argv[1] if len(sys.argv) > 1 else "sliding_path.png")
