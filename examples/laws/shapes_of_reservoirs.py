"""Which shapes can a force reservoir have?
========================================

A reservoir is any set that is star-shaped with respect to the origin. Learn which ready sets there
are, how to combine them, and how to find out whether an outline of your own qualifies.
"""

import asperity as asp
import matplotlib.pyplot as plt
import numpy as np

# %%
# Ready sets
# ----------
# Half-widths and radii are friction coefficients, in the plane of the contact.

theta = np.linspace(0.0, 2.0 * np.pi, 12, endpoint=False)
sets = {
    "Disk": asp.Disk(0.8),
    "Ball, dimension 2": asp.Ball(0.8, dimension=2),
    "Ellipse": asp.Ellipse(1.0, 0.5, angle=0.4),
    "Rectangle": asp.Rectangle(0.9, 0.5, angle=0.3),
    "Box": asp.Box(lower=[-0.6, -0.5], upper=[1.0, 0.7]),
    "Superellipse": asp.Superellipse(1.0, 0.6, 4.0),
    "CappedRectangle": asp.CappedRectangle(0.5, 0.5, cap=0.45),
    "WedgeAsperity": asp.WedgeAsperity(1.2, beta=np.deg2rad(35.0)).scaled(0.16),
    "Polygon": asp.Polygon([[1.0, -0.5], [0.4, 0.2], [0.8, 0.9], [-0.9, 0.5], [-0.5, -0.8]]),
    "PolarCurve": asp.PolarCurve(theta, 0.75 + 0.2 * np.cos(3.0 * theta)),
    "SupportCurve": asp.SupportCurve(theta, 0.75 + 0.06 * np.cos(3.0 * theta)),
}

# %%
# Combinations
# ------------
# Sets are intersected, united, added, and mapped by a matrix; any of these is a set again.

both = asp.Ellipse(1.0, 0.6) & asp.Rectangle(0.7, 0.9, angle=0.3)
either = asp.Ellipse(1.0, 0.35) | asp.Ellipse(0.35, 0.8)
total = asp.Rectangle(0.5, 0.3) + asp.Ellipse(0.4, 0.2, angle=0.7)
print(f"a sum of convex sets is convex: {bool(total.is_convex)}, a union: {bool(either.is_convex)}")
sets |= {"Intersection  &": both, "Union  |": either, "MinkowskiSum  +": total}
sets["Mapped"] = asp.Superellipse(0.8, 0.6, 3.0).mapped([[1.0, 0.5], [0.0, 1.0]])
for name, one in sets.items():
    largest = one.radius(np.linspace(0.0, 2.0 * np.pi, 721)).max()
    print(f"{name:18} convex: {bool(one.is_convex)!s:5}  largest coefficient {largest:.2f}")

# %%
# An outline of your own
# ----------------------
# A set with a slot is not star-shaped: some ray from the origin leaves it and enters it again. The
# witness of the verdict is a point where that happens.

outline = [[1, -1], [1, 1], [-1, 1], [-1, 0.7], [0.5, 0.7], [0.5, 0.3], [-1, 0.3], [-1, -1]]
verdict = asp.star_shape(outline)
print(f"slotted square star-shaped: {bool(verdict)}, see the point {verdict.witness[0]}")

# %%
# All of them
# -----------
# Only a convex set can be its own direction set; every other one needs a convex set beside it.

with asp.plot.style():
    figure, axes = plt.subplots(4, 4, figsize=(10.0, 8.6), layout="constrained")
    for ax, (name, one) in zip(axes.flat, sets.items(), strict=False):
        asp.plot.plot_set(one, ax=ax, color="#0072B2" if one.is_convex else "#D55E00")
        ax.set(title=name)
    last = axes.flat[-1]
    last.fill(*np.transpose(outline), color="0.6", alpha=0.4)
    last.set(title="refused: not star-shaped", aspect="equal")
    for ax in axes.flat:
        ax.plot(0.0, 0.0, "k.", markersize=5.0)
        ax.set(xlabel="", ylabel="", xlim=(-1.3, 1.3), ylim=(-1.1, 1.1))
        ax.tick_params(labelbottom=False, labelleft=False)
    figure.suptitle("Blue: convex. Orange: star-shaped only.")
plt.show()
