"""Which way does a gripper hold a grooved part?
=============================================

Fingers that press on grooves hold a part across them and lose it along them. Learn how to let a
part carry its grooves as it is turned, and how much it may weigh in every attitude.
"""

import asperity as asp
import matplotlib.pyplot as plt
import numpy as np
from scipy.spatial.transform import Rotation

GRIP = 10.0  # N, of each finger
HALF = (0.01, 0.03, 0.03)

# %%
# A part between two fingers
# --------------------------
# The fingers press along x with prescribed forces. Across the grooves, e₁ of the part, the
# coefficient is 0.6, along them 0.2.

law = asp.FrictionLaw.associated(asp.Ellipse(0.6, 0.2))


def gripped(mass, angle):
    """Return a part whose grooves lie at an angle to the horizontal between two fingers."""
    turned = Rotation.from_euler("x", angle)
    part = asp.Body.box(mass, half_sizes=HALF, orientation=turned)
    across = asp.BodyAxis((0.0, 0.0, 1.0))
    fingers = [
        asp.PointPlane(
            0,
            point=(side * HALF[0], 0.0, 0.0),
            plane=asp.Plane(
                point=(side * HALF[0], 0.0, 0.0), normal=(-side, 0.0, 0.0), axis=(0, 0, 1)
            ),
            law=law,
            frame=across,
            normal_force=GRIP,
        )
        for side in (-1.0, 1.0)
    ]
    return asp.RigidBodies([part], pairs=fingers)


# %%
# The heaviest part
# -----------------
# The weight has to lie in the reservoirs of both fingers, m g ≤ 2 F r(θ), where r is the radius of
# the ellipse towards the vertical.

angles = np.deg2rad(np.arange(0.0, 181.0, 15.0))
towards = np.stack([np.cos(angles), np.sin(angles)], axis=-1)
limits = 2.0 * GRIP / law.reservoir.gauge(towards) / 9.81
held, fallen = [], []
for angle, limit in zip(angles, limits, strict=True):
    for mass in (0.99 * limit, 1.01 * limit):
        run = asp.integrate(gripped(mass, angle), t_end=0.2)
        (held if abs(run.q[-1, 2]) < 1e-12 else fallen).append((angle, mass))
print(f"{len(held)} parts are held, {len(fallen)} are lost")
assert held == list(zip(angles, 0.99 * limits, strict=True))

# %%
# How it is lost
# --------------
# Along the grooves and across them a part that is too heavy falls with g − 2 μ F/m; grooves that
# lie obliquely lead it aside.

for angle, mu in ((0.0, 0.6), (np.pi / 2, 0.2)):
    run = asp.integrate(gripped(2.0, angle), t_end=0.2)
    fall, expected = -run.q[-1, 2], 0.5 * (9.81 - 2.0 * mu * GRIP / 2.0) * 0.2**2
    print(f"it falls {1e3 * fall:.6f} mm in 0.2 s, by Coulomb's law {1e3 * expected:.6f} mm")
    assert abs(fall - expected) < 1e-9
run = asp.integrate(gripped(1.0, np.deg2rad(45.0)), t_end=0.1)
aside = np.rad2deg(np.arctan2(abs(run.q[-1, 1]), -run.q[-1, 2]))
print(f"with grooves at 45° it slips {aside:.1f}° beside the vertical")

# %%

with asp.plot.style():
    figure, ax = plt.subplots(figsize=(7.6, 4.4), layout="constrained")
    fine = np.linspace(0.0, np.pi, 200)
    radius = law.reservoir.radius(fine)
    ax.plot(np.rad2deg(fine), 2.0 * GRIP * radius / 9.81, color="#0072B2", label="m g = 2 F r")
    for parts, marker, color, label in (
        (held, "o", "#009E73", "held"),
        (fallen, "x", "#D55E00", "lost"),
    ):
        ax.plot(
            *np.transpose([(np.rad2deg(a), m) for a, m in parts]), marker, color=color, label=label
        )
    ax.set(xlabel="angle of the grooves to the horizontal in degrees", ylabel="mass in kg")
    ax.set(ylim=(0.0, 1.4))
    ax.legend(loc="upper center")
plt.show()
