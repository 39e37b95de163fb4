"""How do I compute a chart that survives a kill?
==============================================

A chart of hours must not be lost when the computer restarts. Learn how to call any function over a
grid, with results in a folder from which the next call goes on.
"""

import tempfile
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

import asperity as asp
import matplotlib.pyplot as plt
import numpy as np

SIZE = 24


def slide(phi, mu, budget):
    """Return how far a disk slides; one that goes on for longer than the budget has failed."""
    law = asp.FrictionLaw.associated(asp.Ellipse(mu, 0.3))
    start = 1.5 * np.array([np.cos(phi), np.sin(phi)])
    disk = asp.SlidingPoint(0.018, law=law)
    run = asp.simulate(disk, dt=1e-3, t_end=budget, u0=start, until_rest=True)
    if run.status is not asp.Outcome.AT_REST:
        raise RuntimeError(f"still sliding after {budget} s")
    return {"distance": np.hypot(*run.q[-1])}


# %%
# A first part, then the whole
# ----------------------------
# The report of the progress plays Ctrl-C. The second call computes what is missing. Without an
# executor, processes of their own do the work.
grid = {"phi": np.linspace(0.0, np.pi / 2, SIZE), "mu": np.linspace(0.1, 0.6, SIZE)}
with tempfile.TemporaryDirectory() as folder, ThreadPoolExecutor(2) as pool:
    call = {"store": Path(folder) / "chart.zarr", "executor": pool, "constants": {"budget": 0.8}}

    def impatient(done, whole):
        """Press Ctrl-C after half of the points."""
        if done > whole / 2:
            raise KeyboardInterrupt

    try:
        asp.sweep(slide, grid, progress=impatient, **call)
    except asp.errors.SweepInterrupted as stopped:
        print(f"stopped with {stopped.done} of {stopped.points} points")
    # What is in the store is read when it is needed: here, before the folder vanishes.
    chart = asp.sweep(slide, grid, units={"distance": "m"}, **call).load()
    standing = asp.sweep_status(call["store"])
print(standing.summary())
with asp.plot.style():
    figure, ax = plt.subplots(figsize=(7.0, 4.4), layout="constrained")
    ax.set(facecolor="0.85", xlabel="direction of the launch in degrees", ylabel=r"$\mu$ across")
    filled = ax.pcolormesh(np.rad2deg(chart.phi), chart.mu, chart.distance.T)
    figure.colorbar(filled, label="distance in m")
    ax.annotate("failed: still sliding", (5.0, 0.12))
plt.show()
