"""When does a box slide off a turntable?
======================================

A turntable with a grooved surface starts slowly, with a box on it. Learn how surfaces move over
time, and how ``integrate`` locates the instant at which something begins to slide.
"""

import asperity as asp
import matplotlib.pyplot as plt
import numpy as np

# %%
# A grooved disk that turns faster and faster
# -------------------------------------------
# The grooves turn with the table. A motion is a function that returns a rotation vector and its
# rate. Friction is 0.6 across the grooves and 0.3 along them.

ACCELERATION, RADIUS, GRAVITY = 1.0, 0.3, 9.81
law = asp.FrictionLaw.associated(asp.Ellipse(0.6, 0.3))


def turn(t):
    """Return the rotation vector of the table and its rate."""
    normal = np.array([0.0, 0.0, ACCELERATION])
    return 0.5 * t**2 * normal, t * normal


table = asp.Plane(motion=asp.PlaneMotion(rotation=turn))

# %%
# Boxes at different places
# -------------------------
# All of them lie 0.3 m from the axis, and the centrifugal force acts across the grooves, obliquely,
# or along them.

motions, begins = {}, {}
for degrees in np.linspace(0.0, 90.0, 7):
    place = RADIUS * np.array([np.cos(np.deg2rad(degrees)), np.sin(np.deg2rad(degrees)), 0.0])
    box = asp.Body.box(0.2, half_sizes=(0.01, 0.01, 0.01), position=place)
    foot = asp.PointPlane(0, point=(0.0, 0.0, 0.0), plane=table, law=law)
    motion = asp.integrate(
        asp.RigidBodies([box], pairs=[foot]), t_end=5.2, max_step=0.05, sample_every=0.02
    )
    event = next(event for event in motion.events if event.kind is asp.EventKind.SLIP)
    motions[degrees], begins[degrees] = motion, event.time
    print(f"at {degrees:3.0f}° the box slides from {event.time:.6f} s on")

# %%
# The box sticks as long as the force that takes it along lies in the reservoir.

angle, t = np.deg2rad(np.linspace(0.0, 90.0, 181)), np.linspace(2.0, 5.0, 3001)
out = np.stack([np.cos(angle), np.sin(angle)], axis=-1)
along = np.stack([-np.sin(angle), np.cos(angle)], axis=-1)
needed = RADIUS / GRAVITY * (ACCELERATION * along - (ACCELERATION * t[:, None, None]) ** 2 * out)
expected = t[(law.reservoir.gauge(needed) < 1.0).sum(axis=0)]

# %%
# Paths as seen on the table
# --------------------------

with asp.plot.style():
    figure, (left, right) = plt.subplots(1, 2, figsize=(10.0, 4.6), layout="constrained")
    for degrees, motion in motions.items():
        back = np.exp(-0.5j * ACCELERATION * motion.t**2)
        path = (motion.q[:, 0] + 1j * motion.q[:, 1]) * back
        path = path[motion.t < begins[degrees] + 0.7]
        (line,) = left.plot(path.real, path.imag)
        left.plot(path[0].real, path[0].imag, "o", color=line.get_color(), markersize=5.0)
        right.plot(degrees, begins[degrees], "o", color=line.get_color())
    left.set(title="Paths on the table, 0.7 s of sliding", xlabel="$x$ across the grooves in m")
    left.set(ylabel="$y$ along the grooves in m", aspect="equal")
    right.plot(np.rad2deg(angle), expected, "k-", linewidth=1.0, label="from the reservoir")
    right.set(title="Start of sliding", xlabel="place of the box in degrees", ylabel="time in s")
    right.set(xticks=range(0, 91, 15))
    right.legend()
plt.show()
