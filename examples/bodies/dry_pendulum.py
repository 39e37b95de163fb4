"""Where does a pendulum with a dry hinge come to rest?
====================================================

A dry hinge takes the same angle off every swing of small size, less off large ones, and holds the
pendulum beside the vertical. Learn how to put a torque of dry friction on the joint of a system of
your own, and how closely events find the angle of rest.
"""

import asperity as asp
import matplotlib.pyplot as plt
import numpy as np
from scipy.optimize import brentq

MASS, LENGTH, TORQUE, START = 0.5, 0.4, 0.12, 2.6
WEIGHT = MASS * 9.81 * LENGTH

# %%
# A hinge that resists
# --------------------
# The friction torque is a contact of one dimension whose law is the interval from −1 to 1 and whose
# normal force is the largest torque in N m.


class Pendulum(asp.System):
    """A mass on an arm."""

    dof = 1
    coordinate_names = ("angle",)
    coordinate_units = ("rad",)

    def __init__(self):
        law = asp.FrictionLaw.isotropic(1.0, dimension=1)
        self.contacts = [asp.ContactLaw(law, normal_force=TORQUE, name="hinge")]

    def mass(self, q):
        """M = m l²."""
        return np.array([[MASS * LENGTH**2]])

    def forces(self, t, q, u):
        """H = −m g l sin φ."""
        return -WEIGHT * np.sin(q)

    def direction(self, t, q, contact):
        """W = 1."""
        return np.array([[1.0]])


run = asp.integrate(Pendulum(), t_end=12.0, q0=[START], u0=[0.0])

# %%
# The closed form
# ---------------
# A swing ends where the weight's work is used up, m g l (cos φ₁ − cos φ₀) = τ (φ₀ − φ₁), and the
# last one within the band m g l |sin φ| ≤ τ.

band = np.arcsin(TORQUE / WEIGHT)
turns = [START]
while abs(turns[-1]) > band:
    side, begin = np.sign(turns[-1]), abs(turns[-1])

    def left(angle, begin=begin):
        """Return the energy over m g l that is left at an angle."""
        return np.cos(angle) - np.cos(begin) - TORQUE / WEIGHT * (begin - angle)

    turns.append(side * brentq(left, -begin, band, xtol=1e-15))
print(f"it rests within {np.rad2deg(band):.2f}° of the vertical, here at", end=" ")
print(f"{np.rad2deg(run.q[-1, 0]):.6f}°, by the closed form at {np.rad2deg(turns[-1]):.6f}°")
assert abs(run.q[-1, 0] - turns[-1]) < 1e-8

# %%

with asp.plot.style():
    figure, ax = plt.subplots(figsize=(8.0, 4.4), layout="constrained")
    hold = np.rad2deg(band)
    ax.axhspan(-hold, hold, color="#56B4E9", alpha=0.4, label="friction can hold")
    shown = run.t <= 11.0
    ax.plot(run.t[shown], np.rad2deg(run.q[shown, 0]), color="#0072B2", linewidth=1.0)
    times = [0.0, *(event.time for event in run.events)]
    ax.plot(times, np.rad2deg(turns), "o", color="#D55E00", label="turns by the closed form")
    ax.set(xlabel="time in s", ylabel="angle in degrees", xlim=(0.0, 11.0))
    ax.legend(loc="upper right")
plt.show()
