"""What does a law say of each sliding direction?
==============================================

Friction coefficient, deflection and stability depend on the direction of sliding. Learn which
functions a law has for that, and how laws are compared at a glance.
"""

import asperity as asp
import matplotlib.pyplot as plt
import numpy as np

# %%
# Laws of one surface
# -------------------
# Coefficients along and across are the same, 0.5 and 0.3; what lies between is not.

reservoir = asp.Ellipse(0.5, 0.3)
laws = {
    "associated": asp.FrictionLaw.associated(reservoir),
    "collinear": asp.FrictionLaw.collinear(reservoir),
    "tensor": asp.FrictionLaw.tensor([[0.5, 0.0], [0.0, 0.3]]),
    "box": asp.FrictionLaw.associated(asp.Rectangle(0.5, 0.3)),
}
phi = np.deg2rad(40.0)
slip = np.array([np.cos(phi), np.sin(phi)])
for name, law in laws.items():
    along, across = law.resistance(phi)
    print(
        f"{name:10} sliding at 40°: {along:.3f} against and {across:+.3f} across the sliding, "
        f"power {law.dissipation(slip):.3f} W per N and m/s"
    )

# %%
# A reservoir as the level of a function
# --------------------------------------
# The gauge of a set is one on its boundary and grows along rays: it tells how far a force is from
# its limit.

print(f"a force ratio of (0.3, 0.2) is at {reservoir.gauge([0.3, 0.2]):.0%} of its limit")
unstable = asp.ellipses_can_be_unstable(0.5, 0.3, 0.0, 1.0, 1.0)
print(f"sliding can be unstable with these ellipses unturned: {unstable}")

# %%

with asp.plot.style():
    figure = plt.figure(figsize=(12.0, 4.2), layout="constrained")
    gauge = figure.add_subplot(1, 3, 1, projection="3d")
    asp.plot.plot_gauge(reservoir, ax=gauge)
    gauge.set(title="Gauge of the reservoir", zlabel="", xlabel="", ylabel="")
    friction, deflection = figure.add_subplot(1, 3, 2), figure.add_subplot(1, 3, 3)
    for (name, law), color in zip(
        laws.items(), ("#0072B2", "#D55E00", "#009E73", "#CC79A7"), strict=True
    ):
        look = {"label": name, "color": color}
        asp.plot.plot_friction_coefficient(law, ax=friction, across=False, **look)
        asp.plot.plot_deflection(law, ax=deflection, **look)
    friction.set_title("Coefficient against the sliding")
    deflection.set_title("Deflection of the force")
    for ax in (friction, deflection):
        if legend := ax.get_legend():
            legend.remove()
    figure.legend(*friction.get_legend_handles_labels(), loc="outside lower right", ncols=4)
plt.show()
