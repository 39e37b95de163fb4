"""From the files of a tribometer to a friction law, and from the law to a sliding path.

The measurement is synthetic, so that the law behind it is known.

Run: python tribometer_to_path.py path.png
"""

import sys
import tempfile
from pathlib import Path

import asperity as asp
import numpy as np
from asperity import identify

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
    machine.write(folder)  # readings, calibration, records without load; tribometer.toml
    configuration = identify.Configuration.load(folder / "tribometer.toml")
    data = identify.process(configuration.read([folder / "run_1.csv"]))
fit = identify.fit_law(data)
for parameter, estimate in fit.parameters.items():
    print(f"{parameter:<20} {estimate}")


def slide(law: asp.FrictionLaw) -> asp.Trajectory:
    """Return the path of a disk of 18 g that starts with 1.52 m/s at 32°."""
    angle = np.deg2rad(32.0)
    start = [1.52 * np.cos(angle), 1.52 * np.sin(angle)]
    block = asp.SlidingPoint(0.018, law=law)
    return asp.simulate(block, dt=1e-4, t_end=1.0, u0=start, until_rest=True)


known, found = slide(truth), slide(fit.law)
comparison = asp.compare_path(found, known)
print(comparison.summary())

with asp.plot.style():
    import matplotlib.pyplot as plt

    figure, (left, right) = plt.subplots(1, 2, figsize=(10.0, 4.6), layout="constrained")
asp.plot.plot_fitted_sets(fit, ax=left)
asp.plot.plot_path(known, ax=right, label="law that was measured", linewidth=4.0, alpha=0.35)
asp.plot.plot_path(found, ax=right, label="law that was identified")
right.legend()
asp.plot.save_figure(figure, sys.argv[1] if len(sys.argv) > 1 else "tribometer_to_path.png")
