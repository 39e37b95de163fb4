"""Which law does a whole contact patch have?
==========================================

A body that stands on a face slides and turns at once, and friction is a force with a torque. Learn
how a law is fitted to wrenches and twists, and how to tell what the patch stands on.
"""

import asperity as asp
import matplotlib.pyplot as plt
import numpy as np
from asperity import identify

# %%
# Measured pairs
# --------------
# A body on three points was moved in many ways, and its wrench was measured with 3 % of noise.

places = np.array([[0.06, 0.00], [-0.03, 0.05], [-0.03, -0.05]])
loads = np.array([2.0, 5.0, 3.0])
random = np.random.default_rng(0)
twist = random.normal(size=(300, 3)) * [1.0, 1.0, 20.0]
velocity = twist[:, None, :2] + twist[:, None, 2:] * places[:, ::-1] * [-1.0, 1.0]
along = velocity / np.linalg.norm(velocity, axis=-1, keepdims=True)
force = 0.3 * loads[:, None] * along
torque = (places[:, 0] * force[..., 1] - places[:, 1] * force[..., 0]).sum(axis=1)
wrench = np.column_stack([force.sum(axis=1), torque])
wrench += 0.03 * wrench.std(axis=0) * random.normal(size=wrench.shape)

# %%
# Three models
# ------------
# Parts of the pairs are left out in turn and predicted from the others.

models = {
    "ellipsoid": {},
    "round area": {"reservoir": "contensou"},
    "three points": {"reservoir": "supports", "points": 3},
}
comparison = identify.compare_patches(wrench, twist, models=models, length=0.05)
for candidate in comparison.candidates:
    print(f"{candidate.name:13} left-out wrenches missed by {candidate.left_out:.1%}")
best = comparison.best
fit = identify.fit_patch(wrench, twist, length=0.05, **models[best.name])
print(fit.summary())

# %%
# Known points
# ------------
# Where the points are known, pushes tell the law of a single point: is it anisotropic?

step = 1e-3 * twist
pushes = np.column_stack([np.zeros((300, 3)), step, wrench])
supports = identify.fit_supports(pushes, places, loads=loads)
print(f"μ of the points: {supports.parameters['mu']}, anisotropic: {supports.anisotropic}")

# %%
# Errors of the models, and the points that were found
# ----------------------------------------------------

x, y, mu_load = (
    np.array([fit.parameters[f"point_{k}.{name}"].value for k in (1, 2, 3)])
    for name in ("x1", "x2", "load")
)
with asp.plot.style():
    figure, (left, right) = plt.subplots(1, 2, figsize=(10.0, 4.4), layout="constrained")
    errors = [100.0 * candidate.left_out for candidate in comparison.candidates]
    left.bar(list(models), errors)
    left.set(title="Error of left-out wrenches", ylabel="error in %")
    right.scatter(*1e3 * places.T, s=60.0 * loads, color="0.8", label="true, area as the load")
    right.scatter(1e3 * x, 1e3 * y, s=60.0 * mu_load / 0.3, facecolors="none", edgecolors="#D55E00")
    right.scatter([], [], facecolors="none", edgecolors="#D55E00", label="found")
    right.set(title="Support points", xlabel="$x$ in mm", ylabel="$y$ in mm", aspect="equal")
    right.set(xlim=(-60.0, 90.0), ylim=(-80.0, 80.0))
    right.legend(loc="upper right")
plt.show()
