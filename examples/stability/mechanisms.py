"""Which mechanism makes my system unstable?
=========================================

Friction shakes systems in several ways, and ``stability`` names the one at work. Learn to ask it
for the reason, with the classical mechanisms at hand, and where their limits are.
"""

import asperity as asp
import matplotlib.pyplot as plt
import numpy as np
from asperity import mechanisms

# %%
# Four ways to lose stability
# ---------------------------
# Each is a function of the friction coefficient, as an example of Fig. 13 of Walker & Leine (2019).

families = {
    "falling friction": lambda mu: mechanisms.stribeck_block(mu=mu, belt_velocity=0.2),
    "mode coupling": mechanisms.mode_coupling,
    "velocity feedback": mechanisms.FrictionalImpactOscillator,
    "follower force": mechanisms.FollowerPendulum,
}
mus = {name: np.linspace(0.02, 1.2, 60) for name in families}
mus["follower force"] = np.linspace(0.02, 0.45, 60)
growth = {}
for name, family in families.items():
    found = [asp.stability(family(mu)) for mu in mus[name]]
    growth[name] = [one.growth_rate for one in found]
    first = next(k for k, one in enumerate(found) if one.kind == "unstable")
    print(f"{name}, unstable from μ = {mus[name][first]:.2f}\n    {found[first].reason}")

# %%
# Steady sliding itself
# ---------------------
# What is linearised is a state of steady sliding, which can be asked for by itself.

steady = asp.equilibrium(mechanisms.mode_coupling(0.5))
print(steady.summary())
state = asp.stability(mechanisms.mode_coupling(0.9))
print("what each cause does to the growth:", state.mechanisms)

# %%
# Growth rates
# ------------

with asp.plot.style():
    figure, axes = plt.subplots(2, 2, figsize=(9.6, 6.0), layout="constrained")
    for ax, (name, rates) in zip(axes.flat, growth.items(), strict=True):
        rates = np.array(rates)
        ax.axhline(0.0, color="black", linewidth=0.8)
        ax.plot(mus[name], rates)
        ax.fill_between(mus[name], 0.0, rates, where=rates > 1e-9, alpha=0.25)
        ax.set(title=name.capitalize(), xlabel=r"friction coefficient $\mu$")
        ax.set(ylabel="growth rate in 1/s")
plt.show()
