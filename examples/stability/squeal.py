"""Why does a brake squeal?
========================

Friction does not fall with the speed, and yet two modes of vibration couple through the normal
force, as in Fig. 13b of Walker & Leine (2019). Learn from which coefficient on, and what happens
then.
"""

import asperity as asp
import matplotlib.pyplot as plt
import numpy as np
from asperity import mechanisms

# %%
# The reason of the instability
# -----------------------------
# ``stability`` leaves out one cause after the other, and names the one without which sliding is
# stable.

mu = np.linspace(0.2, 1.2, 101)
found = [asp.stability(mechanisms.mode_coupling(value)) for value in mu]
limit = mu[[one.kind == "unstable" for one in found]][0]
print(f"unstable from μ = {limit:.2f}")
print(found[-1].reason)

# %%
# The motion beyond the limit
# ---------------------------
# A disturbance of a millimetre grows until the mass lifts off the belt.

motion = asp.simulate(
    mechanisms.mode_coupling(0.9), dt=1e-2, t_end=120.0, q0=[1e-3, 0.0, 0.0], sample_every=0.05
)
print(motion.summary())

# %%
# Eigenvalues and lift-off
# ------------------------
# Two frequencies meet, and one of the two modes begins to grow.

with asp.plot.style():
    figure, (left, right) = plt.subplots(1, 2, figsize=(11.0, 4.2), layout="constrained")
    asp.plot.plot_root_locus(found, values=mu, ax=left, label=r"friction coefficient $\mu$")
    left.set_title("Two modes meet")
    right.plot(motion.t, motion.q[:, 1], label="mass $y$")
    right.plot(motion.t, motion.q[:, 2], label="belt $z$", linewidth=1.0)
    right.set(title=r"The mass lifts off, $\mu = 0.9$", xlabel="time in s", ylabel="height in m")
    right.legend(loc="upper left")
plt.show()
