"""Why does a spinning disk slide farther?
=======================================

Friction of a contact area points against the motion of each of its points, so that spin and sliding
share it. Learn how to use laws with three components, and which shape of set such an area has.
"""

import asperity as asp
import matplotlib.pyplot as plt
import numpy as np

RADIUS, MU, SPEED = 0.04, 0.2, 1.0

# %%
# Sets in three dimensions
# ------------------------
# A force of the contact is (λ₁, λ₂, τ/R). The reservoir of a round area of uniform pressure is
# known exactly; ellipsoid and superellipsoid have the same largest force and torque.

torque = 2.0 / 3.0 * MU
reservoirs = {
    "round area": asp.CoulombContensou(MU, pressure="uniform"),
    "superellipsoid": asp.Superellipsoid([MU, MU, torque], exponent=1.75),
    "ellipsoid": asp.Ellipsoid([MU, MU, torque]),
    "ball: no drilling": asp.Ellipsoid([MU, MU, 1e-3 * torque]),
}

# %%
# Disks with the same speed and more and more spin
# ------------------------------------------------

spins = np.linspace(0.0, 120.0, 13)
distances = {}
for name, reservoir in reservoirs.items():
    law = asp.FrictionLaw.associated(reservoir)
    ends = []
    for spin in spins:
        disk = asp.Body.cylinder(
            1.0,
            radius=RADIUS,
            height=0.01,
            velocity=(SPEED, 0.0, 0.0),
            angular_velocity=(0.0, 0.0, spin),
        )
        area = asp.PointPlane(
            0, point=(0.0, 0.0, 0.0), plane=asp.Plane(), law=law, patch_radius=RADIUS
        )
        run = asp.simulate(
            asp.RigidBodies([disk], pairs=[area]), dt=2e-3, t_end=3.0, until_rest=True
        )
        ends.append(run.q[-1, 0])
    distances[name] = np.array(ends)
    print(f"{name:18} {ends[0]:.3f} m without spin, {ends[-1]:.3f} m with 120 rad/s")

# %%
# Reservoirs and distances
# ------------------------
# Rim speed and sliding speed are equal at 25 rad/s.

angle = np.linspace(0.0, np.pi / 2.0, 200)
rays = np.stack([np.cos(angle), 0.0 * angle, np.sin(angle)], axis=-1)
with asp.plot.style():
    figure, (left, right) = plt.subplots(1, 2, figsize=(10.5, 4.2), layout="constrained")
    for name, reservoir in reservoirs.items():
        x, _, z = (rays / reservoir.gauge(rays)[:, None]).T
        left.plot(x, z)
        right.plot(spins, distances[name], label=name)
    left.set(title="A quarter of the reservoirs", xlabel="force, per unit load")
    left.set(ylabel="torque / $R$, per unit load")
    left.set_aspect("equal")
    right.set(title="Distance until rest", xlabel="spin in rad/s", ylabel="distance in m")
    figure.legend(loc="outside lower center", ncols=4)
plt.show()
