"""Does friction throw a billiard ball off its line?
=================================================

A cue ball that hits another one obliquely slides along it for an instant and drags it aside. Learn
how balls touch, and what friction and spin do to the line that players aim at.
"""

import asperity as asp
import matplotlib.pyplot as plt
import numpy as np

RADIUS, MASS, SPEED = 0.0286, 0.17, 1.0

# %%
# One impact
# ----------
# The cue ball runs along x. The line of centres has the angle of the cut, along which the object
# ball would go without friction. A spin about the vertical, "english", changes how the balls slide
# on each other.


def throw(cut, spin=0.0, mu=0.06):
    """Return by what angle in degrees the object ball leaves the line of centres."""
    line = np.array([np.cos(cut), np.sin(cut), 0.0])
    cue = asp.Body.ball(
        MASS,
        radius=RADIUS,
        position=-(2.0 * RADIUS + 1e-5) * line,
        velocity=(SPEED, 0.0, 0.0),
        angular_velocity=(0.0, 0.0, spin),
    )
    ball = asp.Body.ball(MASS, radius=RADIUS)
    law = asp.FrictionLaw.isotropic(mu)
    impact = asp.SphereSphere(
        0, radius=RADIUS, other=1, other_radius=RADIUS, law=law, normal_restitution=0.95
    )
    table = asp.RigidBodies([cue, ball], pairs=[impact], gravity=(0.0, 0.0, 0.0))
    run = asp.simulate(table, dt=1e-4, t_end=5e-3)
    along, across = run.u[-1, 6:8]
    return np.rad2deg(np.arctan2(across, along) - cut)


# %%
# Throw over the angle of the cut
# -------------------------------

cuts = np.linspace(0.0, 75.0, 26)
spins = {"no english": 0.0, "half": 0.5, "full": 1.0}
throws = {
    name: [throw(np.deg2rad(cut), spin=share * SPEED / RADIUS) for cut in cuts]
    for name, share in spins.items()
}
for name, angles in throws.items():
    print(f"{name:11} from {min(angles):+.2f}° to {max(angles):+.2f}°")

# %%
# Where the balls slide to the end of the impact, the throw is the angle of friction, here 3.4°. The
# slower they slide on each other, the less of it is left: at some cut english cancels it.

with asp.plot.style():
    figure, ax = plt.subplots(figsize=(7.6, 4.4), layout="constrained")
    for name, angles in throws.items():
        ax.plot(cuts, angles, "o-", markersize=3.0, label=name)
    limit = np.rad2deg(np.arctan(0.06))
    ax.hlines([-limit, limit], 0.0, 75.0, "0.5", ":", label="angle of friction")
    ax.axhline(0.0, color="black", linewidth=0.8)
    ax.set(xlabel="angle of the cut in degrees", ylabel="throw in degrees")
    ax.legend(title="spin of the cue ball")
plt.show()
