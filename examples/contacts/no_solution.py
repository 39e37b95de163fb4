"""What if there is no solution, or more than one?
===============================================

A lever that leans against the motion of a belt can lock, and then no force holds it. Learn how to
list all solutions of a contact, and what is raised, with which proof, if there is none.
"""

import asperity as asp
import matplotlib.pyplot as plt
import numpy as np

# %%
# A lever on a belt
# -----------------
# The lever of 1 kg and 1 m turns with the rate s about a hinge above the belt. Its tip, at the
# angle θ from the vertical, has the normal velocity s sin θ and slides with s cos θ + v.


def lever(angle, mu, rate, belt=1.0):
    """Return the contact problem of the tip; the lever turns with a rate in rad/s."""
    w = np.array([np.sin(angle), np.cos(angle)])
    law = asp.FrictionLaw.isotropic(mu, dimension=1)
    free = rate * w + [0.0, belt]
    return asp.ContactProblem(3.0 * np.outer(w, w), free_velocity=free, laws=law)


# %%
# All solutions of a contact
# --------------------------
# A lever that just lifts off may go on doing so. If it locks, friction may just as well hold it.

for solution in lever(np.deg2rad(20.0), mu=0.8, rate=0.1).solutions(0):
    print(f"{solution.phase.name.lower()}: percussion {solution.percussion} N s")

# %%
# No solution
# -----------
# A lever that comes down while it locks cannot be stopped by any percussion. Its only contact is
# searched for all solutions, and has none.

try:
    lever(np.deg2rad(20.0), mu=0.8, rate=-0.1).solve()
except asp.NoSolutionError as error:
    proof = error.infeasibility
    print(f"no solution, by {proof.kind} of contact {proof.contact}")

# %%
# How many solutions are there?
# -----------------------------
# The lever locks for μ > tan θ.

angles, mus = np.linspace(2.0, 60.0, 40), np.linspace(0.05, 1.5, 40)
numbers = {
    rate: [[len(lever(angle, mu, rate).solutions(0)) for angle in np.deg2rad(angles)] for mu in mus]
    for rate in (-0.1, 0.1)
}
with asp.plot.style():
    figure, axes = plt.subplots(1, 2, figsize=(10.0, 4.2), sharey=True, layout="constrained")
    colors = ["#D55E00", "0.9", "#56B4E9"]
    for ax, (rate, number) in zip(axes, numbers.items(), strict=True):
        ax.contourf(angles, mus, number, levels=[-0.5, 0.5, 1.5, 2.5], colors=colors)
        ax.plot(angles, np.tan(np.deg2rad(angles)), "k--")
        ax.set(xlabel=r"angle $\theta$ in degrees", ylim=(mus[0], mus[-1]))
        ax.set_title("The lever comes down" if rate < 0.0 else "The lever goes up")
        ax.annotate("one solution", (42.0, 0.35))
    axes[0].annotate("no solution", (10.0, 1.1))
    axes[1].annotate("two solutions", (10.0, 1.1))
    axes[0].annotate(r"$\mu = \tan\theta$", (52.0, 1.36), ha="right")
    axes[0].set_ylabel(r"friction coefficient $\mu$")
plt.show()
