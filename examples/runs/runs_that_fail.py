"""What if some of many runs fail?
===============================

In thousands of runs a few meet a parameter that makes no sense, or no solution. Learn how they are
recorded without stopping the others, and how to look at one of them.
"""

import asperity as asp
import matplotlib.pyplot as plt
import numpy as np

SIZE = 60
law = asp.FrictionLaw.associated(asp.Ellipse(0.5, 0.3))

# %%
# A grid of launches, with a mistake in it
# ----------------------------------------
# The smallest semi-axes are not positive, which their constructor refuses.
disk = asp.SlidingPoint(0.018, law=law)
b, phi = np.linspace(-0.1, 0.6, SIZE), np.linspace(0.0, np.pi / 2, SIZE)
start = 1.5 * np.stack([np.cos(phi), np.sin(phi)], axis=-1)
run = {"dt": 1e-3, "t_end": 3.0, "axes": ["b", "phi"], "keep": "rest_time"}
many = asp.simulate_many(disk, u0=start, replace={"law.reservoir.b": b[:, None]}, **run)
failure = many.failures[0]
print(f"{len(many.failures)} of {many.status.size} runs failed; the first: {failure}")
print(f"the run {(SIZE // 2, 3)} again: {many.repeat((SIZE // 2, 3)).status.name.lower()}")
# %%
# Limit cycles are searched for in the same way; where there is none, the status says so.
belt = asp.MassOnBelt(1.0, stiffness=1.0, law=law, normal_force=60.0, belt_velocity=[0.6, 0.8])
cycles = asp.limit_cycle_many(belt, replace={"normal_force": [0.0, 20.0, 60.0]})
print("limit cycles:", ", ".join(cycles.status.tolist()))
# %%
# Ctrl-C leaves what was done
# ---------------------------
# Here the report of the progress plays the user.


def impatient(done, whole):
    """Press Ctrl-C after half of the runs."""
    if done > whole / 2:
        raise KeyboardInterrupt


try:
    asp.simulate_many(disk, u0=start, dt=1e-3, t_end=1.0, threads=1, progress=impatient)
except asp.errors.EnsembleInterrupted as stopped:
    statuses, numbers = np.unique(stopped.ensemble.status.astype(str), return_counts=True)
    print(dict(zip(statuses.tolist(), numbers.tolist(), strict=True)))

# %%

with asp.plot.style():
    figure, ax = plt.subplots(figsize=(7.0, 4.4), layout="constrained")
    ax.set(facecolor="0.85", xlabel="direction of the launch in degrees", ylabel="semi-axis $b$")
    filled = ax.pcolormesh(np.rad2deg(phi), b, many.rest_time)
    figure.colorbar(filled, label="time until rest in s")
    ax.annotate("failed", (40.0, -0.06))
    ax.annotate("still sliding after 3 s", (60.0, 0.018))
plt.show()
