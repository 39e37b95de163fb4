"""Why does a block that is pulled slowly move in jerks?
=====================================================

A block on a spring sticks until the spring is strong enough, and then jumps. Learn how to pull with
a spring, how a body gets a name, and which speed of the pull ends the jerks.
"""

import asperity as asp
import matplotlib.pyplot as plt

# %%
# A block on a line, and a spring whose end runs
# ----------------------------------------------
# A spring of variable length is a winch: its far end is fixed at 1 m, and its relaxed length falls.
# Friction falls from 0.4 to 0.3 above a few millimetres per second. It acts at the centre of mass,
# so that the block does not tip.

law = asp.FrictionLaw.isotropic(0.4, dimension=1).replace(rate=asp.Stribeck(0.005, ratio=0.75))
block = asp.PlanarBody.box(1.0, half_sizes=(0.05, 0.02), name="block")
floor = asp.PointPlane(0, point=(0.0, 0.0), plane=asp.Line(), law=law, name="sole")


def pulled(speed, distance=0.12):
    """Return the motion of the block while the winch takes in some distance."""
    t_end = distance / speed
    winch = asp.Spring(
        0,
        point=(0.0, 0.0),
        other_point=(1.0, 0.0),
        stiffness=200.0,
        damping=1.0,
        length=asp.Signal([0.0, t_end], [1.0, 1.0 - distance], interpolation="linear"),
    )
    system = asp.RigidBodies([block], pairs=[floor], springs=[winch])
    return asp.simulate(system, dt=1e-3, t_end=t_end)


runs = {speed: pulled(speed) for speed in (0.01, 0.03, 0.1)}
labels = runs[0.01].system.labels
print(f"coordinates: {labels.coordinates}, contacts: {labels.contacts}")
for speed, run in runs.items():
    print(f"{1e3 * speed:3.0f} mm/s: sticks for {run.stick_fraction[0]:.0%} of the time")

# %%
# Place of the block over that of the winch
# -----------------------------------------

with asp.plot.style():
    figure, (left, right) = plt.subplots(1, 2, figsize=(10.5, 4.2), layout="constrained")
    for speed, run in runs.items():
        left.plot(1e3 * speed * run.t, 1e3 * run.q[:, 0], label=f"{1e3 * speed:.0f} mm/s")
    left.set(xlabel="way of the winch in mm", ylabel="way of the block in mm")
    left.legend(title="speed of the winch", loc="upper left")
    for speed, run in runs.items():
        right.plot(1e3 * (speed * run.t - run.q[:, 0]), 1e3 * run.u[:, 0])
    right.set(xlabel="stretch of the spring in mm", ylabel="speed of the block in mm/s")
plt.show()
