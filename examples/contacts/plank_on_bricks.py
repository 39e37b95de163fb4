"""How do I state a contact problem of my own bodies?
==================================================

Masses, inertias, and points with normals are all that a step of a scene needs. Learn how to write
them down, and how to see which contacts carry and which slip while a plank on bricks is pulled.
"""

import asperity as asp
import matplotlib.pyplot as plt
import numpy as np
from asperity import problems

# %%
# Two bricks and a plank
# ----------------------
# The bricks are cubes of 0.2 m, the plank is 1.2 m long. Bricks touch ground and plank with four
# corners each. A contact has a lower body and an upper one; the normal points to the upper one.

size, mass = (
    np.array([[0.2, 0.2, 0.2], [0.2, 0.2, 0.2], [1.2, 0.2, 0.05]]),
    np.array([8.0, 8.0, 4.0]),
)
center = np.array([[-0.4, 0.0, 0.1], [0.4, 0.0, 0.1], [0.0, 0.0, 0.225]])
squares = size**2
inertia = [np.diag(m * (s.sum() - s) / 12.0) for m, s in zip(mass, squares, strict=True)]
corners = 0.1 * np.array([[-1, -1], [1, -1], [1, 1], [-1, 1]])
pairs = [(problems.GROUND, 0, 0.0), (problems.GROUND, 1, 0.0), (0, 2, 0.2), (1, 2, 0.2)]
points = [
    [center[upper if upper < 2 else lower, 0] + x, y, height]
    for lower, upper, height in pairs
    for x, y in corners
]
frame = np.array([[0.0, 0.0, 1.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]])
scene = problems.Scene(
    mass=mass,
    inertia=inertia,
    center=center,
    lower=np.repeat([lower for lower, _, _ in pairs], 4),
    upper=np.repeat([upper for _, upper, _ in pairs], 4),
    point=points,
    frame=np.tile(frame, (16, 1, 1)),
)

# %%
# Pull the plank
# --------------
# The plank has sawn undersides, rougher across the grain: 0.3 along x and 0.6 across. On the ground
# friction is 0.5.

grain = asp.FrictionLaw.associated(asp.Ellipse(0.3, 0.6))
ground = asp.FrictionLaw.isotropic(0.5)
laws, dt = [ground] * 8 + [grain] * 8, 0.01
pulls = {}
for name, direction in {"along the plank": [1, 0, 0], "across it": [0, 1, 0]}.items():
    for pull in np.arange(2.0, 60.0, 1.0):
        force = np.zeros((3, 3))
        force[2] = pull * np.array(direction)
        problem = scene.problem(law=laws, force=force, dt=dt)
        solution = problem.solve()
        if np.abs(solution.velocity.reshape(-1, 3)[:, 1:]).max() > 1e-6:
            break
    pulls[name] = problem, solution
    slipping = solution.phase == asp.Phase.SLIP
    where = "under the plank" if slipping[8:].any() else "under the bricks"
    print(f"pulled {name}, something moves from {pull:.0f} N on; contacts slip {where}")

# %%
# Who carries?
# ------------
# Forces on the upper body of each contact, when the plank begins to slide along; bodies are drawn
# apart. What four feet share is not determined by rigid bodies, only what they add up to.

problem, solution = pulls["along the plank"]
forces = solution.percussion.reshape(-1, 3) / dt
apart = np.array([0.12, 0.12, 0.3])
with asp.plot.style():
    figure, ax = plt.subplots(figsize=(9.0, 4.4), layout="constrained")
    for middle, extent, up in zip(center, size, apart, strict=True):
        x, z = middle[0] - extent[0] / 2.0, middle[2] - extent[2] / 2.0 + up
        ax.add_patch(plt.Rectangle((x, z), extent[0], extent[2], facecolor="0.92", edgecolor="0.5"))
    near = scene.point[:, 1] < 0.0
    x, z = scene.point[near, 0], scene.point[near, 2] + np.where(scene.lower[near] < 0, 0.0, 0.15)
    arrows = {"scale": 140.0, "scale_units": "xy", "angles": "xy", "width": 0.004, "zorder": 5}
    ax.quiver(x, z, 0.0 * x, forces[near, 0], color="#0072B2", label="normal force", **arrows)
    ax.quiver(x, z, forces[near, 1], 0.0 * x, color="#D55E00", label="friction", **arrows)
    ax.axhline(0.0, color="black")
    ax.set(xlabel="$x$ in m", ylabel="$z$ in m, bodies apart", aspect="equal")
    ax.set(xlim=(-0.75, 0.75), ylim=(-0.05, 0.68), title="Plank pulled to the right")
    ax.legend(loc="upper right", ncols=2)
plt.show()
