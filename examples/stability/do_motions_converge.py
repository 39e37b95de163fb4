"""Does a system forget how it began?
==================================

If two motions of one system approach each other from any start, the system forgets its start. Learn
how to measure their distance as energy, and which friction laws make it grow.
"""

import asperity as asp
import matplotlib.pyplot as plt
import numpy as np

# %%
# Two masses on one belt
# ----------------------
# They start at different places. The distance is the energy that the difference of the two motions
# would have; springs and inertia conserve it, so that only friction changes it.

laws = {
    "associated": asp.FrictionLaw.associated(asp.Ellipse(3.0, 1.0, angle=np.pi / 6)),
    "extended": asp.FrictionLaw(asp.Ellipse(3.0, 1.0, angle=np.pi / 6), asp.Ellipse(3.0, 1.0)),
}
velocity = 0.1 * np.array([np.cos(np.deg2rad(50.0)), np.sin(np.deg2rad(50.0))])
distances, motions = {}, {}
for name, law in laws.items():
    belt = asp.MassOnBelt(1.0, stiffness=1.0, law=law, normal_force=1.0, belt_velocity=velocity)
    two = [
        asp.integrate(belt, t_end=60.0, q0=q0, sample_every=0.05) for q0 in ([0.0, 0.0], [2.0, 1.0])
    ]
    motions[name] = two
    distances[name] = asp.incremental_distance(*two, system=belt)
    t, v = distances[name]
    print(
        f"{name:10} from {v[0]:.2f} J to {v[-1]:.4f} J, largest increase {np.diff(v).max():.1e} J"
    )

# %%
# Distances and paths
# -------------------
# Under the associated law, which is maximal monotone, the distance never grows.

with asp.plot.style():
    figure, (left, right) = plt.subplots(1, 2, figsize=(10.5, 4.4), layout="constrained")
    for (name, (t, v)), color in zip(distances.items(), ("#0072B2", "#D55E00"), strict=True):
        left.plot(t, v, label=name, color=color)
        for motion, style in zip(motions[name], ("-", "--"), strict=True):
            right.plot(*motion.q.T, style, color=color, linewidth=1.0)
            right.plot(*motion.q[0], "o", color="black", markersize=4.0)
    left.set(xlabel="time in s", ylabel="distance in J", title="Distance of the two motions")
    left.legend()
    right.set(xlabel="$x$ in m", ylabel="$y$ in m", title="Paths from both starts", aspect="equal")
plt.show()
