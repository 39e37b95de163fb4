"""How do I show what a body and its contacts do?
==============================================

A run knows its system, so that pictures of bodies, forces and phases take a line each. Learn which
there are, and how to write them as figures and films.
"""

import tempfile
from pathlib import Path

import asperity as asp
import matplotlib.pyplot as plt
import numpy as np

# %%
# A crate that slides and turns
# -----------------------------
# It stands on three feet, turned by 25° about the vertical, on a floor whose boards lie along x.

law = asp.FrictionLaw.associated(asp.Ellipse(0.25, 0.5))
crate = asp.Body.box(
    8.0,
    half_sizes=(0.2, 0.15, 0.1),
    position=(0.0, 0.0, 0.1),
    orientation=asp.axis_angle((0.0, 0.0, 1.0), angle=np.deg2rad(25.0)),
    velocity=(1.6, 0.6, 0.0),
    angular_velocity=(0.0, 0.0, 3.0),
    name="crate",
)
feet = [
    asp.PointPlane(0, point=(x, y, -0.1), plane=asp.Plane(), law=law, name=f"foot {k}")
    for k, (x, y) in enumerate([(0.2, 0.0), (-0.2, 0.15), (-0.2, -0.15)])
]
system = asp.RigidBodies([crate], pairs=feet)
run = asp.simulate(system, dt=1e-3, t_end=2.0, until_rest=True)
print(run.summary())

# %%
# Bodies, forces, phases
# ----------------------
# Forces are drawn per newton of normal load, in the reservoir: inside it a foot sticks, on its
# boundary it slips.

with asp.plot.style():
    figure, axes = plt.subplots(2, 2, figsize=(11.0, 8.0), layout="constrained")
    asp.plot.plot_bodies(run, at=5, ax=axes[0, 0])
    asp.plot.plot_forces_in_reservoir(run, ax=axes[0, 1])
    asp.plot.plot_history(run, quantity="speed", ax=axes[1, 0])
    asp.plot.plot_phase_portrait(run, coordinate=0, ax=axes[1, 1])
    for ax, title in zip(
        axes.flat, ("From above", "Forces", "Speed", "Phase portrait"), strict=True
    ):
        ax.set_title(title)

# %%
# Figures and films
# -----------------
# Files are complete or not there. The suffix says the format.

with tempfile.TemporaryDirectory() as folder:
    asp.plot.save_figure(figure, Path(folder) / "crate.pdf")
    asp.plot.save_animation(run, Path(folder) / "crate.gif", fps=10, dpi=60.0)
    for file in sorted(Path(folder).iterdir()):
        print(f"{file.name}: {file.stat().st_size / 1000:.0f} kB")
plt.show()
