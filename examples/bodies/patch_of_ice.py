"""What does a patch of ice do to what slides over it?
===================================================

One runner of a sledge crosses a patch of ice, the other one does not: it turns. Learn how to make
friction depend on the place, and what a border between two coefficients of friction does.
"""

import asperity as asp
import matplotlib.pyplot as plt
import numpy as np

# %%
# A floor with a patch
# --------------------
# On the ice friction is 0.2 of what it is elsewhere.

CORNERS = [(0.5, 0.0), (1.4, 0.0), (1.6, 1.0), (0.5, 1.0)]
law = asp.FrictionLaw.isotropic(0.5)
floor = asp.Plane(friction_factor=asp.FrictionRegions([(CORNERS, 0.2)]))

# %%
# A puck across the ice
# ---------------------
# A point that slides straight on uses up its energy ½v² by g ∫ μ dx, which gives the place where it
# stops.

puck = asp.Body.ball(1.0, radius=0.1, position=(0.0, 0.4, 0.0), velocity=(3.6, 0.0, 0.0))
point = asp.PointPlane(0, point=(0.0, 0.0, 0.0), plane=floor, law=law)
run = asp.integrate(asp.RigidBodies([puck], pairs=[point]), t_end=3.0)
width = 1.4 + 0.2 * 0.4 - 0.5
expected = 3.6**2 / (2 * 9.81 * 0.5) + (1.0 - 0.2) * width
print(f"the puck stops at x = {run.q[-1, 0]:.9f} m, by its energy at {expected:.9f} m")
assert abs(run.q[-1, 0] - expected) < 1e-9

# %%
# A sledge that turns
# -------------------
# A sledge stands on four feet, two of which meet the ice.

HALF = (0.15, 0.1, 0.03)
sledge = asp.Body.box(1.0, half_sizes=HALF, position=(0.0, 0.0, 0.03), velocity=(3.6, 0.0, 0.0))
feet = asp.BoxPlane(0, half_sizes=HALF, plane=floor, law=law)
system = asp.RigidBodies([sledge], pairs=[feet])
motion = asp.integrate(system, t_end=3.0, sample_every=0.01)
borders = [event for event in motion.events if event.kind is asp.EventKind.BORDER]
turned = np.rad2deg(2.0 * np.arctan2(motion.q[-1, 6], motion.q[-1, 3]))
print(f"its feet cross the border {len(borders)} times, and it turns by {turned:.1f}°")

# %%

with asp.plot.style():
    figure, ax = plt.subplots(figsize=(8.4, 4.0), layout="constrained")
    ax.fill(*np.transpose(CORNERS), color="#56B4E9", alpha=0.4, label="ice")
    ax.plot(*run.q[:, :2].T, color="#009E73", linewidth=2.0, label="puck")
    ax.plot(*run.q[-1, :2], "o", color="#009E73")
    outline = np.array([(1, 1), (-1, 1), (-1, -1), (1, -1), (1, 1)]) * HALF[:2]
    for k in [*range(0, 60, 12), -1]:
        angle = 2.0 * np.arctan2(motion.q[k, 6], motion.q[k, 3])
        cosine, sine = np.cos(angle), np.sin(angle)
        corners = outline @ np.array([[cosine, sine], [-sine, cosine]]) + motion.q[k, :2]
        ax.plot(*corners.T, color="#D55E00", linewidth=1.2, label="sledge" if k == -1 else None)
    ax.set(xlabel="$x$ in m", ylabel="$y$ in m", aspect="equal", ylim=(-0.5, 1.1))
    ax.legend(loc="upper right")
plt.show()
