"""How do I give masses, springs and contacts as matrices?
=======================================================

Whoever has matrices of mass, damping and stiffness, from a finite element program perhaps, needs no
bodies. Learn how to add contacts to them, with stops and friction, and how to name what comes out.
"""

import asperity as asp
import matplotlib.pyplot as plt
import numpy as np

# %%
# A chain of three masses
# -----------------------
# The middle mass rubs under a clamp. The last one, which can also move across the chain, meets a
# rough stop after 2 mm.

stiffness = 1e3 * np.array([[2, -1, 0, 0], [-1, 2, -1, 0], [0, -1, 1, 0], [0, 0, 0, 0.2]])
friction = asp.FrictionLaw.isotropic(0.4, dimension=1)
clamp = asp.Contact(friction, direction=[0.0, 1.0, 0.0, 0.0], normal_force=2.0, name="clamp")
stop = asp.Contact(
    friction,
    normal=[0.0, 0.0, -1.0, 0.0],
    gap=2e-3,
    direction=[0.0, 0.0, 0.0, 1.0],
    normal_restitution=0.6,
    name="stop",
)
system = asp.LinearSystem(
    np.diag([1.0, 1.0, 0.5, 0.5]),
    stiffness=stiffness,
    damping=0.5 * np.eye(4),
    contacts=[clamp, stop],
    coordinate_names=["first", "middle", "last", "last, across"],
    coordinate_units=["m", "m", "m", "m"],
)

# %%
# Let go from a stretched state
# -----------------------------

run = asp.integrate(system, t_end=1.5, q0=[-5e-3, -1e-2, -1.5e-2, 8e-3], sample_every=1e-3)
impacts = [event.time for event in run.events if event.kind is asp.EventKind.IMPACT]
print(f"{len(impacts)} impacts on the stop, the last one at {impacts[-1]:.4f} s")
print(f"at the end the clamp holds the middle mass {1e3 * run.q[-1, 1]:.3f} mm off")

# %%
# Coordinates and phases
# ----------------------
# A bar for each contact says when it is open, sticks or slips.

with asp.plot.style():
    figure, ax = plt.subplots(figsize=(8.6, 4.8), layout="constrained")
    asp.plot.plot_history(run, quantity="q", ax=ax)
    ax.axhline(2e-3, color="0.5", linestyle=":")
    ax.set_title("A clamped chain with a stop at 2 mm")
plt.show()
