"""How rough must stones be for an arch to stand?
==============================================

An arch of stones without mortar stands by its shape and by friction, or slides apart. Learn how to
let a solver decide between the two, over a parameter, and what a grain in the stones changes.
"""

import asperity as asp
import matplotlib.pyplot as plt
import numpy as np
from asperity import problems

# %%
# A step from rest
# ----------------
# ``arch`` returns a step of a semicircle of stones that are at rest. It stands if percussions exist
# with which all velocities after the step are zero.


def fastest(stones, law, push=0.0):
    """Return the largest velocity of a contact after a step of 10 ms, in m/s."""
    solution = problems.arch(stones, push=push, law=law).solve(tolerance=1e-9)
    return np.abs(solution.velocity).max()


mus = np.linspace(0.05, 0.6, 23)
speeds = {
    stones: [fastest(stones, asp.FrictionLaw.isotropic(mu)) for mu in mus]
    for stones in (10, 20, 30)
}
for stones, series in speeds.items():
    stands = mus[np.array(series) < 1e-6][0]
    print(f"{stones} stones stand from μ = {stands:.3f} on")

# %%
# A push from the side
# --------------------
# Joints may be rougher across the arch (second tangent) than along it, or the other way round. From
# some coefficient on, the push opens joints before any stone slips: more friction does not help.

pushes = np.linspace(0.0, 60.0, 21)
laws = {
    "0.5 both ways": asp.FrictionLaw.isotropic(0.5),
    "0.4 one way, 0.6 the other": asp.FrictionLaw.associated(asp.Ellipse(0.4, 0.6)),
    "0.6 one way, 0.4 the other": asp.FrictionLaw.associated(asp.Ellipse(0.6, 0.4)),
}

# %%

with asp.plot.style():
    figure, (left, right) = plt.subplots(1, 2, figsize=(10.5, 4.4), layout="constrained")
    for stones, series in speeds.items():
        left.plot(mus, series, "o-", markersize=3.5, label=f"{stones} stones")
    left.set(title="Under its own weight", xlabel=r"friction coefficient $\mu$")
    left.set(ylabel="fastest joint after 10 ms in m/s")
    left.legend()
    for (name, law), line in zip(laws.items(), ("-", "-", "--"), strict=True):
        right.plot(pushes, [fastest(20, law, push) for push in pushes], line, label=name)
    right.set(title="20 stones pushed near the crown", xlabel="push in N")
    right.set(ylabel="fastest joint after 10 ms in m/s")
    right.legend()
plt.show()
