"""How do I write a system of my own?
==================================

A pendulum hangs in a rough bearing and swings until it rests. Learn how to write a system in
Python: mass matrix, forces, and the direction of each friction force.
"""

import asperity as asp
import matplotlib.pyplot as plt
import numpy as np

MASS, LENGTH, GRAVITY, BEARING_RADIUS = 0.5, 0.3, 9.81, 0.01

# %%
# Equations of motion
# -------------------
# With the angle :math:`\varphi` from the vertical, :math:`m l^2 \ddot\varphi = -m g l \sin\varphi +
# R \lambda`. The pin of the bearing slides with the velocity :math:`R\dot\varphi`.


class Pendulum(asp.System):
    """One angle, and a friction force under the constant load m g."""

    dof = 1

    def __init__(self, friction):
        law = asp.FrictionLaw.isotropic(friction, dimension=1)
        self.contacts = [asp.ContactLaw(law, normal_force=MASS * GRAVITY)]

    def mass(self, q):
        """M = m l²."""
        return np.array([[MASS * LENGTH**2]])

    def forces(self, t, q, u):
        """H = −m g l sin φ."""
        return -MASS * GRAVITY * LENGTH * np.sin(q)

    def direction(self, t, q, contact):
        """W = R."""
        return np.array([[BEARING_RADIUS]])


# %%
# Until rest
# ----------

motion = asp.simulate(Pendulum(friction=0.8), dt=1e-3, t_end=30.0, q0=[1.2], until_rest=True)
print(motion.summary())
print(f"at rest after {motion.t[-1]:.2f} s, {np.rad2deg(motion.q[-1, 0]):.3f}° from the vertical")

# %%
# Dry friction takes nearly the same angle from every swing: amplitudes fall along a straight line.

with asp.plot.style():
    figure, ax = plt.subplots(layout="constrained")
    ax.plot(motion.t, np.rad2deg(motion.q[:, 0]))
    ax.set(xlabel="time in s", ylabel="angle from the vertical in degrees")
plt.show()
