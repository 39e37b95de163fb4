"""Why does a skate glide where it points?
=======================================

A blade slides easily along itself and hardly across, whatever the ice is like: the body carries the
law. Learn how to choose what carries the axes of a law, and what difference that makes.
"""

import asperity as asp
import matplotlib.pyplot as plt
import numpy as np

# %%
# One law, two carriers
# ---------------------
# The coefficient is 0.01 along e₁ and 5 across. The axis e₁ belongs to the ice, as a groove does,
# or to the body, as a blade does.

law = asp.FrictionLaw.associated(asp.Ellipse(0.01, 5.0))
skate = asp.Body.box(
    1.0, half_sizes=(0.15, 0.02, 0.05), velocity=(2.0, 0.0, 0.0), angular_velocity=(0.0, 0.0, 1.0)
)
carriers = {"grooves of the ice": "plane", "blade of the skate": asp.BodyAxis((1.0, 0.0, 0.0))}
runs = {}
for name, frame in carriers.items():
    blade = asp.PointPlane(0, point=(0.0, 0.0, 0.0), plane=asp.Plane(), law=law, frame=frame)
    system = asp.RigidBodies([skate], pairs=[blade])
    runs[name] = asp.simulate(system, dt=1e-3, t_end=3.0)
    heading = np.rad2deg(np.arctan2(runs[name].u[-1, 1], runs[name].u[-1, 0]))
    print(f"{name}: after 3 s it moves at {heading:.1f}°, and points at {np.rad2deg(3.0):.1f}°")

# %%
# Both skates turn with 1 rad/s. The blade leads along a circle, the groove straight ahead.

with asp.plot.style():
    figure, ax = plt.subplots(figsize=(8.0, 5.0), layout="constrained")
    for (name, run), color in zip(runs.items(), ("#0072B2", "#D55E00"), strict=True):
        ax.plot(*run.q[:, :2].T, color=color, label=name)
        shown = run.q[::500]
        heading = 2.0 * np.arctan2(shown[:, 6], shown[:, 3])
        ax.quiver(*shown[:, :2].T, np.cos(heading), np.sin(heading), color=color, scale=14.0)
    ax.set(xlabel="$x$ in m", ylabel="$y$ in m", title="Paths, and where the skate points")
    ax.set(aspect="equal", xlim=(-0.5, 6.5), ylim=(-1.0, 4.2))
    ax.legend(title="The law belongs to the", loc="upper right")
plt.show()
