"""Which way does a contact slide at a corner of its reservoir?
============================================================

Where a set has a corner, one force belongs to many sliding directions: those of its normal cone.
Learn what normal and tangent cones are, and how a projection finds the force that a push leads to.
"""

import asperity as asp
import matplotlib.pyplot as plt
import numpy as np

# %%
# A corner and a smooth point
# ---------------------------
# Two mechanisms that limit a force each by itself, such as a groove and a clamp, have the
# intersection of their reservoirs.

reservoir = asp.Ellipse(0.6, 0.4) & asp.Rectangle(0.45, 0.5)
height = 0.4 * np.sqrt(1.0 - (0.45 / 0.6) ** 2)
corner, smooth = np.array([0.45, height]), reservoir.support_point([-0.4, 1.0])
for name, point in (("corner", corner), ("smooth point", smooth)):
    cone = reservoir.normal_cone(point)
    rays = cone.generators
    angles = np.sort(np.rad2deg(np.arctan2(rays[:, 1], rays[:, 0])))
    print(f"{name}: sliding directions from {angles[0]:.1f}° to {angles[-1]:.1f}°")

# %%
# A block that is pushed
# ----------------------
# A block of 1 kg gets a push. In a step with G = I the friction that answers is the projection of
# the push onto the reservoir; the rest of the push is what slides.

law = asp.FrictionLaw.associated(reservoir)
push = np.array([0.75, 0.45])
problem = asp.ContactProblem(np.eye(2), free_velocity=push, laws=law, normal_force=1.0)
solution = problem.solve()
print(f"push {push}, friction {-solution.percussion}, velocity left {solution.velocity}")
print(f"projection of the push: {reservoir.project(push)}")

# %%
# Cones and projections
# ---------------------

with asp.plot.style():
    figure, ax = plt.subplots(figsize=(7.4, 5.4), layout="constrained")
    asp.plot.plot_set(reservoir, ax=ax, label="reservoir $C$")
    for point in (corner, smooth):
        asp.plot.plot_cones(reservoir, x=point, ax=ax, size=0.22)
    asp.plot.plot_projection(reservoir, z=[push, [0.1, -0.55], [-0.7, -0.1]], ax=ax)
    ax.annotate("push", push, (6, 4), textcoords="offset points")
    ax.annotate("normal cone", corner, (-6, 52), textcoords="offset points", color="#009E73")
    ax.annotate("tangent cone", corner, (-92, -34), textcoords="offset points", color="#CC79A7")
    ax.set(xlim=(-0.85, 0.95), ylim=(-0.68, 0.72))
    ax.legend(loc="lower right")
plt.show()
