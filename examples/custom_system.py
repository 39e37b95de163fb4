"""A system written in Python: a rigid pendulum with a rough bearing.

Run: python custom_system.py pendulum.png
"""

import sys

import asperity as asp
import numpy as np

MASS, LENGTH, GRAVITY, BEARING_RADIUS = 0.5, 0.3, 9.81, 0.01


class Pendulum(asp.System):
    """One angle; the bearing's pin slides with the velocity R φ̇ under a constant load."""

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


motion = asp.simulate(Pendulum(friction=0.8), dt=1e-3, t_end=30.0, q0=[1.2], until_rest=True)
print(motion.summary())
print(f"at rest after {motion.t[-1]:.2f} s, {np.rad2deg(motion.q[-1, 0]):.3f}° from the vertical")

with asp.plot.style():
    import matplotlib.pyplot as plt

    figure, ax = plt.subplots(layout="constrained")
ax.plot(motion.t, np.rad2deg(motion.q[:, 0]))
ax.set(xlabel="time in s", ylabel="angle in degrees")
asp.plot.save_figure(figure, sys.argv[1] if len(sys.argv) > 1 else "custom_system.png")
