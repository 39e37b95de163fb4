"""How do I stop a long run and go on later?
=========================================

Ctrl-C loses nothing: the run so far comes with the error. Learn how to keep it in a file, how to go
on from it, and that the parts are to the bit what an unbroken run gives.
"""

import tempfile
from pathlib import Path

import asperity as asp
import matplotlib.pyplot as plt
import numpy as np

# %%
# A run that is interrupted
# -------------------------
# Here the report of the progress plays the user who presses Ctrl-C.

law = asp.FrictionLaw(asp.Ellipse(30.0, 10.0, angle=np.pi / 6), asp.Ellipse(3.0, 1.0))
velocity = [np.cos(np.deg2rad(50.0)), np.sin(np.deg2rad(50.0))]
belt = asp.MassOnBelt(1.0, stiffness=1.0, law=law, normal_force=1.0, belt_velocity=velocity)


def impatient(done, whole):
    """Press Ctrl-C after a third of the run."""
    if done > whole / 3:
        raise KeyboardInterrupt


try:
    asp.simulate(belt, dt=1e-4, t_end=120.0, sample_every=0.05, progress=impatient)
except asp.errors.SimulationInterrupted as stopped:
    first = stopped.trajectory
print(f"{first.status.name.lower()} after {first.t[-1]:.2f} s")

# %%
# Keep it and go on
# -----------------
# The file holds the numbers, the system that was run, and the options, so that whoever reads it can
# run it again. What contacts remember of the last step is in the state at the end.

with tempfile.TemporaryDirectory() as folder:
    file = Path(folder) / "first.npz"
    first.save(file)
    read = asp.Trajectory.load(file)
origin, options, end = read.origin, read.options, read.end
print(f"made by asperity {origin.version} in steps of {options.dt} s, {end.steps} of them")
second = asp.simulate(read.system, dt=options.dt, t_end=120.0, start=read, sample_every=0.05)

# %%
# The parts are the whole
# -----------------------

whole = asp.simulate(belt, dt=1e-4, t_end=120.0, sample_every=0.05)
same = np.array_equal(whole.q[-1], second.q[-1])
print(f"equal to the bit at the end: {same}; {second.status is asp.Outcome.FINISHED}")

with asp.plot.style():
    figure, ax = plt.subplots(figsize=(8.4, 4.2), layout="constrained")
    ax.plot(whole.t, whole.q[:, 0], linewidth=5.0, alpha=0.3, label="unbroken")
    ax.plot(first.t, first.q[:, 0], label="until Ctrl-C")
    ax.plot(second.t, second.q[:, 0], label="continued")
    ax.set(xlabel="time in s", ylabel="$x$ in m")
    figure.legend(loc="outside upper center", ncols=3)
plt.show()
