"""How do I read the file of my tribometer?
========================================

Every laboratory writes other columns, units and decimal marks. Learn how a file is inspected, how
its description is kept, and what becomes of the readings until they are forces.
"""

import tempfile
from pathlib import Path

import asperity as asp
import matplotlib.pyplot as plt
import numpy as np
from asperity import identify

folder = tempfile.TemporaryDirectory()
file = Path(folder.name) / "messung.csv"

# %%
# A file as a machine may write it
# --------------------------------
# Semicolons, decimal commas, a title, milliseconds and millinewtons.

law = asp.FrictionLaw(asp.Superellipse(0.537, 0.457, 2.94), asp.Superellipse(1.84, 1.19, 2.51))
machine = identify.VirtualTribometer(
    law, normal_force=9.3, turns=4, sample_rate=300.0, noise=0.01, load_ripple=0.02, seed=3
)
run = machine.record().recordings[0]
lines = ["Prüfstand 3;", "Zeit [ms];Winkel [°];Ft [mN];Fr [mN];Fn [N];"]
for t, angle, (along, across, normal) in zip(run.time, run.angle, run.readings, strict=True):
    row = f"{1e3 * t:.1f};{np.rad2deg(angle) % 360.0:.3f};"
    row += f"{1e3 * along:.1f};{1e3 * across:.1f};{normal:.4f};"
    lines.append(row.replace(".", ","))
file.write_text("\n".join(lines), encoding="latin-1")

# %%
# What does it seem to hold?
# --------------------------
# The inspection is a guess, to be looked over, and writes the description that reads the file.

found = identify.inspect_file(file)
for column in found.columns:
    print(
        f"{column.name:8} {column.unit:4} {column.role:11} {column.low:9.1f} to {column.high:9.1f}"
    )
found.write(file.with_suffix(".toml"))
configuration = identify.Configuration.load(file.with_suffix(".toml"))

# %%
# From readings to forces
# -----------------------
# ``Configuration.read`` stops at the readings, ``process`` turns them into forces over the sliding
# direction. ``identify.load`` does both at once.

raw = configuration.read([file])
recording, processing = raw.recordings[0], raw.processing
print(f"{recording.turns:.1f} turns at {recording.sample_rate:.0f} Hz; {processing}")
data = identify.process(raw)
average = data.turn_averages()["tangential"]
means = data.averaged()
print(f"{means.count.sum()} samples in {len(means.phi)} directions")
print(f"turns differ by at most {np.ptp(average.offset):.4f} in their mean coefficients")

# %%

with asp.plot.style():
    figure, (left, right) = plt.subplots(1, 2, figsize=(11.0, 4.2), layout="constrained")
    left.plot(
        recording.time, recording.readings, linewidth=0.6, label=["along", "across", "normal"]
    )
    left.set(title="Readings", xlabel="time in s", ylabel="force in N", ylim=(-4.0, 14.0))
    left.legend(loc="upper center", ncols=3)
    degrees = np.rad2deg(average.phi)
    for turn in average.turns:
        right.plot(degrees, turn, color="0.7", linewidth=0.6)
    right.plot(degrees, average.mean, label="mean of the turns")
    right.set(title="Force along, over the sliding direction", xlabel="direction in degrees")
    right.set(ylabel="force per unit load", xticks=range(0, 361, 60))
    right.legend(loc="lower right")
plt.show()
folder.cleanup()
