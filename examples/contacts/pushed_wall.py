"""How hard can I push a brick before the wall gives way?
======================================================

In walls, piles and arches hundreds of contacts share the loads. Learn how to state such a problem,
how to read what every contact does, and how the certificate tells how exact a solution is.
"""

import asperity as asp
import matplotlib.pyplot as plt
import numpy as np
from asperity import problems

# %%
# Walls on grooved beds
# ---------------------
# ``wall`` returns a time step of a wall as a contact problem: masses, directions of contacts,
# velocities without contact forces, and one law per contact. A brick in the middle is pushed along
# the wall, whose grooves lie across the push or along it.

laws = {
    "grooves across": asp.FrictionLaw.associated(asp.Ellipse(0.6, 0.3)),
    "grooves along": asp.FrictionLaw.associated(asp.Ellipse(0.3, 0.6)),
}
pushes = np.linspace(0.0, 30.0, 16)
solutions = {
    name: [problems.wall(6, columns=4, push=push, law=law).solve() for push in pushes]
    for name, law in laws.items()
}

# %%
# What contacts do
# ----------------
# The certificate says by how much the contact laws are violated, each in its own unit.

last = solutions["grooves along"][-1]
certificate = last.certificate
print(f"{len(last.phase)} contacts: {certificate.stick} stick, {certificate.slip} slip")
print(f"penetration {certificate.penetration_velocity:.0e} m/s")
print(f"tension {certificate.tension:.0e} N s")
for stage in last.stages:
    print(f"{stage.method}: {stage.iterations} iterations, then residual {stage.residual:.0e}")

# %%
# Percussions and phases
# ----------------------
# The first row of each contact is the normal percussion, the two others are friction.

load, first, second = last.percussion.reshape(-1, 3).T
with asp.plot.style():
    figure, (left, right) = plt.subplots(1, 2, figsize=(10.5, 4.4), layout="constrained")
    for name, found in solutions.items():
        fastest = [np.hypot(*one.velocity.reshape(-1, 3)[:, 1:].T).max() for one in found]
        left.plot(pushes, fastest, "o-", markersize=4.0, label=name)
    left.set(title="Largest speed of slip", xlabel="push in N s", ylabel="speed in m/s")
    left.legend(loc="upper left")
    asp.plot.plot_set(laws["grooves along"].reservoir, ax=right, color="0.5")
    for name, phase in (("stick", asp.Phase.STICK), ("slip", asp.Phase.SLIP)):
        chosen = (last.phase == phase) & (load > 1e-9)
        ratio = -np.stack([first[chosen], second[chosen]]) / load[chosen]
        right.plot(*ratio, ".", label=name, color="#0072B2" if name == "stick" else "#D55E00")
    right.set(title=f"Friction of each contact, push {pushes[-1]:.0f} N s", xlim=(-0.6, 0.9))
    right.set(xlabel="$-P_1/P_N$", ylabel="$-P_2/P_N$")
    right.legend(loc="upper right")
plt.show()
