"""Laws from data: from 36 noisy force measurements, and from a friction tensor.

Run: python laws_from_data.py laws.png
"""

import sys

import asperity as asp
import numpy as np

# A surface to be measured: its law is known here, so that the result can be judged.
surface = asp.FrictionLaw(asp.Superellipse(0.537, 0.457, 2.94), asp.Superellipse(1.84, 1.19, 2.51))
phi = np.deg2rad(np.arange(0.0, 360.0, 10.0))
slip = np.stack([np.cos(phi), np.sin(phi)], axis=-1)
noise = 0.01 * np.random.default_rng(7).normal(size=slip.shape)
measured = -surface.force(slip) + noise

law = asp.FrictionLaw.from_samples(phi, measured)
theta = np.linspace(0.0, 2.0 * np.pi, 361)
around = np.stack([np.cos(theta), np.sin(theta)], axis=-1)
error_c = np.abs(law.reservoir.radius(theta) / surface.reservoir.radius(theta) - 1.0)
error_force = np.linalg.norm(law.force(around) - surface.force(around), axis=-1)
error_d = np.rad2deg(np.abs(law.deflection(theta) - surface.deflection(theta)))
print("36 samples with noise of 0.01 per component:")
print(f"  smoothed by a series of order {law.report.order}, noise found {law.report.noise:.4f}")
print(f"  largest misfit          {law.report.misfit:.1%} of the largest force")
print(f"  r_D(2π)/r_D(0)          {law.report.closure:.4f}, repaired to 1")
print(f"  convexity defect of D   {np.rad2deg(law.report.convexity_defect):.2f}°")
print(f"  change of D by repairs  {law.report.repair:.1%}")
print("against the surface itself:")
print(
    f"  error of r_C            {np.sqrt(np.mean(error_c**2)):.1%} rms, {error_c.max():.1%} at most"
)
rms_force = np.sqrt(np.mean(error_force**2))
print(f"  error of the force      {rms_force:.4f} rms, {error_force.max():.4f} at most")
print(f"  error of its direction  {error_d.max():.1f}° at most")

tensor = asp.FrictionLaw.tensor([[0.5, 0.0], [0.0, 0.3]])
across, along = tensor.direction.radius([0.0, np.pi / 2])
print(f"tensor diag(0.5, 0.3): semi-axes of D as {across / along:.6f} : 1, that is √(0.5/0.3) : 1")
print(f"  associated: {bool(tensor.is_associated)}, dissipative: {bool(tensor.is_dissipative)}")

try:
    asp.FrictionLaw.tensor([[0.5, -0.1], [0.1, 0.3]])
except asp.ParameterError as refused:
    print(f"a skew part is refused, {refused}")

with asp.plot.style():
    import matplotlib.pyplot as plt

    figure, (left, right) = plt.subplots(1, 2, figsize=(10.0, 5.0), layout="constrained")
    asp.plot.plot_law(law, ax=left, angles=20, legend=False)
    left.plot(*measured.T, "x", color="black", label="measured", zorder=4.0)
    left.set_title("From 36 noisy samples")
    asp.plot.plot_law(tensor, ax=right, angles=20, legend=False)
    right.set_title("From the tensor diag(0.5, 0.3)")
    figure.legend(*left.get_legend_handles_labels(), loc="outside lower center", ncols=5)
asp.plot.save_figure(figure, sys.argv[1] if len(sys.argv) > 1 else "laws_from_data.png")
