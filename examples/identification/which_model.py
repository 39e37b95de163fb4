"""Which shapes of law does my record deserve?
===========================================

A circle is too simple, and a curve with twenty parameters fits noise. Learn how models of C and D
are compared, by BIC and by turns that were left out, and how to see what a model misses.
"""

import asperity as asp
import matplotlib.pyplot as plt
from asperity import identify

law = asp.FrictionLaw(asp.Superellipse(0.537, 0.457, 2.94), asp.Superellipse(1.84, 1.19, 2.51))
machine = identify.VirtualTribometer(law, normal_force=9.3, turns=4, sample_rate=300.0, seed=4)
data = identify.process(machine.record())

# %%
# Pairs of models
# ---------------
# Models have names; those with options are objects.

pairs = [
    (identify.CircleReservoir(), identify.CircleDirection()),
    (identify.SuperellipseReservoir(2.0), identify.CircleDirection()),
    (identify.SuperellipseReservoir(2.0), identify.SuperellipseDirection(2.0)),
    (identify.SuperellipseReservoir(), identify.SuperellipseDirection()),
    (identify.FourierReservoir(6), identify.FourierDirection(6)),
]
names = ["circles", "ellipse, collinear", "ellipses", "superellipses", "curves of order 6"]
comparison = identify.compare_models(data, pairs=pairs)
for name, candidate in zip(names, comparison.candidates, strict=True):
    print(
        f"{name:18} {candidate.parameters:2} parameters, BIC {candidate.bic:9.1f}, "
        f"left-out turns missed by {candidate.left_out:.2%}"
    )
best = comparison.best
print(f"the best has {best.parameters} parameters")

# %%
# What a model misses
# -------------------
# Residuals of a good model show no pattern over the direction.

fits = {
    name: identify.fit_law(data, reservoir=reservoir, direction=direction)
    for name, (reservoir, direction) in zip(names, pairs, strict=True)
    if name in ("ellipses", "superellipses")
}
with asp.plot.style():
    figure, axes = plt.subplots(2, 2, figsize=(11.0, 6.4), sharex=True, layout="constrained")
    for (above, below), (name, fit) in zip(axes.T, fits.items(), strict=True):
        asp.plot.plot_fitted_forces(fit, ax=above)
        above.set(title=f"Forces and {name}", xlabel="")
        asp.plot.plot_residuals(fit, ax=below)
        below.set(title="What is left", ylim=(-0.12, 0.12))
plt.show()
