"""A slender block rocks from edge to edge; each impact takes the same share of its energy.

Run: python rocking_block.py block.png
"""

import sys

import asperity as asp
import numpy as np

HALF = np.array([0.0125, 0.05])
START = np.deg2rad(8.0)


def standing_on_an_edge(angle):
    """Return the block on its left edge, tilted by `angle`."""
    c, s = np.cos(angle), np.sin(angle)
    return asp.PlanarBody.box(1.0, half_sizes=HALF, position=[[c, -s], [s, c]] @ HALF, angle=angle)


floor = asp.BoxPlane(
    0, half_sizes=HALF, plane=asp.Line(), law=asp.FrictionLaw.isotropic(10.0, dimension=1)
)
system = asp.RigidBodies([standing_on_an_edge(START)], pairs=[floor])
motion = asp.simulate(system, dt=2e-5, t_end=2.0, sample_every=4e-5)
angle, energy = np.rad2deg(motion.q[:, 2]), system.energy(motion)

turns = np.flatnonzero(np.diff(np.sign(motion.u[1:, 2])) * np.sign(angle[1:-1]) < 0.0) + 1
impacts = np.flatnonzero(np.diff(np.sign(angle)))
housner = 1.0 - 1.5 * np.sin(np.arctan(HALF[0] / HALF[1])) ** 2
print("turns at", ", ".join(f"{abs(angle[turn]):.3f}°" for turn in turns[:4]))
rest = 9.81 * HALF[1]
shares = (energy[impacts[:4] + 5] - rest) / (energy[impacts[:4] - 5] - rest)
print("an impact leaves", ", ".join(f"{share:.4f}" for share in shares), "of the energy")
print(f"Housner's ratio squared is {housner**2:.4f}")

with asp.plot.style():
    import matplotlib.pyplot as plt

    figure, (above, below) = plt.subplots(2, 1, sharex=True, layout="constrained")
above.plot(motion.t, angle)
above.set_ylabel("angle in degrees")
below.plot(motion.t, 1e3 * (energy - rest))
below.set(xlabel="time in s", ylabel="energy above rest in mJ")
asp.plot.save_figure(figure, sys.argv[1] if len(sys.argv) > 1 else "rocking_block.png")
