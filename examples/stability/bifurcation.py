"""What does a vibration become when a parameter changes?
======================================================

Vibrations begin, grow and vanish as a speed or a direction is changed. Learn how to follow steady
sliding and limit cycles over any parameter of any system, and where both are possible.
"""

import asperity as asp
import matplotlib.pyplot as plt
import numpy as np

# %%
# A family of systems
# -------------------
# Any function of one number that returns a system: here the direction of the belt below a mass on
# two springs.

SIZE = 16
law = asp.FrictionLaw(asp.Ellipse(30.0, 10.0, angle=np.pi / 6), asp.Ellipse(3.0, 1.0))


def belt(degrees):
    """Return a mass of 1 kg on springs of 1 N/m, on a belt with 1 m/s."""
    phi = np.deg2rad(degrees)
    return asp.MassOnBelt(
        1.0, stiffness=1.0, law=law, normal_force=1.0, belt_velocity=[np.cos(phi), np.sin(phi)]
    )


# %%
# Steady sliding and limit cycles
# -------------------------------
# Where cycles are found is where motions end that begin at rest with relaxed springs.

degrees = np.linspace(38.0, 78.0, SIZE)
diagram = asp.bifurcation_diagram(belt, parameter="degrees", values=degrees)
print(diagram.summary())
middle = SIZE // 2
cycle = diagram.cycles[middle]
print(f"at {degrees[middle]:.0f}°: {cycle.summary()}")

# %%
# Both at once
# ------------
# Before the critical directions are reached, the stick–slip cycle is there already, beside steady
# sliding that is not unstable yet: the start decides.

with asp.plot.style():
    figure, (left, right) = plt.subplots(1, 2, figsize=(11.0, 4.4), layout="constrained")
    asp.plot.plot_bifurcation(diagram, ax=left)
    left.set(title="Equilibria and limit cycles", xlabel="direction of the belt in degrees")
    left.set(ylim=(5.0, 34.0), ylabel="$x$ in m")
    left.legend(loc="upper right", ncols=2)
    right.plot(degrees, diagram.periods, "o-", markersize=4.0)
    right.set(title="Period of the cycle", xlabel="direction of the belt in degrees")
    right.set(ylabel="period in s", ylim=(0.0, None))
plt.show()
