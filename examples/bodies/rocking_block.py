"""How does a block rock from edge to edge?
========================================

A slender block is tilted and let go. Learn how much of its energy each impact takes, and what
Housner's formula of 1963 says of a block that does not slide.
"""

import asperity as asp
import matplotlib.pyplot as plt
import numpy as np

HALF = np.array([0.0125, 0.05])
TILT = np.deg2rad(8.0)

# %%
# A block on its left edge
# ------------------------
# All four corners may touch the floor; with a friction coefficient of 10 none of them slides.

c, s = np.cos(TILT), np.sin(TILT)
block = asp.PlanarBody.box(1.0, half_sizes=HALF, position=[[c, -s], [s, c]] @ HALF, angle=TILT)
rough = asp.FrictionLaw.isotropic(10.0, dimension=1)
floor = asp.BoxPlane(
    0, half_sizes=HALF, plane=asp.Line(), law=asp.FrictionLaw.isotropic(10.0, dimension=1)
)
system = asp.RigidBodies([block], pairs=[floor])
motion = asp.simulate(system, dt=2e-5, t_end=2.0, sample_every=4e-5)

# %%
# Energy that is left
# -------------------
# The block turns back where its angular velocity changes sign, and hits the floor where its angle
# does.

angle = np.rad2deg(motion.q[:, 2])
energy = system.energy(motion) - 9.81 * HALF[1]
turns = np.flatnonzero(np.diff(np.sign(motion.u[1:, 2])) * np.sign(angle[1:-1]) < 0.0) + 1
impacts = np.flatnonzero(np.diff(np.sign(angle)))[:4]
shares = energy[impacts + 5] / energy[impacts - 5]
housner = 1.0 - 1.5 * np.sin(np.arctan(HALF[0] / HALF[1])) ** 2
print("turns at", ", ".join(f"{abs(angle[turn]):.3f}°" for turn in turns[:4]))
print("an impact leaves", ", ".join(f"{share:.4f}" for share in shares), "of the energy")
print(f"Housner's ratio squared is {housner**2:.4f}")

# %%
# The motion
# ----------

with asp.plot.style():
    figure, (above, below) = plt.subplots(2, 1, sharex=True, layout="constrained")
    above.plot(motion.t, angle)
    above.set_ylabel("angle in degrees")
    below.plot(motion.t, 1e3 * energy)
    below.set(xlabel="time in s", ylabel="energy above rest in mJ")
plt.show()
