"""Which belt directions shake a mass?
===================================

Anisotropic friction alone can make the mass on a belt unstable. Learn for which directions that
happens, how fast small motions grow, and in which cycles they end.
"""

import asperity as asp
import matplotlib.pyplot as plt
import numpy as np

# %%
# Critical directions
# -------------------
# They depend on the law only: the sliding direction leads into the tangent cone of :math:`C`.


def belt(phi, zeta=np.pi / 6):
    """Return 1 kg on springs of 1 N/m; the long axis of C lies at the angle ζ to that of D."""
    law = asp.FrictionLaw(asp.Ellipse(30.0, 10.0, angle=zeta), asp.Ellipse(3.0, 1.0))
    velocity = [np.cos(phi), np.sin(phi)]
    return asp.MassOnBelt(
        mass=1.0, stiffness=1.0, law=law, normal_force=1.0, belt_velocity=velocity
    )


[(first, last), _] = np.rad2deg(asp.critical_directions(belt(0.0).law))
print(f"unstable for directions of the belt from {first:.3f}° to {last:.3f}°, and opposite ones")
for degrees in (40.0, 50.0):
    print(f"at {degrees:.0f}°: {asp.stability(belt(np.deg2rad(degrees)))}")

# %%
# Limit cycles
# ------------
# Where the equilibrium is unstable, shooting finds the motion that takes its place.

cycles = {degrees: asp.limit_cycle(belt(np.deg2rad(degrees))) for degrees in (46.0, 54.0, 58.0)}
for degrees, cycle in cycles.items():
    stick = cycle.share(asp.Phase.STICK)
    print(f"at {degrees:.0f}° a period takes {cycle.period:.4f} s, {stick:.1%} of it in stick")

# %%
# Growth rates and orbits
# -----------------------
# The more :math:`C` is turned against :math:`D`, the more directions are unstable.

phi = np.deg2rad(np.linspace(30.0, 90.0, 241))
with asp.plot.style():
    figure, (left, right) = plt.subplots(
        1, 2, figsize=(10.0, 4.8), width_ratios=(1.5, 1.0), layout="constrained"
    )
    for zeta in (20.0, 30.0, 40.0):
        growth = asp.growth_chart(belt(0.0, 0.0), phi=phi, zeta=np.deg2rad(zeta)).growth
        left.plot(np.rad2deg(phi), growth, label=f"$C$ turned by {zeta:.0f}°")
    left.set(
        title="How fast small motions grow",
        xlabel="direction of the belt in degrees",
        ylabel="growth rate in 1/s",
    )
    left.legend()
    for degrees, cycle in cycles.items():
        (orbit,) = right.plot(*cycle.motion.q.T, label=f"belt at {degrees:.0f}°")
        right.plot(*belt(np.deg2rad(degrees)).equilibrium, "+", color=orbit.get_color())
    right.set(title="Limit cycles and equilibria", xlabel="$x$ in m", ylabel="$y$ in m")
    right.set_aspect("equal")
    right.legend(loc="upper left", bbox_to_anchor=(0.0, 0.98))
plt.show()
