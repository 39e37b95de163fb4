"""Why does a surface slide easily one way only?
=============================================

Fur, velvet and the scales of a snake resist one sense of sliding more than the other. Learn how to
give friction a sense, and how far it carries a block that is only shaken to and fro.
"""

import asperity as asp
import matplotlib.pyplot as plt
import numpy as np

# %%
# Reservoirs that are not symmetric
# ---------------------------------
# A reservoir that is not symmetric about the origin bears different forces in opposite
# directions. Wedges whose flanks have unequal slopes are one source of such a law: climbing the
# gentle flanks takes less force than climbing the steep ones. A polygon can have any coefficients.

laws = {
    "wedges of 5° and 40°": asp.FrictionLaw.asperity(0.5, beta=np.deg2rad([5.0, 40.0])),
    "velvet": asp.FrictionLaw.associated(
        asp.Polygon([[0.3, -0.2], [0.3, 0.2], [-0.1, 0.4], [-0.7, 0.2], [-0.7, -0.2], [-0.1, -0.4]])
    ),
    "the same both ways": asp.FrictionLaw.isotropic(0.45),
}
for name, law in laws.items():
    forward, backward = np.linalg.norm(law.force([[1.0, 0.0], [-1.0, 0.0]]), axis=-1)
    print(f"{name:22} forward {forward:.3f}, backward {backward:.3f}")

# %%
# A block on a shaken tray
# ------------------------
# The tray swings along x, and nothing but friction tells the two senses apart. What pushes the
# block forward is the friction of a tray that overtakes it.

shaken = asp.Plane(velocity=asp.Sine([1.0, 0.0], frequency=4.0))
half = (0.02, 0.02, 0.01)
block = asp.Body.box(0.1, half_sizes=half, position=(0.0, 0.0, half[2]))
motions = {}
for name, law in laws.items():
    foot = asp.PointPlane(0, point=(0.0, 0.0, -half[2]), plane=shaken, law=law)
    system = asp.RigidBodies([block], pairs=[foot])
    motions[name] = asp.simulate(system, dt=1e-3, t_end=2.0)
    print(f"{name:22} carried {motions[name].q[-1, 0]:+.3f} m in 2 s")

# %%
# The block is carried to the side from which sliding forward means less friction.

with asp.plot.style():
    figure, (left, right) = plt.subplots(1, 2, figsize=(10.0, 4.4), layout="constrained")
    colors = ("#0072B2", "#D55E00", "#009E73")
    for law, color in zip(laws.values(), colors, strict=True):
        asp.plot.plot_set(law.reservoir, ax=left, color=color)
    left.plot(0.0, 0.0, "k+")
    left.set(title="Reservoirs")
    for (name, motion), color in zip(motions.items(), colors, strict=True):
        right.plot(motion.t, motion.q[:, 0], color=color, label=name)
    right.set(title="Block on the shaken tray", xlabel="time in s", ylabel="$x$ in m")
    right.legend(loc="upper left")
plt.show()
