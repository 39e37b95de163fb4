"""How do I get from a tribometer to a sliding path?
=================================================

A pin-on-disk tribometer has written its readings to files. Learn which law it measured, and where
a disk of this material will come to rest.
"""

import tempfile
from pathlib import Path

import asperity as asp
import matplotlib.pyplot as plt
import numpy as np
from asperity import identify

# %%
# Files of a tribometer
# ---------------------
# The measurement is synthetic, so that the law behind it is known. The virtual machine writes what
# a real one does: readings, a calibration, records without load, and the configuration
# ``tribometer.toml``.

NORMAL_FORCE = 9.3
truth = asp.FrictionLaw(
    asp.Superellipse(4.99 / NORMAL_FORCE, 4.25 / NORMAL_FORCE, 2.94),
    asp.Superellipse(1.84, 1.19, 2.51),
)
machine = identify.VirtualTribometer(
    truth, normal_force=NORMAL_FORCE, turns=5, sample_rate=1000.0, seed=2
)
with tempfile.TemporaryDirectory() as name:
    folder = Path(name)
    machine.write(folder)
    configuration = identify.Configuration.load(folder / "tribometer.toml")
    data = identify.process(configuration.read([folder / "run_1.csv"]))

# %%
# The identified law
# ------------------
# Each parameter comes with its 95 % confidence interval.

fit = identify.fit_law(data)
for parameter, estimate in fit.parameters.items():
    print(f"{parameter:<20} {estimate}")

# %%
# The paths
# ---------
# The same disk slides under the law that was measured and under the one that was identified.


def slide(law: asp.FrictionLaw) -> asp.Trajectory:
    """Return the path of a disk of 18 g that starts with 1.52 m/s at 32°."""
    angle = np.deg2rad(32.0)
    start = 1.52 * np.array([np.cos(angle), np.sin(angle)])
    disk = asp.SlidingPoint(0.018, law=law)
    return asp.simulate(disk, dt=1e-4, t_end=1.0, u0=start, until_rest=True)


known, found = slide(truth), slide(fit.law)
print(asp.compare_path(found, known).summary())

# %%

with asp.plot.style():
    figure, (left, right) = plt.subplots(1, 2, figsize=(10.0, 4.6), layout="constrained")
    asp.plot.plot_fitted_sets(fit, ax=left)
    left.set_title("Identified sets")
    asp.plot.plot_path(known, ax=right, label="law that was measured", linewidth=4.0, alpha=0.35)
    asp.plot.plot_path(found, ax=right, label="law that was identified")
    right.set(xlabel="$x$ across the grooves in m", ylabel="$y$ along the grooves in m")
    right.set_title("Sliding path")
    right.legend()
plt.show()
