"""How do I make a law of measured forces?
=======================================

The friction force was measured in 36 sliding directions, with noise. Learn how a law is made of
such samples, or of a friction tensor, and how far it can be trusted.
"""

import asperity as asp
import matplotlib.pyplot as plt
import numpy as np

# %%
# A surface to be measured
# ------------------------
# Its law is known here, so that the result can be judged.

surface = asp.FrictionLaw(asp.Superellipse(0.537, 0.457, 2.94), asp.Superellipse(1.84, 1.19, 2.51))
phi = np.deg2rad(np.arange(0.0, 360.0, 10.0))
slip = np.stack([np.cos(phi), np.sin(phi)], axis=-1)
noise = 0.01 * np.random.default_rng(7).normal(size=slip.shape)
measured = -surface.force(slip) + noise

# %%
# The law of the samples
# ----------------------
# A Fourier series smooths the samples; its order is found by cross-validation. The set :math:`D`
# of a law closes and is convex: how much the samples had to be changed for that is in the report.

law = asp.FrictionLaw.from_samples(phi, measured)
report = law.report
print(f"smoothed by a series of order {report.order}, noise found {report.noise:.4f}")
print(f"largest misfit          {report.misfit:.1%} of the largest force")
print(f"r_D(2π)/r_D(0)          {report.closure:.4f}, repaired to 1")
print(f"convexity defect of D   {np.rad2deg(report.convexity_defect):.2f}°")
print(f"change of D by repairs  {report.repair:.1%}")

# %%
# Against the surface itself
# --------------------------

theta = np.linspace(0.0, 2.0 * np.pi, 361)
around = np.stack([np.cos(theta), np.sin(theta)], axis=-1)
error_c = np.abs(law.reservoir.radius(theta) / surface.reservoir.radius(theta) - 1.0)
error_d = np.rad2deg(np.abs(law.deflection(theta) - surface.deflection(theta)))
error = np.linalg.norm(law.force(around) - surface.force(around), axis=-1)
print(
    f"error of r_C            {np.sqrt(np.mean(error_c**2)):.1%} rms, {error_c.max():.1%} at most"
)
print(f"error of the force      {np.sqrt(np.mean(error**2)):.4f} rms, {error.max():.4f} at most")
print(f"error of its direction  {error_d.max():.1f}° at most")

# %%
# A law of a friction tensor
# --------------------------
# A tensor of second order is data as well: for :math:`\mathrm{diag}(0.5, 0.3)` the semi-axes of
# :math:`D` are as :math:`\sqrt{0.5/0.3}` to 1. A tensor with a skew part has no such set, and is
# refused.

tensor = asp.FrictionLaw.tensor([[0.5, 0.0], [0.0, 0.3]])
across, along = tensor.direction.radius([0.0, np.pi / 2])
print(f"semi-axes of D as {across / along:.6f} : 1, that is √(0.5/0.3) : 1")
print(f"associated: {bool(tensor.is_associated)}, dissipative: {bool(tensor.is_dissipative)}")
try:
    asp.FrictionLaw.tensor([[0.5, -0.1], [0.1, 0.3]])
except asp.ParameterError as refused:
    print(f"refused: {refused}")

# %%
# Both laws
# ---------
# Arrows show the sliding directions that belong to forces on the boundary of :math:`C`.

with asp.plot.style():
    figure, (left, right) = plt.subplots(1, 2, figsize=(10.0, 5.0), layout="constrained")
    asp.plot.plot_law(law, ax=left, angles=20, legend=False)
    left.plot(*measured.T, "x", color="black", label="measured", zorder=4.0)
    left.set_title("From 36 noisy samples")
    asp.plot.plot_law(tensor, ax=right, angles=20, legend=False)
    right.set_title("From the tensor diag(0.5, 0.3)")
    figure.legend(*left.get_legend_handles_labels(), loc="outside lower center", ncols=5)
plt.show()
