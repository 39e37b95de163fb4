"""Where will my part stop, and how certain is that?
=================================================

A law that was measured has a covariance, and so has all that is computed from it. Learn how a
prediction is described in a file, how its bands are made, and whether sliding would be stable.
"""

import tempfile

import asperity as asp
import matplotlib.pyplot as plt
import numpy as np
from asperity import identify, predict

folder = tempfile.TemporaryDirectory()

# %%
# A law with its uncertainty
# --------------------------

truth = asp.FrictionLaw(asp.Superellipse(0.537, 0.457, 2.94), asp.Superellipse(1.84, 1.19, 2.51))
machine = identify.VirtualTribometer(truth, normal_force=9.3, turns=4, sample_rate=300.0, seed=8)
fit = identify.fit_law(identify.process(machine.record()))
phi = np.deg2rad(np.arange(0.0, 91.0, 15.0))
forces = fit.bands(phi)
for angle, (along, _), (width, _) in zip(
    phi, forces.resistance, forces.resistance_half_width, strict=True
):
    print(f"friction coefficient at {np.rad2deg(angle):2.0f}°: {along:.4f} ± {width:.4f}")
scenario_file, law_file = predict.write_example("sliding point", folder.name)
fit.save_law(law_file)
identified = identify.IdentifiedLaw.load(law_file)
for name, value, error in zip(
    identified.names, identified.values, identified.standard_errors, strict=True
):
    print(f"{name:20} {value:.4f} ± {error:.4f}")

# %%
# A scenario and its prediction
# -----------------------------
# The scenario says what moves and how it starts. Laws are drawn from the covariance, and the part
# slides under each of them.

scenario = predict.Scenario.load(scenario_file)
print(scenario.title)
simulation = predict.simulate_scenario(scenario_file, bands=True)
print(simulation.summary())
bands = simulation.bands
region = bands.region

# %%
# Would it squeal?
# ----------------
# The same file of a law tells in which directions sliding on a belt is unstable.

heavy = predict.Belt(mass=2.0, stiffness=500.0, speed=0.1, normal_force=20.0)
sheet = predict.describe_stability(law_file, belt=heavy)
print(sheet.summary())

# %%

with asp.plot.style():
    figure, (left, right) = plt.subplots(1, 2, figsize=(10.5, 4.4), layout="constrained")
    asp.plot.plot_path(simulation.run, ax=left)
    left.plot(*region.centre, "o", color="#D55E00", label="end")
    left.set(title="Predicted path", xlabel="$x$ in m", ylabel="$y$ in m")
    left.legend()
    right.plot(*1e3 * bands.ends.T, ".", color="0.6", label="laws that were drawn")
    right.plot(*1e3 * region.outline().T, color="#D55E00", label="95 % region")
    start = {"dt": 1e-3, "t_end": 1.0, "u0": simulation.run.u[0], "until_rest": True}
    end = asp.simulate(asp.SlidingPoint(0.018, law=truth), **start).q[-1]
    right.plot(*1e3 * np.asarray(end), "k*", markersize=10.0, label="true law")
    right.set(title="End of the path", xlabel="$x$ in mm", ylabel="$y$ in mm")
    right.set_aspect("equal", adjustable="datalim")
    right.legend()
plt.show()
folder.cleanup()
