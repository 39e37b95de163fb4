"""What does friction in a joint do to a swing?
============================================

Joints resist turning with a torque, often more in one sense than in the other, and hold a load
wherever they like within a band. Learn how to put an interval of torques on a coordinate.
"""

import asperity as asp
import matplotlib.pyplot as plt
import numpy as np

# %%
# A lever with a joint
# --------------------
# Friction torques per unit of normal force are an interval; with a normal force of 1 N they are
# those in N m. The reservoir holds −λ: 0.5 N m against turning forward, 0.2 N m backward.

joint = asp.FrictionLaw.associated(asp.Interval(-0.2, 0.5))
INERTIA, STIFFNESS = 0.05, 5.0
turning = asp.Contact(joint, direction=[1.0], normal_force=1.0, name="joint")
lever = asp.LinearSystem(
    [[INERTIA]],
    stiffness=[[STIFFNESS]],
    contacts=[turning],
    coordinate_names=["angle"],
    coordinate_units=["rad"],
)

# %%
# Swings from many angles
# -----------------------
# The joint holds wherever the torque of its spring is in the interval.

starts = np.linspace(-1.0, 1.0, 9)
runs = {start: asp.integrate(lever, t_end=3.0, q0=[start], sample_every=0.01) for start in starts}
for start, run in runs.items():
    print(f"from {start:+.2f} rad it comes to rest at {run.q[-1, 0]:+.4f} rad")
low, high = -0.5 / STIFFNESS, 0.2 / STIFFNESS
print(f"rest is possible from {low:.3f} to {high:.3f} rad")

# %%

with asp.plot.style():
    figure, ax = plt.subplots(figsize=(7.8, 4.4), layout="constrained")
    ax.axhspan(low, high, color="#56B4E9", alpha=0.4, label="friction can hold")
    for run in runs.values():
        ax.plot(run.t, run.q[:, 0], color="#0072B2", linewidth=1.0)
    ax.set(xlabel="time in s", ylabel="angle in rad", xlim=(0.0, 2.5))
    ax.legend(loc="upper right")
plt.show()
