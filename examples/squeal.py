"""A mass on a belt squeals by mode coupling (Walker & Leine 2019, Fig. 13b).

Run: python squeal.py squeal.png
"""

import sys

import asperity as asp
import numpy as np
from asperity import mechanisms
from asperity.plot import plot_root_locus, save_figure, style
from matplotlib import pyplot as plt

mu = np.linspace(0.2, 1.2, 101)
found = [asp.stability(mechanisms.mode_coupling(value)) for value in mu]
limit = mu[[one.kind == "unstable" for one in found]][0]
print(f"unstable from μ = {limit:.2f}")
print(found[-1].reason)

motion = asp.simulate(
    mechanisms.mode_coupling(0.9), dt=1e-2, t_end=120.0, q0=[1e-3, 0.0, 0.0], sample_every=0.05
)
print(motion.summary())

with style():
    figure, (left, right) = plt.subplots(1, 2, figsize=(11.0, 4.2), layout="constrained")
    plot_root_locus(found, values=mu, ax=left, label=r"friction coefficient $\mu$")
    left.set_title("two modes meet")
    right.plot(motion.t, motion.q[:, 1], label="mass $y$")
    right.plot(motion.t, motion.q[:, 2], label="belt $z$", linewidth=1.0)
    right.set(
        title=r"and the mass lifts off, $\mu = 0.9$", xlabel="time in s", ylabel="height in m"
    )
    right.legend(loc="upper left")
save_figure(figure, sys.argv[1] if len(sys.argv) > 1 else "squeal.png")
