"""Is my law associated, and does it matter?
=========================================

A law is associated if it slides along the normals of its own reservoir; only then do two motions
under it never drive each other apart. Learn how to ask a law, and what the witness of a verdict is.
"""

import asperity as asp
import matplotlib.pyplot as plt

# %%
# Three laws with the same forces at their limit
# ----------------------------------------------

reservoir = asp.Ellipse(0.6, 0.2)
laws = {
    "associated": asp.FrictionLaw.associated(reservoir),
    "collinear": asp.FrictionLaw.collinear(reservoir),
    "extended": asp.FrictionLaw(reservoir, asp.Ellipse(2.0, 1.0)),
}
for name, law in laws.items():
    print(
        f"{name:10}  associated: {bool(law.is_associated)!s:5}  collinear: "
        f"{bool(law.is_collinear)!s:5}  dissipates: {bool(law.is_dissipative)}"
    )

# %%
# Witnesses
# ---------
# A law is monotone if (γ − γ*)·(λ − λ*) ≤ 0 for all pairs of sliding states. The verdict on the
# collinear law is no, and its witness is a pair that proves it: one state slides, the other one
# sticks, and the power of the difference is positive, so that they drive each other apart.

verdict = laws["collinear"].is_maximal_monotone
slip, force, other_slip, other_force = verdict.witness
power = (slip - other_slip) @ (force - other_force)
print(f"the collinear law is monotone: {bool(verdict)}, (γ − γ*)·(λ − λ*) = {power:.4f}")
print(f"the associated law is monotone: {bool(laws['associated'].is_maximal_monotone)}")

# %%
# Forces and sliding directions
# -----------------------------
# Arrows are sliding directions at the forces that they belong to. Purple: the witness, a force that
# slides along the arrow and one that sticks (square).

with asp.plot.style():
    figure, axes = plt.subplots(1, 3, figsize=(12.0, 3.4), layout="constrained")
    for ax, (name, law) in zip(axes, laws.items(), strict=True):
        asp.plot.plot_law(law, ax=ax, angles=20, legend=False)
        ax.set(title=name, xlim=(-0.85, 0.85), ylim=(-0.42, 0.42))
    arrow = {"arrowstyle": "->", "color": "#CC79A7", "lw": 2.5, "shrinkA": 0}
    axes[1].annotate("", -force + 0.25 * slip, -force, arrowprops=arrow, zorder=5)
    axes[1].plot(*-force, "o", color="#CC79A7", zorder=6)
    axes[1].plot(*-other_force, "s", color="#CC79A7", zorder=6)
    figure.legend(*axes[2].get_legend_handles_labels(), loc="outside lower center", ncols=4)
plt.show()
