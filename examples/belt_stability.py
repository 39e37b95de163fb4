"""For which directions of a belt anisotropic friction shakes the mass on it, and how.

Run: python belt_stability.py stability.png
"""

import sys

import asperity as asp
import numpy as np

PHI = np.deg2rad(np.linspace(30.0, 90.0, 241))
"""Directions of the belt."""


def belt(phi, zeta=np.pi / 6):
    """Return 1 kg on springs of 1 N/m; the long axis of C lies at the angle ζ to that of D."""
    law = asp.FrictionLaw(asp.Ellipse(30.0, 10.0, angle=zeta), asp.Ellipse(3.0, 1.0))
    return asp.MassOnBelt(
        1.0, stiffness=1.0, law=law, normal_force=1.0, belt_velocity=[np.cos(phi), np.sin(phi)]
    )


[(first, last), _] = np.rad2deg(asp.critical_directions(belt(0.0).law))
print(f"unstable for directions of the belt from {first:.3f}° to {last:.3f}°, and opposite ones")
for degrees in (40.0, 50.0):
    print(f"at {degrees:.0f}°: {asp.stability(belt(np.deg2rad(degrees)))}")

cycles = {degrees: asp.limit_cycle(belt(np.deg2rad(degrees))) for degrees in (46.0, 54.0, 58.0)}
for degrees, cycle in cycles.items():
    stick = cycle.share(asp.Phase.STICK)
    print(f"at {degrees:.0f}° a period takes {cycle.period:.4f} s, {stick:.1%} of it in stick")

with asp.plot.style():
    import matplotlib.pyplot as plt

    figure, (left, right) = plt.subplots(
        1, 2, figsize=(10.0, 4.8), width_ratios=(1.5, 1.0), layout="constrained"
    )
    for zeta in (20.0, 30.0, 40.0):
        growth = asp.growth_chart(belt(0.0, 0.0), phi=PHI, zeta=np.deg2rad(zeta)).growth
        left.plot(np.rad2deg(PHI), growth, label=f"C turned by {zeta:.0f}°")
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
asp.plot.save_figure(figure, sys.argv[1] if len(sys.argv) > 1 else "belt_stability.png")
